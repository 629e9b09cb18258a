//! The bench of `drive_command`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{DriveCommandCoverage, DriveCommandRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::drive_command::{DriveCommand, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::drive_command::{emit, simulate};
use posicast_hdl::emit::{EmitError, Module, shared_name};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "drive_command",
    benches: |sizes| Ok(one(DriveCommandBlock::new(&sizes.prefix, "alone"))),
    small: || Ok(small(DriveCommandBlock::new("", "alone"), "nothing tied")),
    proofs: || {
        let block = (emit("")?, ports());
        let task = Task::new("drive_command", "all inputs", INDUCTION, block);
        Ok(vec![
            task.macros(&crate::axis::proofs::macros())
                .properties(&[], include_str!("drive_command.sv")),
        ])
    },
    areas: || {
        Ok(vec![
            AreaRow::new("nothing tied", emit("")?).note("Two counters and two results belong to the self-test."),
        ])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The drive command, which has one size.
#[derive(Debug, Clone)]
pub struct DriveCommandBlock {
    prefix: String,
    instance: String,
}

impl DriveCommandBlock {
    /// Creates the drive command `PREFIX_drive_command`; `instance` names the axes that it serves.
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
