//! `posicast design --compare`: every kind of shaper on the axes of one machine.

use crate::Outcome;
use crate::failure::Failure;
use crate::machine;
use crate::text::{Table, percent};
use posicast_machine::compare::{Candidate, KindComparison, compare as compare_kinds};
use posicast_machine::machine_file::Machine;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;
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
    let comparisons = compare_kinds(&machine, band_percent / 100.0);
    let text = text(&machine, band_percent, &comparisons);
    Ok(Outcome::passed(
        Document::new(&machine, band_percent, &comparisons),
        text,
    ))
}

fn text(machine: &Machine, band_percent: f64, comparisons: &[KindComparison]) -> String {
    let mut text = format!("{}: shapers for modes off by up to ±{band_percent} %\n", machine.name);
    for comparison in comparisons {
        let _ = writeln!(text, "\naxis {}{}", comparison.axis, tolerance(comparison));
        let mut table = Table::new(&[
            "",
            "kind",
            ">duration ms",
            ">worst residual %",
            ">least there %",
            ">taps",
            ">partial sums",
            ">delay ms",
            "",
        ]);
        for c in &comparison.candidates {
            table.row([
                if c.pareto { "*" } else { "" }.into(),
                c.kind.clone(),
                format!("{:.4}", 1e3 * c.duration_s),
                percent(c.worst_residual),
                c.least_residual.map_or_else(String::new, percent),
                c.taps.to_string(),
                format!("{:.3} … {:.3}", c.partial_sums.min, c.partial_sums.max),
                format!("{:.4}", 1e3 * c.delay_s),
                remark(c).into(),
            ]);
        }
        text += &table.text("  ");
        for missing in &comparison.missing {
            let _ = writeln!(text, "  no {}: {}", missing.kind, missing.reason);
        }
    }
    text + "\n* no other kind is better in one of duration, worst residual and taps, and at least as good in the others\n\
            optimal: designed for this band and these tolerances, without negative amplitudes and with a step within −1 … 1\n\
            least there: residual of the best shaper without negative amplitudes in the duration of a smooth kind\n"
}

/// The tolerances of an axis's modes, by which its kinds are judged.
fn tolerance(comparison: &KindComparison) -> String {
    let texts: Vec<String> = comparison
        .tolerances
        .iter()
        .map(|tolerance| percent(*tolerance))
        .collect();
    match texts.split_first() {
        None => String::new(),
        Some((first, others)) if others.iter().all(|other| other == first) => format!(", tolerance {first} %"),
        Some(_) => format!(", tolerances {} %", texts.join(", ")),
    }
}

fn remark(candidate: &Candidate) -> &'static str {
    match (candidate.in_file, candidate.shortest) {
        (true, true) => "as in the file; the shortest that keeps the tolerance",
        (true, false) => "as in the file",
        (false, true) => "the shortest that keeps the tolerance",
        (false, false) => "",
    }
}

/// `design --compare --json`, and `kinds` in `report.json`.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Kinds")]
pub struct Document {
    name: String,
    band_percent: f64,
    axes: Vec<KindsOfAxis>,
}

#[derive(Serialize, JsonSchema)]
struct KindsOfAxis {
    name: String,
    /// Of each mode, in the order of the file.
    tolerances: Vec<f64>,
    kinds: Vec<Kind>,
    missing: Vec<MissingKind>,
}

#[derive(Serialize, JsonSchema)]
struct Kind {
    kind: String,
    in_file: bool,
    /// No other kind is as good in duration, worst residual and taps, and better in one of them.
    pareto: bool,
    /// The worst residual of each mode is within its tolerance.
    keeps_tolerance: bool,
    /// No other kind that keeps the tolerance is shorter.
    shortest: bool,
    duration_s: f64,
    /// With the modes' frequencies off by up to `band_percent`.
    worst_residual: f64,
    /// Of a smooth kind: the least worst residual of any shaper without negative amplitudes in its duration.
    #[serde(skip_serializing_if = "Option::is_none")]
    least_residual: Option<f64>,
    taps: usize,
    partial_sum_min: f64,
    partial_sum_max: f64,
    delay_s: f64,
}

#[derive(Serialize, JsonSchema)]
struct MissingKind {
    kind: String,
    reason: String,
}

impl Document {
    pub(crate) fn new(machine: &Machine, band_percent: f64, comparisons: &[KindComparison]) -> Self {
        let axes = comparisons.iter().map(|comparison| KindsOfAxis {
            name: comparison.axis.clone(),
            tolerances: comparison.tolerances.clone(),
            kinds: comparison
                .candidates
                .iter()
                .map(|c| Kind {
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
