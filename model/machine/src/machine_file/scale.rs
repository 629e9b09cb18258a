//! `[axis.scale]`: a linear scale at the load, read by a second pulse counter.

use super::key::{Default, Key, Values};
use super::range::COUNTS_PER_UNIT;
use super::table::Table;
use crate::unit::AxisUnit;

/// Use of the scale's position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ScaleUse {
    /// The position is compared with the motor's, which the loop runs on.
    #[default]
    Monitor,
    /// The loop's position is the scale's, and its velocity the motor's.
    Position,
}

impl ScaleUse {
    /// Every use with its name in the machine file.
    pub const ALL: [(Self, &str); 2] = [(Self::Monitor, "monitor"), (Self::Position, "position")];
}

/// `[axis.scale]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Counts per m or rad of the scale; those of the motor's encoder are the axis's.
    pub counts_per_unit: f64,
    /// Use of the scale. Default: comparison.
    pub usage: ScaleUse,
    /// Whether the scale's lines count down where the motor's encoder counts up. Default: false.
    pub invert: bool,
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "counts_per_unit",
        Values::Counts(COUNTS_PER_UNIT),
        "Counts of the scale per unit.",
    )
    .required(),
    Key::new(
        "use",
        Values::Word(|| ScaleUse::ALL.map(|(_, name)| name).to_vec()),
        "monitor: compared with the motor's position. position: the loop runs on it, with the motor's velocity.",
    )
    .rule("`position` needs `[axis.controller]`")
    .default(Default::Word("monitor")),
    Key::switch(
        "invert",
        "The scale counts down where the encoder, with its own `invert`, counts up.",
    ),
];

/// Reads the table of an axis; `None` where a value is refused.
pub(super) fn read(axis: &Table<'_, '_>, table: &Table<'_, '_>, unit: AxisUnit) -> Option<Scale> {
    table.allow(KEYS);
    let counts_per_unit = table.required_counts("counts_per_unit", COUNTS_PER_UNIT, unit);
    let usage = table.word("use", &ScaleUse::ALL).unwrap_or_default();
    if usage == ScaleUse::Position && !axis.has("controller") {
        let found = "use = \"position\" without [axis.controller]";
        let allowed = "position on an axis with [axis.controller], whose loop it closes; else monitor";
        table.contradiction("use", found, allowed, "add [axis.controller], or set use = \"monitor\"");
    }
    Some(Scale {
        counts_per_unit: counts_per_unit?,
        usage,
        invert: table.boolean("invert").unwrap_or(false),
    })
}
