//! `[axis.probe]`: a touch switch at which an axis with steps is homed.
//!
//! The approaches are the host's: the hardware has polarity and filter of the line, and latches the position at the contact.

use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use super::{ClockSection, LimitsSection};
use crate::unit::AxisUnit;
use posicast_blocks::pulse_counter::FILTER_CLOCKS_MAX;
use posicast_shaper::unit::short;

/// Range of the filter's time.
const SHORT_S: NumberRange = NumberRange::closed(0.0, 1.0).unit("s");
/// Range of distances and velocities.
const MOTION: NumberRange = NumberRange::positive(1e9);
/// Range of the contact's position.
const POSITION: NumberRange = NumberRange::closed(-1e9, 1e9);
/// The second approach is so much slower than the first one where the file does not state its velocity.
const SLOWER: f64 = 5.0;

/// Side on which the contact is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProbeSide {
    /// Towards lower positions.
    Minus,
    /// Towards higher positions.
    Plus,
}

impl ProbeSide {
    /// Every side with its name in the machine file.
    pub const ALL: [(Self, &str); 2] = [(Self::Minus, "minus"), (Self::Plus, "plus")];

    /// Sign of the motion towards the contact.
    pub fn sign(self) -> f64 {
        match self {
            Self::Minus => -1.0,
            Self::Plus => 1.0,
        }
    }
}

/// `[axis.probe]`. Lengths are in m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProbeSection {
    /// Whether the line is low while the probe touches. Default false.
    pub active_low: bool,
    /// Pulses of up to this length on the line are ignored, s. Default 0.
    pub filter_s: f64,
    /// Side on which the contact is. Default: minus.
    pub side: ProbeSide,
    /// Velocity of the first approach, per s.
    pub velocity: f64,
    /// Velocity of the second approach, per s. Default: a fifth of the first one's.
    pub slow_velocity: f64,
    /// Largest distance of the contact.
    pub within: f64,
    /// Distance back from the contact, before the second approach.
    pub retract: f64,
    /// Position of the contact. Default 0.
    pub position: f64,
}

impl ProbeSection {
    /// Clocks of the line's filter; at most [`FILTER_CLOCKS_MAX`], which the reader checks.
    pub fn filter_clocks(&self, clock: &ClockSection) -> u32 {
        clock.clocks_up(self.filter_s).min(FILTER_CLOCKS_MAX)
    }
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::switch(
        "active_low",
        "The line is low while the probe touches: a contact that closes to ground, or opens from the supply.",
    ),
    Key::or_zero(
        "filter_s",
        SHORT_S,
        "Longest ignored pulse on the line, rounded up to clocks.",
    )
    .rule("at most 63 clocks"),
    Key::new(
        "side",
        Values::Word(|| ProbeSide::ALL.map(|(_, name)| name).to_vec()),
        "Side of the contact: towards lower positions, or towards higher ones.",
    )
    .default(Default::Word("minus")),
    Key::new(
        "velocity",
        Values::Quantity(MOTION),
        "Velocity of the first approach, in unit/s.",
    )
    .rule("at most `limits.velocity`")
    .required(),
    Key::new(
        "slow_velocity",
        Values::Quantity(MOTION),
        "Velocity of the second approach, whose contact counts, in unit/s. Absent: a fifth of `velocity`.",
    )
    .rule("at most `velocity`"),
    Key::new(
        "within",
        Values::Quantity(MOTION),
        "Largest distance of the contact from where the axis stands, in the axis's unit.",
    )
    .required(),
    Key::new(
        "retract",
        Values::Quantity(MOTION),
        "Distance back from the contact before the second approach, in the axis's unit.",
    )
    .rule("at most `within`")
    .required(),
    Key::new(
        "position",
        Values::Quantity(POSITION),
        "Position of the contact, in the axis's unit. Absent: 0.",
    ),
];

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>, unit: AxisUnit, clock: Option<ClockSection>) -> Option<ProbeSection> {
    table.allow(KEYS);
    for (key, what) in [
        ("velocity", "a velocity above 0"),
        ("within", "a distance above 0"),
        ("retract", "a distance above 0"),
    ] {
        table.require(key, what.to_owned());
    }
    let side = table.word("side", &ProbeSide::ALL);
    let [velocity, slow, within, retract] =
        ["velocity", "slow_velocity", "within", "retract"].map(|key| table.quantity(key, MOTION, unit));
    let filter_s = table.number("filter_s", SHORT_S).unwrap_or(0.0);
    let position = table.quantity("position", POSITION, unit).unwrap_or(0.0);
    let active_low = table.boolean("active_low").unwrap_or(false);
    let velocity = velocity?;
    let probe = ProbeSection {
        active_low,
        filter_s,
        side: side.unwrap_or(ProbeSide::Minus),
        velocity,
        slow_velocity: slow.unwrap_or(velocity / SLOWER),
        within: within?,
        retract: retract?,
        position,
    };
    let remedy = "shorten it: a contact that bounces later does not matter";
    table.at_most_clocks(("filter_s", filter_s), clock, FILTER_CLOCKS_MAX, remedy);
    Some(probe)
}

/// Checks the approaches against each other and the axis.
pub(super) fn check(table: &Table<'_, '_>, probe: &ProbeSection, limits: Option<&LimitsSection>, unit: AxisUnit) {
    let shown = |value: f64| short(unit.in_file(value));
    if let Some(most) = limits
        .and_then(|limits| limits.velocity)
        .filter(|most| probe.velocity > *most)
    {
        let found = format!(
            "velocity = {} with limits.velocity = {}",
            shown(probe.velocity),
            shown(most)
        );
        let allowed = "an approach at most as fast as a move";
        table.contradiction(
            "velocity",
            found,
            allowed,
            "lower it: the axis must stop behind the contact",
        );
    }
    if probe.slow_velocity > probe.velocity {
        let found = format!(
            "slow_velocity = {} with velocity = {}",
            shown(probe.slow_velocity),
            shown(probe.velocity)
        );
        let allowed = "a second approach at most as fast as the first one";
        table.contradiction("slow_velocity", found, allowed, "lower it, or remove the key");
    }
    if probe.retract > probe.within {
        let found = format!(
            "retract = {} with within = {}",
            shown(probe.retract),
            shown(probe.within)
        );
        let allowed = "a retract of at most the distance in which the contact is";
        table.contradiction("retract", found, allowed, "shorten it, or search further");
    }
}
