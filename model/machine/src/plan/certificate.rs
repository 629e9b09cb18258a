//! Certifies the table of an axis over the bands of its modes and, for `optimal`, that no shorter shaper exists.

use crate::machine_file::AxisSection;
use crate::plan::AxisTables;
use crate::plant::response::step_figures;
use crate::plant::{Plant, PlantError};
use posicast_shaper::analysis::tap_impulses;
use posicast_shaper::certify::{CheckedBound, ResidualBound, ShorterError, check_shorter, residual_bound};
use posicast_shaper::design::Findings;
use posicast_shaper::mode::{Mode, ModeBand};

/// Slack of a tolerance, as of every insensitivity.
const SLACK: f64 = 1.0 + 1e-6;

/// The certificate of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisCertificate {
    /// The modes, in the order of the file.
    pub modes: Vec<ModeCertificate>,
    /// For `optimal`, the proof that no shorter shaper meets the tolerances over the bands, or the reason why there is none.
    pub shorter: Option<Result<CheckedBound, ShorterError>>,
}

/// Residual that an axis's integer taps leave of one mode, anywhere in its band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeCertificate {
    /// The band.
    pub band: ModeBand,
    /// Tolerance in the file.
    pub tolerance: f64,
    /// Upper bound of the residual, and the largest that was found.
    pub residual: ResidualBound,
}

impl ModeCertificate {
    /// Returns whether the whole band is within the tolerance.
    pub fn holds(&self) -> bool {
        self.residual.bound <= self.tolerance * SLACK
    }
}

/// Certifies the table of an axis.
pub fn certify_axis(axis: &AxisSection, tables: &AxisTables, sample_hz: f64) -> AxisCertificate {
    let modes = axis.modes.iter().map(|mode| ModeCertificate {
        band: mode.band(),
        tolerance: axis.shaped().tolerance_of(mode),
        residual: residual_bound(&tables.table, sample_hz, &mode.band()),
    });
    AxisCertificate {
        modes: modes.collect(),
        shorter: match &tables.design.findings {
            Findings::Optimal(found) => {
                let proof = found.shorter.as_ref();
                proof.map(|proof| check_shorter(&found.request, proof))
            }
            _ => None,
        },
    }
}

/// A corner of a mode's band, on the simulated plant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerFigures {
    /// Index of the mode.
    pub index: usize,
    /// The corner.
    pub corner: Mode,
    /// Residual of a step that is shaped by the integer taps, measured on the simulated plant.
    pub measured: f64,
    /// The bound that is certified over the mode's whole band.
    pub certified: f64,
}

/// Measures a shaped step on simulated plants that are each at a corner of a mode's band.
///
/// # Errors
/// [`PlantError`] for a corner that cannot be simulated.
pub fn measure_corners(
    axis: &AxisSection,
    tables: &AxisTables,
    certificate: &AxisCertificate,
    sample_hz: f64,
) -> Result<Vec<CornerFigures>, PlantError> {
    let taps = tap_impulses(&tables.table, sample_hz);
    let mut figures = Vec::new();
    for (index, (mode, certified)) in axis.modes.iter().zip(&certificate.modes).enumerate() {
        for corner in mode.band().corners() {
            let plant = Plant::new(&[(corner, 1.0)])?;
            let measured = step_figures(&plant, &taps).residual;
            figures.push(CornerFigures {
                index,
                corner,
                measured: measured.first().copied().unwrap_or(0.0),
                certified: certified.residual.bound,
            });
        }
    }
    Ok(figures)
}
