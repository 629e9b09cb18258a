//! The bench of `drive_command`.

use posicast_hdl::SimulationError;
use posicast_hdl::drive_command::{emit, simulate};
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::drive_command::DriveCommand;

use super::{Bins, Block, named};
use crate::lockstep::Clock;
use crate::stimuli::{DriveCommandCoverage, DriveCommandRandom, Stimuli};

/// The drive command, which has one size.
#[derive(Debug, Clone)]
pub struct DriveCommandBlock {
    prefix: String,
    instance: String,
}

impl DriveCommandBlock {
    /// The drive command `PREFIX_drive_command`; `instance` says which axes it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for DriveCommandBlock {
    fn name(&self) -> &str {
        "drive_command"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "drive_command")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(DriveCommand::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(DriveCommandRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(DriveCommandCoverage::default())
    }
}

impl Bins for DriveCommandCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
