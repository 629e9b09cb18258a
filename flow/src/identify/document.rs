//! The document of a log's modes: the command line's contract.

use super::findings::Findings;
use crate::template::MachineKind;
use posicast_identify::recommend::{Judgement, Recommendation};
use posicast_identify::{FoundMode, Interval};
use posicast_machine::unit::AxisUnit;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// The modes of a log, and shapers for them.
#[derive(Serialize, JsonSchema)]
pub struct Document {
    /// The modes.
    pub modes: Vec<IdentifiedMode>,
    /// Shapers for all modes: those that leave little first, the shortest of them first.
    pub recommended: Vec<RecommendedShaper>,
    /// `m` or `rad`: the unit of the displacements and of the smoothing, whatever their names end with.
    pub si_unit: &'static str,
    /// Name of the method by which the modes were found.
    pub method: &'static str,
    /// Number of rows of the log.
    pub rows: usize,
    /// Samples per second.
    pub sample_hz: f64,
    /// The axis that the log names.
    pub axis: Option<String>,
    /// Problems of the log, and missing information in it.
    pub remarks: Vec<String>,
    /// How the figures were found, and what was written; for people.
    #[serde(skip)]
    pub background: Background,
}

/// How the figures of a log were found, and what was written.
pub struct Background {
    /// The log.
    pub log: PathBuf,
    /// Time between its first and its last row.
    pub duration_s: f64,
    /// Description of the log.
    pub source: String,
    /// Description of the method.
    pub method: String,
    /// Unit of the axis of the modes, in which the shapers' figures are shown.
    pub unit: AxisUnit,
    /// What the shapers were judged by.
    pub judgement: Judgement,
    /// Whether the modes suit a printer, whose corners the shapers round.
    pub is_printer: bool,
    /// The machine file that was written.
    pub written: Option<WrittenMachine>,
}

/// A machine file with the modes of a log.
pub struct WrittenMachine {
    /// The file.
    pub path: PathBuf,
    /// Text of the file.
    pub text: String,
    /// The axis from which the other values were copied, if the axis was added.
    pub copied_from: Option<String>,
}

/// A mode with its uncertainty.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Mode")]
pub struct IdentifiedMode {
    /// The natural frequency.
    pub frequency_hz: f64,
    /// The damping ratio.
    pub damping: f64,
    /// Its share in the static displacement of the response; the shares of all modes sum to one.
    pub participation: f64,
    /// Amplitude after the jump of the acceleration, in the SI unit.
    pub ringing_m: f64,
    /// Its share in that of all modes.
    pub ringing_share: f64,
    /// Standard deviation of the frequency.
    pub frequency_sd_hz: f64,
    /// Standard deviation of the damping ratio.
    pub damping_sd: f64,
    /// 95 % interval of the frequency.
    pub frequency_interval_hz: [f64; 2],
    /// 95 % interval of the damping ratio.
    pub damping_interval: [f64; 2],
}

/// A shaper for all modes of a log.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Recommended")]
pub struct RecommendedShaper {
    /// Name of the kind.
    pub kind: &'static str,
    /// From the first to the last impulse.
    pub duration_s: f64,
    /// Largest displacement that it leaves, in the SI unit.
    pub residual_displacement_m: f64,
    /// Displacement without a shaper, in the SI unit.
    pub unshaped_displacement_m: f64,
    /// Mean delay of a command.
    pub delay_s: f64,
    /// Rounding of a path under the acceleration that the shapers were judged by, in the SI unit.
    pub smoothing_m: f64,
    /// Whether it leaves at most 5 % of the unshaped displacement.
    pub is_enough: bool,
    /// Largest acceleration of a 3D printer, at which a corner is rounded by 0.12 mm; not for rotary axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_accel_mm_s2: Option<f64>,
    /// The rounding there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corner_smoothing_m: Option<f64>,
}

impl Document {
    /// The document of a log's findings, and of the machine file that was written with them.
    pub(super) fn new(log: &Path, findings: &Findings, written: Option<WrittenMachine>) -> Self {
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
            background: Background {
                log: log.to_owned(),
                duration_s: findings.rows as f64 * findings.sample_s,
                source: findings.source.clone(),
                method: findings.method.clone(),
                unit: findings.unit,
                judgement: findings.judgement,
                is_printer: findings.unit.si_name() == "m" && findings.kind() == MachineKind::Printer,
                written,
            },
        }
    }
}

fn mode(found: &FoundMode, findings: &Findings) -> IdentifiedMode {
    let ringing = |found: &FoundMode| found.ringing(findings.judgement.acceleration);
    let whole: f64 = findings.modes.iter().map(ringing).sum();
    let ends = |interval: Interval| [interval.low, interval.high];
    IdentifiedMode {
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

fn recommended(recommendation: &Recommendation, findings: &Findings) -> RecommendedShaper {
    let of_printer = (findings.unit.si_name() == "m").then_some(recommendation);
    RecommendedShaper {
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
