//! The certificate of an axis's table, for `--certify` and for every `optimal` design.

use posicast_machine::machine_file::AxisSection;
use posicast_machine::plan::AxisTables;
use posicast_machine::plan::{AxisCertificate, ModeCertificate, certify_axis};
use posicast_shaper::certify::{CheckedBound, ShorterError};
use posicast_shaper::design::Findings;
use posicast_shaper::design::optimal::Optimal;
use schemars::JsonSchema;
use serde::Serialize;

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
            checked: self.certificate.shorter.clone(),
            is_together: optimal.is_together,
            samples: self.samples,
            most_taps: optimal.request.most_taps,
        }
    }
}

/// What is certified of an axis.
#[derive(Serialize, JsonSchema)]
pub struct Certificate {
    /// The modes, in the order of the file.
    pub modes: Vec<CertifiedMode>,
    /// Of `optimal`: what is known about shorter shapers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shorter: Option<LeastDuration>,
}

/// What is certified of a mode.
#[derive(Serialize, JsonSchema)]
pub struct CertifiedMode {
    /// Lower and upper end of the band of frequencies.
    pub frequency_hz: [f64; 2],
    /// Least and largest damping ratio of the band.
    pub damping: [f64; 2],
    /// Largest residual that the machine file allows.
    pub tolerance: f64,
    /// Upper bound of the residual in the band.
    pub certified_residual: f64,
    /// Largest residual that was found there.
    pub found_residual: f64,
    /// Where it was found.
    pub found_at: WorstPoint,
    /// Whether the bound is within the tolerance.
    pub holds: bool,
}

/// A point of a band.
#[derive(Serialize, JsonSchema)]
pub struct WorstPoint {
    /// Natural frequency.
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping: f64,
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
pub struct LeastDuration {
    /// The shortest duration that was found.
    pub least_samples: u32,
    /// The same in seconds.
    pub least_duration_s: f64,
    /// Whether no shorter one exists.
    pub proven: bool,
    /// Duration up to which there is none.
    pub excluded_samples: Option<u32>,
    /// The least part of the tolerance that each of those leaves somewhere.
    pub excluded_ratio: Option<f64>,
    /// Points of the bands, with weights, that prove it.
    pub points: Vec<ProofPoint>,
    /// The proof, checked, or why it is none; `None` if there is no proof.
    #[serde(skip)]
    pub checked: Option<Result<CheckedBound, ShorterError>>,
    /// Whether the taps are those of a joint design of several axes.
    #[serde(skip)]
    pub is_together: bool,
    /// Duration of the design.
    #[serde(skip)]
    pub samples: u32,
    /// The number of taps that the machine file allows.
    #[serde(skip)]
    pub most_taps: usize,
}

/// A point of the band of a mode, with its weight in a proof.
#[derive(Serialize, JsonSchema)]
pub struct ProofPoint {
    mode: usize,
    frequency_hz: f64,
    damping: f64,
    weight: [f64; 2],
}
