//! The checks of a run, which must all hold for exit status 0.

use super::waves::Waves;
use crate::bench::{self, Simulator};
use crate::failure::Failure;
use crate::output::percent;
use crate::tolerance::{beyond_tolerance, shaped_modes};
use posicast_model::certify::{certify_axis, measure_corners};
use posicast_model::design::{Findings, MachineDesign};
use posicast_model::machine_file::Machine;
use posicast_model::simulation::AxisSimulation;
use posicast_synth::yosys::Estimate;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use posicast_testbench::wording::counted;
use serde::Serialize;
use wavecmp::diff::{Comparison, DiffVerdict};

/// Rounding of a residual that is measured on the simulated plant.
const MEASURED_ROUNDING: f64 = 1e-9;

/// One check and how it went.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Check {
    /// Description of the check in a few words.
    pub(crate) name: &'static str,
    /// Whether the check held.
    pub(crate) passed: bool,
    /// The figures of the check; for a failed one the place where it failed first.
    pub(crate) detail: String,
}

/// Prefix of the detail of a check that compared nothing, or too little: it is named, and does not count as ok.
pub(crate) const NOT_EXERCISED: &str = "not exercised: ";

/// Part of the detail of a comparison in which nothing differed, and too little was compared.
const TOO_LITTLE: &str = "no mismatch, but not exercised: ";

impl Check {
    /// The result in a word.
    pub(crate) fn verdict(&self) -> &'static str {
        match (self.passed, self.detail.starts_with(NOT_EXERCISED)) {
            (false, _) => "FAILED",
            (true, true) => "open  ",
            (true, false) => "ok    ",
        }
    }

    /// Whether the check failed only because too few clocks were compared.
    pub(crate) fn is_too_short(&self) -> bool {
        !self.passed && self.detail.contains(TOO_LITTLE)
    }

    /// Whether the check held but compared nothing, or too little.
    pub(crate) fn is_open(&self) -> bool {
        self.passed && self.detail.starts_with(NOT_EXERCISED)
    }
}

/// The checks of the comparisons.
pub(crate) fn all(
    simulator: Simulator,
    machine: &Machine,
    design: &MachineDesign,
    lockstep: &LockstepReport,
    waves: &Waves,
) -> Vec<Check> {
    vec![
        rtl_equals_model(simulator, lockstep),
        move_equals_model(waves),
        within_float_bound(waves),
        residual_within_rounding(machine, design),
        residual_within_tolerance(machine, design),
    ]
    .into_iter()
    .chain(residual_at_corners(machine, design))
    .collect()
}

fn rtl_equals_model(simulator: Simulator, lockstep: &LockstepReport) -> Check {
    let first = lockstep
        .blocks
        .iter()
        .find_map(|b| b.first.as_ref().map(|first| (b, first)));
    let detail = match first {
        None if lockstep.not_exercised() > 0 => format!(
            "{}, {TOO_LITTLE}{}; compare more clocks with --cycles",
            counted(lockstep.cycles, "clock"),
            lockstep.not_exercised_names().join(", ")
        ),
        None => format!(
            "{}, {}, no mismatch",
            counted(lockstep.cycles, "clock"),
            counted(lockstep.samples, "sample")
        ),
        Some((block, first)) => format!("{} {}:\n{first}", block.name, block.instance),
    };
    Check {
        name: match simulator {
            Simulator::Rusthdl => "RustHDL description equals the bit-exact model in every clock",
            Simulator::Verilator | Simulator::Icarus => "RTL equals the bit-exact model in every clock",
        },
        passed: lockstep.result == LockstepVerdict::Match && lockstep.cycles > 0 && lockstep.samples > 0,
        detail: match lockstep.cycles > 0 && lockstep.samples > 0 {
            true => detail,
            false => format!("{NOT_EXERCISED}{detail}"),
        },
    }
}

fn move_equals_model(waves: &Waves) -> Check {
    Check {
        name: "wave/rtl.vcd equals wave/model.vcd over the move",
        passed: waves.model.result == DiffVerdict::Equal && !is_empty(&waves.model),
        detail: compared(&waves.model, waves),
    }
}

fn within_float_bound(waves: &Waves) -> Check {
    Check {
        name: "RTL stays within the rounding bound of the float design",
        passed: waves.float.result == DiffVerdict::Equal && !is_empty(&waves.float),
        detail: compared(&waves.float, waves),
    }
}

fn is_empty(comparison: &Comparison) -> bool {
    comparison.signals == 0 || comparison.samples == 0
}

fn compared(comparison: &Comparison, waves: &Waves) -> String {
    if is_empty(comparison) {
        return format!(
            "{NOT_EXERCISED}{}, {}",
            counted(comparison.signals, "signal"),
            counted(comparison.samples, "clock")
        );
    }
    match comparison.differences.first() {
        None => format!(
            "{} in {} recorded clocks of {}",
            counted(comparison.signals, "signal"),
            comparison.samples,
            waves.clocks
        ),
        Some(first) => format!(
            "{}, {} first at {}",
            comparison.differing(),
            first.signal,
            comparison.time(first.time)
        ),
    }
}

/// Every axis must move by a count or more: the waveforms of an axis at rest compare nothing.
pub(crate) fn moves(machine: &Machine, axes: &[AxisSimulation]) -> Check {
    let one = f64::from(machine.fixed_point.command_fraction).exp2();
    let counts = |run: &AxisSimulation| {
        let [low, high] =
            [run.shaped.iter().min(), run.shaped.iter().max()].map(|word| word.copied().unwrap_or(0) as f64);
        (high - low) / one
    };
    let moved: Vec<(&str, f64)> = machine
        .axes
        .iter()
        .map(|axis| axis.name.as_str())
        .zip(axes.iter().map(counts))
        .collect();
    let still = moved.iter().find(|(_, counts)| *counts < 1.0);
    Check {
        name: "the command moves every axis",
        passed: still.is_none() && !moved.is_empty(),
        detail: match still {
            Some((axis, counts)) => format!("{NOT_EXERCISED}axis {axis} moves by {counts:.3} counts"),
            None => {
                let texts: Vec<String> = moved
                    .iter()
                    .map(|(axis, counts)| format!("{axis} by {counts:.0} counts"))
                    .collect();
                texts.join(", ")
            }
        },
    }
}

/// The integer tables must keep every mode within its tolerance.
fn residual_within_tolerance(machine: &Machine, design: &MachineDesign) -> Check {
    let (beyond, modes) = (beyond_tolerance(machine, design), shaped_modes(machine, design));
    Check {
        name: "the integer taps keep the tolerance that was asked for",
        // A machine whose axes have no shaper asks for nothing: that is reported, and is not a failure.
        passed: beyond.is_empty(),
        detail: match (beyond.first(), modes) {
            (Some(text), _) => text.clone(),
            (None, 0) => format!("{NOT_EXERCISED}no axis has a shaper for a mode"),
            (None, modes) => counted(modes as u64, "mode"),
        },
    }
}

/// With each mode at each corner of its band, a step on the simulated plant leaves no more than is certified; no check where no shaper is made for
/// bands.
fn residual_at_corners(machine: &Machine, design: &MachineDesign) -> Option<Check> {
    let axes = machine.axes.iter().zip(&design.axes);
    let optimal = axes.filter(|(_, tables)| matches!(tables.design.findings, Findings::Optimal(_)));
    let (mut corners, mut worst, mut beyond) = (0, None::<(f64, f64)>, None);
    for (axis, tables) in optimal {
        let certificate = certify_axis(axis, tables, design.sample_hz);
        let figures = match measure_corners(axis, tables, &certificate, design.sample_hz) {
            Ok(figures) => figures,
            Err(error) => {
                beyond.get_or_insert_with(|| format!("axis {}: {error}", axis.name));
                continue;
            }
        };
        for figure in figures {
            corners += 1;
            let (measured, certified) = (figure.measured, figure.certified);
            if worst.is_none_or(|(most, _)| measured > most) {
                worst = Some((measured, certified));
            }
            if measured > certified + MEASURED_ROUNDING {
                beyond.get_or_insert_with(|| {
                    format!(
                        "axis {}, mode {} at {:.3} Hz, damping {:.4}: {} % measured, {} % certified",
                        axis.name,
                        figure.index + 1,
                        figure.corner.frequency_hz,
                        figure.corner.damping,
                        percent(measured),
                        percent(certified)
                    )
                });
            }
        }
    }
    let (measured, certified) = worst.unwrap_or_default();
    (corners > 0 || beyond.is_some()).then(|| Check {
        name: "at the corners of the modes' bands the simulated plant keeps the certified residual",
        passed: beyond.is_none(),
        detail: beyond.unwrap_or_else(|| {
            format!(
                "{}, largest residual of a step {} %, {} % certified",
                counted(corners, "corner"),
                percent(measured),
                percent(certified)
            )
        }),
    })
}

/// Rounding the taps may raise the residual by no more than `Σ |c_i/2^F − a_i|`.
fn residual_within_rounding(machine: &Machine, design: &MachineDesign) -> Check {
    let mut worst: Option<String> = None;
    for (axis, tables) in machine.axes.iter().zip(&design.axes) {
        let allowed = tables.quantising_error();
        for mode in tables.mode_figures(axis, design.sample_hz) {
            if mode.residual_quantised > mode.residual_digitised + allowed {
                worst.get_or_insert_with(|| {
                    format!(
                        "axis {}, {} Hz: {:.3e} after rounding, {:.3e} before, {allowed:.1e} allowed",
                        axis.name, mode.mode.frequency_hz, mode.residual_quantised, mode.residual_digitised
                    )
                });
            }
        }
    }
    Check {
        name: "integer taps keep the residual that was digitised",
        passed: worst.is_none(),
        detail: worst.unwrap_or_else(|| "every mode".to_owned()),
    }
}

/// Verilator's lint must have no warning about the Verilog under any of the tops; no check where Verilator is not the
/// simulator.
pub(crate) fn lint(simulator: Simulator, sources: &Sources, tops: &[&dyn Block]) -> Result<Option<Check>, Failure> {
    if simulator != Simulator::Verilator {
        return Ok(None);
    }
    let mut warnings = Vec::new();
    for top in tops {
        let reached = sources.reached_by(*top).map_err(bench::failure)?;
        warnings.extend(reached.lint(*top).map_err(bench::failure)?);
    }
    Ok(Some(Check {
        name: "Verilog is clean under verilator --lint-only -Wall",
        passed: warnings.is_empty(),
        detail: warnings
            .first()
            .cloned()
            .unwrap_or_else(|| format!("{} files", sources.files().len())),
    }))
}

/// The top module, without the components, must fit the device of the machine file; no check where it names none.
pub(crate) fn fits(machine: &Machine, estimate: &Estimate) -> Option<Check> {
    machine.target.as_ref()?;
    let excess = estimate.excesses().first().map(|e| {
        format!(
            "{} {} needed, {} available, most of it in {}",
            e.needed, e.resource, e.available, e.block
        )
    });
    Some(Check {
        name: "the top module, with its shapers alone, fits the target device",
        passed: excess.is_none(),
        detail: excess.unwrap_or_else(|| estimate.device.name.to_owned()),
    })
}
