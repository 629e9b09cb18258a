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
    /// A travel of which rounding inwards leaves nothing, or limits of 0, which mean that there are none.
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
            Self::Travel { .. } => "axis.limits.travel",
        }
    }
}
