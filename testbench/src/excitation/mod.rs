//! The bench of `excitation`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{ExcitationCoverage, ExcitationRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::excitation::{Excitation, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::excitation::{emit, simulate};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "excitation",
    benches: |sizes| Ok(one(ExcitationBlock::new(&sizes.prefix, "alone"))),
    small: || Ok(small(ExcitationBlock::new("", "alone"), "32 bits")),
    proofs: || {
        let task = Task::new("excitation", "all signals", INDUCTION, (emit("")?, ports()));
        Ok(vec![task.properties(&[], include_str!("excitation.sv"))])
    },
    areas: || {
        Ok(vec![AreaRow::new("", emit("")?).note(
            "The references of velocity and acceleration are 64 registers without logic. Without these, and \
                 with `amplitude_limit` and `modulo` tied, it takes 333 LE.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The excitation, which has one size.
#[derive(Debug, Clone)]
pub struct ExcitationBlock {
    prefix: String,
    instance: String,
}

impl ExcitationBlock {
    /// Creates the excitation `PREFIX_excitation`; `instance` names the axes that it serves.
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
