//! The bench of `spi_bridge`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{SpiBridgeCoverage, SpiBridgeRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::spi_bridge::{SpiBridge, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::spi_bridge::{emit, simulate};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "spi_bridge",
    benches: |sizes| Ok(one(SpiBridgeBlock::new(&sizes.prefix, "alone"))),
    small: || Ok(small(SpiBridgeBlock::new("", "alone"), "one size")),
    proofs: || {
        let bridge = Task::new("spi_bridge", "all clocks of the host", INDUCTION, (emit("")?, ports()));
        Ok(vec![bridge.properties(&[], include_str!("spi_bridge.sv"))])
    },
    areas: || {
        Ok(vec![AreaRow::new("", emit("")?).note(
            "Decoder, CRC, sequencer and reply are those of uart_bridge. A byte from the host and two for it are flip-flops of \
             the line.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The bridge, which has one size.
#[derive(Debug, Clone)]
pub struct SpiBridgeBlock {
    prefix: String,
    instance: String,
}

impl SpiBridgeBlock {
    /// Creates the bridge `PREFIX_spi_bridge`.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for SpiBridgeBlock {
    fn name(&self) -> &str {
        "spi_bridge"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "spi_bridge")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(SpiBridge::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(SpiBridgeRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(SpiBridgeCoverage::default())
    }
}

impl Bins for SpiBridgeCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
