//! Errors of the supervisor's words: the value of the file, and the range that its word holds.

use crate::unit::AxisUnit;
use posicast_shaper::unit::short;

/// Keys with a further remedy besides another value: one for values that are too large, one for those that are too small.
const OTHERWISE: [(&str, &str, &str); 10] = [
    ("axis.limits.deviation_s", "", "; 0 stops the axis at once"),
    ("axis.limits.saturation_s", "", "; 0 disables the check"),
    ("axis.limits.encoder_lost_s", "", "; 0 disables the check"),
    ("axis.limits.watchdog_s", "", "; 0 disables the watchdog"),
    (
        "axis.limits.encoder_lost_command",
        ": the command never exceeds that, so the check would never act",
        "",
    ),
    ("axis.limits.following_error", COARSER, FINER),
    ("axis.limits.deviation", COARSER, FINER),
    ("axis.limits.excitation", COARSER, FINER),
    ("axis.limits.travel", COARSER, COARSER),
    (
        "axis.limits.acceleration",
        "; `stop_deceleration` sets that of a quick stop alone",
        "; `stop_deceleration` sets that of a quick stop alone",
    ),
];
const COARSER: &str = "; a lower counts_per_unit allows more";
const FINER: &str = "; a higher counts_per_unit allows less";

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
    #[error(
        "axis {axis}: found {} {unit}; allowed: {} to {} {unit}, {reason}",
        short(*.found), short(*.smallest), short(*.largest)
    )]
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
        /// Reason for the range.
        reason: &'static str,
    },
    /// The position word does not hold the travel wherever the axis stands at reset.
    #[error(
        "axis {axis}: found a travel from {} to {} {unit}, in which the shaped command covers {}{}; allowed: at most {} together at {} \
         counts per {unit}, because the count is 0 where the axis stands at reset, and that may be either end",
        short(.unit.in_file(*.low)), short(.unit.in_file(*.high)), .unit.as_in_file(*.shaped, ""),
        stop_text(*.unit, *.stop, .deceleration), .unit.as_in_file(*.reach, ""), short(*.counts_per_unit)
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
        /// Distance from one end to the other, with the shaper's overshoot.
        shaped: f64,
        /// Distance of a quick stop from the largest velocity; 0 if the file does not determine it.
        stop: f64,
        /// Key of the deceleration of that stop: `stop_deceleration`, or `acceleration` in its place.
        deceleration: &'static str,
        /// Range of the word to one side.
        reach: f64,
        /// Counts of the loop per unit of the file.
        counts_per_unit: f64,
    },
    /// Rounding the soft limits inwards leaves no travel, or limits of 0, which would disable them.
    #[error(
        "axis {axis}: found a travel from {} to {} {unit}; allowed: one that is wider than a count, {} {unit}",
        short(.unit.in_file(*.low)), short(.unit.in_file(*.high)), short(.unit.in_file(*.count))
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

/// Text with the distance of a quick stop and its keys; empty if the file does not determine the distance.
fn stop_text(unit: AxisUnit, stop: f64, deceleration: &str) -> String {
    let key = deceleration.rsplit('.').next().unwrap_or(deceleration);
    if stop > 0.0 {
        format!(
            ", and a quick stop from `velocity` at `{key}` {}",
            unit.as_in_file(stop, "")
        )
    } else {
        String::new()
    }
}

impl SupervisionError {
    /// The key of the machine file that is to blame, dotted, such as `axis.limits.following_error`.
    pub fn key(&self) -> &'static str {
        match self {
            Self::Missing { .. } => "axis.limits",
            Self::Range { key, .. } => key,
            // Without the stop the travel would fit.
            Self::Reach {
                shaped,
                reach,
                deceleration,
                ..
            } if shaped <= reach => deceleration,
            Self::Travel { .. } | Self::Reach { .. } => "axis.limits.travel",
        }
    }

    /// Returns the remedy.
    pub fn remedy(&self) -> String {
        match self {
            Self::Missing { table, .. } => format!("add [axis.{table}], or remove [axis.controller]"),
            Self::Range { key: "axis.shaper", .. } => {
                "choose a shorter kind of shaper, or lower clock.sample_hz".to_owned()
            }
            Self::Range {
                key,
                found,
                smallest,
                largest,
                ..
            } => {
                let name = key.rsplit('.').next().unwrap_or(key);
                let otherwise = OTHERWISE.iter().find(|(of, ..)| of == key);
                let (end, more, otherwise) = if found > largest {
                    (*largest, "less", otherwise.map_or("", |(_, above, _)| above))
                } else {
                    (*smallest, "more", otherwise.map_or("", |(.., below)| below))
                };
                match name {
                    "travel" => format!("keep each end of the travel within its range{otherwise}"),
                    _ => format!("write `{name} = {}`, or {more}{otherwise}", short(end)),
                }
            }
            Self::Reach { stop, deceleration, .. } => {
                let key = deceleration.rsplit('.').next().unwrap_or(deceleration);
                let of_stop = if *stop > 0.0 {
                    format!(", raise `{key}` or lower `velocity`, from which the stop follows")
                } else {
                    String::new()
                };
                format!(
                    "shorten `travel`{of_stop}, choose a shaper that overshoots less, or lower the counts_per_unit of the loop"
                )
            }
            Self::Travel { .. } => "widen `travel`, or raise counts_per_unit for finer counts".to_owned(),
        }
    }
}
