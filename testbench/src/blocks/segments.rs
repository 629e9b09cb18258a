//! The bench of `segments`.

use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::segments::{emit, simulate};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::segments::Segments;

use super::{Bins, Block};
use crate::lockstep::Clock;
use crate::stimuli::{SegmentsCoverage, SegmentsRandom, Stimuli};

/// Clocks after which the stimuli have driven every flag, and every named mutant of `mutation::INSIDE` shows.
const LEAST_CLOCKS: u64 = 60_000;

/// The command FIFO, which has one size.
#[derive(Debug, Clone)]
pub struct SegmentsBlock {
    prefix: String,
    instance: String,
}

impl SegmentsBlock {
    /// The command FIFO `PREFIX_segments`; `instance` says which axes it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for SegmentsBlock {
    fn name(&self) -> &str {
        "segments"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "segments")
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Segments::new(seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(SegmentsRandom::new(seed))
    }

    fn least_clocks(&self) -> u64 {
        LEAST_CLOCKS
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(SegmentsCoverage::default())
    }
}

impl Bins for SegmentsCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock.expected);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        self.counts().map(|(name, count)| (name.to_owned(), count)).collect()
    }
}
