//! What a stage does with its machine, measured: from reset over switch-on and a move to standstill, and round a circle.
//!
//! ```text
//!  StageRun ─┬─ side_by_side ─► model and RTL in every clock of a move       ─► Compared: the first clock that differs
//!            ├─ moved ────────► the model alone: shaped, unshaped, other plant ─► Moved: tracking, residual vibration
//!            └─ circle ───────► the model alone: points through the FIFOs      ─► Circled: contour error
//! ```
//!
//! A host on the bus does what a program would: it clears the first trip, enables, waits for the brakes, writes segments, sets one
//! bit, kicks the watchdogs, and keeps the FIFOs filled as their low marks say. A stage that does not do what it should is a
//! result, with its [`Trouble`]; an error is what could not be run at all.

mod circle;
mod contour;
mod expected;
mod figures;
mod host;
mod moves;
mod shaping;
mod tables;

use posicast_model::contour::{Contour, ContourError};
use posicast_model::design::{MachineDesign, TableFamily, design_machine};
use posicast_model::hardware::{self, MachineStageError};
use posicast_model::machine_file::{Machine, StageSection};
use posicast_model::motion::{AxisMove, PlanError};
use posicast_model::plant::axis::{AxisPlant, AxisPlantError, PlantOptions};
use posicast_model::rtl::component::Component;
use posicast_model::rtl::stage::{StageConfig, StageError};

use crate::Error;
use crate::lockstep::Device;
use crate::lockstep::report::Mismatch;
use crate::stage_bench::StageBench;

pub use circle::{Circle, Circled, NoCircle};
pub use contour::Contoured;
pub use expected::Expected;
pub use figures::AxisFigures;
pub use host::Trouble;
pub use moves::Moved;
pub use shaping::Shaping;

use host::Host;
use tables::AxisTables;

/// Why a run could not be made.
#[derive(Debug, thiserror::Error)]
pub enum StageRunError {
    /// The bench.
    #[error(transparent)]
    Bench(#[from] Error),
    /// A move of an axis.
    #[error("the move of axis {axis}: {source}")]
    Plan {
        /// The axis.
        axis: String,
        /// Why there is none.
        source: PlanError,
    },
    /// The machine.
    #[error(transparent)]
    Plant(#[from] AxisPlantError),
    /// The hardware.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// The hardware, from the machine file.
    #[error(transparent)]
    MachineStage(#[from] MachineStageError),
    /// A contour.
    #[error("the contour: {0}")]
    Contour(Box<ContourError>),
    /// The tap tables of the same machine with, or without, `[stage]`.
    #[error("the axes with and without equal delays: {0}")]
    Design(Box<dyn std::error::Error + Send + Sync>),
}

/// The comparison of model and RTL over a move.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// Clocks that were compared, reset included.
    pub clocks: u64,
    /// Whether they reach to standstill; a very long move is compared at its beginning.
    pub whole: bool,
    /// Outputs that differed, clock by clock.
    pub mismatches: u64,
    /// The first.
    pub first: Option<Mismatch>,
    /// What the stage did not do.
    pub trouble: Option<Trouble>,
}

/// A stage and the machine that it is for.
#[derive(Debug, Clone)]
pub struct StageRun<'a> {
    machine: &'a Machine,
    config: StageConfig,
    component: Component,
    seed: u64,
    /// Of each axis.
    moves: Vec<AxisMove>,
    /// Of the axes whose modes move.
    families: Vec<TableFamily>,
    /// Of each axis, whether its move has its acceleration from tick to tick, because a smoother one would not exercise its shaper.
    harsh: Vec<bool>,
}

impl<'a> StageRun<'a> {
    /// A stage with this configuration, of `machine`, whose axes make their default moves. `seed` gives the arbitrary contents of
    /// memories.
    ///
    /// # Errors
    /// [`StageRunError::Stage`] where the configuration is none.
    pub fn new(machine: &'a Machine, config: &StageConfig, seed: u64) -> Result<Self, StageRunError> {
        Self::with_moves(machine, config, seed, &[])
    }

    /// The same with a move for each axis, in their order; an axis beyond their end makes its default move.
    ///
    /// # Errors
    /// As [`StageRun::new`].
    pub fn with_moves(
        machine: &'a Machine,
        config: &StageConfig,
        seed: u64,
        moves: &[AxisMove],
    ) -> Result<Self, StageRunError> {
        let moving = machine.axes.iter().any(|axis| axis.family.is_some());
        let families = match moving {
            true => designed(machine)?.families,
            false => Vec::new(),
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
        };
        // A machine of which nothing can be expected says so where it is moved.
        if let Ok(harsh) = expected::too_smooth(&run) {
            run.harsh.splice(..harsh.len(), harsh);
        }
        Ok(run)
    }

    /// The same with a host that leaves every axis on the table of its ROM.
    #[must_use]
    pub fn with_one_table(mut self) -> Self {
        self.families.clear();
        self
    }

    /// Whether the move of an axis has its whole acceleration from tick to tick: its limited jerk would excite its modes too little to
    /// see what the shaper does.
    pub fn is_harsh(&self, axis: usize) -> bool {
        self.harsh.get(axis).copied().unwrap_or(false)
    }

    /// The same machine with delays that are equal for all axes, or with each shaper's own.
    ///
    /// # Errors
    /// [`StageRunError::Design`] where a table cannot hold the delay that is missing; [`StageRunError::MachineStage`].
    pub fn with_delays(machine: &'a Machine, equal: bool, seed: u64) -> Result<Option<Self>, StageRunError> {
        let own = machine.stage.unwrap_or(StageSection {
            extra_delay_s: 0.0,
            contour_speed: None,
        });
        let other = Machine {
            stage: equal.then_some(own),
            ..machine.clone()
        };
        let design = designed(&other)?;
        let stage = hardware::stage(&other, &design)?;
        stage
            .map(|stage| Self::with_families(machine, &stage.config, seed, &[], design.families))
            .transpose()
    }

    /// Moves model and `device` side by side, from reset to standstill: every output of every clock is compared.
    ///
    /// # Errors
    /// [`StageRunError`] where that cannot be run.
    pub fn side_by_side(&self, device: Box<dyn Device>) -> Result<Compared, StageRunError> {
        let mut host = self.host(1.0, Some(device), Shaping::Shaped)?;
        let (trouble, whole) = moves::compare(self, &mut host)?;
        Ok(compared(&host, trouble, whole))
    }

    /// The move in the model alone, on a machine whose modes are at `frequency_factor` times their frequencies.
    ///
    /// # Errors
    /// [`StageRunError`] where that cannot be run.
    pub fn moved(&self, shaping: Shaping, frequency_factor: f64) -> Result<Moved, StageRunError> {
        moves::measure(self, self.host(frequency_factor, None, shaping)?, shaping)
    }

    /// What the move should come to, by axis, from the machine file alone.
    ///
    /// # Errors
    /// [`StageRunError`] where the machine has no such move.
    pub fn expected(&self, shaping: Shaping, frequency_factor: f64) -> Result<Vec<Expected>, StageRunError> {
        expected::of_move(self, shaping, frequency_factor)
    }

    /// The circle in the model alone.
    ///
    /// # Errors
    /// [`StageRunError`] where that cannot be run.
    pub fn circle(&self, circle: &Circle) -> Result<Circled, StageRunError> {
        circle::measure(self, self.host(1.0, None, Shaping::Shaped)?, circle)
    }

    /// The contour in the model alone, from where both axes stand at reset.
    ///
    /// # Errors
    /// [`StageRunError`] where that cannot be run.
    pub fn contour(&self, contour: &Contour) -> Result<Contoured, StageRunError> {
        let host = self.host(1.0, None, Shaping::Shaped)?;
        contour::measure(self, host, contour, &designed(self.machine)?)
    }

    /// Drives model and `device` side by side along a contour, or the part of it that is compared in a minute or so.
    ///
    /// # Errors
    /// [`StageRunError`] where that cannot be run.
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
        Ok(Host::new(bench, &self.config, tables.collect()))
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
