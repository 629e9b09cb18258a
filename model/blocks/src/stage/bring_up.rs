//! Registers for bringing an axis up: trace memory, test signals, and encoder edges without a machine.

use super::registers::with_the_drive_off;
use crate::registers::trace::Traced;
use crate::registers::{Access, Field, Register};

/// Signals that can be recorded: net, and meaning of its words.
pub(super) const TRACED: [(&str, &str); 13] = [
    ("command_position", "position of the segments, Q24.8 counts"),
    ("command_velocity", "velocity of the segments, Q16.16 counts/tick"),
    (
        "command_acceleration",
        "acceleration of the segments, Q8.24 counts/tick^2",
    ),
    ("shaped_position", "position after the shaper, Q24.8 counts"),
    ("shaped_velocity", "velocity after the shaper, Q16.16 counts/tick"),
    (
        "shaped_acceleration",
        "acceleration after the shaper, Q8.24 counts/tick^2",
    ),
    ("captured_position", "position of the loop at the tick, counts"),
    ("velocity", "velocity of the motor, Q16.16 counts/tick"),
    ("error", "e, Q16.16 counts"),
    ("sliding", "sliding variable s, Q16.16 counts/tick"),
    ("command", "command to the drive, Q20.12 command units"),
    ("excitation_value", "test signal added to the position, Q24.8 counts"),
    ("deviation", "deviation of the motor from the scale, counts"),
];

/// The registers, in words of the axis's window.
pub(super) fn registers() -> Vec<Register> {
    [trace(), excitation(), generator()].concat()
}

fn trace() -> Vec<Register> {
    let traced = Traced {
        signals: &TRACED,
        event: ("start", "start of a move"),
    };
    let mut registers = traced.registers();
    registers.push(Register::new(
        "bring_up_events",
        0x50,
        Access::Sticky,
        "events since the flag was cleared",
        vec![
            Field::flag("trace_done", 0, "the trace is full"),
            Field::flag("excitation_done", 1, "the test signal has ended"),
        ],
    ));
    registers
}

fn excitation() -> Vec<Register> {
    let kinds = [
        (0, "none", "nothing"),
        (1, "prbs", "pseudo-random, 15 bits"),
        (2, "chirp", "a triangle of rising frequency"),
        (3, "square", "a square wave"),
    ];
    vec![
        Register::new(
            "excitation",
            0x54,
            Access::Configuration,
            "test signal added to the position, in HOLD",
            vec![
                Field::choice("excitation_kind", 0, 2, "which", &kinds),
                Field::flag("excitation_enable", 4, "a rising edge begins the signal; low ends it"),
                Field::new(
                    "excitation_amplitude",
                    16,
                    16,
                    "amplitude in Q8.8; limited by the machine file",
                )
                .with_unit("counts / 256"),
            ],
        ),
        Register::new(
            "excitation_time",
            0x55,
            Access::Configuration,
            "period and sweep of the test signal",
            vec![
                Field::new(
                    "excitation_period",
                    0,
                    16,
                    "length of a bit, a period, or a chirp's first \
                    period",
                )
                .with_unit("ticks"),
                Field::new(
                    "excitation_sweep",
                    16,
                    16,
                    "rise of a chirp's frequency per tick, in 65536ths of the \
                    first",
                ),
            ],
        ),
        Register::new(
            "excitation_length",
            0x56,
            Access::Configuration,
            "duration of the test signal",
            vec![Field::new("excitation_duration", 0, 24, "0: the signal never begins").with_unit("ticks")],
        ),
        Register::new(
            "excitation_state",
            0x57,
            Access::Live,
            "state of the test signal",
            vec![Field::flag("excitation_active", 0, "the signal is running")],
        ),
    ]
}

fn generator() -> Vec<Register> {
    vec![
        Register::new(
            "generator",
            0x58,
            with_the_drive_off(),
            "internal encoder, for tests without a machine",
            vec![
                Field::flag("loop_back", 0, "the counter gets the generator's lines, not the pins"),
                Field::new("index_every", 16, 16, "distance from index to index; 0: no index").with_unit("counts"),
            ],
        ),
        Register::new(
            "generator_rate",
            0x59,
            Access::Configuration,
            "rate of the internal encoder",
            vec![
                Field::new("generator_rate", 0, 32, "counts per clock")
                    .fixed(32)
                    .with_unit("counts/clock"),
            ],
        ),
        Register::new(
            "generated_count",
            0x5a,
            Access::Live,
            "counts of the internal encoder",
            vec![
                Field::new("generated_count", 0, 32, "counts since reset")
                    .signed()
                    .with_unit("counts"),
            ],
        ),
    ]
}
