//! The report of `run`: tables for people, a document for programs, plots for both.

use super::checks::Check;
use super::closed_loop::{ClosedLoop, StageFigures};
use super::gain::Gain;
use super::summary;
use super::waves::Waves;
use crate::bench::Simulator;
use crate::compare;
use crate::design::{self, DesignReport};
use crate::failure::Failure;
use crate::simulate::si_per_lsb;
use crate::synth;
use crate::text::{Table, UnitDocument, percent};
use posicast_machine::compare::{DEFAULT_BAND, KindComparison};
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::plan::{AxisTables, MachineDesign};
use posicast_machine::plant::Plant;
use posicast_machine::plant::response::{PlantFigures, StepFigures, plant_figures};
use posicast_machine::simulation::AxisSimulation;
use posicast_shaper::analysis::tap_impulses;
use posicast_shaper::impulse::ImpulseSequence;
use posicast_synth::yosys::Estimate;
use posicast_testbench::lockstep::report::LockstepReport;
use posicast_testbench::verilator;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};
use wavecmp::diff::Comparison;

/// All results of a run.
pub(crate) struct RunReport<'a> {
    pub(crate) machine: &'a Machine,
    pub(crate) design: &'a DesignReport<'a>,
    pub(crate) axes: &'a [AxisSimulation],
    pub(crate) plants: Vec<OnPlant>,
    pub(crate) simulator: Simulator,
    pub(crate) seed: u64,
    pub(crate) lockstep: &'a LockstepReport,
    pub(crate) waves: &'a Waves,
    pub(crate) estimate: Option<&'a Estimate>,
    pub(crate) closed_loop: Option<&'a ClosedLoop<'a>>,
    pub(crate) checks: &'a [Check],
    /// The command of the move, per axis.
    pub(crate) words: &'a [Vec<i64>],
    /// Cost and gain of each shaper.
    pub(crate) gains: Vec<Gain>,
    /// All kinds of shaper on the axes.
    pub(crate) kinds: &'a [KindComparison],
    /// The command line of the run, to be called in the output folder.
    pub(crate) command: String,
}

/// Version of the document: raised when a key is removed or gets another meaning.
const REPORT_VERSION: u32 = 1;

/// Figures of one axis on the simulated machine.
pub(crate) struct OnPlant {
    shaped: PlantFigures,
    unshaped: PlantFigures,
}

impl OnPlant {
    fn new(axis: &AxisSection, tables: &AxisTables, sample_hz: f64) -> Result<Self, Failure> {
        let plant = Plant::of_axis(axis).map_err(Failure::because)?;
        Ok(Self {
            shaped: plant_figures(&plant, &tap_impulses(&tables.table, sample_hz)),
            unshaped: plant_figures(&plant, ImpulseSequence::unity().impulses()),
        })
    }
}

/// The figures of every axis of a machine.
pub(crate) fn on_plants(machine: &Machine, design: &MachineDesign) -> Result<Vec<OnPlant>, Failure> {
    let axes = machine.axes.iter().zip(&design.axes);
    axes.map(|(axis, tables)| OnPlant::new(axis, tables, design.sample_hz))
        .collect()
}

/// The largest residual of all modes; `None` without a mode.
fn worst(figures: &StepFigures) -> Option<f64> {
    figures.residual.iter().copied().reduce(f64::max)
}

fn percent_or_dash(fraction: Option<f64>) -> String {
    fraction.map_or_else(|| "-".to_owned(), percent)
}

impl RunReport<'_> {
    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, &AxisSection, &AxisTables)> {
        let axes = self.machine.axes.iter().zip(&self.design.design.axes).enumerate();
        axes.map(|(index, (axis, tables))| (index, axis, tables))
    }

    pub(super) fn sample_hz(&self) -> f64 {
        self.design.design.sample_hz
    }

    /// All tables and checks, with the verdict last.
    pub(crate) fn text(&self, root: &Path, files: &[PathBuf]) -> String {
        let mut text = self.heading();
        text.push('\n');
        text += &self.shapers_text();
        text.push('\n');
        text += &self.comparison_text();
        if let Some(closed_loop) = self.closed_loop {
            text.push('\n');
            text += &closed_loop.text();
        }
        if let Some(estimate) = self.estimate {
            text.push('\n');
            text += &synth::text(estimate);
        }
        text.push('\n');
        text += &self.checks_text(|_| true);
        text.push('\n');
        text += &summary::folder(root, files);
        text + &self.verdict()
    }

    /// Name of the simulator.
    pub(super) fn tool(&self) -> String {
        match self.simulator {
            Simulator::Verilator => verilator::version().map_or_else(|_| self.simulator.to_string(), str::to_owned),
            Simulator::Icarus => "Icarus Verilog".to_owned(),
            Simulator::Rusthdl => {
                "RustHDL's simulator: the weaker check, the Verilog itself was not simulated".to_owned()
            }
        }
    }

    fn shapers_text(&self) -> String {
        let mut residuals = Table::new(&[
            "axis",
            "shaper",
            ">impulses",
            ">taps",
            ">float",
            ">quantised",
            ">on plant",
            ">plant -10 %",
            ">plant +10 %",
        ]);
        let mut overshoots = Table::new(&[
            "axis",
            ">unshaped",
            ">on plant",
            ">plant -10 %",
            ">plant +10 %",
            ">ringing unshaped",
            ">ringing shaped",
        ]);
        for (index, axis, tables) in self.rows() {
            let plant = &self.plants[index];
            let figures = tables.mode_figures(axis, self.sample_hz());
            let largest =
                |pick: fn(&posicast_machine::plan::ModeFigures) -> f64| figures.iter().map(pick).reduce(f64::max);
            residuals.row([
                axis.name.clone(),
                tables.design.kind.clone(),
                tables.design.impulses.impulses().len().to_string(),
                tables.table.taps().len().to_string(),
                percent_or_dash(largest(|m| m.residual)),
                percent_or_dash(largest(|m| m.residual_quantised)),
                percent_or_dash(worst(&plant.shaped.nominal)),
                percent_or_dash(worst(&plant.shaped.minus_10_percent)),
                percent_or_dash(worst(&plant.shaped.plus_10_percent)),
            ]);
            let per_lsb = si_per_lsb(self.machine, axis);
            let ringing = [self.axes[index].vibration_unshaped, self.axes[index].vibration];
            let [ringing_unshaped, ringing_shaped] = axis.unit.show_all(ringing.map(|lsb| lsb * per_lsb));
            overshoots.row([
                axis.name.clone(),
                percent(plant.unshaped.nominal.overshoot),
                percent(plant.shaped.nominal.overshoot),
                percent(plant.shaped.minus_10_percent.overshoot),
                percent(plant.shaped.plus_10_percent.overshoot),
                ringing_unshaped,
                ringing_shaped,
            ]);
        }
        format!(
            "Residual vibration of a step, worst mode, % of unshaped\n{}\n\
             Overshoot of a step, %; ringing after the move\n{}",
            residuals.text("  "),
            overshoots.text("  ")
        )
    }

    fn comparison_text(&self) -> String {
        let mut table = Table::new(&[
            "axis",
            ">clocks",
            ">mismatches",
            ">samples of the move",
            ">largest difference from float, LSB",
            ">bound, LSB",
        ]);
        for (index, axis, _) in self.rows() {
            let block = self
                .lockstep
                .blocks
                .iter()
                .find(|b| b.name == "shaper" && b.instance == axis.name);
            table.row([
                axis.name.clone(),
                block.map_or_else(String::new, |b| b.cycles.to_string()),
                block.map_or_else(String::new, |b| b.mismatches.to_string()),
                self.waves.samples[index].to_string(),
                format!("{:.3}", self.waves.largest_difference_lsb[index]),
                format!("{:.3}", self.axes[index].bound_lsb),
            ]);
        }
        format!("RTL against model and float design\n{}", table.text("  "))
    }

    /// The document for programs, which is also `report.json`.
    pub(crate) fn json(&self) -> Document {
        let axes = self.rows().map(|(index, axis, _)| {
            let plant = &self.plants[index];
            let per_lsb = si_per_lsb(self.machine, axis);
            RunAxis {
                name: axis.name.clone(),
                unit: UnitDocument::new(axis.unit),
                plant: StepOnPlant::new(plant),
                residual_displacement_unshaped: self.axes[index].vibration_unshaped * per_lsb,
                residual_displacement: self.axes[index].vibration * per_lsb,
                samples: self.waves.samples[index],
                largest_difference_lsb: self.waves.largest_difference_lsb[index],
                bound_lsb: self.axes[index].bound_lsb,
                gain: self.gains[index].clone(),
            }
        });
        Document {
            report_version: REPORT_VERSION,
            posicast: env!("CARGO_PKG_VERSION"),
            command: self.command.clone(),
            name: self.machine.name.clone(),
            result: if self.checks.iter().all(|check| check.passed) {
                RunVerdict::Pass
            } else {
                RunVerdict::Fail
            },
            simulator: self.simulator,
            seed: self.seed,
            design: self.design.json(),
            axes: axes.collect(),
            verify: self.lockstep.clone(),
            model_against_rtl: self.waves.model.clone(),
            rtl_against_float: self.waves.float.clone(),
            synth: self.estimate.cloned(),
            stage: self.closed_loop.map(ClosedLoop::json),
            kinds: compare::Document::new(self.machine, 100.0 * DEFAULT_BAND, self.kinds),
            checks: self.checks.to_vec(),
        }
    }
}

/// The result of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum RunVerdict {
    /// Every check held.
    Pass,
    /// At least one check did not hold.
    Fail,
}

/// `report.json` after `posicast run`, and `posicast run --json`. Times are in s, lengths in m, angles in rad.
#[derive(Serialize, JsonSchema)]
pub struct Document {
    /// Raised when a key is removed or gets another meaning; new keys do not raise it.
    #[schemars(extend("const" = REPORT_VERSION))]
    report_version: u32,
    /// Version of posicast.
    posicast: &'static str,
    /// The command line of the run, to be called in the output folder.
    command: String,
    /// Name of the machine.
    name: String,
    result: RunVerdict,
    simulator: Simulator,
    /// Seed of the random stimuli.
    seed: u64,
    /// As `design --json`.
    design: design::Document,
    axes: Vec<RunAxis>,
    /// As `verify --json`: the shapers, with random stimuli.
    verify: LockstepReport,
    /// As `diff --json`.
    model_against_rtl: Comparison,
    /// As `diff --json`.
    rtl_against_float: Comparison,
    /// As `synth --json`; null without Yosys.
    synth: Option<Estimate>,
    /// The closed loop; absent where the machine file describes no stage.
    #[serde(skip_serializing_if = "Option::is_none")]
    stage: Option<StageFigures>,
    /// As `design --compare --json`.
    kinds: compare::Document,
    checks: Vec<Check>,
}

/// The move of an axis.
#[derive(Serialize, JsonSchema)]
struct RunAxis {
    name: String,
    #[serde(flatten)]
    unit: UnitDocument,
    plant: StepOnPlant,
    /// Ringing after the move without the shaper, in `si_unit`.
    residual_displacement_unshaped: f64,
    /// Ringing after the move with it, in `si_unit`.
    residual_displacement: f64,
    /// Output samples of the move.
    samples: usize,
    /// Largest difference of hardware and float design.
    largest_difference_lsb: f64,
    /// The largest that rounding explains.
    bound_lsb: f64,
    gain: Gain,
}

/// A step on the simulated machine, and on machines whose frequencies are 10 % off.
#[derive(Serialize, JsonSchema)]
struct StepOnPlant {
    unshaped: Step,
    nominal: Step,
    minus_10_percent: Step,
    plus_10_percent: Step,
}

/// A step.
#[derive(Serialize, JsonSchema)]
struct Step {
    /// Residual vibration of each mode, as a fraction of that of an unshaped step.
    residual: Vec<f64>,
    /// As a fraction of the step.
    overshoot: f64,
}

impl StepOnPlant {
    fn new(plant: &OnPlant) -> Self {
        let step = |figures: &StepFigures| Step {
            residual: figures.residual.clone(),
            overshoot: figures.overshoot,
        };
        Self {
            unshaped: step(&plant.unshaped.nominal),
            nominal: step(&plant.shaped.nominal),
            minus_10_percent: step(&plant.shaped.minus_10_percent),
            plus_10_percent: step(&plant.shaped.plus_10_percent),
        }
    }
}
