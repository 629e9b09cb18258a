//! Numbers that depend on the block: `${..}` in the text of a leaf, and in the name of a module.
//!
//! | in the text | replaced by |
//! |---|---|
//! | `${width NAME}` | w, the width of a port or another signal |
//! | `${last_bit NAME}` | w − 1 |
//! | `${words NAME}` | 2^w |
//! | `${last_word NAME}` | 2^w − 1 |
//! | `${pattern NAME HEX}` | the bit pattern as a sized literal, w bits wide |
//! | `${count ARRAY}` | the number of ports of the array |
//! | `${value NAME}` | the value of a constant, or the reset value of a register |
//! | `${log2 NAME}` | the exponent of a constant that is a power of two, of either sign |
//! | `${if NAME TEXT}` | the text if the value of NAME is not 0, else nothing |

use super::collect::{Kind, Node, Signal};
use super::error::EmitCause;
use super::leaf;

/// Returns the text with its numbers replaced by those of `node`.
pub(super) fn fill(text: &str, node: &Node) -> Result<String, EmitCause> {
    let mut filled = String::new();
    let mut rest = text;
    while let Some((before, from)) = rest.split_once("${") {
        let (number, after) = from
            .split_once('}')
            .ok_or_else(|| EmitCause::Leaf("a `${` without `}`".to_owned()))?;
        filled.push_str(before);
        let wrong = || {
            EmitCause::Leaf(format!(
                "`${{{number}}}` is not a number of the block, or does not fit it"
            ))
        };
        filled.push_str(&self::number(number, node)?.ok_or_else(wrong)?);
        rest = after;
    }
    filled.push_str(rest);
    Ok(filled)
}

fn number(text: &str, node: &Node) -> Result<Option<String>, EmitCause> {
    let parts: Vec<&str> = text.split_whitespace().collect();
    Ok(match parts.as_slice() {
        ["pattern", name, hex] => signal(node, name).and_then(|signal| pattern(signal, hex)),
        ["count", array] => count(node, array),
        ["value", name] => value(node, name)?.map(|value| value.to_string()),
        ["log2", name] => value(node, name)?.and_then(exponent),
        ["if", name, text] => value(node, name)?.map(|value| if value == 0 { "" } else { text }.to_owned()),
        [what, name] => signal(node, name).and_then(|signal| of_width(what, signal.ty.width)),
        _ => None,
    })
}

fn signal<'a>(node: &'a Node, name: &str) -> Option<&'a Signal> {
    node.signals.iter().find(|signal| signal.raw == name)
}

fn of_width(what: &str, width: u32) -> Option<String> {
    let words = 1u128 << width;
    Some(match what {
        "width" => width.to_string(),
        "last_bit" => (width - 1).to_string(),
        "words" => words.to_string(),
        "last_word" => (words - 1).to_string(),
        _ => return None,
    })
}

fn pattern(signal: &Signal, hex: &str) -> Option<String> {
    let pattern = u64::from_str_radix(hex, 16).ok()?;
    let digits = signal.ty.width.div_ceil(4) as usize;
    (pattern & !signal.ty.mask() == 0).then(|| format!("{}'h{pattern:0digits$x}", signal.ty.width))
}

fn count(node: &Node, array: &str) -> Option<String> {
    let element = |port: &&Signal| port.raw.strip_prefix(array).is_some_and(|rest| rest.starts_with('$'));
    match node.ports().filter(element).count() {
        0 => None,
        count => Some(count.to_string()),
    }
}

/// The value of a constant, or the reset value of a register.
fn value(node: &Node, name: &str) -> Result<Option<i128>, EmitCause> {
    let constant = signal(node, name).and_then(|signal| match signal.kind {
        Kind::Constant(pattern) => Some(signal.ty.value(pattern)),
        _ => None,
    });
    let register = node.children.iter().find(|child| child.raw == name);
    match (constant, register) {
        (None, Some(register)) => Ok(leaf::register(register)?.map(|tag| i128::from(tag.initial))),
        (constant, _) => Ok(constant),
    }
}

fn exponent(value: i128) -> Option<String> {
    let size = value.unsigned_abs();
    size.is_power_of_two().then(|| size.trailing_zeros().to_string())
}
