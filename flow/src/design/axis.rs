//! The design of one axis, for people and for programs.

use super::certificate::CertificateReport;
use super::delay::Delay;
use super::document;
use super::error_table::ErrorTableReport;
use super::family::FamilyReport;
use crate::control::AxisControl;
use crate::machine;
use crate::text::{Table, UnitDocument, percent};
use posicast_machine::hardware::HardwareError;
use posicast_machine::machine_file::{AxisSection, DriveMode};
use posicast_machine::plan::{AxisTables, ModeFigures};
use posicast_shaper::analysis::INSENSITIVITY_LIMIT;
use posicast_shaper::design::ratios::Class;
use posicast_shaper::design::{ConvolutionFigures, Findings};
use posicast_shaper::mode::Mode;
use posicast_shaper::unit::trimmed;
use posicast_testbench::wording::counted;
use std::fmt::Write;
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
    pub(super) fn json(&self, sample_hz: f64, coefficient_fraction: u32) -> document::Axis {
        let impulses = &self.tables.design.impulses;
        let sums = impulses.partial_sums();
        let findings = &self.tables.design.findings;
        document::Axis {
            name: self.axis.name.clone(),
            unit: UnitDocument::new(self.axis.unit),
            kind: self.tables.design.kind.clone(),
            solutions: match findings {
                Findings::Periodic(found) => Some(found.solutions.iter().map(document::Solution::new).collect()),
                _ => None,
            },
            classes: match findings {
                Findings::Antisymmetric(found) => Some(found.classes.iter().map(document::Class::new).collect()),
                _ => None,
            },
            time_optimal: match findings {
                Findings::Simultaneous(found) => Some(found.is_time_optimal),
                _ => None,
            },
            impulses: impulses
                .impulses()
                .iter()
                .map(|i| document::Impulse {
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
                .map(|g| document::CrossGain {
                    kind: g.kind.name(),
                    shaper_hz: self.modes[g.shaper].mode.frequency_hz,
                    at_hz: self.modes[g.at].mode.frequency_hz,
                    gain: g.gain,
                })
                .collect(),
            warnings: self.convolution.warnings.iter().map(ToString::to_string).collect(),
            modes: self
                .modes
                .iter()
                .zip(&self.axis.modes)
                .map(|(m, of_file)| document::Mode {
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
                    insensitivity: m.insensitivity.map(|i| (i.low, i.high)),
                })
                .collect(),
            quantised: document::Quantised {
                sample_hz,
                coefficient_fraction,
                digitise: self.tables.digitised.method_used.to_string(),
                fits: self.misfit.is_none(),
                taps: document::Tap::of(&self.tables.table),
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
            delay: self.in_stage.then(|| Delay::new(&self.tables.delay)),
            control: self.control.map(AxisControl::json),
        }
    }

    /// The section for people.
    pub(super) fn text(&self, sample_hz: f64) -> String {
        let mut text = String::new();
        let impulses = &self.tables.design.impulses;
        let sums = impulses.partial_sums();
        let _ = writeln!(
            text,
            "axis {}: {}, {}, duration {:.4} ms, delay {:.4} ms, partial sums {:.4} … {:.4}",
            self.axis.name,
            self.tables.design.kind,
            counted(impulses.impulses().len() as u64, "impulse"),
            impulses.duration_s() * 1e3,
            impulses.delay_s() * 1e3,
            sums.min,
            sums.max,
        );
        let mut table = Table::new(&["", ">time ms", ">amplitude"]);
        for impulse in impulses.impulses() {
            table.row([
                String::new(),
                format!("{:.6}", impulse.time_s * 1e3),
                format!("{:.6}", impulse.amplitude),
            ]);
        }
        text += &table.text("  ");
        text += &findings_text(&self.tables.design.findings);
        text += &self.modes_text();
        text += &self.convolution_text();
        let taps = self.tables.table.taps();
        let _ = writeln!(
            text,
            "\n  {} at {sample_hz} Hz, digitised {}, sum {}",
            counted(taps.len() as u64, "tap"),
            self.tables.digitised.method_used,
            taps.iter().map(|t| i64::from(t.coefficient)).sum::<i64>(),
        );
        let mut table = Table::new(&["", ">delay", ">coefficient"]);
        for tap in taps {
            table.row([
                String::new(),
                tap.delay_samples.to_string(),
                tap.coefficient.to_string(),
            ]);
        }
        text += &table.text("  ");
        if let Some(certificate) = &self.certificate {
            text += &certificate.text();
        }
        if let Some(family) = &self.family {
            text += &family.text();
        }
        if let Some(table) = &self.error_table {
            text += &table.text();
        }
        if let Some(reason) = self.misfit {
            let _ = writeln!(text, "  does not fit: {reason}");
        }
        if let Some(control) = self.control {
            let _ = write!(text, "\n{}", control.text());
        }
        text
    }

    /// The effect of the modes' shapers on each other, if there are several.
    fn convolution_text(&self) -> String {
        let mut text = String::new();
        if !self.convolution.cross_gains.is_empty() {
            let mut table = Table::new(&["shaper", ">for mode Hz", ">at mode Hz", ">gain"]);
            for g in &self.convolution.cross_gains {
                table.row([
                    g.kind.to_string(),
                    format!("{:.3}", self.modes[g.shaper].mode.frequency_hz),
                    format!("{:.3}", self.modes[g.at].mode.frequency_hz),
                    format!("{:.4}", g.gain),
                ]);
            }
            let _ = write!(
                text,
                "\n  peak command {:.4} of a step; gain of each shaper at the other modes\n{}",
                self.convolution.peak_command,
                table.text("  ")
            );
        }
        for warning in &self.convolution.warnings {
            let placed = machine::place(self.path, self.place, "axis.shaper", warning);
            let _ = writeln!(text, "\n  warning: {placed}");
        }
        text
    }

    /// Whether the drive leaves the motor free to swing against the load.
    fn is_motor_free(&self) -> bool {
        let drive = self.axis.drive.as_ref();
        drive.is_some_and(|drive| matches!(drive.mode, DriveMode::Torque { .. }))
    }

    /// Where the mode of `[axis.mechanics]` comes from.
    fn mechanics_text(&self) -> String {
        let Some(screw) = &self.axis.mechanics else {
            return String::new();
        };
        let between = format!(
            "mode 1: from [axis.mechanics], {} N/µm between motor and table, table {} kg, motor and screw {} kg·m² ({} kg at the table)",
            trimmed(screw.stiffness() / 1e6, 4),
            trimmed(screw.table_mass, 4),
            trimmed(screw.turning_inertia(), 4),
            trimmed(screw.motor_mass(), 4),
        );
        let mode = |mode: Mode| format!("{:.3} Hz and {:.4}", mode.frequency_hz, mode.damping);
        if self.is_motor_free() {
            format!(
                "  {between}; the motor free, as behind a torque drive; held it would be {}\n",
                mode(screw.held_mode())
            )
        } else {
            format!(
                "  {between}; the motor held; free it would be {}\n",
                mode(screw.free_mode())
            )
        }
    }

    fn modes_text(&self) -> String {
        if self.modes.is_empty() {
            return "\n  no modes given: no residual to state\n".to_owned();
        }
        let headings = [
            "mode Hz",
            ">damping",
            ">residual %",
            ">quantised %",
            ">tolerance %",
            "insensitivity f/f0",
        ];
        let mut table = Table::new(&headings);
        for m in &self.modes {
            let range = match m.insensitivity {
                None => "none: the residual exceeds the tolerance".to_owned(),
                Some(i) => match i.high {
                    Some(high) => format!("{:.4} … {high:.4}", i.low),
                    None => format!("{:.4} … above {INSENSITIVITY_LIMIT}", i.low),
                },
            };
            table.row([
                format!("{:.3}", m.mode.frequency_hz),
                format!("{:.4}", m.mode.damping),
                percent(m.residual),
                percent(m.residual_quantised),
                percent(m.tolerance),
                range,
            ]);
        }
        let mut text = format!("\n{}{}", table.text("  "), self.mechanics_text());
        for (index, mode) in self.axis.modes.iter().enumerate() {
            if let Some(free) = mode.free {
                let _ = writeln!(
                    text,
                    "  mode {}: measured with the motor free at {:.3} Hz, damping {:.4}; designed for the motor held, {:.3} Hz and {:.4}",
                    index + 1,
                    free.frequency_hz,
                    free.damping,
                    mode.mode.frequency_hz,
                    mode.mode.damping,
                );
            }
        }
        text
    }
}

/// Further results of a kind that treats all modes together.
fn findings_text(findings: &Findings) -> String {
    let mut text = String::new();
    match findings {
        // The certificate has the findings of these kinds.
        Findings::None | Findings::Optimal(_) => {}
        Findings::Periodic(found) => {
            let _ = writeln!(text, "\n  periodic at {:.6} Hz; all solutions:", found.system_hz);
            let mut table = Table::new(&["", ">from Hz", ">to Hz", "odd multiples"]);
            for solution in &found.solutions {
                let multiples = solution.n.iter().map(|n| (2 * n + 1).to_string());
                table.row([
                    String::new(),
                    format!("{:.6}", solution.low_hz),
                    format!("{:.6}", solution.high_hz),
                    multiples.collect::<Vec<_>>().join(", "),
                ]);
            }
            text += &table.text("  ");
        }
        Findings::Antisymmetric(found) => {
            for Class { members, multiples } in &found.classes {
                let modes: Vec<String> = members.iter().map(|index| (index + 1).to_string()).collect();
                let odd: Vec<String> = multiples.multiples.iter().map(u64::to_string).collect();
                let _ = writeln!(
                    text,
                    "\n  antisymmetric modes {}: {} times {:.6} Hz, within {:.2e} of each",
                    modes.join(", "),
                    odd.join(", "),
                    multiples.divisor,
                    multiples.error,
                );
            }
        }
        Findings::Simultaneous(found) => {
            text += if found.is_time_optimal {
                "\n  no command within the same bounds is shorter\n"
            } else {
                "\n  the shortest found, not proven to be the shortest\n"
            };
        }
    }
    text
}
