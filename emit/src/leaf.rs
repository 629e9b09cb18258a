//! Leaves: blocks with hand-written Verilog, and the tag that describes them.
//!
//! ```text
//! // @dff 8'h05                       a register: reset and power-up value as a bit pattern; ports clock, rst, d, q
//! // @dff 8'h05 kept                  a register that its block clocks, resets and keeps without a statement
//!
//! // @leaf ram_64x16 reg: read_data   any other: base name of its module, outputs that its text assigns in `always`
//! // @of_machine                      its contents are a machine's: its name begins with the prefix
//! // @about One line of the header, repeatable.
//! reg [15:0] memory [0:63];           the body, between port list and `endmodule`
//! ```
//!
//! A number that depends on a port's width is written as `${..}`, so that the text serves every size: see
//! [`numbers`](super::numbers).

use super::collect::{Kind, Node};
use super::error::EmitCause;
use super::names;
use super::types::Type;
use rust_hdl_core::prelude::Verilog;

/// A hand-written module, as its tag describes it.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Leaf<'a> {
    pub(super) base_name: &'a str,
    /// Whether its contents belong to one machine.
    pub(super) of_machine: bool,
    /// Raw names of the outputs declared `reg`.
    pub(super) regs: Vec<&'a str>,
    pub(super) about: Vec<&'a str>,
    pub(super) body: Vec<&'a str>,
}

/// A register as described by its tag.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RegisterTag {
    /// Reset and power-up value.
    pub(super) initial: u64,
    /// Whether the owning block clocks it, resets it and keeps its value without a statement in the kernel.
    pub(super) is_kept: bool,
}

/// The tag, if `node` is a register.
pub(super) fn register(node: &Node) -> Result<Option<RegisterTag>, EmitCause> {
    let Verilog::Custom(text) = &node.code else {
        return Ok(None);
    };
    let Some(literal) = text.strip_prefix("// @dff ") else {
        return Ok(None);
    };
    let port = |name: &str, kind: Kind| {
        let found = node.ports().find(|port| port.raw == name && port.kind == kind);
        found.ok_or_else(|| EmitCause::Leaf(format!("a register has no {kind:?} port `{name}`")))
    };
    port("clock", Kind::Input)?;
    port("rst", Kind::Input)?;
    let (next, now) = (port("d", Kind::Input)?, port("q", Kind::Output)?);
    if next.ty != now.ty || node.ports().count() != 4 {
        return Err(EmitCause::Leaf(
            "a register has exactly clock, rst, d and q, the last two of one type".to_owned(),
        ));
    }
    let (literal, is_kept) = match literal.trim().strip_suffix(" kept") {
        Some(literal) => (literal, true),
        None => (literal, false),
    };
    let bad = || {
        EmitCause::Leaf(format!(
            "`{}` is no {}-bit pattern of the form 8'h05",
            literal.trim(),
            now.ty.width
        ))
    };
    let (width, digits) = literal.trim().split_once("'h").ok_or_else(bad)?;
    let value = u64::from_str_radix(digits, 16).map_err(|_| bad())?;
    if width.parse() != Ok(now.ty.width) || value & !now.ty.mask() != 0 {
        return Err(bad());
    }
    Ok(Some(RegisterTag {
        initial: value,
        is_kept,
    }))
}

/// The text of a register, which [`register`] reads.
pub(super) fn register_text(tag: RegisterTag, ty: Type) -> String {
    let kept = if tag.is_kept { " kept" } else { "" };
    format!("// @dff {}'h{:x}{kept}\n", ty.width, tag.initial)
}

/// Splits a leaf's text into its parts.
pub(super) fn parse<'a>(text: &'a str, node: &Node) -> Result<Leaf<'a>, EmitCause> {
    let mut lines = text.lines().map(str::trim_end).peekable();
    let tag = lines.next().and_then(|line| line.strip_prefix("// @leaf "));
    let tag =
        tag.ok_or_else(|| EmitCause::Leaf("the first line is not `// @dff ..` or `// @leaf name ..`".to_owned()))?;
    let (base_name, list) = tag.split_once(" reg:").unwrap_or((tag, ""));
    names::check_name(base_name.trim())?;
    let regs: Vec<_> = list.split(',').map(str::trim).filter(|name| !name.is_empty()).collect();
    for name in &regs {
        if !node.ports().any(|port| port.kind == Kind::Output && port.raw == *name) {
            return Err(EmitCause::Leaf(format!("`{name}` after `reg:` is not an output")));
        }
    }
    let of_machine = lines.next_if_eq(&"// @of_machine").is_some();
    let mut about = Vec::new();
    while let Some(line) = lines.peek().and_then(|line| line.strip_prefix("// @about ")) {
        about.push(line);
        lines.next();
    }
    Ok(Leaf {
        base_name: base_name.trim(),
        of_machine,
        regs,
        about,
        body: lines.collect(),
    })
}
