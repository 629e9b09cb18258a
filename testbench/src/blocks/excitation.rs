//! The bench of `excitation`.

use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::excitation::{emit, simulate};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::excitation::Excitation;

use super::{Bins, Block, named};
use crate::lockstep::Clock;
use crate::stimuli::{ExcitationCoverage, ExcitationRandom, Stimuli};

/// The excitation, which has one size.
#[derive(Debug, Clone)]
pub struct ExcitationBlock {
    prefix: String,
    instance: String,
}

impl ExcitationBlock {
    /// The excitation `PREFIX_excitation`; `instance` says which axes it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for ExcitationBlock {
    fn name(&self) -> &str {
        "excitation"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "excitation")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Excitation::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(ExcitationRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(ExcitationCoverage::default())
    }
}

impl Bins for ExcitationCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
