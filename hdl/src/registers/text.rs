//! Types, parts of words and lists, as a bank's Verilog writes them.

use crate::emit::Type;
use crate::emit::print::Lines;
use posicast_blocks::registers::Field;

pub(super) fn bits(width: u32) -> Type {
    Type { width, signed: false }
}

pub(super) fn type_of(field: &Field) -> Type {
    Type {
        width: field.width,
        signed: field.is_signed(),
    }
}

/// A part of a word: `name[7:0]`, `name[3]`, or the whole.
pub(super) fn part(word: &str, field: &Field) -> String {
    match (field.low, field.width) {
        (0, 32) => word.to_owned(),
        (low, 1) => format!("{word}[{low}]"),
        (low, width) => format!("{word}[{}:{low}]", low + width - 1),
    }
}

/// Writes `begin`, then the terms with the operator between them, and `end`.
pub(super) fn joined(lines: &mut Lines, begin: &str, terms: &[String], operator: &str, end: &str) {
    lines.line(&format!("{begin}{}{end}", terms.join(operator)));
}
