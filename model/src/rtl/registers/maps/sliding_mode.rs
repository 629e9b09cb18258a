//! Registers of the stand-alone controller.

use super::super::{Access, Description, Field, FlagSource};

/// The map of a controller with its settings in banks. `law` and `modulo` are after reset what the machine wants.
pub fn sliding_mode(law: u32, modulo: bool) -> Description {
    use Access::{Configuration, Live, Snapshot, Staged, Sticky};
    let command = |strobe: &str| Access::Command {
        strobe: strobe.to_owned(),
    };
    let commit = Access::Commit {
        tick: "ends".to_owned(),
    };
    let laws = [
        (0, "sliding_mode", "c de + k s + eps sat(s / phi)"),
        (1, "pd", "proportional and derivative"),
        (2, "pid", "the same and the integral"),
    ];
    let banks = [
        (0, "machine", "the machine's, a ROM"),
        (1, "loaded_1", "what was loaded into bank 1"),
        (2, "loaded_2", "what was loaded into bank 2"),
    ];
    let reference = |index: usize, meaning: &str, fraction: u32, unit: &str| {
        Field::new(&format!("host_x_{index}"), 0, 32, meaning)
            .fixed(fraction)
            .with_unit(unit)
    };
    let (position, velocity) = ("position", "velocity");
    let about = "Controller: sliding mode, PD or PID; reference and measurement by register or pins.";
    Description::new("sliding_mode", about, *b"SMC1", (1, 1), vec![])
        .with("snapshot", 0x08, Snapshot, "freezes the words `SNAPSHOT_...`", vec![])
        .with(
            "commit",
            0x09,
            commit,
            "law and bank of settings, together, between two passes",
            vec![Field::flag("commit_waits", 0, "a commit waits")],
        )
        .with(
            "control",
            0x10,
            Configuration,
            "where the motion comes from",
            vec![Field::flag(
                "from_pins",
                0,
                "`start` and the motion are the pins, not the registers",
            )],
        )
        .with(
            "law",
            0x11,
            Staged,
            "what computes the command",
            vec![
                Field::choice("law", 0, 2, "the law", &laws).with_reset(law & 3),
                Field::flag("modulo", 4, "a rotary axis: references wrap").with_reset(modulo.into()),
                Field::choice("bank", 8, 2, "settings in use; bank 3 is all 0", &banks),
            ],
        )
        .with("status", 0x12, Live, "state of the controller", status())
        .with(
            "flags",
            0x13,
            Sticky,
            "what has happened since the flag was cleared",
            vec![
                super::partial_write(0),
                Field::flag("commit_rejected", 1, "a write was ignored").set_by(FlagSource::CommitRejected),
                Field::flag(
                    "setting_refused",
                    2,
                    "a setting for a bank in use, or for none that can be loaded",
                ),
            ],
        )
        .with_interrupts(
            0x14,
            vec![
                Field::flag("valid", 0, "a command was computed"),
                Field::flag("overrun", 1, "a start came while a pass ran"),
                Field::flag("limited_high", 2, "the command was cut at +limit"),
                Field::flag("limited_low", 3, "the command was cut at -limit"),
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
        .with("start", 0x1d, command("host_strobe"), "computes a command", vec![])
        .with(
            "clear_integral",
            0x1e,
            command("clear_integral"),
            "at the start of motion",
            vec![],
        )
        .with(
            "clear_flags",
            0x1f,
            command("clear_flags"),
            "clears the flags in `STATUS`",
            vec![],
        )
        .with(
            "setting_address",
            0x28,
            Configuration,
            "which setting `SETTING` is",
            vec![
                Field::new("setting_row", 0, 4, "its place: see docs/sliding_mode.md"),
                Field::new("setting_bank", 8, 2, "bank 1 or 2"),
            ],
        )
        .with(
            "setting",
            0x29,
            command("setting_write"),
            "writes a setting",
            vec![Field::new("setting_word", 0, 32, "mantissa and shift, or the limit")],
        )
        .with(
            "setting_read",
            0x2a,
            command("setting_read"),
            "reads the word at `SETTING_ADDRESS` back, which stays until `setting_read_waits` is low",
            vec![],
        )
        .with(
            "setting_loaded",
            0x2b,
            Live,
            "what `SETTING_READ` found: 0 where nothing was written since the reset",
            vec![Field::new("setting_loaded", 0, 32, "mantissa and shift, or the limit")],
        )
        .with_shadowed(
            "error",
            0x20,
            0x30,
            "e of the last tick",
            vec![shown("error", 32, 16, "counts")],
        )
        .with_shadowed(
            "sliding",
            0x21,
            0x31,
            "s of the last tick",
            vec![shown("sliding", 32, 16, "counts/tick")],
        )
        .with_shadowed(
            "command",
            0x22,
            0x32,
            "to the drive",
            vec![shown("command", 32, 12, "command units")],
        )
        .with(
            "limited_ticks",
            0x24,
            Live,
            "how long the command has been cut",
            vec![Field::new("limited_ticks", 0, 16, "in a row; stops at 65535").with_unit("ticks")],
        )
        .with_shadowed("duty", 0x23, 0x33, "to the PWM", vec![shown("duty", 18, 0, "clocks")])
}

fn shown(name: &str, width: u32, fraction: u32, unit: &str) -> Field {
    Field::new(name, 0, width, "of the last pass")
        .fixed(fraction)
        .with_unit(unit)
}

fn status() -> Vec<Field> {
    vec![
        Field::flag("busy", 0, "a pass runs"),
        Field::flag("overrun", 1, "a start came while a pass ran"),
        Field::flag("limited_high", 2, "the last command was cut at +limit"),
        Field::flag("limited_low", 3, "the last command was cut at -limit"),
        Field::flag("setting_read_waits", 4, "`SETTING_READ` was not served yet"),
        Field::new(
            "saturated_high",
            8,
            7,
            "cut at the upper end: e, de, s, feedback, integral, command, duty",
        ),
        Field::new("saturated_low", 16, 7, "cut at the lower end, in the same order"),
    ]
}
