//! Why an axis has no words for its supervisor: the value of the file, and the range that its word holds.

use crate::unit::AxisUnit;

/// Why an axis has no words for its supervisor.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SupervisionError {
    /// A table is missing.
    #[error("axis {axis} has no [axis.{table}]: a supervised axis has a controller and what that needs; add it")]
    Missing {
        /// The axis.
        axis: String,
        /// The table.
        table: &'static str,
    },
    /// A value that its word does not hold.
    #[error("axis {axis}: found {found} {unit}; allowed: {smallest} to {largest} {unit}, {reason}")]
    Range {
        /// The axis.
        axis: String,
        /// Dotted key.
        key: &'static str,
        /// The value found.
        found: f64,
        /// Its unit.
        unit: String,
        /// Smallest value that the word holds.
        smallest: f64,
        /// Largest value that it holds.
        largest: f64,
        /// What sets the range.
        reason: &'static str,
    },
    /// A travel that the position word does not hold wherever the axis stands at reset.
    #[error(
        "axis {axis}: found a travel from {} to {} {unit}, which takes {} with shaper and stop; allowed: at most {} \
         at {counts_per_unit} counts per {unit}, since the count is 0 where the axis stands at reset, at either end perhaps; shorten \
         the travel, or lower the counts_per_unit that the loop runs on",
        .unit.in_file(*.low), .unit.in_file(*.high), .unit.as_in_file(*.taken, ""), .unit.as_in_file(*.reach, "")
    )]
    Reach {
        /// The axis.
        axis: String,
        /// Its unit; the other figures are in m or rad.
        unit: AxisUnit,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
        /// From one end to the other, with the shaper's overshoot and a quick stop.
        taken: f64,
        /// What the word holds to one side.
        reach: f64,
        /// Counts of the loop per unit of the file.
        counts_per_unit: f64,
    },
    /// A travel of which rounding inwards leaves nothing, or limits of 0, which switch the limits off.
    #[error(
        "axis {axis}: found a travel from {} to {} {unit}; allowed: one that is wider than a count, {} {unit}",
        .unit.in_file(*.low), .unit.in_file(*.high), .unit.in_file(*.count)
    )]
    Travel {
        /// The axis.
        axis: String,
        /// Its unit; the other figures are in m or rad.
        unit: AxisUnit,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
        /// Of one count.
        count: f64,
    },
}

impl SupervisionError {
    /// The key of the machine file that is to blame, dotted: `axis.limits.following_error`, for example.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Missing { .. } => "axis.limits",
            Self::Range { key, .. } => key,
            Self::Travel { .. } | Self::Reach { .. } => "axis.limits.travel",
        }
    }
}
