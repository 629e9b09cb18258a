//! The bench of `divider`.

use posicast_hdl::SimulationError;
use posicast_hdl::divider::{emit, simulate};
use posicast_hdl::emit::{EmitError, Module};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::divider::{Divider, DividerConfig};

use super::{Bins, Block, named};
use crate::lockstep::Clock;
use crate::stimuli::{DividerCoverage, DividerRandom, Stimuli};

/// The divider for ticks of one length.
#[derive(Debug, Clone)]
pub struct DividerBlock {
    config: DividerConfig,
    prefix: String,
    instance: String,
}

impl DividerBlock {
    /// The divider `PREFIX_divider`.
    pub fn new(config: DividerConfig, prefix: &str) -> Self {
        Self {
            config,
            prefix: prefix.to_owned(),
            instance: format!("{} clocks per tick", config.tick_clocks()),
        }
    }

    /// The same, called `instance` in the report.
    pub fn called(self, instance: &str) -> Self {
        Self {
            instance: instance.to_owned(),
            ..self
        }
    }
}

impl Block for DividerBlock {
    fn name(&self) -> &str {
        "divider"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        posicast_hdl::divider::name(&self.config, &self.prefix)
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Divider::new(&self.config))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(DividerRandom::new(&self.config, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(DividerCoverage::default())
    }
}

impl Bins for DividerCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
