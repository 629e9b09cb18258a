//! The bench of `cascade`.

use posicast_hdl::SimulationError;
use posicast_hdl::cascade::{emit, simulate, simulated_as};
use posicast_hdl::emit::{EmitError, Module, own_name};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::cascade::{Cascade, CascadeConfig};

use super::{Bins, Block, named};
use crate::lockstep::Clock;
use crate::stimuli::{CascadeCoverage, CascadeRandom, Stimuli};

/// The cascade of one size.
#[derive(Debug, Clone)]
pub struct CascadeBlock {
    config: CascadeConfig,
    prefix: String,
    instance: String,
}

impl CascadeBlock {
    /// The cascade `PREFIX_cascade`.
    pub fn new(config: CascadeConfig, prefix: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: format!("{} stages, {} bits", config.stages(), config.word_bits()),
            config,
        }
    }
}

impl Block for CascadeBlock {
    fn name(&self) -> &str {
        "cascade"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        own_name(&self.prefix, "cascade")
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Cascade::new(&self.config, seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn simulated_as(&self) -> Option<String> {
        simulated_as(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(CascadeRandom::new(&self.config, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(OfSize {
            config: &self.config,
            coverage: CascadeCoverage::default(),
        })
    }
}

/// The ends of the word are the configuration's.
struct OfSize<'a> {
    config: &'a CascadeConfig,
    coverage: CascadeCoverage,
}

impl Bins for OfSize<'_> {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.coverage.observe(self.config, clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.coverage.counts())
    }
}
