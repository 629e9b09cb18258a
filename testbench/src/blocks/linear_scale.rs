//! The bench of `linear_scale`.

use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::linear_scale::{emit, simulate};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::linear_scale::LinearScale;

use super::{Bins, Block, named};
use crate::lockstep::Clock;
use crate::stimuli::{LinearScaleCoverage, LinearScaleRandom, Stimuli};

/// The linear scale, which has one size.
#[derive(Debug, Clone)]
pub struct LinearScaleBlock {
    prefix: String,
    instance: String,
}

impl LinearScaleBlock {
    /// The linear scale `PREFIX_linear_scale`; `instance` says which axes it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for LinearScaleBlock {
    fn name(&self) -> &str {
        "linear_scale"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "linear_scale")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(LinearScale::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(LinearScaleRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(LinearScaleCoverage::default())
    }
}

impl Bins for LinearScaleCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
