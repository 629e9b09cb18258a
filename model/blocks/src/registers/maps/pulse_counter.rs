//! Registers of the pulse counter with its own divider and time base.

use super::super::{Access, Description, Field};
use crate::divider::DividerConfig;

/// Reset value of `timeout`: 5 million clocks.
const TIMEOUT: u32 = 76;

/// The map of a pulse counter with the ticks of `divider`. After reset its filter is `filter_clocks` (6 bits) long,
/// and its direction is reversed with `invert`.
pub fn pulse_counter(divider: &DividerConfig, filter_clocks: u32, invert: bool) -> Description {
    use Access::{Configuration, Live, Snapshot, Sticky};
    let parameters = vec![
        Field::new("tick_clocks", 0, 17, "time from tick to tick")
            .with_reset(divider.tick_clocks())
            .with_unit("clocks"),
    ];
    let about = "Pulse counter: turns encoder or scale signals into position, index and velocity.";
    Description::new("pulse_counter", about, *b"PCNT", (2, 0), parameters)
        .with("snapshot", 0x08, Snapshot, "freezes the words `SNAPSHOT_...`", vec![])
        .with(
            "lines",
            0x10,
            Configuration,
            "how A, B and Z are decoded",
            lines(filter_clocks, invert),
        )
        .with("index", 0x11, Configuration, "effect of an index", index())
        .with(
            "velocity_filter",
            0x12,
            Configuration,
            "how the velocity is measured",
            velocity_filter(),
        )
        .with(
            "preset_value",
            0x13,
            Configuration,
            "position after a preset",
            vec![counts("preset_value", "the position")],
        )
        .with_interrupts(
            0x14,
            vec![
                Field::flag("tick", 0, "a tick has passed"),
                Field::flag("index_seen", 1, "an index was latched"),
                Field::flag("illegal", 2, "A and B changed together"),
                Field::flag("disagreement", 3, "the lines of a pair were equal"),
                Field::flag("velocity_missed", 4, "a tick had no new velocity"),
            ],
        )
        .with(
            "preset",
            0x18,
            Access::command("preset"),
            "the position becomes `PRESET_VALUE`; 0 clears it",
            vec![],
        )
        .with(
            "index_arm",
            0x19,
            Access::command("index_arm"),
            "latches the next index",
            vec![],
        )
        .with(
            "clear_flags",
            0x1a,
            Access::command("clear_flags"),
            "clears the counter's flags in `STATUS`",
            vec![],
        )
        .with(
            "flags",
            0x1b,
            Sticky,
            "events since the flag was cleared",
            vec![
                super::partial_write(0),
                Field::flag("saturated", 1, "the velocity was clamped"),
                Field::flag("index_seen", 2, "an index was latched"),
            ],
        )
        .with("status", 0x1c, Live, "state of the counter", status())
        .with_shadowed(
            "position",
            0x20,
            0x30,
            "position",
            vec![counts("position", "count minus origin")],
        )
        .with_shadowed(
            "velocity",
            0x21,
            0x31,
            "velocity",
            vec![
                Field::new("velocity", 0, 32, "velocity at the last tick")
                    .fixed(16)
                    .with_unit("counts/tick"),
            ],
        )
        .with_times(0x22, 0x32)
        .with_shadowed(
            "count",
            0x24,
            0x34,
            "counter of steps since reset",
            vec![counts("count", "modulo 2^32; a preset does not change it")],
        )
        .with_shadowed(
            "index_count",
            0x25,
            0x35,
            "count at the index",
            vec![counts("index_count", "count at the last latched index")],
        )
        .with(
            "origin",
            0x26,
            Live,
            "origin of the position",
            vec![counts("origin", "count at which the position is 0; presets move it")],
        )
}

fn counts(name: &str, meaning: &str) -> Field {
    Field::new(name, 0, 32, meaning).signed().with_unit("counts")
}

fn lines(filter_clocks: u32, invert: bool) -> Vec<Field> {
    let modes = [
        (0, "quadrature_x4", "every edge of A and B"),
        (1, "quadrature_x2", "edges of A"),
        (2, "quadrature_x1", "edges of A while B is low"),
        (3, "step_direction", "rising A; up while B is high"),
        (4, "up_down", "rising A up, rising B down"),
    ];
    vec![
        Field::new("filter_clocks", 0, 6, "longest pulse that is ignored")
            .with_reset(filter_clocks)
            .with_unit("clocks"),
        Field::choice("mode", 8, 3, "edges that count", &modes),
        Field::flag("swap", 16, "exchanges A and B"),
        Field::flag("invert", 17, "reverses the direction").with_reset(invert.into()),
        Field::flag("differential", 18, "the lines are differential pairs"),
    ]
}

fn index() -> Vec<Field> {
    vec![
        Field::flag("index_always", 0, "latches every index"),
        Field::flag("index_presets", 1, "a latched index also presets the position"),
        Field::new(
            "index_gate",
            4,
            4,
            "bit 0: an index counts only while A equals bit 1; bit 2: only while B equals bit 3",
        ),
    ]
}

fn velocity_filter() -> Vec<Field> {
    vec![
        Field::new("smoothing", 0, 2, "k of the one-pole filter with coefficient 2^-k"),
        Field::flag("velocity_m", 4, "velocity is the counts per tick alone"),
        Field::new(
            "timeout",
            8,
            8,
            "time without an edge after which the velocity is 0; at most 253",
        )
        .with_reset(TIMEOUT)
        .with_unit("65536 clocks"),
    ]
}

fn status() -> Vec<Field> {
    vec![
        Field::flag("index_armed", 1, "the next index will be latched"),
        Field::flag("illegal", 2, "A and B changed together"),
        Field::flag("disagreement", 3, "the lines of a pair were equal"),
        Field::flag("velocity_missed", 4, "a tick had no new velocity"),
        Field::flag("velocity_pending", 5, "a division is running"),
        Field::flag("level_a", 8, "filtered A"),
        Field::flag("level_b", 9, "filtered B"),
        Field::flag("level_z", 10, "filtered Z"),
        Field::new("illegal_count", 16, 8, "illegal transitions; stops at 255"),
    ]
}
