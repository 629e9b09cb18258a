//! Registers of the stand-alone controller.

use super::super::{Access, Description, Field, FlagSource, tables};

/// The map of a controller with its settings in banks. `law` and `modulo` are the reset values for the machine.
pub fn sliding_mode(law: u32, modulo: bool) -> Description {
    use Access::{Configuration, Live, Snapshot, Staged, Sticky};
    let commit = Access::Commit {
        tick: "ends".to_owned(),
    };
    let reference = |index: usize, meaning: &str, fraction: u32, unit: &str| {
        Field::new(&format!("host_x_{index}"), 0, 32, meaning)
            .fixed(fraction)
            .with_unit(unit)
    };
    let (position, velocity) = ("position", "velocity");
    let about = "Controller: sliding mode, PD or PID; reference and measurement come from registers or pins.";
    Description::new("sliding_mode", about, *b"SMC1", (1, 1), vec![])
        .with("snapshot", 0x08, Snapshot, "freezes the words `SNAPSHOT_...`", vec![])
        .with(
            "commit",
            0x09,
            commit,
            "applies law and bank of settings together, between two computations",
            vec![Field::flag("commit_waits", 0, "a commit waits")],
        )
        .with(
            "control",
            0x10,
            Configuration,
            "source of reference and measurement",
            vec![Field::flag(
                "from_pins",
                0,
                "`start`, reference and measurement come from the pins, not the registers",
            )],
        )
        .with(
            "law",
            0x11,
            Staged,
            "control law and settings in use",
            vec![
                tables::law().with_reset(law & 3),
                Field::flag("modulo", 4, "a rotary axis: references wrap").with_reset(modulo.into()),
                tables::setting_bank("bank"),
            ],
        )
        .with("status", 0x12, Live, "state of the controller", status())
        .with(
            "flags",
            0x13,
            Sticky,
            "events since the flag was cleared",
            vec![
                super::partial_write(0),
                Field::flag(
                    "commit_rejected",
                    1,
                    "a write was ignored because a commit \
                    waits",
                )
                .set_by(FlagSource::CommitRejected),
                Field::flag(
                    "setting_refused",
                    2,
                    "a setting was refused: its bank is in use or cannot be loaded",
                ),
            ],
        )
        .with_interrupts(
            0x14,
            vec![
                Field::flag("valid", 0, "a command was computed"),
                Field::flag("overrun", 1, "a start came during a computation"),
                Field::flag("limited_high", 2, "the command was clamped at +limit"),
                Field::flag("limited_low", 3, "the command was clamped at -limit"),
            ],
        )
        .with(
            "position_reference",
            0x18,
            Configuration,
            "wanted",
            vec![reference(0, position, 8, "counts")],
        )
        .with(
            "velocity_reference",
            0x19,
            Configuration,
            "wanted",
            vec![reference(1, velocity, 16, "counts/tick")],
        )
        .with(
            "acceleration_reference",
            0x1a,
            Configuration,
            "wanted",
            vec![reference(2, "acceleration", 24, "counts/tick^2")],
        )
        .with(
            "position",
            0x1b,
            Configuration,
            "measured",
            vec![reference(3, "position", 0, "counts")],
        )
        .with(
            "velocity",
            0x1c,
            Configuration,
            "measured",
            vec![reference(4, velocity, 16, "counts/tick")],
        )
        .with(
            "start",
            0x1d,
            Access::command("host_strobe"),
            "computes a command",
            vec![],
        )
        .with(
            "clear_integral",
            0x1e,
            Access::command("clear_integral"),
            "clears the integral, for the start of a motion",
            vec![],
        )
        .with(
            "clear_flags",
            0x1f,
            Access::command("clear_flags"),
            "clears the flags in `STATUS`",
            vec![],
        )
        .with_register(tables::setting_address(0x28))
        .with_register(tables::setting(0x29))
        .with_register(tables::setting_read(0x2a))
        .with_register(tables::setting_loaded(0x2b))
        .with_shadowed(
            "error",
            0x20,
            0x30,
            "position error e of the last tick",
            vec![shown("error", 32, 16, "counts")],
        )
        .with_shadowed(
            "sliding",
            0x21,
            0x31,
            "sliding variable s of the last tick",
            vec![shown("sliding", 32, 16, "counts/tick")],
        )
        .with_shadowed(
            "command",
            0x22,
            0x32,
            "command to the drive",
            vec![shown("command", 32, 12, "command units")],
        )
        .with(
            "limited_ticks",
            0x24,
            Live,
            "how long the command has been clamped",
            vec![Field::new("limited_ticks", 0, 16, "time without interruption; stops at 65535").with_unit("ticks")],
        )
        .with_shadowed(
            "duty",
            0x23,
            0x33,
            "duty to the PWM",
            vec![shown("duty", 18, 0, "clocks")],
        )
}

fn shown(name: &str, width: u32, fraction: u32, unit: &str) -> Field {
    Field::new(name, 0, width, "value of the last computation")
        .fixed(fraction)
        .with_unit(unit)
}

fn status() -> Vec<Field> {
    vec![
        Field::flag("busy", 0, "a command is being computed"),
        Field::flag("overrun", 1, "a start came during a computation"),
        Field::flag("limited_high", 2, "the last command was clamped at +limit"),
        Field::flag("limited_low", 3, "the last command was clamped at -limit"),
        Field::flag("setting_read_waits", 4, "a read by `SETTING_READ` waits"),
        Field::new(
            "saturated_high",
            8,
            7,
            "clamped at the upper end, from bit 0: e, de, s, feedback, integral, command, duty",
        ),
        Field::new("saturated_low", 16, 7, "clamped at the lower end, in the same order"),
    ]
}
