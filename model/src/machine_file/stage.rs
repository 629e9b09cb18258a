//! `[stage]`: settings of all axes together. With this table their delays are made equal
//! ([`crate::design::matching`]).

use super::key::{Key, Values};
use super::range::NumberRange;
use super::table::Table;

/// Range of delays.
const SHORT_S: NumberRange = NumberRange::closed(0.0, 1.0).unit("s");
/// Range of speeds.
const SPEED: NumberRange = NumberRange::positive(1e9).unit("m/s");

/// `[stage]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageSection {
    /// Delay that every axis gets in addition to that of the slowest axis, s. Default 0.
    pub extra_delay_s: f64,
    /// Speed at which the mismatch of the axes is reported, m/s.
    pub contour_speed: Option<f64>,
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::or_zero(
        "extra_delay_s",
        SHORT_S,
        "Delay in s that every axis gets in addition to that of the slowest, for devices that are slower than the \
        axes.",
    ),
    Key::new(
        "contour_speed",
        Values::Number(SPEED),
        "Speed in m/s at which the remaining mismatch of the axes is reported. Absent: the smallest `velocity` of the \
        axes.",
    ),
];

/// Reads the table.
pub(super) fn read(table: &Table<'_, '_>) -> StageSection {
    table.allow(KEYS);
    StageSection {
        extra_delay_s: table.number("extra_delay_s", SHORT_S).unwrap_or(0.0),
        contour_speed: table.number("contour_speed", SPEED),
    }
}
