//! Verilog from RustHDL: a typed emitter whose Verilog behaves exactly like the simulation, or which refuses the block.
//!
//! RustHDL's own generator loses widths and signs, so its Verilog can compute different values from its simulation.
//! This emitter keeps the type of every expression up to the text. A construct without an exact, plain translation is
//! refused with an [`EmitError`] that names the block, the signal and the remedy.
//!
//! - Input: a RustHDL [`Block`], whose leaves have tags (below), and names: top, prefix, header.
//! - Output: one [`Module`] per Verilog file, sub-modules before those that use them, the top last; byte for byte the
//!   same in each run. It is Verilog-2001, clean under `verilator --lint-only -Wall` without waivers, and accepted by
//!   Icarus and Yosys.
//! - Clock and reset: all registers of a module are clocked by its input `clk` and reset, synchronously, by its input
//!   `rst`; the reset value is also the power-up value.
//! - Sharing: equal sub-blocks are one module. Sub-blocks that differ have different names, because their `@module`
//!   tags contain their sizes. Different contents with one name are an error.
//!
//! A kernel names its module in a comment, and its Verilog begins with the `//!` lines of its file. A leaf has name and
//! description in the first lines of its text:
//!
//! ```text
//! comment!("@module tap_sequencer");   base name of the module; without it, the field path
//!
//! // @dff 8'h05                        a register, inlined
//! // @dff 8'h05 kept                   the same, wired by `kernel!`: the kernel says nothing of its clock and reset
//! // @leaf ram_64x16 reg: read_data    any other leaf, with its outputs that are `reg`
//! // @about 64 x 16 bit block RAM.
//! ```
//!
//! # Passes
//!
//! ```text
//! Block ─► collect ─► scope ─► statements, expressions ─► flow ─► drivers ─► print
//!          nodes      nets     typed                     order    assign or   text
//!                     names    statements                checked  always
//! ```
//!
//! # Limits
//!
//! Signals have 1 to 64 bits. There are no struct signals, no bidirectional ports, no black boxes, and no interface
//! `join` and `link`. An `always @(*)` block whose inputs are all tied to constants *by the parent* has no trigger in
//! an event simulator.

mod collect;
mod compose;
mod connect;
mod drivers;
mod error;
mod expressions;
mod flow;
mod head;
mod ir;
mod leaf;
mod library;
mod modules;
mod names;
mod numbers;
mod paths;
pub mod print;
mod scope;
mod sizes;
mod statements;
mod types;
mod values;
mod wrap;

pub use compose::{ModuleInstance, compose};
pub use connect::connect;
pub use error::{EmitCause, EmitError};
pub use library::{add, digest, own_name, shared_name};
pub use names::{LIBRARY, check_name};
pub use types::Type;

/// First line of the text of the block in which a kernel lists the connections that its logic does not state, each in a line:
/// `output PORT SOURCE`, `input PART.PORT SOURCE`, or `part NAME` for the clock and reset of a part.
pub const CONNECTIONS_TAG: &str = "// @connections";

use posicast_blocks::{Port, PortNote};
use rust_hdl_core::prelude::Block;

/// One Verilog module, one file `NAME.v`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Module {
    /// Name of the module, and of the file without `.v`.
    pub name: String,
    /// The whole text of the file.
    pub text: String,
    /// All ports except `clk`, in the order of the port list.
    pub ports: Vec<Port>,
    /// Whether it has an input `clk`.
    pub clocked: bool,
    /// What the ports are for, where that is known: a composition that has the same ports writes it beside them.
    pub notes: Vec<PortNote>,
}

impl Module {
    /// Whether its name is `base`, with any prefix and any size: `posicast_handover_32x128_f16` is `handover`.
    pub fn is(&self, base: &str) -> bool {
        self.name.match_indices(base).any(|(at, _)| {
            let (before, behind) = (&self.name[..at], &self.name[at + base.len()..]);
            let size = behind.strip_prefix('_').and_then(|size| size.chars().next());
            (before.is_empty() || before.ends_with('_'))
                && (behind.is_empty() || size.is_some_and(|first| first.is_ascii_digit()))
        })
    }

    /// Whether it contains a memory: of all modules only the leaves RAM and ROM do.
    pub fn has_memory(&self) -> bool {
        self.text.contains(" words [0:")
    }
}

/// Parameters of [`emit()`] in addition to the block.
#[derive(Debug, Clone, Default)]
pub struct EmitOptions {
    /// Base name of the top module, which includes the block's size if it has one.
    pub top: String,
    /// Prefix, joined by `_`, of the names of modules whose contents depend on the machine: the names of machine and
    /// axis. All other names begin with [`LIBRARY`]. If it is empty, no name has a prefix, as a bench needs.
    pub prefix: String,
    /// Header of the top's file.
    pub header: Header,
}

/// The comment at the head of a top module's file; version and name are added.
#[derive(Debug, Clone, Default)]
pub struct Header {
    /// Description of the module, in a sentence or some lines.
    pub about: String,
    /// Its build parameters.
    pub parameters: Vec<Parameter>,
    /// Purposes of its ports.
    pub ports: Vec<PortNote>,
}

/// A row of the header's table.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// Name, as elsewhere in the project.
    pub name: String,
    /// Value, with its unit where it has one.
    pub value: String,
    /// Meaning in a few words.
    pub meaning: String,
}

impl Parameter {
    /// A row of the table.
    pub fn new(name: impl Into<String>, value: impl ToString, meaning: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            value: value.to_string(),
            meaning: meaning.into(),
        }
    }
}

/// Documentation of the kernels' files: the name in each `@module` tag, and the lines behind `//!`.
pub type Heads = &'static [(&'static str, &'static str)];

/// Writes `block` as Verilog: sub-modules first, the top last. `heads` become the comments at the heads of the kernels' modules.
///
/// # Errors
/// [`EmitError`] for the first construct that cannot be expressed exactly, or that breaks a rule of the kernels.
pub fn emit<B: Block + ?Sized>(block: &B, options: &EmitOptions, heads: Heads) -> Result<Vec<Module>, EmitError> {
    check_names(options)?;
    let top = collect::collect(block, &options.top)?;
    modules::modules(&top, options, heads)
}

/// Writes a kernel at the sizes `wanted` as Verilog, from the same kernel at a few other sizes.
///
/// Each sample consists of the kernel's sizes and the kernel; all are built for one configuration. A width must be a
/// constant plus the sum of some of the sizes. Two samples determine which ones, if no two subsets of the differences
/// between their sizes have the same sum. At least one more sample must confirm the result.
///
/// # Errors
/// Those of [`emit()`], and an error for numbers that do not follow from the sizes.
pub fn emit_sized<B: Block + ?Sized>(
    samples: &[(&[u32], &B)],
    wanted: &[u32],
    options: &EmitOptions,
    heads: Heads,
) -> Result<Vec<Module>, EmitError> {
    check_names(options)?;
    let sample = |(sizes, block): &(&'_ [u32], &B)| {
        let node = collect::collect(*block, &options.top)?;
        Ok((sizes.to_vec(), node))
    };
    let samples = samples.iter().map(sample).collect::<Result<Vec<_>, EmitError>>()?;
    let top = sizes::resolve(samples, wanted)?;
    modules::modules(&top, options, heads)
}

fn check_names(options: &EmitOptions) -> Result<(), EmitError> {
    let checked = if options.prefix.is_empty() {
        names::check_name(&options.top)
    } else {
        names::check_form(&options.prefix).and_then(|()| names::check_form(&options.top))
    };
    checked.map_err(|cause| EmitError::new(&options.top, "", cause))
}
