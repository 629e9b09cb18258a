//! Registers for bringing an axis up: trace memory, test signals, and encoder edges without a machine.

use super::registers::with_the_drive_off;
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

/// A field that selects a signal of the trace, with the list of signals.
fn signal(name: &str, low: u32, meaning: &str) -> Field {
    let signals = (0..).zip(TRACED).map(|(value, (net, words))| (value, net, words));
    Field::choice(name, low, 4, meaning, &signals.collect::<Vec<_>>())
}

/// The registers, in words of the axis's window.
pub(super) fn registers() -> Vec<Register> {
    [trace(), excitation(), generator()].concat()
}

fn trace() -> Vec<Register> {
    let selects = [0, 1, 2, 3].map(|place| {
        let name = format!("trace_select_{place}");
        signal(&name, 4 * place, "signal that is recorded")
    });
    let counts = [
        (0, "one", "signal per row"),
        (1, "two", "signals"),
        (2, "four", "signals"),
    ];
    let modes = [
        (0, "at_once", "with `TRACE_ARM`"),
        (1, "rising", "through `TRACE_LEVEL`"),
        (2, "falling", "through `TRACE_LEVEL`"),
        (3, "start", "start of a move"),
    ];
    let more = vec![
        Field::choice("trace_signals", 16, 2, "signals per row", &counts).with_reset(2),
        signal("trace_trigger_select", 20, "signal that is compared with the level"),
        Field::choice("trace_trigger_mode", 24, 2, "event that triggers the trace", &modes),
    ];
    vec![
        Register::new(
            "trace_setup",
            0x48,
            Access::Configuration,
            "signals and trigger of the trace; must not change during a trace",
            [selects.to_vec(), more].concat(),
        ),
        Register::new(
            "trace_rate",
            0x49,
            Access::Configuration,
            "interval of the rows, and rows before the trigger",
            vec![
                Field::new("trace_decimation", 0, 16, "time skipped between rows").with_unit("ticks"),
                Field::new("trace_pre_trigger", 16, 11, "rows before the trigger"),
            ],
        ),
        Register::new(
            "trace_level",
            0x4a,
            Access::Configuration,
            "level of the trigger",
            vec![Field::new("trace_trigger_level", 0, 32, "in the unit of the signal").signed()],
        ),
        Register::new(
            "trace_arm",
            0x4b,
            Access::command("trace_arm"),
            "discards the trace and begins a new one",
            vec![],
        ),
        Register::new(
            "trace_halt",
            0x4c,
            Access::command("trace_halt"),
            "ends the trace now",
            vec![],
        ),
        Register::new(
            "trace_address",
            0x4d,
            Access::Configuration,
            "index of the word in `TRACE_DATA`; the oldest is 0",
            vec![Field::new("trace_address", 0, 11, "row times signals, plus signal")],
        ),
        Register::new(
            "trace_data",
            0x4e,
            Access::Live,
            "a word of the trace, while it is idle",
            vec![Field::new("trace_data", 0, 32, "value of the signal")],
        ),
        Register::new(
            "trace_status",
            0x4f,
            Access::Live,
            "progress of the trace",
            vec![
                Field::new("trace_state", 0, 2, "0 idle, 1 filling, 2 waiting, 3 taking"),
                Field::flag("trace_missed", 2, "a tick came too early"),
                Field::new("trace_rows", 4, 12, "rows that can be read"),
                Field::new("trace_trigger_row", 16, 11, "row of the trigger"),
            ],
        ),
        Register::new(
            "bring_up_events",
            0x50,
            Access::Sticky,
            "events since the flag was cleared",
            vec![
                Field::flag("trace_done", 0, "the trace is full"),
                Field::flag("excitation_done", 1, "the test signal has ended"),
            ],
        ),
    ]
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
