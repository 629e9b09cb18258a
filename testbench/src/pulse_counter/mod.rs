//! The bench of `pulse_counter`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{PulseCounterCoverage, PulseCounterRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::pulse_counter::{PulseCounter, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::pulse_counter::{emit, simulate};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block};
use crate::formal::{INDUCTION, Task};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "pulse_counter",
    benches: |sizes| Ok(one(PulseCounterBlock::new(&sizes.prefix, &sizes.with_encoder))),
    small: || Ok(small(PulseCounterBlock::new("", "alone"), "32-bit count")),
    proofs: || {
        let block = (emit("")?, ports());
        let task = Task::new("pulse_counter", "32-bit count", INDUCTION, block);
        Ok(vec![task.properties(&[], include_str!("pulse_counter.sv"))])
    },
    areas: || {
        Ok(vec![AreaRow::new("all features", emit("")?).budget(450, 300).note(
            "13 flip-flops are for differential pairs (three more synchronisers, a filter); they disappear \
                 if `differential` is tied low. A third of the LUTs is the one-pole filter.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The pulse counter, which has one size: registers configure it.
#[derive(Debug, Clone)]
pub struct PulseCounterBlock {
    prefix: String,
    instance: String,
}

impl PulseCounterBlock {
    /// Creates the pulse counter `PREFIX_pulse_counter`; `instance` names the axes that it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for PulseCounterBlock {
    fn name(&self) -> &str {
        "pulse_counter"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "pulse_counter")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(PulseCounter::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(PulseCounterRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(PulseCounterCoverage::default())
    }
}

impl Bins for PulseCounterCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock.inputs, clock.expected);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        let counts = self.counts().into_iter();
        counts.map(|(name, count)| (name.to_owned(), count)).collect()
    }
}
