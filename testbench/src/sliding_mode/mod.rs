//! The bench of `sliding_mode`.

pub(crate) mod proofs;
pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{SlidingModeCoverage, SlidingModeRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::sliding_mode::SlidingMode;
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::sliding_mode::{emit, simulate};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// Number of clocks of a run with time for the ticks that wind up the integral, and as many others.
const LONG_CLOCKS: u64 = 2 * SlidingModeRandom::WIND_UP_CLOCKS;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "sliding_mode",
    benches: |sizes| Ok(one(SlidingModeBlock::new(&sizes.prefix, &sizes.with_controller))),
    small: || Ok(small(SlidingModeBlock::new("", "alone"), "all laws")),
    proofs: proofs::tasks,
    areas: || Ok(vec![AreaRow::new("all laws", emit("")?)]),
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The controller, which has one size: its settings configure it.
#[derive(Debug, Clone)]
pub struct SlidingModeBlock {
    prefix: String,
    instance: String,
}

impl SlidingModeBlock {
    /// Creates the controller `PREFIX_sliding_mode`; `instance` names the axes that it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for SlidingModeBlock {
    fn name(&self) -> &str {
        "sliding_mode"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "sliding_mode")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(SlidingMode::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(if cycles < LONG_CLOCKS {
            SlidingModeRandom::without_wind_up(seed)
        } else {
            SlidingModeRandom::new(seed)
        })
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(SlidingModeCoverage::default())
    }
}

impl Bins for SlidingModeCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock.inputs, clock.expected);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        self.counts()
    }
}
