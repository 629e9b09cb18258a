//! `posicast design --compare`: every kind of shaper on the axes of one machine.

use crate::Outcome;
use crate::failure::Failure;
use crate::machine;
use posicast_machine::compare::{KindComparison, compare as compare_kinds};
use posicast_machine::machine_file::Machine;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Parses a percentage by which frequencies may be off.
///
/// # Errors
/// Returns the allowed values for any other text.
pub fn band(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(percent) if (0.0..=90.0).contains(&percent) => Ok(percent),
        _ => Err("the modes' frequency error in percent, 0 to 90".into()),
    }
}

/// Compares the kinds of shaper on the axes of a machine file, for modes whose frequencies are off by up to `band_percent`.
///
/// # Errors
/// [`Failure`] for a machine file that cannot be read.
pub fn compare(path: &Path, band_percent: f64) -> Result<Outcome<Document>, Failure> {
    let machine = machine::read(path)?.machine;
    Ok(Outcome::passed(of_machine(&machine, band_percent)))
}

/// As [`compare`], for a machine that was read already.
pub fn of_machine(machine: &Machine, band_percent: f64) -> Document {
    let comparisons = compare_kinds(machine, band_percent / 100.0);
    Document::new(machine, band_percent, &comparisons)
}

/// `design --compare --json`, and `kinds` in `report.json`.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Kinds")]
pub struct Document {
    /// Name of the machine.
    pub name: String,
    /// Frequency error of the modes, in percent.
    pub band_percent: f64,
    /// The axes of the machine, in the order of the file.
    pub axes: Vec<KindsOfAxis>,
}

/// The kinds of shaper on an axis.
#[derive(Serialize, JsonSchema)]
pub struct KindsOfAxis {
    /// Name of the axis.
    pub name: String,
    /// Of each mode, in the order of the file.
    pub tolerances: Vec<f64>,
    /// The kinds that can be designed for the axis.
    pub kinds: Vec<ComparedKind>,
    /// The others.
    pub missing: Vec<MissingKind>,
}

/// A kind of shaper on an axis.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Kind")]
pub struct ComparedKind {
    /// Name of the kind.
    pub kind: String,
    /// Whether the machine file has this kind.
    pub in_file: bool,
    /// No other kind is as good in duration, worst residual and taps, and better in one of them.
    pub pareto: bool,
    /// The worst residual of each mode is within its tolerance.
    pub keeps_tolerance: bool,
    /// No other kind that keeps the tolerance is shorter.
    pub shortest: bool,
    /// From the first to the last impulse.
    pub duration_s: f64,
    /// With the modes' frequencies off by up to `band_percent`.
    pub worst_residual: f64,
    /// Of a smooth kind: the least worst residual of any shaper without negative amplitudes in its duration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_residual: Option<f64>,
    /// Number of integer taps.
    pub taps: usize,
    /// The least of the shaped unit step.
    pub partial_sum_min: f64,
    /// The most of the shaped unit step.
    pub partial_sum_max: f64,
    /// Mean delay of a command.
    pub delay_s: f64,
}

/// A kind of shaper that an axis cannot have.
#[derive(Serialize, JsonSchema)]
pub struct MissingKind {
    /// Name of the kind.
    pub kind: String,
    /// Why it cannot be designed.
    pub reason: String,
}

impl Document {
    pub(crate) fn new(machine: &Machine, band_percent: f64, comparisons: &[KindComparison]) -> Self {
        let axes = comparisons.iter().map(|comparison| KindsOfAxis {
            name: comparison.axis.clone(),
            tolerances: comparison.tolerances.clone(),
            kinds: comparison
                .candidates
                .iter()
                .map(|c| ComparedKind {
                    kind: c.kind.clone(),
                    in_file: c.in_file,
                    pareto: c.pareto,
                    keeps_tolerance: c.keeps_tolerance,
                    shortest: c.shortest,
                    duration_s: c.duration_s,
                    worst_residual: c.worst_residual,
                    least_residual: c.least_residual,
                    taps: c.taps,
                    partial_sum_min: c.partial_sums.min,
                    partial_sum_max: c.partial_sums.max,
                    delay_s: c.delay_s,
                })
                .collect(),
            missing: comparison
                .missing
                .iter()
                .map(|m| MissingKind {
                    kind: m.kind.clone(),
                    reason: m.reason.clone(),
                })
                .collect(),
        });
        Self {
            name: machine.name.clone(),
            band_percent,
            axes: axes.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_band_is_a_percentage() {
        assert_eq!(band("7.5"), Ok(7.5));
        for wrong in ["-1", "91", "nan", "inf", "wide", ""] {
            assert!(band(wrong).is_err(), "{wrong}");
        }
    }
}
