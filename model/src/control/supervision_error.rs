//! Errors of the supervisor's words: the value of the file, and the range that its word holds.

use crate::unit::AxisUnit;

/// Why the supervisor of an axis has no valid words.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SupervisionError {
    /// A table of the axis is missing.
    #[error("axis {axis} has no [axis.{table}]: a supervised axis has a controller and what that needs; add it")]
    Missing {
        /// Name of the axis.
        axis: String,
        /// Name of the missing table.
        table: &'static str,
    },
    /// The word does not hold a value.
    #[error("axis {axis}: found {found} {unit}; allowed: {smallest} to {largest} {unit}, {reason}")]
    Range {
        /// Name of the axis.
        axis: String,
        /// Dotted key of the value.
        key: &'static str,
        /// Value of the file.
        found: f64,
        /// Unit of the values.
        unit: String,
        /// Smallest value that the word holds.
        smallest: f64,
        /// Largest value that the word holds.
        largest: f64,
        /// What sets the range.
        reason: &'static str,
    },
    /// The position word does not hold the travel wherever the axis stands at reset.
    #[error(
        "axis {axis}: found a travel from {} to {} {unit}, which takes {} with shaper and stop; allowed: at most {} \
         at {counts_per_unit} counts per {unit}, since the count is 0 where the axis stands at reset, at either end perhaps; shorten \
         the travel, or lower the counts_per_unit that the loop runs on",
        .unit.in_file(*.low), .unit.in_file(*.high), .unit.as_in_file(*.taken, ""), .unit.as_in_file(*.reach, "")
    )]
    Reach {
        /// Name of the axis.
        axis: String,
        /// Unit of the axis; the other figures are in m or rad.
        unit: AxisUnit,
        /// Lower end of the travel.
        low: f64,
        /// Upper end of the travel.
        high: f64,
        /// Distance from one end to the other, with the shaper's overshoot and a quick stop.
        taken: f64,
        /// Range of the word to one side.
        reach: f64,
        /// Counts of the loop per unit of the file.
        counts_per_unit: f64,
    },
    /// Rounding the soft limits inwards leaves no travel, or limits of 0, which would disable them.
    #[error(
        "axis {axis}: found a travel from {} to {} {unit}; allowed: one that is wider than a count, {} {unit}",
        .unit.in_file(*.low), .unit.in_file(*.high), .unit.in_file(*.count)
    )]
    Travel {
        /// Name of the axis.
        axis: String,
        /// Unit of the axis; the other figures are in m or rad.
        unit: AxisUnit,
        /// Lower end of the travel.
        low: f64,
        /// Upper end of the travel.
        high: f64,
        /// Length of one count.
        count: f64,
    },
}

impl SupervisionError {
    /// The key of the machine file that is to blame, dotted, such as `axis.limits.following_error`.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Missing { .. } => "axis.limits",
            Self::Range { key, .. } => key,
            Self::Travel { .. } | Self::Reach { .. } => "axis.limits.travel",
        }
    }
}
