//! The C driver of an inline shaper with registers: its header of registers, from their map, and the functions that use it.

use super::macros::{self, END, Place};
use super::stage_registers::axis_registers;
use super::{DriverFile, file};
use posicast_blocks::registers::{RegisterMap, WINDOW_WORDS};
use std::fmt::Write;

const INLINE: &str = "POSICAST_INLINE";
const AXIS: &str = "POSICAST_INLINE_AXIS";

/// The sources that are the same for every machine.
const FIXED: [(&str, &str); 4] = [
    ("inc/posicast_io.h", include_str!("c/inc/posicast_io.h")),
    ("inc/posicast_result.h", include_str!("c/inc/posicast_result.h")),
    ("inc/posicast_inline.h", include_str!("c/inc/posicast_inline.h")),
    ("src/posicast_inline.c", include_str!("c/src/posicast_inline.c")),
];

/// The driver of the inline shaper of `machine` with these axes and registers.
pub fn inline_files(machine: &str, axes: &[&str], map: &RegisterMap) -> Vec<DriverFile> {
    let fixed = FIXED.iter().map(|(path, text)| file(path, (*text).to_owned()));
    let header = file("inc/posicast_inline_regs.h", header(machine, axes, map));
    fixed.chain([header]).collect()
}

fn header(machine: &str, axes: &[&str], map: &RegisterMap) -> String {
    let about = format!("Registers of the inline shaper of {machine}: axes {}.", axes.join(", "));
    let mut text = macros::head("POSICAST_INLINE_REGS_H", &about);
    text.push_str(
        "\n#include <stdint.h>\n\n#include \"posicast_io.h\"\n\n/* Words of a window, and bytes of all. */\n",
    );
    // Writing to a String cannot fail.
    let _ = writeln!(text, "#define POSICAST_WINDOW_WORDS {WINDOW_WORDS}u");
    let _ = writeln!(text, "#define POSICAST_INLINE_BYTES {}u", 4 * map.words());
    text.push_str("#define POSICAST_AXIS_WORD(axis, reg) (POSICAST_WINDOW_WORDS * ((uint32_t)(axis) + 1u) + (reg))\n");
    for (place, axis) in axes.iter().enumerate() {
        let _ = writeln!(
            text,
            "#define POSICAST_INLINE_{} {place}u",
            format!("of_{axis}").to_uppercase()
        );
    }
    text.push_str("\n/* ---- Window 0: all axes ---- */\n");
    for register in map.registers().iter().filter(|register| register.offset < WINDOW_WORDS) {
        macros::register(&mut text, INLINE, register, map.fields(register), &Place::Fixed);
    }
    text.push_str("\n/* ---- Windows 1 and up: an axis each ---- */\n");
    for found in axis_registers(map, axes) {
        macros::register(&mut text, AXIS, &found.register, &found.fields, &Place::Axis);
    }
    text.push_str(END);
    text
}
