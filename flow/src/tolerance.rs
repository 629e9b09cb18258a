//! Checks whether the integer tap tables keep the tolerance of the machine file.

use crate::warning::Warning;
use posicast_machine::machine_file::Machine;
use posicast_machine::plan::MachineDesign;
use posicast_machine::plan::{ModeCertificate, certify_axis};
use posicast_shaper::design::Findings;

/// Fraction of a tolerance by which the integer taps may exceed it: an impulse between two samples becomes two taps,
/// which changes the residual of kinds that leave one by design.
const BETWEEN_SAMPLES: f64 = 0.05;

/// The key that determines the residual.
const KEY: &str = "axis.shaper";

/// Number of modes for which a shaper is made: those of axes whose shaper has more than one impulse.
pub(crate) fn shaped_modes(machine: &Machine, design: &MachineDesign) -> usize {
    let axes = machine.axes.iter().zip(&design.axes);
    let shaped = axes.filter(|(_, tables)| tables.design.impulses.impulses().len() > 1);
    shaped.map(|(axis, _)| axis.modes.len()).sum()
}

/// Warns about the modes whose residual with the integer taps exceeds their tolerance, with a remedy for each.
pub(crate) fn beyond_tolerance(machine: &Machine, design: &MachineDesign) -> Vec<Warning> {
    let mut beyond = Vec::new();
    for (index, (axis, tables)) in machine.axes.iter().zip(&design.axes).enumerate() {
        if tables.design.impulses.impulses().len() < 2 {
            continue;
        }
        if matches!(tables.design.findings, Findings::Optimal(_)) {
            let certificate = certify_axis(axis, tables, design.sample_hz);
            let above = |mode: &&ModeCertificate| mode.residual.bound > mode.tolerance * (1.0 + BETWEEN_SAMPLES);
            beyond.extend(certificate.modes.iter().filter(above).map(|mode| {
                let text = format!(
                    "axis {}, mode of {:.3} … {:.3} Hz: the integer taps leave up to {:.4} % of the vibration in the band, and the \
                     tolerance is {:.4} %; leave coefficient_fraction out, or allow a longer shaper with fewer taps",
                    axis.name,
                    mode.band.frequency_hz[0],
                    mode.band.frequency_hz[1],
                    100.0 * mode.residual.bound,
                    100.0 * mode.tolerance
                );
                Warning::new(index, KEY, text)
            }));
            continue;
        }
        for mode in tables.mode_figures(axis, design.sample_hz) {
            let (found, asked) = (mode.residual_quantised, mode.tolerance);
            if found <= asked * (1.0 + BETWEEN_SAMPLES) {
                continue;
            }
            let remedy = if mode.residual > asked {
                "the impulses exceed it too: choose another kind, or raise the tolerance of the mode"
            } else {
                "the impulses themselves keep it: leave coefficient_fraction out, or raise sample_hz"
            };
            let text = format!(
                "axis {}, mode of {:.3} Hz: the integer taps leave {:.2} % of the vibration, and the tolerance is {:.2} %; {remedy}",
                axis.name,
                mode.mode.frequency_hz,
                100.0 * found,
                100.0 * asked
            );
            beyond.push(Warning::new(index, KEY, text));
        }
    }
    beyond
}

/// Describes the mode that exceeds its tolerance most, if all stay within [`BETWEEN_SAMPLES`]; `None` if none exceeds
/// it.
pub(crate) fn just_above_tolerance(machine: &Machine, design: &MachineDesign) -> Option<String> {
    let axes = machine.axes.iter().zip(&design.axes);
    let shaped = axes.filter(|(_, tables)| tables.design.impulses.impulses().len() > 1);
    let figures = shaped.flat_map(|(axis, tables)| {
        let of_modes: Vec<(f64, f64)> = match tables.design.findings {
            Findings::Optimal(_) => {
                let modes = certify_axis(axis, tables, design.sample_hz).modes;
                modes.iter().map(|mode| (mode.residual.bound, mode.tolerance)).collect()
            }
            _ => {
                let modes = tables.mode_figures(axis, design.sample_hz);
                modes
                    .iter()
                    .map(|mode| (mode.residual_quantised, mode.tolerance))
                    .collect()
            }
        };
        of_modes.into_iter().map(|(found, asked)| (&axis.name, found, asked))
    });
    let (name, found, asked) = figures
        .filter(|(_, found, asked)| found > asked)
        .max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)))?;
    Some(format!(
        "axis {name} leaves {:.4} %, and the tolerance is {:.4} %: an excess of up to {} % is accepted, because an impulse between two \
         samples becomes two taps",
        100.0 * found,
        100.0 * asked,
        100.0 * BETWEEN_SAMPLES
    ))
}
