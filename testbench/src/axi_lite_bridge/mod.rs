//! The bench of `axi_lite_bridge`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{AxiLiteBridgeCoverage, AxiLiteBridgeRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::axi_lite_bridge::{AxiLiteBridge, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::axi_lite_bridge::{emit, simulate};
use posicast_hdl::emit::{EmitError, Module, shared_name};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block};
use crate::formal::{INDUCTION, Task};
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "axi_lite_bridge",
    benches: |sizes| Ok(one(AxiLiteBridgeBlock::new(&sizes.prefix))),
    small: || Ok(small(AxiLiteBridgeBlock::new(""), "one size")),
    proofs: || {
        let bridge = Task::new("axi_lite_bridge", "any manager", INDUCTION, (emit("")?, ports()));
        Ok(vec![bridge.properties(&[], include_str!("axi_lite_bridge.sv"))])
    },
    areas: || {
        Ok(vec![AreaRow::new("", emit("")?).note(
            "Most of it are the queues: two entries of each channel, four of the answers to reads.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The bridge, which has one size.
#[derive(Debug, Clone)]
pub struct AxiLiteBridgeBlock {
    prefix: String,
}

impl AxiLiteBridgeBlock {
    /// Creates the bridge `PREFIX_axi_lite_bridge`.
    pub fn new(prefix: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
        }
    }
}

impl Block for AxiLiteBridgeBlock {
    fn name(&self) -> &str {
        "axi_lite_bridge"
    }

    fn instance(&self) -> &str {
        "alone"
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "axi_lite_bridge")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(AxiLiteBridge::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(AxiLiteBridgeRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(AxiLiteBridgeCoverage::default())
    }
}
