//! The bench of a stage with its line, whose stimuli are a host at the line, and lines and encoders at the pins.

use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::linked_stage::emit;
use posicast_model::rtl::component::Component;
use posicast_model::rtl::linked_stage::{BridgeConfig, LinkedStage, ports};
use posicast_model::rtl::{ClockedBlock, Direction};

use super::changes::Changes;
use super::levels::Levels;
use super::{Bins, Block, Exercise, not_in_rusthdl};
use crate::stimuli::{LinkedStageRandom, Stimuli};

/// Number of bytes on the line that a run must have at least.
const LEAST_BYTES: f64 = 1000.0;

/// A stage with its line, and the names of its modules.
#[derive(Debug, Clone)]
pub struct LinkedStageBlock {
    stage: Component,
    config: BridgeConfig,
    clock_hz: f64,
    axes: Vec<String>,
    instance: String,
    names: [String; 3],
}

impl LinkedStageBlock {
    /// Creates the top `names[0]` with the stage `names[1]`; modules whose contents depend on the machine begin with `names[2]`. `axes`
    /// are those of the stage.
    pub fn new(stage: &Component, (config, clock_hz): (BridgeConfig, f64), axes: &[String], names: [&str; 3]) -> Self {
        Self {
            stage: stage.clone(),
            config,
            clock_hz,
            axes: axes.to_vec(),
            instance: format!("{}, {} without time-outs", axes.join(", "), config.line()),
            names: names.map(str::to_owned),
        }
    }

    /// The constants of its bridge.
    pub fn config(&self) -> &BridgeConfig {
        &self.config
    }
}

impl Block for LinkedStageBlock {
    fn name(&self) -> &str {
        "linked_stage"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        let [top, stage, prefix] = &self.names;
        emit(&self.stage, &self.config, (top, stage, prefix))
    }

    fn top(&self) -> String {
        self.names[0].clone()
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(LinkedStage::new(&self.stage, &self.config, seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        Err(not_in_rusthdl("linked_stage"))
    }

    fn in_rusthdl(&self) -> bool {
        false
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        let line = (&self.config, self.clock_hz);
        Box::new(LinkedStageRandom::new(&self.stage, &self.axes, line, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(Changes::new(&ports(&self.stage, &self.config)))
    }

    fn least_clocks(&self) -> u64 {
        (LEAST_BYTES * LinkedStageRandom::byte_clocks(&self.config, self.clock_hz)) as u64
    }

    /// Only the line: the stage's own bench exercises the pins, and a line is too slow for that. Time-outs are as long as a run; the bench
    /// of the bridge has them.
    fn exercise(&self) -> Option<Box<dyn Exercise + '_>> {
        let mut ports = ports(&self.stage, &self.config);
        ports.retain(|port| port.direction == Direction::Output);
        Some(Box::new(Levels::new(&self.instance, &ports[..1], &[])))
    }
}
