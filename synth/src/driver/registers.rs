//! The header of a component's registers.

use super::macros::{self, END, Place};
use posicast_blocks::registers::RegisterMap;

/// Writes `TOP_regs.h`: IORD and IOWR of every register, offset and mask of every field.
pub(super) fn header(top: &str, map: &RegisterMap) -> String {
    let prefix = top.to_uppercase();
    let mut text = macros::head(&format!("{prefix}_REGS_H"), map.about());
    text.push_str("\n#include <stdint.h>\n\n#include \"posicast_io.h\"\n");
    for register in map.registers() {
        macros::register(&mut text, &prefix, register, map.fields(register), &Place::Fixed);
    }
    text.push_str(END);
    text
}
