//! The bench of `wishbone_bridge`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{WishboneBridgeCoverage, WishboneBridgeRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::wishbone_bridge::{WishboneBridge, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::wishbone_bridge::{emit, simulate};

use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block};
use crate::formal::{INDUCTION, Task};
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "wishbone_bridge",
    benches: |sizes| Ok(one(WishboneBridgeBlock::new(&sizes.prefix))),
    small: || Ok(small(WishboneBridgeBlock::new(""), "one size")),
    proofs: || {
        let bridge = Task::new("wishbone_bridge", "any master", INDUCTION, (emit("")?, ports()));
        Ok(vec![bridge.properties(&[], include_str!("wishbone_bridge.sv"))])
    },
    areas: || Ok(vec![AreaRow::new("", emit("")?)]),
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The bridge, which has one size.
#[derive(Debug, Clone)]
pub struct WishboneBridgeBlock {
    prefix: String,
}

impl WishboneBridgeBlock {
    /// Creates the bridge `PREFIX_wishbone_bridge`.
    pub fn new(prefix: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
        }
    }
}

impl Block for WishboneBridgeBlock {
    fn name(&self) -> &str {
        "wishbone_bridge"
    }

    fn instance(&self) -> &str {
        "alone"
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "wishbone_bridge")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(WishboneBridge::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(WishboneBridgeRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(WishboneBridgeCoverage::default())
    }
}
