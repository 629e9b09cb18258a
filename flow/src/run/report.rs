//! The results of `run`, and their document.

use super::checks::Check;
use super::closed_loop::{ClosedLoop, StageFigures};
use super::gain::Gain;
use super::inline::{InlineLoop, InlineRunFigures};
use super::sentence::RunSentence;
use super::waves::Waves;
use crate::bench::Simulator;
use crate::compare;
use crate::design::{self, DesignReport};
use crate::failure::Failure;
use crate::simulate::si_per_lsb;
use crate::text::UnitDocument;
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
use std::path::PathBuf;
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
    pub(crate) inline: Option<&'a InlineLoop<'a>>,
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

impl RunReport<'_> {
    pub(super) fn rows(&self) -> impl Iterator<Item = (usize, &AxisSection, &AxisTables)> {
        let axes = self.machine.axes.iter().zip(&self.design.design.axes).enumerate();
        axes.map(|(index, (axis, tables))| (index, axis, tables))
    }

    pub(super) fn sample_hz(&self) -> f64 {
        self.design.design.sample_hz
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
            tool: self.tool(),
            seed: self.seed,
            design: self.design.json(),
            axes: axes.collect(),
            verify: self.lockstep.clone(),
            model_against_rtl: self.waves.model.clone(),
            rtl_against_float: self.waves.float.clone(),
            synth: self.estimate.cloned(),
            stage: self.closed_loop.map(ClosedLoop::json),
            inline: self.inline.map(InlineLoop::json),
            kinds: compare::Document::new(self.machine, 100.0 * DEFAULT_BAND, self.kinds),
            checks: self.checks.to_vec(),
            folder: PathBuf::new(),
            files: Vec::new(),
        }
    }
}

/// The result of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum RunVerdict {
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
    pub report_version: u32,
    /// Version of posicast.
    pub posicast: &'static str,
    /// The command line of the run, to be called in the output folder.
    pub command: String,
    /// Name of the machine.
    pub name: String,
    /// Whether every check held.
    pub result: RunVerdict,
    /// Simulator of the hardware.
    pub simulator: Simulator,
    /// Its name and version for people.
    #[serde(skip)]
    pub tool: String,
    /// Seed of the random stimuli.
    pub seed: u64,
    /// As `design --json`.
    pub design: design::Document,
    /// The moves of the axes, in the order of the file.
    pub axes: Vec<RunAxis>,
    /// As `verify --json`: the shapers, with random stimuli.
    pub verify: LockstepReport,
    /// As `diff --json`.
    pub model_against_rtl: Comparison,
    /// As `diff --json`.
    pub rtl_against_float: Comparison,
    /// As `synth --json`; null without Yosys.
    pub synth: Option<Estimate>,
    /// The closed loop; absent where the machine file describes no stage.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stage: Option<StageFigures>,
    /// The inline shaper; absent where the machine file has no `[axis.input]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inline: Option<InlineRunFigures>,
    /// As `design --compare --json`.
    pub kinds: compare::Document,
    /// All checks.
    pub checks: Vec<Check>,
    /// The output folder; not in JSON, because `report.json` is one of its files.
    #[serde(skip)]
    pub folder: PathBuf,
    /// Paths of its files in it.
    #[serde(skip)]
    pub files: Vec<PathBuf>,
}

impl Document {
    /// The verdict that follows from the checks, as a sentence.
    #[must_use]
    pub fn sentence(&self) -> RunSentence {
        RunSentence::of(&self.checks, self.simulator)
    }
}

/// The move of an axis.
#[derive(Serialize, JsonSchema)]
pub struct RunAxis {
    /// Name of the axis.
    pub name: String,
    /// Its unit.
    #[serde(flatten)]
    pub unit: UnitDocument,
    /// A step on the simulated machine.
    pub plant: StepOnPlant,
    /// Ringing after the move without the shaper, in `si_unit`.
    pub residual_displacement_unshaped: f64,
    /// Ringing after the move with it, in `si_unit`.
    pub residual_displacement: f64,
    /// Output samples of the move.
    pub samples: usize,
    /// Largest difference of hardware and float design.
    pub largest_difference_lsb: f64,
    /// The largest that rounding explains.
    pub bound_lsb: f64,
    gain: Gain,
}

/// A step on the simulated machine, and on machines whose frequencies are 10 % off.
#[derive(Serialize, JsonSchema)]
pub struct StepOnPlant {
    /// Without the shaper.
    pub unshaped: PlantStep,
    /// With it.
    pub nominal: PlantStep,
    /// With it, and frequencies 10 % lower.
    pub minus_10_percent: PlantStep,
    /// With it, and frequencies 10 % higher.
    pub plus_10_percent: PlantStep,
}

/// A step.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Step")]
pub struct PlantStep {
    /// Residual vibration of each mode, as a fraction of that of an unshaped step.
    pub residual: Vec<f64>,
    /// As a fraction of the step.
    pub overshoot: f64,
}

impl StepOnPlant {
    fn new(plant: &OnPlant) -> Self {
        let step = |figures: &StepFigures| PlantStep {
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
