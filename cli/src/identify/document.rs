//! `identify --json`: the command line's contract.

use super::findings::Findings;
use posicast_identify::recommend::Recommendation;
use posicast_identify::{FoundMode, Interval};
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct Document<'a> {
    modes: Vec<ModeDocument>,
    recommended: Vec<RecommendedDocument>,
    /// `m` or `rad`: the unit of the displacements and of the smoothing, whatever their names end with.
    si_unit: &'static str,
    method: &'static str,
    rows: usize,
    sample_hz: f64,
    axis: Option<&'a str>,
    remarks: &'a [String],
}

#[derive(Serialize)]
struct ModeDocument {
    frequency_hz: f64,
    damping: f64,
    participation: f64,
    frequency_sd_hz: f64,
    damping_sd: f64,
    frequency_interval_hz: [f64; 2],
    damping_interval: [f64; 2],
}

#[derive(Serialize)]
struct RecommendedDocument {
    kind: &'static str,
    duration_s: f64,
    residual_displacement_m: f64,
    unshaped_displacement_m: f64,
    delay_s: f64,
    smoothing_m: f64,
}

impl<'a> Document<'a> {
    pub(super) fn new(findings: &'a Findings) -> Self {
        Self {
            modes: findings.modes.iter().map(mode).collect(),
            recommended: findings.recommended.iter().map(recommended).collect(),
            si_unit: findings.unit.si_name(),
            method: findings.method_name,
            rows: findings.rows,
            sample_hz: 1.0 / findings.sample_s,
            axis: findings.axis.as_deref(),
            remarks: &findings.remarks,
        }
    }
}

fn mode(found: &FoundMode) -> ModeDocument {
    let ends = |interval: Interval| [interval.low, interval.high];
    ModeDocument {
        frequency_hz: found.mode.frequency_hz,
        damping: found.mode.damping,
        participation: found.participation,
        frequency_sd_hz: found.frequency_sd_hz,
        damping_sd: found.damping_sd,
        frequency_interval_hz: ends(found.frequency_interval_hz()),
        damping_interval: ends(found.damping_interval()),
    }
}

fn recommended(recommendation: &Recommendation) -> RecommendedDocument {
    RecommendedDocument {
        kind: recommendation.kind.name(),
        duration_s: recommendation.impulses.duration_s(),
        residual_displacement_m: recommendation.residual_displacement,
        unshaped_displacement_m: recommendation.unshaped_displacement,
        delay_s: recommendation.impulses.delay_s(),
        smoothing_m: recommendation.smoothing,
    }
}
