//! `[axis.compare]`: a line that pulses when the axis passes positions at equal distances, for a camera or a laser.

use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use super::{ClockSection, LimitsSection};
use crate::unit::AxisUnit;
use posicast_shaper::unit::{short, show_seconds};

/// Range of the distance of two positions.
const DISTANCE: NumberRange = NumberRange::positive(1e9);
/// Range of the hysteresis.
const FROM_ZERO: NumberRange = NumberRange::closed(0.0, 1e9);
/// Range of the first position.
const POSITION: NumberRange = NumberRange::closed(-1e9, 1e9);
/// Range of the width of a pulse.
const PULSE_S: NumberRange = NumberRange::positive(1.0).unit("s");
/// Largest number of positions.
const MOST_POSITIONS: u32 = i32::MAX as u32;
/// Longest pulse in clocks, which its register holds.
const MOST_PULSE_CLOCKS: u32 = (1 << 24) - 1;
/// Decimals such as 0.01 are not exact: a count may be off by this much.
const NEARLY: f64 = 1e-6;

/// Direction in which a position gives a pulse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CompareDirection {
    /// Towards higher positions.
    Up,
    /// Towards lower positions.
    Down,
    /// In both.
    Both,
}

impl CompareDirection {
    /// Every direction with its name in the machine file.
    pub const ALL: [(Self, &str); 3] = [(Self::Up, "up"), (Self::Down, "down"), (Self::Both, "both")];
}

/// `[axis.compare]`. Lengths are in m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompareSection {
    /// Distance of two positions.
    pub spacing: f64,
    /// Number of positions.
    pub positions: u32,
    /// Lowest position. Default 0.
    pub first: f64,
    /// Direction that gives a pulse. Default: both.
    pub direction: CompareDirection,
    /// Distance from its edge after which a position may give its next pulse. Default 0.
    pub hysteresis: f64,
    /// Width of a pulse, s.
    pub pulse_s: f64,
}

impl CompareSection {
    /// Clocks of a pulse, rounded up.
    pub fn pulse_clocks(&self, clock: &ClockSection) -> u32 {
        clock.clocks_up(self.pulse_s).clamp(1, MOST_PULSE_CLOCKS)
    }

    /// Counts of the hysteresis, rounded up.
    pub fn hysteresis_counts(&self, counts_per_unit: f64) -> u16 {
        (self.hysteresis * counts_per_unit - NEARLY).ceil().max(0.0) as u16
    }
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "spacing",
        Values::Quantity(DISTANCE),
        "Distance of two positions, in the axis's unit.",
    )
    .rule("a whole number of counts")
    .required(),
    Key::new(
        "positions",
        Values::Integer(1, MOST_POSITIONS),
        "Number of positions.",
    )
    .required(),
    Key::new(
        "first",
        Values::Quantity(POSITION),
        "Lowest position, in the axis's unit. Absent: 0.",
    )
    .rule("a whole number of counts"),
    Key::new(
        "direction",
        Values::Word(|| CompareDirection::ALL.map(|(_, name)| name).to_vec()),
        "Direction in which a position gives a pulse.",
    )
    .default(Default::Word("both")),
    Key::new(
        "hysteresis",
        Values::Quantity(FROM_ZERO),
        "Distance from its edge after which a position may give its next pulse, in the axis's unit; rounded up to counts. Absent: 0.",
    )
    .rule("less than `spacing`"),
    Key::new("pulse_s", Values::Number(PULSE_S), "Width of a pulse, rounded up to clocks.")
        .rule("at most 16,777,215 clocks, and shorter than the way to the next position takes at `limits.velocity`")
        .required(),
];

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>, unit: AxisUnit) -> Option<CompareSection> {
    table.allow(KEYS);
    table.require("spacing", "a distance above 0".to_owned());
    table.require("positions", format!("a whole number, 1 to {MOST_POSITIONS}"));
    let spacing = table.quantity("spacing", DISTANCE, unit);
    let positions = table.integer("positions", 1, MOST_POSITIONS);
    let first = table.quantity("first", POSITION, unit).unwrap_or(0.0);
    let direction = table.word("direction", &CompareDirection::ALL);
    let hysteresis = table.quantity("hysteresis", FROM_ZERO, unit).unwrap_or(0.0);
    let pulse_s = table.required_number("pulse_s", PULSE_S);
    Some(CompareSection {
        spacing: spacing?,
        positions: positions?,
        first,
        direction: direction.unwrap_or(CompareDirection::Both),
        hysteresis,
        pulse_s: pulse_s?,
    })
}

/// The axis beside the table.
pub(super) struct OfAxis<'a> {
    pub(super) unit: AxisUnit,
    pub(super) counts_per_unit: Option<f64>,
    pub(super) limits: Option<&'a LimitsSection>,
    pub(super) clock: Option<ClockSection>,
}

/// Checks the positions against the axis's counts, and the pulse against the clock and the axis's velocity.
pub(super) fn check(table: &Table<'_, '_>, compare: &CompareSection, axis: &OfAxis<'_>) {
    let shown = |value: f64| short(axis.unit.in_file(value));
    if let Some(counts_per_unit) = axis.counts_per_unit {
        check_counts(table, compare, axis.unit, counts_per_unit);
    }
    if compare.hysteresis >= compare.spacing {
        let found = format!(
            "hysteresis = {} with spacing = {}",
            shown(compare.hysteresis),
            shown(compare.spacing)
        );
        let allowed = "a hysteresis below the distance of two positions";
        table.contradiction(
            "hysteresis",
            found,
            allowed,
            "lower it: a count or two end the jitter of an encoder",
        );
    }
    table.at_most_clocks(
        ("pulse_s", compare.pulse_s),
        axis.clock,
        MOST_PULSE_CLOCKS,
        "shorten it",
    );
    if let Some(velocity) = axis.limits.and_then(|limits| limits.velocity) {
        let between_s = compare.spacing / velocity;
        if compare.positions > 1 && compare.pulse_s >= between_s {
            let found = format!(
                "pulse_s = {} with spacing = {} and limits.velocity = {}",
                table.quote("pulse_s"),
                shown(compare.spacing),
                shown(velocity)
            );
            let allowed = format!(
                "less than {}, which the axis takes from position to position: longer pulses merge",
                show_seconds(between_s, 4)
            );
            table.contradiction(
                "pulse_s",
                found,
                allowed,
                "shorten it, or raise `spacing`, or lower the velocity",
            );
        }
    }
}

/// Checks that all positions are counts, and words of 32 bits.
fn check_counts(table: &Table<'_, '_>, compare: &CompareSection, unit: AxisUnit, counts_per_unit: f64) {
    let shown = |value: f64| short(unit.in_file(value));
    for (key, length, least) in [("spacing", compare.spacing, 1.0), ("first", compare.first, f64::MIN)] {
        let counts = length * counts_per_unit;
        let whole = counts.round().max(least);
        // The last of many positions must be right, too.
        let most_off = NEARLY.min(0.1 / f64::from(compare.positions));
        if (counts - whole).abs() > most_off * counts.abs().max(1.0) {
            let found = format!("{key} = {}, {} counts", shown(length), short(counts));
            let remedy = format!("take {}, {} counts", shown(whole / counts_per_unit), short(whole));
            table.contradiction(
                key,
                found,
                "a whole number of counts: a position lies between two of them",
                remedy,
            );
        }
    }
    let last = compare.first * counts_per_unit + compare.spacing * counts_per_unit * f64::from(compare.positions - 1);
    if last > f64::from(i32::MAX) || compare.first * counts_per_unit < f64::from(i32::MIN) {
        let found = format!(
            "positions = {}, the last of them at {} counts",
            compare.positions,
            short(last)
        );
        table.contradiction(
            "positions",
            found,
            "positions of at most 2147483647 counts",
            "lower `positions`, `spacing` or `first`",
        );
    }
}
