//! The bench of `uart_bridge`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{UartBridgeCoverage, UartBridgeRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::uart_bridge::{UartBridge, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::uart_bridge::{emit, simulate};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task, part};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "uart_bridge",
    benches: |sizes| Ok(one(UartBridgeBlock::new(&sizes.prefix, "alone"))),
    small: || Ok(small(UartBridgeBlock::new("", "alone"), "one size")),
    proofs: || {
        let bridge = Task::new("uart_bridge", "all baud rates", INDUCTION, (emit("")?, ports()));
        let sequencer = part(emit("")?, "bridge_sequencer")?;
        let sequencer = Task::new("uart_sequencer", "all requests", INDUCTION, sequencer);
        Ok(vec![
            bridge.properties(&[], include_str!("uart_bridge.sv")),
            sequencer.properties(&[], include_str!("uart_sequencer.sv")),
        ])
    },
    areas: || {
        Ok(vec![AreaRow::new("", emit("")?).note(
            "90 flip-flops are the sequencer's, with the word and its address; 44 are the CRC's, which takes a bit per \
             clock. Request and reply are a block RAM of 256 bytes each.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The bridge, which has one size.
#[derive(Debug, Clone)]
pub struct UartBridgeBlock {
    prefix: String,
    instance: String,
}

impl UartBridgeBlock {
    /// Creates the bridge `PREFIX_uart_bridge`.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for UartBridgeBlock {
    fn name(&self) -> &str {
        "uart_bridge"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "uart_bridge")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(UartBridge::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(UartBridgeRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(UartBridgeCoverage::default())
    }
}

impl Bins for UartBridgeCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
