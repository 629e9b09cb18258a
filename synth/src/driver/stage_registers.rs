//! The header of the stage's registers: those of its own window, and those of an axis, once for all axes.
//!
//! The windows of all axes are alike: a register has the same offset in each window that contains it. Widths of
//! fields may differ where the memories of axes do; the masks here are the widest, and the parameters of each axis
//! are registers of its window.

use super::StageDriver;
use super::macros::{self, END, Place};
use posicast_blocks::axis::{Cause, KICK};
use posicast_blocks::group::MOST_AXES;
use posicast_blocks::registers::{Field, Register, RegisterMap, WINDOW_WORDS};
use posicast_blocks::segments::{
    ACCELERATION_BITS, ACCELERATION_FRACTION, CUBIC, ENTRIES_MAX, ENTRY_WORDS, FRACTION_BITS, MORE, NOTIFY, POINT,
    POSITION_FRACTION, SegmentsState, TICK_BITS, VELOCITY_BITS, VELOCITY_FRACTION,
};
use posicast_blocks::sliding_mode::{MANTISSA_BITS, SETTINGS, SHIFT_MAX, SettingRow};
use posicast_blocks::stage::{AXIS_INTERRUPTS, StageAxis};
use std::fmt::Write;

const STAGE: &str = "POSICAST_STAGE";
const AXIS: &str = "POSICAST_AXIS";

/// A register of the axes' windows, without an axis's name, with its widest fields.
pub(super) struct AxisRegister {
    pub(super) register: Register,
    pub(super) fields: Vec<Field>,
    /// Names of the axes that have it.
    axes: Vec<String>,
}

/// Writes `posicast_stage_regs.h`.
pub(super) fn header(driver: &StageDriver<'_>) -> String {
    let map = driver.map;
    let names: Vec<&str> = driver.config.axes.iter().map(|axis| axis.name.as_str()).collect();
    let about = format!(
        "Registers of the stage of {}: axes {}.",
        driver.machine,
        names.join(", ")
    );
    let mut text = macros::head("POSICAST_STAGE_REGS_H", &about);
    text.push_str("\n#include <stdint.h>\n\n#include \"posicast_io.h\"\n");
    numbers(&mut text, map);
    settings(&mut text);
    loops(&mut text, driver);
    bring_up(&mut text, driver);
    parts_of_axes(&mut text, driver);
    text.push_str("\n/* ---- Window 0: the stage ---- */\n");
    for register in map.registers().iter().filter(|register| register.offset < WINDOW_WORDS) {
        macros::register(&mut text, STAGE, register, map.fields(register), &Place::Fixed);
    }
    text.push_str("\n/* ---- Windows 1 and up: an axis each ---- */\n");
    for found in axis_registers(map, &names) {
        let mut register = found.register;
        if found.axes.len() < names.len() {
            let _ = write!(register.meaning, "; axis {} only", found.axes.join(", "));
        }
        macros::register(&mut text, AXIS, &register, &found.fields, &Place::Axis);
    }
    interrupts(&mut text);
    causes(&mut text);
    text.push_str(END);
    text
}

/// Writes numbers of windows, entries and bits.
fn numbers(text: &mut String, map: &RegisterMap) {
    let numbers: [(&str, u32); 19] = [
        ("AXES_MAX", MOST_AXES as u32),
        ("WINDOW_WORDS", WINDOW_WORDS),
        ("STAGE_BYTES", 4 * map.words()),
        ("KICK_WORD", KICK),
        // This is the number of entries that can wait in addition to the one being played.
        ("FIFO_ENTRIES", u32::from(ENTRIES_MAX) - 1),
        ("SEGMENTS_STOP", SegmentsState::Stop as u32),
        ("ENTRY_WORDS", ENTRY_WORDS as u32),
        ("ENTRY_POINT", POINT),
        ("ENTRY_NOTIFY", NOTIFY),
        ("ENTRY_CUBIC", CUBIC),
        ("ENTRY_MORE", MORE),
        ("TICKS_MAX", (1 << TICK_BITS) - 1),
        ("FRACTION_BITS", FRACTION_BITS),
        ("ACCELERATION_BITS", ACCELERATION_BITS),
        ("VELOCITY_BITS", VELOCITY_BITS),
        ("POSITION_FRACTION", POSITION_FRACTION),
        ("VELOCITY_FRACTION", VELOCITY_FRACTION),
        ("ACCELERATION_FRACTION", ACCELERATION_FRACTION),
        ("AXIS_INTERRUPTS", AXIS_INTERRUPTS.len() as u32),
    ];
    text.push_str(
        "\n/* Windows of words, the watchdog's word, entries of the command FIFO, and the integrator's formats. */\n",
    );
    for (name, value) in numbers {
        let value = if value > 0xffff {
            format!("{value:#x}")
        } else {
            value.to_string()
        };
        let _ = writeln!(text, "#define POSICAST_{name} {value}u");
    }
    text.push_str("#define POSICAST_AXIS_WORD(axis, reg) (POSICAST_WINDOW_WORDS * ((uint32_t)(axis) + 1u) + (reg))\n");
}

/// Writes the rows of a controller's settings, and the format of a gain.
fn settings(text: &mut String) {
    text.push_str("\n/* Settings of a controller by row: docs/sliding_mode.md. A gain is mantissa * 2^-shift, the mantissa in the lowest bits. */\n");
    for row in SettingRow::ALL {
        let name = format!("{row:?}").to_uppercase();
        let _ = writeln!(text, "#define POSICAST_SETTING_{name} {}u", row as u32);
    }
    let _ = writeln!(text, "#define POSICAST_SETTINGS {SETTINGS}u");
    let _ = writeln!(text, "#define POSICAST_GAIN_MANTISSA_BITS {MANTISSA_BITS}u");
    let _ = writeln!(text, "#define POSICAST_GAIN_SHIFT_MAX {SHIFT_MAX}u");
}

/// A bit for each axis that has something.
fn mask_of(driver: &StageDriver<'_>, has: fn(&StageAxis) -> bool) -> u32 {
    let axes = driver.config.axes.iter().enumerate();
    axes.filter(|(_, axis)| has(axis)).map(|(place, _)| 1 << place).sum()
}

/// Writes which axes have a controller, which have steps, and which are homed.
fn loops(text: &mut String, driver: &StageDriver<'_>) {
    let mask = |of| mask_of(driver, of);
    text.push_str("\n/* Masks of the axes with a controller, of those with steps, and of those that are homed: an absolute encoder needs no homing. */\n");
    let _ = writeln!(
        text,
        "#define POSICAST_LOOP_AXES {:#x}u",
        mask(|axis| axis.closed_loop().is_some())
    );
    let _ = writeln!(
        text,
        "#define POSICAST_STEPS_AXES {:#x}u",
        mask(|axis| axis.steps().is_some())
    );
    let _ = writeln!(
        text,
        "#define POSICAST_HOMED_AXES {:#x}u",
        mask(|axis| axis.absolute().is_none())
    );
}

/// Writes which axes have the bring-up registers.
fn bring_up(text: &mut String, driver: &StageDriver<'_>) {
    let mask = mask_of(driver, |axis| axis.bring_up.is_some());
    text.push_str("\n/* Mask of the axes with a trace memory and test signals. */\n");
    let _ = writeln!(text, "#define POSICAST_BRING_UP_AXES {mask:#x}u");
}

/// A part that not every axis has: name, which axes have it, and whether an axis does.
type PartOfAxis = (&'static str, &'static str, fn(&StageAxis) -> bool);

/// Writes which axes have a part that not every axis has, if one does.
fn parts_of_axes(text: &mut String, driver: &StageDriver<'_>) {
    let parts: [PartOfAxis; 3] = [
        ("ERROR_TABLE", "with an error table", |axis| axis.error_table.is_some()),
        ("CORRECTION", "whose missing steps are corrected", |axis| axis.corrects),
        ("COMPARE", "with a position compare", |axis| axis.compare.is_some()),
    ];
    for (name, which, has) in parts {
        let mask = mask_of(driver, has);
        if mask != 0 {
            let _ = writeln!(text, "\n/* Mask of the axes {which}. */");
            let _ = writeln!(text, "#define POSICAST_{name}_AXES {mask:#x}u");
        }
    }
}

/// The registers of all windows of axes, by their place.
pub(super) fn axis_registers(map: &RegisterMap, axes: &[&str]) -> Vec<AxisRegister> {
    let mut found: Vec<AxisRegister> = Vec::new();
    for (window, axis) in (1..).zip(axes) {
        let own = |name: &str| name.strip_prefix(&format!("{axis}_")).unwrap_or(name).to_owned();
        let inside = map
            .registers()
            .iter()
            .filter(|register| register.offset / WINDOW_WORDS == window);
        for register in inside {
            let name = own(&register.name);
            let fields = map.fields(register).iter().cloned().map(|mut field| {
                field.name = own(&field.name);
                field
            });
            let place = found.iter().position(|other| other.register.name == name);
            let Some(known) = place.and_then(|place| found.get_mut(place)) else {
                let mut register = register.clone();
                register.name = name;
                register.offset %= WINDOW_WORDS;
                found.push(AxisRegister {
                    register,
                    fields: fields.collect(),
                    axes: vec![(*axis).to_owned()],
                });
                continue;
            };
            known.axes.push((*axis).to_owned());
            for field in fields {
                match known.fields.iter_mut().find(|other| other.name == field.name) {
                    Some(other) => other.width = other.width.max(field.width),
                    None => known.fields.push(field),
                }
            }
        }
    }
    found.sort_by_key(|found| found.register.offset);
    found
}

fn interrupts(text: &mut String) {
    text.push_str("\n/* Interrupts of an axis: POSICAST_AXIS_INTERRUPT(axis, POSICAST_INTERRUPT_MOVE_DONE) */\n");
    for (place, (name, _)) in AXIS_INTERRUPTS.iter().enumerate() {
        let _ = writeln!(
            text,
            "#define POSICAST_INTERRUPT_{} {:#x}u",
            name.to_uppercase(),
            1u32 << place
        );
    }
    text.push_str(
        "#define POSICAST_AXIS_INTERRUPT(axis, interrupt) \
         ((uint32_t)(interrupt) << (POSICAST_AXIS_INTERRUPTS * (uint32_t)(axis)))\n",
    );
}

/// Writes the bits of CAUSES.
fn causes(text: &mut String) {
    text.push_str("\n/* Bits of CAUSES, and their names from the lowest on. */\n");
    let mut names = Vec::new();
    for cause in Cause::ALL {
        let name = cause.name().replace('-', "_").to_uppercase();
        let _ = writeln!(text, "#define POSICAST_CAUSE_{name} {:#x}u", cause.bit());
        names.push(format!("\"{}\"", cause.name().replace('-', " ")));
    }
    let _ = writeln!(text, "#define POSICAST_CAUSE_NAMES {{{}}}", names.join(", "));
}
