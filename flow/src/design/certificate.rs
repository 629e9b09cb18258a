//! The certificate of an axis's table, for `--certify` and for every `optimal` design.

use crate::text::{Table, percent};
use posicast_machine::machine_file::AxisSection;
use posicast_machine::plan::AxisTables;
use posicast_machine::plan::{AxisCertificate, ModeCertificate, certify_axis};
use posicast_shaper::design::Findings;
use posicast_shaper::design::optimal::Optimal;
use posicast_testbench::wording::counted;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;

/// The certificate of an axis, with the certified design.
pub(super) struct CertificateReport<'a> {
    certificate: AxisCertificate,
    optimal: Option<&'a Optimal>,
    /// Duration of the design.
    samples: u32,
    sample_hz: f64,
}

impl<'a> CertificateReport<'a> {
    /// Returns the certificate if it was requested (`asked`) or the kind is `optimal`; otherwise `None`.
    pub(super) fn new(axis: &AxisSection, tables: &'a AxisTables, sample_hz: f64, asked: bool) -> Option<Self> {
        let optimal = match &tables.design.findings {
            Findings::Optimal(found) => Some(found),
            _ => None,
        };
        (asked || optimal.is_some()).then(|| Self {
            certificate: certify_axis(axis, tables, sample_hz),
            optimal,
            samples: (tables.design.impulses.duration_s() * sample_hz).round() as u32,
            sample_hz,
        })
    }

    /// The certified residual of the mode of this index.
    pub(super) fn residual(&self, mode: usize) -> Option<f64> {
        self.certificate.modes.get(mode).map(|mode| mode.residual.bound)
    }

    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        if !self.certificate.modes.is_empty() {
            let mut table = Table::new(&[
                "mode from Hz",
                ">to Hz",
                ">damping from",
                ">to",
                ">tolerance %",
                ">certified %",
                ">found %",
                ">at Hz",
                "",
            ]);
            for mode in &self.certificate.modes {
                table.row(row(mode));
            }
            let _ = write!(
                text,
                "\n  certified: nowhere in these bands do the integer taps leave more\n{}",
                table.text("  ")
            );
        }
        if let Some(optimal) = self.optimal {
            text += &self.shorter_text(optimal);
        }
        text
    }

    fn shorter_text(&self, optimal: &Optimal) -> String {
        let mut text = self.least_text(optimal);
        if optimal.is_together {
            text += "  this is about the axis alone; its taps are those of the joint design below\n";
        } else if self.samples > optimal.least_samples {
            let more = self.samples - optimal.least_samples;
            let _ = writeln!(
                text,
                "  the limit of {2} costs {0} more, {1:.4} ms",
                counted(u64::from(more), "sample"),
                f64::from(more) / self.sample_hz * 1e3,
                counted(optimal.request.most_taps as u64, "tap"),
            );
        }
        text
    }

    fn least_text(&self, optimal: &Optimal) -> String {
        let milliseconds = |samples: u32| f64::from(samples) / self.sample_hz * 1e3;
        let least = optimal.least_samples;
        match &self.certificate.shorter {
            Some(Ok(bound)) if bound.points == 0 => format!(
                "\n  least duration {least} samples, {:.4} ms. Proof, checked: amplitudes within the bounds on at most {} samples do not \
                 sum to 1\n",
                milliseconds(least),
                bound.samples + 1,
            ),
            Some(Ok(bound)) => format!(
                "\n  least duration {least} samples, {:.4} ms. Proof, checked: every shaper of at most {} samples leaves, at one of {} of \
                 the bands, at least {:.6} of what is tolerated there\n",
                milliseconds(least),
                bound.samples,
                counted(bound.points as u64, "point"),
                bound.ratio,
            ),
            Some(Err(error)) => format!(
                "\n  shortest found {least} samples, {:.4} ms; not proven to be the least: {error}\n",
                milliseconds(least)
            ),
            None => format!(
                "\n  shortest found {least} samples, {:.4} ms; not proven to be the least\n",
                milliseconds(least)
            ),
        }
    }

    pub(super) fn json(&self) -> Certificate {
        Certificate {
            modes: self.certificate.modes.iter().map(CertifiedMode::new).collect(),
            shorter: self.optimal.map(|optimal| self.shorter_json(optimal)),
        }
    }

    fn shorter_json(&self, optimal: &Optimal) -> LeastDuration {
        let checked = self
            .certificate
            .shorter
            .as_ref()
            .and_then(|checked| checked.as_ref().ok());
        let proof = optimal.shorter.as_ref().filter(|_| checked.is_some());
        let points = proof.map_or(&[][..], |proof| &proof.points).iter();
        LeastDuration {
            least_samples: optimal.least_samples,
            least_duration_s: f64::from(optimal.least_samples) / self.sample_hz,
            proven: checked.is_some(),
            excluded_samples: checked.map(|bound| bound.samples),
            excluded_ratio: checked.map(|bound| bound.ratio).filter(|ratio| ratio.is_finite()),
            points: points
                .map(|point| ProofPoint {
                    mode: point.band + 1,
                    frequency_hz: point.frequency_hz,
                    damping: point.damping,
                    weight: point.weight,
                })
                .collect(),
        }
    }
}

fn row(mode: &ModeCertificate) -> [String; 9] {
    let ([low_hz, high_hz], [least, most]) = (mode.band.frequency_hz, mode.band.damping);
    [
        format!("{low_hz:.3}"),
        format!("{high_hz:.3}"),
        format!("{least:.4}"),
        format!("{most:.4}"),
        percent(mode.tolerance),
        percent(mode.residual.bound),
        percent(mode.residual.found),
        format!("{:.3}", mode.residual.at.frequency_hz),
        if mode.holds() { "" } else { "above the tolerance" }.into(),
    ]
}

/// What is certified of an axis.
#[derive(Serialize, JsonSchema)]
pub(super) struct Certificate {
    modes: Vec<CertifiedMode>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shorter: Option<LeastDuration>,
}

#[derive(Serialize, JsonSchema)]
struct CertifiedMode {
    frequency_hz: [f64; 2],
    damping: [f64; 2],
    tolerance: f64,
    certified_residual: f64,
    found_residual: f64,
    found_at: WorstPoint,
    holds: bool,
}

#[derive(Serialize, JsonSchema)]
struct WorstPoint {
    frequency_hz: f64,
    damping: f64,
}

impl CertifiedMode {
    fn new(mode: &ModeCertificate) -> Self {
        Self {
            frequency_hz: mode.band.frequency_hz,
            damping: mode.band.damping,
            tolerance: mode.tolerance,
            certified_residual: mode.residual.bound,
            found_residual: mode.residual.found,
            found_at: WorstPoint {
                frequency_hz: mode.residual.at.frequency_hz,
                damping: mode.residual.at.damping,
            },
            holds: mode.holds(),
        }
    }
}

/// That no shorter shaper exists, with the points and weights that prove it; modes are counted from 1.
#[derive(Serialize, JsonSchema)]
struct LeastDuration {
    least_samples: u32,
    least_duration_s: f64,
    proven: bool,
    excluded_samples: Option<u32>,
    excluded_ratio: Option<f64>,
    points: Vec<ProofPoint>,
}

#[derive(Serialize, JsonSchema)]
struct ProofPoint {
    mode: usize,
    frequency_hz: f64,
    damping: f64,
    weight: [f64; 2],
}
