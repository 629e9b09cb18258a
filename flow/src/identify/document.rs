//! The document of a log's modes: the command line's contract.

use super::findings::Findings;
use posicast_identify::recommend::Recommendation;
use posicast_identify::{FoundMode, Interval};
use schemars::JsonSchema;
use serde::Serialize;

/// The modes of a log, and shapers for them.
#[derive(Serialize, JsonSchema)]
pub struct Document {
    modes: Vec<Mode>,
    recommended: Vec<Recommended>,
    /// `m` or `rad`: the unit of the displacements and of the smoothing, whatever their names end with.
    si_unit: &'static str,
    method: &'static str,
    rows: usize,
    sample_hz: f64,
    axis: Option<String>,
    remarks: Vec<String>,
}

#[derive(Serialize, JsonSchema)]
struct Mode {
    frequency_hz: f64,
    damping: f64,
    participation: f64,
    /// Amplitude after the jump of the acceleration, in the SI unit, and its share in that of all modes.
    ringing_m: f64,
    ringing_share: f64,
    frequency_sd_hz: f64,
    damping_sd: f64,
    frequency_interval_hz: [f64; 2],
    damping_interval: [f64; 2],
}

#[derive(Serialize, JsonSchema)]
struct Recommended {
    kind: &'static str,
    duration_s: f64,
    residual_displacement_m: f64,
    unshaped_displacement_m: f64,
    delay_s: f64,
    smoothing_m: f64,
    /// Whether it leaves at most 5 % of the unshaped displacement.
    is_enough: bool,
    /// Largest acceleration of a 3D printer, at which a corner is rounded by 0.12 mm, and its rounding there; not for rotary axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    max_accel_mm_s2: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    corner_smoothing_m: Option<f64>,
}

impl Document {
    pub(super) fn new(findings: &Findings) -> Self {
        Self {
            modes: findings.modes.iter().map(|found| mode(found, findings)).collect(),
            recommended: findings
                .recommended
                .iter()
                .map(|shaper| recommended(shaper, findings))
                .collect(),
            si_unit: findings.unit.si_name(),
            method: findings.method_name,
            rows: findings.rows,
            sample_hz: 1.0 / findings.sample_s,
            axis: findings.axis.clone(),
            remarks: findings.remarks.clone(),
        }
    }
}

fn mode(found: &FoundMode, findings: &Findings) -> Mode {
    let ringing = |found: &FoundMode| found.ringing(findings.judgement.acceleration);
    let whole: f64 = findings.modes.iter().map(ringing).sum();
    let ends = |interval: Interval| [interval.low, interval.high];
    Mode {
        frequency_hz: found.mode.frequency_hz,
        damping: found.mode.damping,
        participation: found.participation,
        ringing_m: ringing(found),
        ringing_share: ringing(found) / whole,
        frequency_sd_hz: found.frequency_sd_hz,
        damping_sd: found.damping_sd,
        frequency_interval_hz: ends(found.frequency_interval_hz()),
        damping_interval: ends(found.damping_interval()),
    }
}

fn recommended(recommendation: &Recommendation, findings: &Findings) -> Recommended {
    let of_printer = (findings.unit.si_name() == "m").then_some(recommendation);
    Recommended {
        kind: recommendation.kind.name(),
        duration_s: recommendation.impulses.duration_s(),
        residual_displacement_m: recommendation.residual_displacement,
        unshaped_displacement_m: recommendation.unshaped_displacement,
        delay_s: recommendation.impulses.delay_s(),
        smoothing_m: recommendation.smoothing,
        is_enough: findings.judgement.is_enough(recommendation),
        max_accel_mm_s2: of_printer.map(|shaper| 1e3 * shaper.max_acceleration),
        corner_smoothing_m: of_printer.map(Recommendation::smoothing_in_corners),
    }
}
