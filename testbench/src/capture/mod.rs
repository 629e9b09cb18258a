//! The bench of `capture`.

mod proofs;
mod reached;
pub(crate) mod stimuli;
mod trials;

pub use self::reached::CaptureCoverage;
pub use self::stimuli::CaptureRandom;

use posicast_blocks::ClockedBlock;
use posicast_blocks::capture::Capture;
use posicast_hdl::SimulationError;
use posicast_hdl::capture::{emit, simulate};
use posicast_hdl::emit::{EmitError, Module, shared_name};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "capture",
    benches: |sizes| Ok(one(CaptureBlock::new(&sizes.prefix, "alone"))),
    small: || Ok(small(CaptureBlock::new("", "alone"), "one size")),
    proofs: proofs::all,
    areas: || {
        Ok(vec![AreaRow::new("", emit("")?).note(
            "A quarter of it hides what the memory shows without an entry; ports that nothing reads disappear.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The position capture, which has one size.
#[derive(Debug, Clone)]
pub struct CaptureBlock {
    prefix: String,
    instance: String,
}

impl CaptureBlock {
    /// Creates the position capture `PREFIX_capture`; `instance` names the axes that it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for CaptureBlock {
    fn name(&self) -> &str {
        "capture"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "capture")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Capture::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(CaptureRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(CaptureCoverage::default())
    }
}

impl Bins for CaptureCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
