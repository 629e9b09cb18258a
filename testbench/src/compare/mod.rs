//! The bench of `compare`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{CompareCoverage, CompareRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::compare::{Compare, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::compare::{emit, simulate};
use posicast_hdl::emit::{EmitError, Module, shared_name};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "compare",
    benches: |sizes| Ok(one(CompareBlock::new(&sizes.prefix, "alone"))),
    small: || Ok(small(CompareBlock::new("", "alone"), "one size")),
    proofs: || Ok(vec![proof(1)?, proof(2)?, proof(4096)?]),
    areas: || {
        Ok(vec![AreaRow::new("", emit("")?).note(
            "Both neighbours of the count, the settings and four differences of 35 bits.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// Rows of this spacing, and any list.
fn proof(spacing: u32) -> Result<Task, Error> {
    let block = (emit("")?, ports());
    let size = format!("rows of spacing {spacing}, and any list");
    let macros = [("SPACING", spacing.to_string())];
    Ok(Task::new("compare", &size, INDUCTION, block).properties(&macros, include_str!("compare.sv")))
}

/// The position compare, which has one size.
#[derive(Debug, Clone)]
pub struct CompareBlock {
    prefix: String,
    instance: String,
}

impl CompareBlock {
    /// Creates the position compare `PREFIX_compare`; `instance` names the axes that it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for CompareBlock {
    fn name(&self) -> &str {
        "compare"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "compare")
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Compare::new(seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(CompareRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(CompareCoverage::default())
    }
}

impl Bins for CompareCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
