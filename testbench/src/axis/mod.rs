//! The bench of `axis`.

mod coverage;
pub(crate) mod proofs;
pub(crate) mod stimuli;
mod trials;

pub use self::coverage::{AxisCoverage, AxisSafety};
pub use self::stimuli::AxisRandom;

use posicast_blocks::ClockedBlock;
use posicast_blocks::axis::Axis;
use posicast_hdl::SimulationError;
use posicast_hdl::axis::{emit, simulate};
use posicast_hdl::emit::{EmitError, Module, shared_name};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// Number of clocks after which the stimuli have driven every flag, and have revealed every named mutant of
/// `mutation::INSIDE`.
const LEAST_CLOCKS: u64 = 30_000;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "axis",
    benches: |sizes| Ok(one(AxisBlock::new(&sizes.prefix, "alone"))),
    small: || Ok(small(AxisBlock::new("", "alone"), "all inputs")),
    proofs: proofs::tasks,
    areas: || {
        Ok(vec![AreaRow::new("", emit("")?).note(
            "Words of 32 bits are compared byte by byte, one after the other: two soft limits, and three \
                 magnitudes with their limits.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The supervisor of an axis, which has one size: registers configure it.
#[derive(Debug, Clone)]
pub struct AxisBlock {
    prefix: String,
    instance: String,
}

impl AxisBlock {
    /// Creates the supervisor `PREFIX_axis`; `instance` names the axes that it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for AxisBlock {
    fn name(&self) -> &str {
        "axis"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "axis")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Axis::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(AxisRandom::new(seed))
    }

    fn least_clocks(&self) -> u64 {
        LEAST_CLOCKS
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(AxisCoverage::default())
    }
}

impl Bins for AxisCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock.inputs, clock.expected);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        self.counts()
    }
}
