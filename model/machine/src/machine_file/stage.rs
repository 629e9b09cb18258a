//! `[stage]`: settings of all axes together. With this table their delays are made equal
//! ([`crate::plan::matching`]).

use super::AxisSection;
use super::key::{Key, Values};
use super::range::NumberRange;
use super::table::Table;
use posicast_shaper::design::kind::ShaperKind;

/// Range of delays.
const SHORT_S: NumberRange = NumberRange::closed(0.0, 1.0).unit("s");
/// Range of speeds.
const SPEED: NumberRange = NumberRange::positive(1e9).unit("m/s");

/// Key of the joint design.
pub(super) const ARRIVE_TOGETHER: &str = "arrive_together";

/// `[stage]`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StageSection {
    /// Delay that every axis gets in addition to that of the slowest axis, s. Default 0.
    pub extra_delay_s: f64,
    /// Speed at which the mismatch of the axes is reported, m/s.
    pub contour_speed: Option<f64>,
    /// Whether the `optimal` shapers of all axes are designed as one, for one delay.
    pub arrive_together: bool,
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::or_zero(
        "extra_delay_s",
        SHORT_S,
        "Delay of every axis in addition to that of the slowest, for slower devices.",
    )
    .rule("as far as the ring buffers reach"),
    Key::new(
        "contour_speed",
        Values::Number(SPEED),
        "Speed in m/s or rad/s at which the remaining mismatch is reported. Absent: the axes' smallest `velocity`.",
    ),
    Key::switch(
        ARRIVE_TOGETHER,
        "Give the `optimal` shapers of all axes one delay: the least, at the least common duration.",
    )
    .rule("every axis needs kind `optimal` and modes that do not move"),
];

/// Reads the table.
pub(super) fn read(table: &Table<'_, '_>) -> StageSection {
    table.allow(KEYS);
    StageSection {
        extra_delay_s: table.number("extra_delay_s", SHORT_S).unwrap_or(0.0),
        contour_speed: table.number("contour_speed", SPEED),
        arrive_together: table.boolean(ARRIVE_TOGETHER).unwrap_or(false),
    }
}

/// Checks that a joint design has an `optimal` shaper on every axis, none of them a family of tables.
pub(super) fn check(table: &Table<'_, '_>, stage: &StageSection, axes: &[AxisSection]) {
    if !stage.arrive_together {
        return;
    }
    let other = axes
        .iter()
        .find(|axis| axis.shaped().joint_kind() != Some(ShaperKind::Optimal) || axis.family.is_some());
    let Some(axis) = other else {
        return;
    };
    let found = match axis.family {
        Some(_) => format!("{ARRIVE_TOGETHER} with axis {}, whose modes move", axis.name),
        None => format!(
            "{ARRIVE_TOGETHER} with axis {} of kind {}",
            axis.name,
            axis.shaped().kind_name()
        ),
    };
    let remedy = format!(
        "set kind = \"optimal\" on every axis, or remove `{ARRIVE_TOGETHER}`: [stage] makes the delays equal without it too"
    );
    table.contradiction(
        ARRIVE_TOGETHER,
        found,
        "kind = \"optimal\" and modes that do not move on every axis",
        remedy,
    );
}
