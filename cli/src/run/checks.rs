//! What must hold for a run to end with exit status 0.

use super::Waves;
use crate::bench::{self, Simulator};
use crate::failure::Failure;
use posicast_model::design::MachineDesign;
use posicast_model::spec::Machine;
use posicast_synth::yosys::Estimate;
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::diff::{Comparison, Verdict};
use posicast_testbench::lockstep::report::{Report, Verdict as LockstepVerdict};
use posicast_testbench::wording::counted;
use serde::Serialize;

/// One check and how it went.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Check {
    /// What was checked, in a few words.
    pub(crate) name: &'static str,
    /// Whether it held.
    pub(crate) passed: bool,
    /// The figures behind it; for a failed one where it failed first.
    pub(crate) detail: String,
}

/// The checks of the comparisons.
pub(crate) fn all(
    simulator: Simulator,
    machine: &Machine,
    design: &MachineDesign,
    lockstep: &Report,
    waves: &Waves,
) -> Vec<Check> {
    vec![
        rtl_equals_model(simulator, lockstep),
        move_equals_model(waves),
        within_float_bound(waves),
        residual_within_rounding(machine, design),
    ]
}

fn rtl_equals_model(simulator: Simulator, lockstep: &Report) -> Check {
    let first = lockstep
        .blocks
        .iter()
        .find_map(|b| b.first.as_ref().map(|first| (b, first)));
    let detail = match first {
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
        passed: lockstep.result == LockstepVerdict::Match,
        detail,
    }
}

fn move_equals_model(waves: &Waves) -> Check {
    Check {
        name: "wave/rtl.vcd equals wave/model.vcd over the move",
        passed: waves.model.result == Verdict::Equal,
        detail: compared(&waves.model, waves),
    }
}

fn within_float_bound(waves: &Waves) -> Check {
    Check {
        name: "RTL stays within the rounding bound of the float design",
        passed: waves.float.result == Verdict::Equal,
        detail: compared(&waves.float, waves),
    }
}

fn compared(comparison: &Comparison, waves: &Waves) -> String {
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

/// Verilator's lint has nothing to say about the Verilog under any of the tops; no check where Verilator does not run it.
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

/// The top module, without the components, fits the device that the machine file names; no check where it names none.
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
