//! The design of one axis.

use super::certificate::CertificateReport;
use super::delay::DelayParts;
use super::document;
use super::error_table::ErrorTableReport;
use super::family::FamilyReport;
use crate::control::AxisControl;
use crate::machine;
use crate::text::UnitDocument;
use posicast_machine::hardware::HardwareError;
use posicast_machine::machine_file::{AxisSection, DriveMode};
use posicast_machine::plan::{AxisTables, ModeFigures};
use posicast_shaper::design::{ConvolutionFigures, Findings};
use posicast_shaper::digitise::half_sums_samples;
use std::path::Path;

/// The design of an axis with its figures.
pub(super) struct AxisReport<'a> {
    /// The machine file, or the folder that contains it.
    pub(super) path: &'a Path,
    /// Index of the axis, from 0.
    pub(super) place: usize,
    pub(super) axis: &'a AxisSection,
    pub(super) tables: &'a AxisTables,
    /// Its certificate, if it is requested.
    pub(super) certificate: Option<CertificateReport<'a>>,
    /// Whether its delay is made equal to that of other axes.
    pub(super) in_stage: bool,
    pub(super) modes: Vec<ModeFigures>,
    pub(super) convolution: ConvolutionFigures,
    /// Why its shaper cannot be built, or cannot run at the sample rate.
    pub(super) misfit: Option<&'a HardwareError>,
    pub(super) control: Option<&'a AxisControl>,
    /// Its table family, if its modes move.
    pub(super) family: Option<FamilyReport<'a>>,
    /// Its error table.
    pub(super) error_table: Option<ErrorTableReport<'a>>,
}

impl AxisReport<'_> {
    /// The document of the axis.
    pub(super) fn json(&self, sample_hz: f64, coefficient_fraction: u32) -> document::DesignAxis {
        let impulses = &self.tables.design.impulses;
        let sums = impulses.partial_sums();
        let findings = &self.tables.design.findings;
        document::DesignAxis {
            name: self.axis.name.clone(),
            unit: UnitDocument::new(self.axis.unit),
            kind: self.tables.design.kind.clone(),
            solutions: match findings {
                Findings::Periodic(found) => {
                    Some(found.solutions.iter().map(document::PeriodicSolution::new).collect())
                }
                _ => None,
            },
            system_hz: match findings {
                Findings::Periodic(found) => Some(found.system_hz),
                _ => None,
            },
            classes: match findings {
                Findings::Antisymmetric(found) => Some(found.classes.iter().map(document::ModeClass::new).collect()),
                _ => None,
            },
            time_optimal: match findings {
                Findings::Simultaneous(found) => Some(found.is_time_optimal),
                _ => None,
            },
            impulses: impulses
                .impulses()
                .iter()
                .map(|i| document::DesignImpulse {
                    time_s: i.time_s,
                    amplitude: i.amplitude,
                })
                .collect(),
            duration_s: impulses.duration_s(),
            delay_s: impulses.delay_s(),
            partial_sum_min: sums.min,
            partial_sum_max: sums.max,
            peak_command: self.convolution.peak_command,
            cross_gains: self
                .convolution
                .cross_gains
                .iter()
                .map(|g| document::ShaperCrossGain {
                    kind: g.kind.name(),
                    shaper_hz: self.modes[g.shaper].mode.frequency_hz,
                    at_hz: self.modes[g.at].mode.frequency_hz,
                    gain: g.gain,
                })
                .collect(),
            warnings: self.convolution.warnings.iter().map(ToString::to_string).collect(),
            placed_warnings: self
                .convolution
                .warnings
                .iter()
                .map(|warning| machine::place(self.path, self.place, "axis.shaper", warning))
                .collect(),
            modes: self
                .modes
                .iter()
                .zip(&self.axis.modes)
                .map(|(m, of_file)| document::DesignMode {
                    frequency_hz: m.mode.frequency_hz,
                    damping: m.mode.damping,
                    mechanics: self
                        .axis
                        .mechanics
                        .map(|screw| document::Mechanics::new(&screw, self.is_motor_free())),
                    free: of_file.free.map(|free| document::FreeMode {
                        frequency_hz: free.frequency_hz,
                        damping: free.damping,
                    }),
                    residual: m.residual,
                    tolerance: m.tolerance,
                    insensitivity: m.insensitivity.map(|i| (i.low, i.high)),
                })
                .collect(),
            quantised: document::Quantised {
                sample_hz,
                coefficient_fraction,
                digitise: self.tables.digitised.method_used.to_string(),
                fits: self.misfit.is_none(),
                misfit: self.misfit.map(ToString::to_string),
                half_sums_samples: match findings {
                    Findings::HalfSums(delays_s) => half_sums_samples(delays_s, sample_hz),
                    _ => Vec::new(),
                },
                taps: document::TableTap::of(&self.tables.table),
                modes: self
                    .modes
                    .iter()
                    .enumerate()
                    .map(|(index, m)| document::Residual {
                        residual: m.residual_quantised,
                        certified_residual: self.certificate.as_ref().and_then(|c| c.residual(index)),
                    })
                    .collect(),
            },
            certificate: self.certificate.as_ref().map(CertificateReport::json),
            family: self.family.as_ref().map(FamilyReport::json),
            error_table: self.error_table.as_ref().map(ErrorTableReport::json),
            delay: self.in_stage.then(|| DelayParts::new(&self.tables.delay)),
            control: self.control.map(AxisControl::json),
        }
    }

    /// Whether the drive leaves the motor free to swing against the load.
    fn is_motor_free(&self) -> bool {
        let drive = self.axis.drive.as_ref();
        drive.is_some_and(|drive| matches!(drive.mode, DriveMode::Torque { .. }))
    }
}
