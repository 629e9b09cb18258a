//! The checks of a run, which must all hold for exit status 0.

use super::advice::{self, Advice};
use super::waves::Waves;
use crate::bench::{self, Simulator};
use crate::failure::Failure;
use crate::text::percent;
use crate::tolerance::{beyond_tolerance, just_above_tolerance, shaped_modes};
use posicast_machine::machine_file::Machine;
use posicast_machine::plan::MachineDesign;
use posicast_machine::plan::{certify_axis, measure_corners};
use posicast_machine::simulation::AxisSimulation;
use posicast_shaper::design::Findings;
use posicast_shaper::unit::short;
use posicast_synth::yosys::Estimate;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::bus_component::BusComponentBlock;
use posicast_testbench::linked_stage::LinkedStageBlock;
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use posicast_testbench::verilator;
use posicast_testbench::wording::counted;
use schemars::JsonSchema;
use serde::Serialize;
use wavecmp::diff::{Comparison, DiffVerdict};

/// Rounding of a residual that is measured on the simulated plant.
const MEASURED_ROUNDING: f64 = 1e-9;

/// One check and how it went.
#[derive(Debug, Clone, JsonSchema)]
#[schemars(with = "NamedCheck<'static>")]
pub struct Check {
    /// Description of the check in a few words.
    pub name: &'static str,
    /// Whether the check held.
    pub passed: bool,
    /// The figures of the check; for a failed one the place where it failed first.
    pub detail: String,
    /// How much of what the check is about was compared.
    pub(crate) coverage: Coverage,
}

/// A check in `report.json`.
#[derive(Serialize, JsonSchema)]
struct NamedCheck<'a> {
    /// What was checked, in a few words.
    name: &'a str,
    passed: bool,
    /// `ok`, `open` or `failed`; open: the check held but compared nothing, or too little.
    #[schemars(extend("enum" = ["ok", "open", "failed"]))]
    verdict: String,
    /// The figures of the check; for a failed one the place where it failed first.
    detail: &'a str,
}

impl Serialize for Check {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let document = NamedCheck {
            name: self.name,
            passed: self.passed,
            verdict: self.verdict().trim().to_lowercase(),
            detail: &self.detail,
        };
        document.serialize(serializer)
    }
}

/// How much of what a check is about was compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Coverage {
    /// Enough for its verdict.
    #[default]
    Enough,
    /// Nothing differed in the clocks that were compared, but there were too few of them.
    TooFewClocks,
    /// Nothing differed, but the run was given up before its end.
    GivenUp,
    /// Nothing was compared, or too little to tell: the check is named, and does not count as ok.
    Nothing,
}

impl Check {
    /// A check that compared what its name says.
    pub(crate) fn new(name: &'static str, passed: bool, detail: String) -> Self {
        Self {
            name,
            passed,
            detail,
            coverage: Coverage::Enough,
        }
    }

    /// A check that compared nothing, or too little, for this reason.
    pub(crate) fn not_exercised(name: &'static str, passed: bool, reason: &str) -> Self {
        Self {
            name,
            passed,
            detail: format!("not exercised: {reason}"),
            coverage: Coverage::Nothing,
        }
    }

    /// The result in a word, with spaces up to the width of the longest.
    #[must_use]
    pub fn verdict(&self) -> &'static str {
        match (self.passed, self.coverage) {
            (false, _) => "FAILED",
            (true, Coverage::Enough) => "ok    ",
            (true, _) => "open  ",
        }
    }

    /// Whether the check failed only because too few clocks were compared.
    #[must_use]
    pub fn is_too_short(&self) -> bool {
        !self.passed && self.coverage == Coverage::TooFewClocks
    }

    /// Whether the check held but compared nothing, or too little.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.passed && self.coverage != Coverage::Enough
    }

    /// The likely cause if it failed, and remedies.
    #[must_use]
    pub fn advice(&self) -> Option<&'static Advice> {
        if self.passed { None } else { advice::for_failed(self) }
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
    let is_short = first.is_none() && lockstep.not_exercised() > 0;
    let detail = match first {
        None if is_short => format!(
            "{}, no mismatch, but not exercised: {}; compare more clocks with --cycles",
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
    let name = match simulator {
        Simulator::Rusthdl => "RustHDL description equals the bit-exact model in every clock",
        Simulator::Verilator | Simulator::Icarus => "RTL equals the bit-exact model in every clock",
    };
    let check = if lockstep.cycles > 0 && lockstep.samples > 0 {
        Check::new(name, lockstep.result == LockstepVerdict::Match, detail)
    } else {
        Check::not_exercised(name, false, &detail)
    };
    Check {
        coverage: if is_short {
            Coverage::TooFewClocks
        } else {
            check.coverage
        },
        ..check
    }
}

fn move_equals_model(waves: &Waves) -> Check {
    compared("wave/rtl.vcd equals wave/model.vcd over the move", &waves.model, waves)
}

fn within_float_bound(waves: &Waves) -> Check {
    let name = "RTL stays within the rounding bound of the float design";
    compared(name, &waves.float, waves)
}

fn compared(name: &'static str, comparison: &Comparison, waves: &Waves) -> Check {
    if comparison.signals == 0 || comparison.samples == 0 {
        let found = [(comparison.signals, "signal"), (comparison.samples, "clock")];
        let found = found.map(|(number, what)| counted(number, what));
        return Check::not_exercised(name, false, &found.join(", "));
    }
    let detail = match comparison.differences.first() {
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
    };
    Check::new(name, comparison.result == DiffVerdict::Equal, detail)
}

/// Every axis must move by at least a count: the waveforms of an axis at rest compare nothing.
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
    let name = "the command moves every axis";
    if let Some((axis, counts)) = still {
        return Check::not_exercised(name, false, &format!("axis {axis} moves by {counts:.3} counts"));
    }
    let texts: Vec<String> = moved
        .iter()
        .map(|(axis, counts)| format!("{axis} by {counts:.0} counts"))
        .collect();
    Check::new(name, !moved.is_empty(), texts.join(", "))
}

/// The integer tables must keep every mode within its tolerance.
fn residual_within_tolerance(machine: &Machine, design: &MachineDesign) -> Check {
    let (beyond, modes) = (beyond_tolerance(machine, design), shaped_modes(machine, design));
    let name = "the integer taps keep the tolerance that was asked for";
    match (beyond.first(), modes) {
        (Some(first), _) => Check::new(name, false, first.text.clone()),
        // The axes of this machine have no shaper: that is reported, and is not a failure.
        (None, 0) => Check::not_exercised(name, true, "no axis has a shaper for a mode"),
        (None, modes) => {
            let above = just_above_tolerance(machine, design).map_or_else(String::new, |text| format!("; {text}"));
            Check::new(name, true, counted(modes as u64, "mode") + &above)
        }
    }
}

/// With each mode at each corner of its band, a step on the simulated plant must leave no more than is certified. There is no check if no
/// shaper is designed for bands.
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
    (corners > 0 || beyond.is_some()).then(|| {
        let held = || {
            format!(
                "{}, largest residual of a step {} %, {} % certified",
                counted(corners, "corner"),
                percent(measured),
                percent(certified)
            )
        };
        Check::new(
            "at the corners of the modes' bands the simulated plant keeps the certified residual",
            beyond.is_none(),
            beyond.unwrap_or_else(held),
        )
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
                        axis.name,
                        short(mode.mode.frequency_hz),
                        mode.residual_quantised,
                        mode.residual_digitised
                    )
                });
            }
        }
    }
    Check::new(
        "integer taps keep the residual that was digitised",
        worst.is_none(),
        worst.unwrap_or_else(|| "every mode".to_owned()),
    )
}

/// Verilator's lint must have no warning about the Verilog; there is no check if another simulator is used.
pub(crate) fn lint(simulator: Simulator, sources: &Sources) -> Result<Option<Check>, Failure> {
    if simulator != Simulator::Verilator {
        return Ok(None);
    }
    let warnings = verilator::lint_all(sources.files()).map_err(bench::failure)?;
    let clean = || format!("{} files", sources.files().len());
    Ok(Some(Check::new(
        "Verilog is clean under verilator --lint-only -Wall",
        warnings.is_empty(),
        warnings.first().cloned().unwrap_or_else(clean),
    )))
}

/// The components on another bus, which a run does not simulate.
pub(crate) fn buses(buses: &[BusComponentBlock]) -> Option<Check> {
    let first = buses.first()?;
    let reason = format!(
        "a run does not simulate {}; `posicast verify MACHINE --block {}` does",
        first.top(),
        first.name()
    );
    Some(Check::not_exercised(
        "the components on their bus, with its bridge, equal their models",
        true,
        &reason,
    ))
}

/// The line to a host, which a run does not simulate.
pub(crate) fn link(link: Option<&LinkedStageBlock>) -> Option<Check> {
    let link = link?;
    let reason = format!(
        "a run does not simulate {}; `posicast verify MACHINE --block {}` does",
        link.top(),
        link.name()
    );
    Some(Check::not_exercised(
        "the line to the host, with its bridge, equals its model",
        true,
        &reason,
    ))
}

/// The top module, without the components, must fit the device of the machine file; there is no check if the file names none.
pub(crate) fn fits(machine: &Machine, estimate: &Estimate) -> Option<Check> {
    machine.target.as_ref()?.family.as_ref()?;
    let excess = estimate.excesses().first().map(|e| {
        format!(
            "{} {} needed, {} available, most of it in {}",
            e.needed, e.resource, e.available, e.block
        )
    });
    Some(Check::new(
        "the top module, with its shapers alone, fits the target device",
        excess.is_none(),
        excess.unwrap_or_else(|| estimate.device.name.to_owned()),
    ))
}
