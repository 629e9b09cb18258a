//! The bench of `encoder_generator`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{EncoderGeneratorCoverage, EncoderGeneratorRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::encoder_generator::{EncoderGenerator, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::encoder_generator::{emit, simulate};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "encoder_generator",
    benches: |sizes| Ok(one(EncoderGeneratorBlock::new(&sizes.prefix, "alone"))),
    small: || Ok(small(EncoderGeneratorBlock::new("", "alone"), "32 bits")),
    proofs: || {
        let task = Task::new("encoder_generator", "all rates", INDUCTION, (emit("")?, ports()));
        Ok(vec![task.properties(&[], include_str!("encoder_generator.sv"))])
    },
    areas: || {
        Ok(vec![AreaRow::new("", emit("")?).note(
            "Most of it is the sum of 64 bits; if `generated_count` is not used, a synthesiser keeps 34 of \
                 them.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The internal encoder, which has one size.
#[derive(Debug, Clone)]
pub struct EncoderGeneratorBlock {
    prefix: String,
    instance: String,
}

impl EncoderGeneratorBlock {
    /// Creates the internal encoder `PREFIX_encoder_generator`; `instance` names the axes that it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for EncoderGeneratorBlock {
    fn name(&self) -> &str {
        "encoder_generator"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "encoder_generator")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(EncoderGenerator::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(EncoderGeneratorRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(EncoderGeneratorCoverage::default())
    }
}

impl Bins for EncoderGeneratorCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
