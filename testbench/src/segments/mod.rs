//! The bench of `segments`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{SegmentsCoverage, SegmentsRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::segments::{REACH_COUNTS, STAND_COUNTS, Segments, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::segments::{emit, simulate};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block};
use crate::formal::{INDUCTION, Task};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// Number of clocks after which the stimuli have driven every flag, and have revealed every named mutant of
/// `mutation::INSIDE`.
const LEAST_CLOCKS: u64 = 60_000;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "segments",
    benches: |sizes| Ok(one(SegmentsBlock::new(&sizes.prefix, "alone"))),
    small: || Ok(small(SegmentsBlock::new("", "alone"), "64 entries")),
    proofs,
    areas: || Ok(vec![AreaRow::new("64 entries", emit("")?)]),
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The command FIFO, which has one size.
#[derive(Debug, Clone)]
pub struct SegmentsBlock {
    prefix: String,
    instance: String,
}

impl SegmentsBlock {
    /// Creates the command FIFO `PREFIX_segments`; `instance` names the axes that it serves.
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

fn proofs() -> Result<Vec<Task>, Error> {
    let block = (emit("")?, ports());
    let counts = |counts: i32| format!("24'sd{counts}");
    // These are the largest and the smallest position.
    let range = [
        ("REACH_COUNTS", counts(REACH_COUNTS)),
        ("STAND_COUNTS", counts(STAND_COUNTS)),
    ];
    Ok(vec![
        Task::new("segments", "64 entries", INDUCTION, block.clone()).properties(&[], include_str!("segments.sv")),
        Task::new("segments_range", "any position", INDUCTION, block)
            .properties(&range, include_str!("segments_range.sv")),
    ])
}
