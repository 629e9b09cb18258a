//! Measures what a stage does with its machine: from reset over switching on and a move to standstill, and round a
//! circle.
//!
//! ```text
//!  StageRun ─┬─ side_by_side ─► model and RTL in every clock of a move       ─► Compared: the first clock that differs
//!            ├─ moved ────────► the model alone: shaped, unshaped, other plant ─► Moved: tracking, residual vibration
//!            └─ circle ───────► the model alone: points through the FIFOs      ─► Circled: contour error
//! ```
//!
//! A host on the bus does what a program would: it clears the first trip, enables, homes the axes that have an error
//! table, waits for the brakes, writes segments, sets one bit, kicks the watchdogs, and refills the FIFOs at their low
//! marks. If a stage does not do what it should, this is a result with its [`Trouble`]; an error is a run that was not
//! possible.

mod circle;
mod compensated;
mod contour;
mod expected;
mod figures;
mod host;
mod moves;
mod shaping;
mod stepped;
mod tables;

use posicast_blocks::component::Component;
use posicast_blocks::stage::{StageConfig, StageError};
use posicast_machine::contour::{Contour, ContourError};
use posicast_machine::hardware::{self, MachineStageError};
use posicast_machine::machine_file::Machine;
use posicast_machine::motion::{AxisMove, PlanError};
use posicast_machine::plan::{MachineDesign, TableFamily, design_machine};
use posicast_machine::plant::axis::{AxisPlant, AxisPlantError, PlantOptions};
use schemars::JsonSchema;
use serde::Serialize;

use crate::stage_bench::{AxisSample, StageBench};
use posicast_testbench::Error;
use posicast_testbench::lockstep::Device;
use posicast_testbench::lockstep::report::Mismatch;

pub use circle::{Circle, Circled, NoCircle};
pub use compensated::Compensated;
pub use contour::Contoured;
pub use expected::Expected;
pub use figures::AxisFigures;
pub use host::Trouble;
pub use moves::Moved;
pub use shaping::Shaping;

pub(crate) use expected::{commands, stepped_move};
pub(crate) use figures::{of_move as figures_of_move, ringing as ringing_of_move};
pub(crate) use moves::{COMPARED_CLOCKS, STANDSTILL_TICKS, WORD_FRACTION, plan_axis, settle_ticks};

use host::Host;
use tables::AxisTables;

/// Why a run was not possible.
#[derive(Debug, thiserror::Error)]
pub enum StageRunError {
    /// An error of the bench.
    #[error(transparent)]
    Bench(#[from] Error),
    /// The move of an axis cannot be planned.
    #[error("the move of axis {axis}: {source}")]
    Plan {
        /// Name of the axis.
        axis: String,
        /// Why it cannot be planned.
        source: PlanError,
    },
    /// The machine cannot be simulated.
    #[error(transparent)]
    Plant(#[from] AxisPlantError),
    /// The stage cannot be made.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// The stage cannot be made from the machine file.
    #[error(transparent)]
    MachineStage(#[from] MachineStageError),
    /// An error of a contour.
    #[error("the contour: {0}")]
    Contour(Box<ContourError>),
    /// The tap tables of the machine with, or without, `[stage]` cannot be designed.
    #[error("the axes with and without equal delays: {0}")]
    Design(Box<dyn std::error::Error + Send + Sync>),
}

/// Comparison of model and RTL over a move.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Compared {
    /// Number of clocks compared, including the reset.
    pub clocks: u64,
    /// Whether the compared clocks reach standstill; only the beginning of a very long move is compared.
    pub whole: bool,
    /// Number of differing outputs, over all clocks.
    pub mismatches: u64,
    /// The first differing output.
    pub first: Option<Mismatch>,
    /// Set if the stage did not do what it should.
    #[serde(skip)]
    pub trouble: Option<Trouble>,
}

/// A stage with the machine for which it was made.
#[derive(Debug, Clone)]
pub struct StageRun<'a> {
    machine: &'a Machine,
    config: StageConfig,
    component: Component,
    seed: u64,
    /// The move of each axis.
    moves: Vec<AxisMove>,
    /// Table families of the axes whose modes move.
    families: Vec<TableFamily>,
    /// Whether, for each axis, the move has no jerk limit, because a smoother one would not exercise its shaper.
    harsh: Vec<bool>,
    /// Whether the host homes the axes that have an error table, so that the table is in force.
    homes: bool,
}

impl<'a> StageRun<'a> {
    /// A stage of `machine` with this configuration, whose axes make their default moves. `seed` determines the
    /// arbitrary contents of memories.
    ///
    /// # Errors
    /// [`StageRunError::Stage`] where the configuration is invalid.
    pub fn new(machine: &'a Machine, config: &StageConfig, seed: u64) -> Result<Self, StageRunError> {
        Self::with_moves(machine, config, seed, &[])
    }

    /// A stage with a move for each axis, in their order; further axes make their default move.
    ///
    /// # Errors
    /// Those of [`StageRun::new`].
    pub fn with_moves(
        machine: &'a Machine,
        config: &StageConfig,
        seed: u64,
        moves: &[AxisMove],
    ) -> Result<Self, StageRunError> {
        let moving = machine.axes.iter().any(|axis| axis.family.is_some());
        let families = if moving {
            designed(machine)?.families
        } else {
            Vec::new()
        };
        Self::with_families(machine, config, seed, moves, families)
    }

    fn with_families(
        machine: &'a Machine,
        config: &StageConfig,
        seed: u64,
        moves: &[AxisMove],
        families: Vec<TableFamily>,
    ) -> Result<Self, StageRunError> {
        let axes = machine.axes.iter().enumerate();
        let moves = axes.map(|(index, axis)| {
            let given = moves.get(index).copied();
            given.unwrap_or_else(|| AxisMove::of_axis(axis, &machine.fixed_point))
        });
        let mut run = Self {
            machine,
            config: config.clone(),
            component: Component::stage(config)?,
            seed,
            moves: moves.collect(),
            families,
            harsh: vec![false; machine.axes.len()],
            homes: true,
        };
        // For a machine without expected figures the error is reported when it is moved.
        if let Ok(harsh) = expected::too_smooth(&run) {
            run.harsh.splice(..harsh.len(), harsh);
        }
        Ok(run)
    }

    /// The run with a host that leaves every axis on the table of its ROM.
    #[must_use]
    pub fn with_one_table(mut self) -> Self {
        self.families.clear();
        self
    }

    /// The run with a host that homes no axis, so that no error table is in force.
    #[must_use]
    pub fn without_error_tables(mut self) -> Self {
        self.homes = false;
        self
    }

    /// Whether the move of an axis has no jerk limit. With a limit it would excite the modes too little to show the effect
    /// of the shaper.
    pub fn is_harsh(&self, axis: usize) -> bool {
        self.harsh.get(axis).copied().unwrap_or(false)
    }

    /// The machine with delays that are equal for all axes, or with each shaper's own.
    ///
    /// # Errors
    /// [`StageRunError::Design`] where a table cannot hold the delay that it needs; [`StageRunError::MachineStage`]
    /// where the stage cannot be made.
    pub fn with_delays(machine: &'a Machine, equal: bool, seed: u64) -> Result<Option<Self>, StageRunError> {
        let other = Machine {
            stage: equal.then_some(machine.stage.unwrap_or_default()),
            ..machine.clone()
        };
        let design = designed(&other)?;
        let stage = hardware::stage(&other, &design)?;
        stage
            .map(|stage| Self::with_families(machine, &stage.config, seed, &[], design.families))
            .transpose()
    }

    /// Moves model and `device` side by side, from reset to standstill: every output is compared in every clock.
    ///
    /// # Errors
    /// [`StageRunError`] where the run is not possible.
    pub fn side_by_side(&self, device: Box<dyn Device>) -> Result<Compared, StageRunError> {
        let mut host = self.host(1.0, Some(device), Shaping::Shaped)?;
        let (trouble, whole) = moves::compare(self, &mut host)?;
        Ok(compared(&host, trouble, whole))
    }

    /// Makes the move in the model alone, on a machine whose modes are at `frequency_factor` times their frequencies.
    ///
    /// # Errors
    /// [`StageRunError`] where the run is not possible.
    pub fn moved(&self, shaping: Shaping, frequency_factor: f64) -> Result<Moved, StageRunError> {
        moves::measure(self, self.host(frequency_factor, None, shaping)?, shaping)
    }

    /// Expected figures of the move, by axis, from the machine file alone.
    ///
    /// # Errors
    /// [`StageRunError`] where the machine has no such move.
    pub fn expected(&self, shaping: Shaping, frequency_factor: f64) -> Result<Vec<Expected>, StageRunError> {
        expected::of_move(self, shaping, frequency_factor)
    }

    /// Drives the circle in the model alone.
    ///
    /// # Errors
    /// [`StageRunError`] where the run is not possible.
    pub fn circle(&self, circle: &Circle) -> Result<Circled, StageRunError> {
        circle::measure(self, self.host(1.0, None, Shaping::Shaped)?, circle)
    }

    /// Drives the contour in the model alone, from where both axes stand at reset.
    ///
    /// # Errors
    /// [`StageRunError`] where the run is not possible.
    pub fn contour(&self, contour: &Contour) -> Result<Contoured, StageRunError> {
        let host = self.host(1.0, None, Shaping::Shaped)?;
        contour::measure(self, host, contour, &designed(self.machine)?)
    }

    /// Drives model and `device` side by side along a contour, or along a part of it that can be compared in about a
    /// minute.
    ///
    /// # Errors
    /// [`StageRunError`] where the run is not possible.
    pub fn contour_side_by_side(&self, device: Box<dyn Device>, contour: &Contour) -> Result<Compared, StageRunError> {
        let mut host = self.host(1.0, Some(device), Shaping::Shaped)?;
        let (trouble, whole) = contour::compare(self, &mut host, contour)?;
        Ok(compared(&host, trouble, whole))
    }

    fn host(
        &self,
        frequency_factor: f64,
        device: Option<Box<dyn Device>>,
        shaping: Shaping,
    ) -> Result<Host<'_>, StageRunError> {
        let options = PlantOptions {
            frequency_factor,
            ..PlantOptions::default()
        };
        let plant = |axis| AxisPlant::new(axis, &self.machine.clock, &options);
        let plants = self.machine.axes.iter().map(plant).collect::<Result<_, _>>()?;
        let bench = StageBench::new(&self.config, &self.component, plants, device, self.seed)?;
        let families = match shaping {
            Shaping::Shaped => self.families.as_slice(),
            Shaping::Unshaped => &[],
        };
        let tables = families.iter().filter_map(|family| {
            let axis = self.machine.axes.get(family.axis)?;
            AxisTables::new(axis, family)
        });
        Ok(Host::new(bench, &self.config, tables.collect(), self.homes))
    }

    /// Returns the samples of a run. The load of an axis with an error table is at its true position, which is the counted
    /// one plus the measured error of the machine file.
    fn recorded(&self, host: &mut Host<'_>) -> Vec<Vec<AxisSample>> {
        let mut samples = host.bench.recorded();
        for (samples, axis) in samples.iter_mut().zip(&self.machine.axes) {
            let Some(table) = &axis.error_table else {
                continue;
            };
            for sample in samples {
                sample.load += table.at(sample.load);
            }
        }
        samples
    }
}

fn compared(host: &Host<'_>, trouble: Option<Trouble>, whole: bool) -> Compared {
    let (mismatches, first) = host.bench.mismatches();
    Compared {
        clocks: host.bench.now(),
        whole,
        mismatches,
        first,
        trouble,
    }
}

fn designed(machine: &Machine) -> Result<MachineDesign, StageRunError> {
    design_machine(machine).map_err(|error| StageRunError::Design(Box::new(error)))
}
