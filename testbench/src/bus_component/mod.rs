//! The bench of a component on AXI4-Lite or Wishbone: the stimuli of the component on its own bus, whose accesses a manager makes.

pub(crate) mod stimuli;

pub use self::stimuli::BusComponentRandom;

use posicast_blocks::bus_component::{BridgedBus, BusComponent, ports};
use posicast_blocks::component::Component;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::stage::STAGE;
use posicast_blocks::{ClockedBlock, Direction, Port};
use posicast_hdl::SimulationError;
use posicast_hdl::bus_component::emit;
use posicast_hdl::emit::{EmitError, Module};

use crate::axi_lite_bridge::AxiLiteBridgeBlock;
use crate::blocks::changes::Changes;
use crate::blocks::levels::Levels;
use crate::blocks::reached::InsideAStage;
use crate::blocks::registry::RegistryRow;
use crate::blocks::{Bins, Block, BlockMutant, Exercise, Reach, Trial, not_in_rusthdl};
use crate::formal::refused;
use crate::stage::{FEW_TICKS_BARS, example};
use crate::stimuli::Stimuli;
use crate::wishbone_bridge::WishboneBridgeBlock;

/// The row of the components in the registry. Its trials are a small component and a stage, on each bus.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "bus_component",
    benches: |sizes| {
        let buses = sizes.buses.iter().cloned();
        Ok(buses.map(|block| Box::new(block) as Box<dyn Block>).collect())
    },
    trials: || {
        let counter = || {
            let tick = DividerConfig::new(500).map_err(refused)?;
            Component::pulse_counter(tick, 8, false).map_err(refused)
        };
        let stage = || Component::stage(&example("")?).map_err(refused);
        let trial = |component: Component, bus: BridgedBus, size| {
            let names = ["top", "inner", "alone"];
            let axes = ["x", "y"].map(str::to_owned);
            let axes = if component.name() == STAGE { &axes[..] } else { &[] };
            Trial::new(BusComponentBlock::new(component, bus, axes, names), &[1], 2).size(size)
        };
        let wishbone = |pipelined| BridgedBus::Wishbone { pipelined };
        Ok(vec![
            trial(counter()?, BridgedBus::AxiLite, "pulse counter, AXI4-Lite"),
            trial(counter()?, wishbone(false), "pulse counter, Wishbone"),
            trial(counter()?, wishbone(true), "pulse counter, pipelined Wishbone"),
            trial(stage()?, BridgedBus::AxiLite, "stage, AXI4-Lite"),
            trial(stage()?, wishbone(false), "stage, Wishbone").long(),
        ])
    },
    mutants: &[
        BlockMutant::new(
            "a word without a register that is acknowledged",
            "assign avm_mapped = ",
            "assign avm_mapped = 1'b1 | ",
        )
        .of("pulse counter, AXI4-Lite"),
        BlockMutant::new(
            "bytes that are always written",
            ".avs_byteenable (avm_byteenable)",
            ".avs_byteenable (4'hf)",
        )
        .of("pulse counter, Wishbone"),
    ],
    ..RegistryRow::EMPTY
};

/// A component on a bus, and the names of its modules.
#[derive(Debug, Clone)]
pub struct BusComponentBlock {
    component: Component,
    bus: BridgedBus,
    /// Names of the axes of a stage.
    axes: Vec<String>,
    names: [String; 3],
    instance: String,
}

impl BusComponentBlock {
    /// Creates the top `names[0]` with the component `names[1]`; modules whose contents depend on the machine begin with `names[2]`.
    /// `axes` are those of a stage.
    pub fn new(component: Component, bus: BridgedBus, axes: &[String], names: [&str; 3]) -> Self {
        Self {
            instance: format!("{}, {}", component.name(), bus.title()),
            component,
            bus,
            axes: axes.to_vec(),
            names: names.map(str::to_owned),
        }
    }

    /// The bus.
    pub fn bus(&self) -> BridgedBus {
        self.bus
    }

    /// The component.
    pub fn component(&self) -> &Component {
        &self.component
    }

    /// Name of the component's module.
    pub fn inside(&self) -> &str {
        &self.names[1]
    }

    /// The outputs to the bus.
    fn shown(&self) -> Vec<Port> {
        let ports = ports(&self.component, self.bus).into_iter();
        let outputs = ports.filter(|port| port.direction == Direction::Output);
        outputs.take(self.bus.bus_outputs()).collect()
    }

    /// The bridge alone, with the modules of the machine.
    pub fn bridge(&self) -> Box<dyn Block> {
        match self.bus {
            BridgedBus::AxiLite => Box::new(AxiLiteBridgeBlock::new(&self.names[2])),
            BridgedBus::Wishbone { .. } => Box::new(WishboneBridgeBlock::new(&self.names[2])),
        }
    }
}

impl Block for BusComponentBlock {
    fn name(&self) -> &str {
        "bus_component"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        let [top, component, prefix] = &self.names;
        emit(&self.component, self.bus, (top, component, prefix))
    }

    fn top(&self) -> String {
        self.names[0].clone()
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(BusComponent::new(&self.component, self.bus, seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        Err(not_in_rusthdl("bus_component"))
    }

    fn in_rusthdl(&self) -> bool {
        false
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(BusComponentRandom::new(&self.component, self.bus, &self.axes, seed))
    }

    /// Only the bus, as for [`exercise`](Block::exercise).
    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(Changes::new(&self.shown()))
    }

    fn reach(&self) -> Box<dyn Reach + '_> {
        Box::new(InsideAStage::new(
            &self.instance,
            &self.axes,
            self.component.map(),
            FEW_TICKS_BARS,
        ))
    }

    /// Only the bus: the component's own row exercises its pins.
    fn exercise(&self) -> Option<Box<dyn Exercise + '_>> {
        Some(Box::new(Levels::new(&self.instance, &self.shown(), &[])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    #[test]
    fn the_bus_has_the_addresses_of_the_component() -> Result<(), Error> {
        let counter = Component::pulse_counter(DividerConfig::new(500).map_err(refused)?, 8, false).map_err(refused)?;
        for (bus, port, width) in [
            (BridgedBus::AxiLite, "s_axi_araddr", 10),
            (BridgedBus::Wishbone { pipelined: false }, "wb_adr", 8),
        ] {
            let block = BusComponentBlock::new(counter.clone(), bus, &[], ["top", "inner", "alone"]);
            let modules = block.modules().map_err(refused)?;
            let top = modules.last().ok_or_else(|| refused("no module"))?;
            let found = top.ports.iter().find(|found| found.name == port);
            assert_eq!(found.map(|found| found.width), Some(width), "{port}");
        }
        Ok(())
    }
}
