//! Why an axis has no words for its supervisor: the value of the file, and the range that its word holds.

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
        unit: &'static str,
        /// Smallest value that the word holds.
        smallest: f64,
        /// Largest value that it holds.
        largest: f64,
        /// What sets the range.
        reason: &'static str,
    },
    /// A travel that the position word does not hold wherever the axis stands at reset.
    #[error(
        "axis {axis}: found a travel from {low} to {high} m, which takes {taken} m with shaper and stop; allowed: at most {reach} m \
         at {counts_per_unit} counts per m, since the count is 0 where the axis stands at reset, at either end perhaps; shorten \
         the travel, or lower the counts_per_unit that the loop runs on"
    )]
    Reach {
        /// The axis.
        axis: String,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
        /// From one end to the other, with the shaper's overshoot and a quick stop.
        taken: f64,
        /// What the word holds to one side.
        reach: f64,
        /// Counts of the loop per unit.
        counts_per_unit: f64,
    },
    /// A travel of which rounding inwards leaves nothing, or limits of 0, which switch the limits off.
    #[error("axis {axis}: found a travel from {low} to {high} m; allowed: one that is wider than a count, {count} m")]
    Travel {
        /// The axis.
        axis: String,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
        /// Metres per count.
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
