//! The bench of a whole `stage`, whose stimuli are a driver, random traffic, and lines and encoders at its pins.

mod coverage;
pub(crate) mod proofs;
pub(crate) mod short_ticks;
pub(crate) mod stimuli;

pub use self::coverage::StageCoverage;
pub use self::short_ticks::ShortTicksBlock;
pub use self::stimuli::StageRandom;

use posicast_blocks::ClockedBlock;
use posicast_blocks::component::Component;
use posicast_blocks::sliding_mode::Settings;
use posicast_blocks::stage::{StageAxis, StageConfig, StageError};
use posicast_hdl::SimulationError;
use posicast_hdl::component::emit;
use posicast_hdl::emit::{EmitError, Module};
use posicast_machine::plan::design_machine;
use posicast_machine::{hardware, machine_file};

use crate::Error;
use crate::blocks::reached::InsideAStage;
use crate::blocks::registry::{AreaRow, RegistryRow};
use crate::blocks::{Bins, Block, ProofMutant, Reach, inside, not_in_rusthdl};
use crate::formal::refused;
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "stage",
    benches: |sizes| {
        let bench = |config| -> Result<Box<dyn Block>, Error> {
            Ok(Box::new(StageBlock::new(config, "stage").map_err(refused)?))
        };
        sizes.stages.iter().map(bench).collect()
    },
    proofs: proofs::tasks,
    proof_mutants: &[
        ProofMutant::new(
            "an emergency stop of another axis on no wire",
            ".group_emergency_stop   (group_emergency_stop)",
            ".group_emergency_stop   (1'd0)",
        )
        .of("stage_axis")
        .violates("group_stop_"),
        ProofMutant::new(
            "steps without the supervisor's enable",
            ".enable        (steps_enable)",
            ".enable        (1'd1)",
        )
        .of("stage_steps")
        .violates("group_stop_steps"),
        ProofMutant::new(
            "a trip of the steps on no wire",
            ".pwm_tripped            (steps_tripped)",
            ".pwm_tripped            (1'd0)",
        )
        .of("stage_steps")
        .violates("trip_is_off"),
    ],
    areas: || {
        Ok(vec![
            area("XY, whole", "")?,
            area("XY, traces of 256 samples", "[axis.trace]\nsamples = 256\n\n")?,
        ])
    },
    ..RegistryRow::EMPTY
};

/// A stage with the name of its top module.
#[derive(Debug, Clone)]
pub struct StageBlock {
    component: Component,
    axes: Vec<String>,
    instance: String,
    top: String,
    prefix: String,
    /// Moves, taps and per cent of the registers that a run must reach.
    bars: [u64; 3],
}

/// The bars of a run with short ticks. Its least clocks write 28 of 66 words that can be written, and read 67 of 97 as other words than 0.
pub(crate) const BARS: [u64; 3] = [1, 1, 35];
/// The bars of a run with so few ticks that an axis may not come to its first move.
pub(crate) const FEW_TICKS_BARS: [u64; 3] = [0, 0, 10];
/// A run with at least this many clocks per tick counts as one with few ticks.
const LONG_TICK_CLOCKS: u32 = 1500;

impl StageBlock {
    /// Creates the stage with the top module `top`.
    ///
    /// # Errors
    /// As [`Component::stage`].
    pub fn new(config: &StageConfig, top: &str) -> Result<Self, StageError> {
        let axes: Vec<String> = config.axes.iter().map(|axis| axis.name.clone()).collect();
        Ok(Self {
            component: Component::stage(config)?,
            instance: format!("{}, Avalon", axes.join(", ")),
            axes,
            top: top.to_owned(),
            prefix: top.to_owned(),
            bars: if config.tick.tick_clocks() < LONG_TICK_CLOCKS {
                BARS
            } else {
                FEW_TICKS_BARS
            },
        })
    }

    /// Counts what a row of this stage reaches, on any bus.
    pub(crate) fn reach_with(&self, instance: &str, bars: [u64; 3]) -> InsideAStage {
        InsideAStage::new(instance, &self.axes, self.component.map(), bars)
    }

    /// Returns the stage's blocks, each with the modules of the stage, on the bench of its kind: those that all axes
    /// share once, the others per axis.
    ///
    /// # Errors
    /// [`Error::Unlike`] if a shaper lacks a port that the stimuli drive.
    pub fn inner(&self) -> Result<Vec<Box<dyn Block>>, Error> {
        inside::of_stage(&self.component, &self.prefix)
    }

    /// Sets the prefix of the modules whose contents depend on the machine: in a package, the machine's name. By
    /// default it is the name of the top.
    pub fn with_prefix(self, prefix: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            ..self
        }
    }

    /// Returns the names of its axes.
    pub fn axes(&self) -> &[String] {
        &self.axes
    }

    /// Returns the stage.
    pub fn component(&self) -> &Component {
        &self.component
    }
}

impl Block for StageBlock {
    fn name(&self) -> &str {
        self.component.name()
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.component, &self.top, &self.prefix)
    }

    fn top(&self) -> String {
        self.top.clone()
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(self.component.model(seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        Err(not_in_rusthdl("stage"))
    }

    fn in_rusthdl(&self) -> bool {
        false
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(StageRandom::new(&self.component, &self.axes, seed))
    }

    fn reach(&self) -> Box<dyn Reach + '_> {
        Box::new(self.reach_with(&self.instance, self.bars))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(StageCoverage::new(&self.component, &self.axes))
    }
}

impl Bins for StageCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock.inputs);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        self.counts()
    }
}

/// The area of the example machine's stage, flattened, so that constants of the machine file are folded. `traces` is
/// inserted before the controller of each axis.
fn area(size: &'static str, traces: &str) -> Result<AreaRow, Error> {
    let component = Component::stage(&example(traces)?).map_err(refused)?;
    Ok(AreaRow::new(size, emit(&component, "xy_stage", "xy")?))
}

/// Returns the controller's settings of the example's first axis.
pub(crate) fn example_settings() -> Result<Settings, Error> {
    let stage = example("")?;
    let of = stage.axes.first().and_then(StageAxis::closed_loop);
    Ok(of.ok_or_else(|| refused("the example has no controller"))?.settings)
}

/// Returns the stage of the example machine, with this text before the controller of each axis.
pub(crate) fn example(before_controllers: &str) -> Result<StageConfig, Error> {
    let controller = "[axis.controller]";
    let text = include_str!("../../machines/xy-stage.toml");
    let text = text.replace(controller, &format!("{before_controllers}{controller}"));
    let machine = machine_file::parse("xy-stage.toml", &text).map_err(refused)?;
    let designs = design_machine(&machine).map_err(refused)?;
    let stage = hardware::stage(&machine, &designs).map_err(refused)?;
    Ok(stage.ok_or_else(|| refused("the example has no stage"))?.config)
}
