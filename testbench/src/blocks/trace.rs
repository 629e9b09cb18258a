//! The bench of `trace`.

use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::trace::{emit, simulate};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::trace::{Trace, TraceConfig};

use super::{Bins, Block};
use crate::lockstep::Clock;
use crate::stimuli::{Stimuli, TraceCoverage, TraceRandom};

/// The trace memory of one size.
#[derive(Debug, Clone)]
pub struct TraceBlock {
    config: TraceConfig,
    prefix: String,
    instance: String,
}

impl TraceBlock {
    /// The trace memory `PREFIX_trace`.
    pub fn new(config: TraceConfig, prefix: &str) -> Self {
        Self {
            config,
            prefix: prefix.to_owned(),
            instance: format!("{} samples", config.samples()),
        }
    }
}

impl TraceBlock {
    /// The same, called `instance` in the report.
    pub fn called(self, instance: &str) -> Self {
        Self {
            instance: instance.to_owned(),
            ..self
        }
    }
}

impl Block for TraceBlock {
    fn name(&self) -> &str {
        "trace"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        posicast_hdl::trace::name(&self.config, &self.prefix)
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Trace::new(&self.config))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(TraceRandom::new(&self.config, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(TraceCoverage::new(&self.config))
    }
}

impl Bins for TraceCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        self.counts().map(|(name, count)| (name.to_owned(), count)).collect()
    }
}
