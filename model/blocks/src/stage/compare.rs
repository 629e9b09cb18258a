//! The position compare of an axis in the stage: its nets, its pin and its registers.

use super::axis::Nets;
use super::config::StageCompare;
use crate::registers::{Access, Field, Register};

/// Pin of the pulse.
pub(super) const PIN: &str = "compare";
/// Interrupt of a pulse: name and meaning.
pub(super) const INTERRUPT: (&str, &str) = ("compare_passed", "a position of the compare gave a pulse");

/// Connections of the block, which compares the count of the axis's encoder, or of its steps.
pub(super) const NETS: Nets = &[
    ("arm", "compare_arm"),
    ("disarm", "compare_disarm"),
    ("use_list", "compare_use_list"),
    ("first", "compare_first"),
    ("spacing", "compare_spacing"),
    ("positions", "compare_positions"),
    ("rises", "compare_rises"),
    ("falls", "compare_falls"),
    ("hysteresis", "compare_hysteresis"),
    ("pulse_clocks", "compare_pulse_clocks"),
    ("entry", "compare_entry"),
    ("entry_write", "compare_entry_write"),
    ("entries_clear", "compare_entries_clear"),
    ("clear_flags", "clear_sources"),
    ("pulse", PIN),
    ("passed", INTERRUPT.0),
    ("passed_upward", "compare_upward"),
    ("passes", "compare_passes"),
    ("armed", "compare_armed"),
    ("ready", "compare_ready"),
    ("entries", "compare_entries"),
    ("merged", "compare_merged"),
    ("jumped", "compare_jumped"),
    ("refused", "compare_refused"),
];

/// The registers, in words of the axis's window.
pub(super) fn registers(of: &StageCompare) -> Vec<Register> {
    [settings(of), commands(), state()].concat()
}

fn settings(of: &StageCompare) -> Vec<Register> {
    let word = |name: &str, offset, field: Field| {
        let meaning = field.meaning.clone();
        Register::new(name, offset, Access::Configuration, &meaning, vec![field])
    };
    vec![
        Register::new(
            "compare_control",
            0x70,
            Access::Configuration,
            "which passages give pulses, from the next `COMPARE_ARM` on",
            vec![
                Field::flag("compare_rises", 0, "upward").with_reset(of.rises.into()),
                Field::flag("compare_falls", 1, "downward").with_reset(of.falls.into()),
                Field::flag("compare_use_list", 2, "the positions are those of the list"),
                Field::new(
                    "compare_hysteresis",
                    16,
                    16,
                    "distance from its edge, after which a position may give its next pulse",
                )
                .with_unit("counts")
                .with_reset(of.hysteresis.into()),
            ],
        ),
        word(
            "compare_first",
            0x71,
            Field::new(
                "compare_first",
                0,
                32,
                "lowest position, in counts since reset: see `ORIGIN`",
            )
            .signed()
            .with_unit("counts")
            .with_reset(of.first as u32),
        ),
        word(
            "compare_spacing",
            0x72,
            Field::new("compare_spacing", 0, 32, "distance of two positions")
                .with_unit("counts")
                .with_reset(of.spacing),
        ),
        word(
            "compare_positions",
            0x73,
            Field::new("compare_positions", 0, 32, "number of positions").with_reset(of.positions),
        ),
        word(
            "compare_pulse",
            0x74,
            Field::new("compare_pulse_clocks", 0, 24, "width of a pulse")
                .with_unit("clocks")
                .with_reset(of.pulse_clocks),
        ),
    ]
}

fn commands() -> Vec<Register> {
    let command = |name: &str, offset, strobe: &str, meaning: &str, fields| {
        Register::new(name, offset, Access::command(strobe), meaning, fields)
    };
    vec![
        command(
            "compare_arm",
            0x75,
            "compare_arm",
            "takes the settings, and begins with no pulse counted",
            vec![],
        ),
        command(
            "compare_disarm",
            0x76,
            "compare_disarm",
            "no position is passed any more",
            vec![],
        ),
        command(
            "compare_entry",
            0x77,
            "compare_entry_write",
            "appends a position to the list, at least 4 counts above the one before",
            vec![
                Field::new("compare_entry", 0, 32, "position in counts since reset")
                    .signed()
                    .with_unit("counts"),
            ],
        ),
        command(
            "compare_clear",
            0x78,
            "compare_entries_clear",
            "empties the list; refused while armed",
            vec![],
        ),
    ]
}

fn state() -> Vec<Register> {
    vec![
        Register::new(
            "compare_state",
            0x79,
            Access::Live,
            "state of the compare; its flags stay until `CLEAR_FAULTS`",
            vec![
                Field::flag("compare_armed", 0, "armed"),
                Field::flag("compare_ready", 1, "the positions beside the count are known"),
                Field::flag("compare_merged", 2, "a pulse began during another"),
                Field::flag(
                    "compare_jumped",
                    3,
                    "the count jumped: positions between were not passed",
                ),
                Field::flag(
                    "compare_refused",
                    4,
                    "an entry, or the emptying of the list, was refused",
                ),
                Field::flag("compare_upward", 5, "direction of the last pulse"),
                Field::new("compare_entries", 16, 9, "positions in the list"),
            ],
        ),
        Register::new(
            "compare_passes",
            0x7a,
            Access::Live,
            "pulses since `COMPARE_ARM`",
            vec![Field::new("compare_passes", 0, 32, "number of pulses, modulo 2^32")],
        ),
    ]
}
