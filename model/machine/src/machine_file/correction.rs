//! `[axis.correction]`: missing steps that a host gives while the axis rests, as its scale shows them.

use super::LimitsSection;
use super::key::{Key, Values};
use super::range::NumberRange;
use super::table::Table;
use crate::unit::AxisUnit;
use posicast_shaper::unit::short;

/// Range of distances and velocities.
const MOTION: NumberRange = NumberRange::positive(1e9);
/// Range of the time at rest.
const SECONDS: NumberRange = NumberRange::closed(0.0, 60.0).unit("s");
/// Largest number of steps of one correction, which its register holds.
const MOST_STEPS: f64 = i16::MAX as f64;

/// `[axis.correction]`. Lengths are in m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrectionSection {
    /// A larger deviation from the scale is corrected.
    pub from: f64,
    /// A deviation larger than this is not.
    pub most: f64,
    /// Velocity with which the missing steps are given, per s.
    pub velocity: f64,
    /// Time that the axis must have rested, s. Default 0.
    pub rest_s: f64,
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "from",
        Values::Quantity(MOTION),
        "Deviation from which on missing steps are given, in the axis's unit.",
    )
    .rule("at least a step, below `most`")
    .required(),
    Key::new(
        "most",
        Values::Quantity(MOTION),
        "Largest deviation that is corrected, in the axis's unit.",
    )
    .rule("at most `limits.deviation` and 32,767 steps")
    .required(),
    Key::new(
        "velocity",
        Values::Quantity(MOTION),
        "Velocity with which the missing steps are given, in unit/s.",
    )
    .rule("at most `limits.velocity`")
    .required(),
    Key::or_zero("rest_s", SECONDS, "How long the axis must have rested."),
];

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>, unit: AxisUnit) -> Option<CorrectionSection> {
    table.allow(KEYS);
    for (key, what) in [
        ("from", "a distance above 0"),
        ("most", "a distance above 0"),
        ("velocity", "a velocity above 0"),
    ] {
        table.require(key, what.to_owned());
    }
    let [from, most, velocity] = ["from", "most", "velocity"].map(|key| table.quantity(key, MOTION, unit));
    let rest_s = table.number("rest_s", SECONDS).unwrap_or(0.0);
    Some(CorrectionSection {
        from: from?,
        most: most?,
        velocity: velocity?,
        rest_s,
    })
}

/// Checks the distances against each other and the axis, whose steps are 1/`counts_per_unit` long.
pub(super) fn check(
    table: &Table<'_, '_>,
    correction: &CorrectionSection,
    limits: Option<&LimitsSection>,
    (unit, counts_per_unit): (AxisUnit, Option<f64>),
) {
    let shown = |value: f64| short(unit.in_file(value));
    let limit = |of: fn(&LimitsSection) -> Option<f64>| limits.and_then(of);
    if let Some(counts_per_unit) = counts_per_unit {
        if correction.from * counts_per_unit < 1.0 - 1e-9 {
            let found = format!(
                "from = {}, {} steps",
                shown(correction.from),
                short(correction.from * counts_per_unit)
            );
            table.contradiction(
                "from",
                found,
                "at least a step",
                "raise it: less than a step cannot be given",
            );
        }
        if correction.most * counts_per_unit > MOST_STEPS {
            let found = format!(
                "most = {}, {} steps",
                shown(correction.most),
                short(correction.most * counts_per_unit)
            );
            let allowed = format!("at most {MOST_STEPS} steps");
            table.contradiction("most", found, allowed, "lower it");
        }
    }
    if correction.from >= correction.most {
        let found = format!(
            "from = {} with most = {}",
            shown(correction.from),
            shown(correction.most)
        );
        table.contradiction("from", found, "less than `most`", "lower it, or raise `most`");
    }
    if let Some(deviation) = limit(|limits| limits.deviation).filter(|deviation| correction.most > *deviation) {
        let found = format!(
            "most = {} with limits.deviation = {}",
            shown(correction.most),
            shown(deviation)
        );
        let allowed = "a correction of at most the deviation that stops the axis";
        table.contradiction("most", found, allowed, "lower it, or raise limits.deviation");
    }
    if let Some(velocity) = limit(|limits| limits.velocity).filter(|velocity| correction.velocity > *velocity) {
        let found = format!(
            "velocity = {} with limits.velocity = {}",
            shown(correction.velocity),
            shown(velocity)
        );
        table.contradiction("velocity", found, "a correction at most as fast as a move", "lower it");
    }
}
