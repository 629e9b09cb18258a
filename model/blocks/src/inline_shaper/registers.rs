//! The register map of an inline shaper: a window of its own, and one per axis, all alike. A host looks on with it, loads tables and
//! asks for no shaping; nothing in it stops or starts an axis.
//!
//! What a stage has, too, is at the same offset and in the same bits, so that one host's code loads the tables of both.

use super::{InlineConfig, InlineShaperAxis};
use crate::registers::maps::partial_write;
use crate::registers::trace::Traced;
use crate::registers::{Access, Description, Field, Register, WINDOW_WORDS, tables};
use crate::stage::{axis_register, driven_and_read};

/// Net of the steps that an input has counted.
pub(super) const INPUT_STEPS: &str = "input_steps";
/// Net of the steps that an axis has given.
pub(super) const GIVEN_STEPS: &str = "given_steps";
/// Net of the steps that it still owes.
pub(super) const OWED_STEPS: &str = "owed_steps";

/// Signals that can be recorded, with the meaning of their words.
const TRACED: [(&str, &str); 3] = [
    ("input_position", "position of the input at the tick, Q24.8 steps"),
    ("shaped_position", "position after the shaper, Q24.8 steps"),
    ("output_position", "position for the drive, shaped or not, Q24.8 steps"),
];
/// Their nets.
pub(super) const TRACED_NETS: [&str; 3] = ["x", "shaped", "position"];

/// All registers.
pub(super) fn description(config: &InlineConfig, machine_crc: Option<u32>) -> Description {
    let about = "Inline shaper: step pulses in, shaped step pulses out; window 0 is that of all axes, then there is one window per axis.";
    let parameter = |name: &str, bits, meaning: &str, value| Field::new(name, 0, bits, meaning).with_reset(value);
    let mut parameters = vec![
        parameter("axes", 3, "windows after this one", config.axes.len() as u32),
        parameter("tick_clocks", 17, "time from tick to tick", config.tick.tick_clocks()).with_unit("clocks"),
    ];
    if let Some(crc) = machine_crc {
        parameters.push(parameter("machine_crc", 32, "CRC-32 of the machine file", crc));
    }
    let mut description = Description::new(super::INLINE_SHAPER, about, *b"INLN", (1, 0), parameters)
        .with_windows(config.axes.len() as u32 + 1)
        .with(
            "snapshot",
            0x08,
            Access::Snapshot,
            "freezes the words `SNAPSHOT_...` of all axes in one clock",
            vec![],
        )
        .with(
            "bypass",
            0x09,
            Access::Configuration,
            "no shaping, to home and to probe",
            vec![Field::flag(
                "bypass_request",
                0,
                "1 asks for no shaping, as the pin `bypass` does; either is enough",
            )],
        )
        .with(
            "status",
            0x0a,
            Access::Live,
            "state of all axes",
            vec![
                Field::flag("run", 0, "the axes may follow: enabled, and no fault"),
                Field::flag("settled", 1, "every axis stands, and has given every step that it got"),
                Field::flag("bypassed", 2, "no axis is shaped"),
                Field::flag(
                    "fault",
                    3,
                    "an axis has stopped with a cause; without one there was an emergency stop",
                ),
            ],
        )
        .with(
            "flags",
            0x0b,
            Access::Sticky,
            "events since the flag was cleared",
            vec![partial_write(0)],
        )
        .with_interrupts(
            0x0c,
            vec![
                Field::flag("tick", 0, "a tick has passed"),
                Field::flag("fault", 1, "the axes have stopped with a cause"),
            ],
        )
        .with_times(0x20, 0x40);
    for (window, axis) in (1..).zip(&config.axes) {
        let placed = window_of(axis)
            .into_iter()
            .map(|register| axis_register(register, &axis.name, window * WINDOW_WORDS));
        description.registers.extend(placed);
    }
    description
}

/// Nets of an axis that its registers drive, and those that they read.
pub(super) fn hardware(axis: &InlineShaperAxis) -> (Vec<String>, Vec<String>) {
    driven_and_read(&window_of(axis))
}

/// The registers of an axis, in words of its window, without the axis's name as prefix.
fn window_of(axis: &InlineShaperAxis) -> Vec<Register> {
    let trace = if axis.trace.is_some() { trace() } else { Vec::new() };
    [parameters(axis), loaded_tables(axis), states(), counts(), trace].concat()
}

fn trace() -> Vec<Register> {
    let traced = Traced {
        signals: &TRACED,
        event: ("follow", "the steps follow the input"),
    };
    let mut registers = traced.registers();
    registers.push(Register::new(
        "trace_events",
        0x50,
        Access::Sticky,
        "events since the flag was cleared",
        vec![Field::flag("trace_done", 0, "the trace is full")],
    ));
    registers
}

fn parameters(axis: &InlineShaperAxis) -> Vec<Register> {
    let mut registers = vec![tables::parameter(
        "step_period_clocks",
        0x00,
        "shortest time from step to step of the output in clocks",
        axis.steps.period_clocks() as u32,
    )];
    registers.extend(tables::axis_shaper(&axis.shaper));
    registers.extend([
        tables::parameter(
            "limit_steps",
            0x05,
            "largest number of steps of the input per tick",
            axis.follower.limit_steps(),
        ),
        tables::parameter(
            "settle_ticks",
            0x06,
            "ticks without a step of the input until it may be settled",
            axis.follower.settle_ticks(),
        ),
    ]);
    registers
}

fn loaded_tables(axis: &InlineShaperAxis) -> Vec<Register> {
    let mut registers = tables::axis_taps(&axis.shaper);
    registers.push(tables::tap_loaded(&axis.shaper, 0x3f));
    registers
}

fn states() -> Vec<Register> {
    vec![
        Register::new(
            "status",
            0x28,
            Access::Live,
            "state of the axis",
            vec![
                Field::flag("follow", 0, "the steps follow the input"),
                Field::flag("settled", 1, "it stands, and has given every step that it got"),
                Field::flag(
                    "level_a",
                    13,
                    "filtered first line of the command, high if it is active",
                ),
                Field::flag("level_b", 14, "filtered second line of the command, likewise"),
                Field::flag("swap_pending", 16, "a swap of tables waits, or hands over"),
                Field::new("table_bank", 17, 2, "the shaper's active bank"),
                Field::flag("tap_read_waits", 27, "a read by `TAP_READ` waits"),
            ],
        ),
        Register::new(
            "causes",
            0x29,
            Access::Live,
            "why the axis has stopped, until the pin `clear_faults`: see docs/inline_axis.md",
            vec![
                Field::flag("input_too_fast", 0, "a tick brought more steps than the limit"),
                Field::flag(
                    "steps_stopped",
                    1,
                    "the lines of the drive are too slow, or too many steps were owed",
                ),
                Field::flag("input_illegal", 2, "both lines of a quadrature input changed together"),
            ],
        ),
        Register::new(
            "flags",
            0x2a,
            Access::Sticky,
            "events since the flag was cleared",
            vec![
                Field::flag("table_refused", 7, "a tap or a swap was refused"),
                Field::flag(
                    "illegal",
                    8,
                    "both lines of a quadrature input changed together, whether the axis followed or not",
                ),
                Field::flag(
                    "too_fast",
                    25,
                    "a tick demanded more steps than the lines of the drive give",
                ),
                Field::flag("owed_exceeded", 26, "more steps were owed than are allowed"),
            ],
        ),
        Register::new(
            "illegal_count",
            0x2b,
            Access::Live,
            "errors of a quadrature input",
            vec![Field::new(
                "illegal_count",
                0,
                8,
                "transitions in which both lines changed; stops at 255",
            )],
        ),
    ]
}

fn counts() -> Vec<Register> {
    let steps = |name: &str, bits, meaning: &str| Field::new(name, 0, bits, meaning).signed().with_unit("steps");
    let live = |offset, field: Field| {
        let (name, meaning) = (field.name.clone(), field.meaning.clone());
        Register::new(&name, offset, Access::Live, &meaning, vec![field])
    };
    let shadow = |of: &str, offset, meaning: &str| {
        let access = Access::Shadow { of: of.to_owned() };
        Register::new(&format!("snapshot_{of}"), offset, access, meaning, vec![])
    };
    vec![
        live(
            0x31,
            steps(
                INPUT_STEPS,
                32,
                "steps of the input since reset, modulo 2^32, whether the axis followed or not",
            ),
        ),
        live(0x38, steps(GIVEN_STEPS, 32, "steps given since reset, modulo 2^32")),
        live(
            0x39,
            steps(
                OWED_STEPS,
                16,
                "steps that the shaped position has demanded and that are still to come",
            ),
        ),
        shadow(INPUT_STEPS, 0x40, "steps of the input at the snapshot"),
        shadow(GIVEN_STEPS, 0x42, "steps given at the snapshot"),
        shadow(OWED_STEPS, 0x43, "steps owed at the snapshot"),
    ]
}
