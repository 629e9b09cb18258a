//! Registers for bringing an axis up: trace memory, test signals, and encoder edges without a machine.

use super::register::{command, register, with_the_drive_off};
use crate::rtl::registers::{Access, Field, Register};

/// What can be traced: net, and what its words are.
pub(super) const TRACED: [(&str, &str); 13] = [
    ("command_position", "of the segments, Q24.8 counts"),
    ("command_velocity", "of the segments, Q16.16 counts/tick"),
    ("command_acceleration", "of the segments, Q8.24 counts/tick^2"),
    ("shaped_position", "of the shaper, Q24.8 counts"),
    ("shaped_velocity", "of the shaper, Q16.16 counts/tick"),
    ("shaped_acceleration", "of the shaper, Q8.24 counts/tick^2"),
    ("captured_position", "of the loop at the tick, counts"),
    ("velocity", "of the motor, Q16.16 counts/tick"),
    ("error", "e, Q16.16 counts"),
    ("sliding", "s, Q16.16 counts/tick"),
    ("command", "to the drive, Q20.12 command units"),
    ("excitation_value", "added to the position, Q24.8 counts"),
    ("deviation", "motor against scale, counts"),
];

/// Signal of the trace: what there is to choose from.
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
        signal(&name, 4 * place, "what is recorded")
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
        (3, "start", "of a move"),
    ];
    let more = vec![
        Field::choice("trace_signals", 16, 2, "signals per row", &counts).with_reset(2),
        signal("trace_trigger_select", 20, "what is compared with the level"),
        Field::choice("trace_trigger_mode", 24, 2, "when the trace is taken", &modes),
    ];
    vec![
        register(
            "trace_setup",
            0x48,
            Access::Configuration,
            "what is recorded, and when; not to be changed while it is",
            [selects.to_vec(), more].concat(),
        ),
        register(
            "trace_rate",
            0x49,
            Access::Configuration,
            "how often, and how much before the trigger",
            vec![
                Field::new("trace_decimation", 0, 16, "ticks that are left out between rows").with_unit("ticks"),
                Field::new("trace_pre_trigger", 16, 11, "rows before the trigger"),
            ],
        ),
        register(
            "trace_level",
            0x4a,
            Access::Configuration,
            "of the trigger",
            vec![Field::new("trace_trigger_level", 0, 32, "in the words of the signal").signed()],
        ),
        register(
            "trace_arm",
            0x4b,
            command("trace_arm"),
            "forgets everything and begins",
            vec![],
        ),
        register("trace_halt", 0x4c, command("trace_halt"), "ends it now", vec![]),
        register(
            "trace_address",
            0x4d,
            Access::Configuration,
            "which word `TRACE_DATA` is, the oldest is 0",
            vec![Field::new("trace_address", 0, 11, "row times signals, plus signal")],
        ),
        register(
            "trace_data",
            0x4e,
            Access::Live,
            "a word of the trace, while it is idle",
            vec![Field::new("trace_data", 0, 32, "of the signal")],
        ),
        register(
            "trace_status",
            0x4f,
            Access::Live,
            "how far it is",
            vec![
                Field::new("trace_state", 0, 2, "0 idle, 1 filling, 2 waiting, 3 taking"),
                Field::flag("trace_missed", 2, "a tick came too early"),
                Field::new("trace_rows", 4, 12, "rows that can be read"),
                Field::new("trace_trigger_row", 16, 11, "row of the trigger"),
            ],
        ),
        register(
            "bring_up_events",
            0x50,
            Access::Sticky,
            "what has happened since the flag was cleared",
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
        (2, "chirp", "a triangle that gets faster"),
        (3, "square", "up and down"),
    ];
    vec![
        register(
            "excitation",
            0x54,
            Access::Configuration,
            "a test signal on the position, in HOLD",
            vec![
                Field::choice("excitation_kind", 0, 2, "which", &kinds),
                Field::flag("excitation_enable", 4, "begins when it becomes high; low ends it"),
                Field::new("excitation_amplitude", 16, 16, "Q8.8; limited by the machine file")
                    .with_unit("counts / 256"),
            ],
        ),
        register(
            "excitation_time",
            0x55,
            Access::Configuration,
            "its pace",
            vec![
                Field::new("excitation_period", 0, 16, "a bit, a period, or a chirp's first").with_unit("ticks"),
                Field::new("excitation_sweep", 16, 16, "a chirp's rise per tick, of 65536"),
            ],
        ),
        register(
            "excitation_length",
            0x56,
            Access::Configuration,
            "how long it lasts",
            vec![Field::new("excitation_duration", 0, 24, "0: it never begins").with_unit("ticks")],
        ),
        register(
            "excitation_state",
            0x57,
            Access::Live,
            "what it is doing",
            vec![Field::flag("excitation_active", 0, "it runs")],
        ),
    ]
}

fn generator() -> Vec<Register> {
    vec![
        register(
            "generator",
            0x58,
            with_the_drive_off(),
            "encoder edges without a machine",
            vec![
                Field::flag("loop_back", 0, "the counter sees the generator, not the pins"),
                Field::new("index_every", 16, 16, "an index every so many counts; 0: none").with_unit("counts"),
            ],
        ),
        register(
            "generator_rate",
            0x59,
            Access::Configuration,
            "its speed",
            vec![
                Field::new("generator_rate", 0, 32, "per clock")
                    .fixed(32)
                    .with_unit("counts/clock"),
            ],
        ),
        register(
            "generated_count",
            0x5a,
            Access::Live,
            "what it has made",
            vec![
                Field::new("generated_count", 0, 32, "since reset")
                    .signed()
                    .with_unit("counts"),
            ],
        ),
    ]
}
