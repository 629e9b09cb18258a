//! A component whose registers are on AXI4-Lite or Wishbone: the component with its bridge.
//!
//! ```text
//!              ┌─────────────────┐ avm_*      avs_* ┌───────────┐
//! s_axi_*  ─►  │ axi_lite_bridge ├────────────────► │ component ├─► pins, irq
//! or wb_*  ◄─  │ wishbone_bridge │ ◄─ avm_mapped    │           │ ◄─
//!              └─────────────────┘                  └───────────┘
//! ```
//!
//! `avm_mapped` is a function of the address: whether the register map has a word there. Everything else is that of
//! [`axi_lite_bridge`], [`wishbone_bridge`] and the component; the datasheets are theirs.
//!
//! | ports | |
//! |---|---|
//! | `rst`, and `s_axi_*` or `wb_*` | the bridge's; addresses are as wide as the component has words |
//! | `irq`, all pins | the component's; not its bus |

use super::axi_lite_bridge::{self, AxiLiteBridge};
use super::bridged::{self, Bridged};
use super::component::Component;
use super::composition::Composed;
use super::registers::RegisterMap;
use super::wishbone_bridge::{self, WishboneBridge};
use super::{ClockedBlock, Direction, Port, StepError};

/// Prefix of the ports between bridge and component.
pub const INNER_PREFIX: &str = "avm_";

/// A bus that a bridge leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BridgedBus {
    /// AXI4-Lite, 32 bits.
    AxiLite,
    /// Wishbone B4, 32 bits, classic or pipelined.
    Wishbone {
        /// Whether every clock of a request is another one. The Verilog has a parameter for it.
        pipelined: bool,
    },
}

impl BridgedBus {
    /// Name of the bridge.
    pub fn block(self) -> &'static str {
        match self {
            Self::AxiLite => "axi_lite_bridge",
            Self::Wishbone { .. } => "wishbone_bridge",
        }
    }

    /// Name of the bus in a sentence.
    pub fn title(self) -> &'static str {
        match self {
            Self::AxiLite => "AXI4-Lite",
            Self::Wishbone { pipelined: false } => "Wishbone",
            Self::Wishbone { pipelined: true } => "pipelined Wishbone",
        }
    }

    /// End of the name of a top module on this bus.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::AxiLite => "axi",
            Self::Wishbone { .. } => "wishbone",
        }
    }

    /// The ports of the bridge: inputs, then outputs.
    pub fn bridge_ports(self) -> Vec<Port> {
        match self {
            Self::AxiLite => axi_lite_bridge::ports(),
            Self::Wishbone { .. } => wishbone_bridge::ports(),
        }
    }

    /// Number of outputs of the bridge to the bus, its first ones.
    pub fn bus_outputs(self) -> usize {
        let ports = self.bridge_ports();
        let outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        outputs.count() - INNER_OUTPUTS
    }

    /// The constant inputs of the bridge, with their values.
    pub fn constants(self) -> Vec<(&'static str, bool)> {
        match self {
            Self::AxiLite => Vec::new(),
            Self::Wishbone { pipelined } => vec![("pipelined", pipelined)],
        }
    }

    /// The ports of the bus of a component with addresses of so many bits: an AXI4-Lite address counts bytes.
    fn ports(self, address_bits: u32) -> Vec<Port> {
        let constants = self.constants();
        let mut ports = self.bridge_ports();
        ports.retain(|port| {
            let inner = port.name.starts_with(INNER_PREFIX) || port.name == "rst";
            !inner && constants.iter().all(|(name, _)| *name != port.name)
        });
        for port in &mut ports {
            port.width = match port.name.as_str() {
                "s_axi_awaddr" | "s_axi_araddr" => address_bits + 2,
                "wb_adr" => address_bits,
                _ => port.width,
            };
        }
        ports
    }
}

/// The ports of a component on a bus: inputs, then outputs.
pub fn ports(component: &Component, bus: BridgedBus) -> Vec<Port> {
    bridged::ports(component, bus.ports(component.map().address_bits()))
}

/// The words that have a register: pairs of the first and the last offset, in ascending order, not adjacent.
pub fn mapped(map: &RegisterMap) -> Vec<(u32, u32)> {
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for register in map.registers() {
        let end = register.offset + register.words() - 1;
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 >= register.offset => *last = end,
            _ => ranges.push((register.offset, end)),
        }
    }
    ranges
}

enum Bridge {
    AxiLite(AxiLiteBridge),
    Wishbone(WishboneBridge, bool),
}

impl Bridge {
    fn new(bus: BridgedBus) -> Self {
        match bus {
            BridgedBus::AxiLite => Self::AxiLite(AxiLiteBridge::new()),
            BridgedBus::Wishbone { pipelined } => Self::Wishbone(WishboneBridge::new(), pipelined),
        }
    }

    /// The outputs in this clock: those of the bus, then [`INNER_OUTPUTS`].
    fn shown(&self) -> Vec<u64> {
        match self {
            Self::AxiLite(bridge) => bridge.outputs().to_raw().to_vec(),
            Self::Wishbone(bridge, _) => bridge.outputs().to_raw().to_vec(),
        }
    }

    /// Simulates a clock with these inputs of the bus.
    fn step(&mut self, rst: bool, bus: &[u64], avm_readdata: u32, avm_mapped: bool) {
        let inner = [avm_readdata.into(), avm_mapped.into()];
        match self {
            Self::AxiLite(bridge) => {
                let raw = row([&[rst.into()], bus, &inner]);
                bridge.step(&axi_lite_bridge::Inputs::from_raw(&raw));
            }
            Self::Wishbone(bridge, pipelined) => {
                let raw = row([&[rst.into(), (*pipelined).into()], bus, &inner]);
                bridge.step(&wishbone_bridge::Inputs::from_raw(&raw));
            }
        }
    }
}

/// These values one after the other.
fn row<const N: usize>(parts: [&[u64]; 3]) -> [u64; N] {
    let mut values = parts.into_iter().flatten().copied();
    std::array::from_fn(|_| values.next().unwrap_or(0))
}

/// The last outputs of a bridge: address, read, write, byteenable and writedata, as the component's bus has them.
const INNER_OUTPUTS: usize = 5;

/// The cycle-accurate model.
pub struct BusComponent {
    bridge: Bridge,
    /// Number of inputs of the bus.
    bus_inputs: usize,
    component: Bridged,
    ports: Vec<Port>,
    mapped: Vec<(u32, u32)>,
}

impl BusComponent {
    /// A component after reset. `seed` determines the arbitrary contents of memories.
    pub fn new(component: &Component, bus: BridgedBus, seed: u64) -> Self {
        let of_bus = bus.ports(component.map().address_bits());
        Self {
            bridge: Bridge::new(bus),
            bus_inputs: of_bus.iter().filter(|port| port.direction == Direction::Input).count(),
            component: Bridged::new(component, seed),
            ports: ports(component, bus),
            mapped: mapped(component.map()),
        }
    }
}

impl ClockedBlock for BusComponent {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let wrong = || StepError(format!("{} inputs and {} outputs", inputs.len(), outputs.len()));
        let [rst, rest @ ..] = inputs else {
            return Err(wrong());
        };
        let rst = *rst & 1 != 0;
        let shown = self.bridge.shown();
        let (of_bus, access) = shown.split_last_chunk::<INNER_OUTPUTS>().ok_or_else(wrong)?;
        let (bus, pins) = rest.split_at_checked(self.bus_inputs).ok_or_else(wrong)?;
        if outputs.len() < of_bus.len() {
            return Err(wrong());
        }
        let (to_bus, to_pins) = outputs.split_at_mut(of_bus.len());
        let read_data = self.component.step(rst, *access, pins, to_pins)?;
        to_bus.copy_from_slice(of_bus);
        let address = access[0] as u32;
        let mut mapped = self.mapped.iter();
        let mapped = mapped.any(|(first, last)| (*first..=*last).contains(&address));
        self.bridge.step(rst, bus, read_data, mapped);
        Ok(())
    }

    fn composed(&self) -> Option<&Composed> {
        Some(self.component.composed())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::divider::DividerConfig;
    use crate::registers::Register;

    #[test]
    fn neighbours_are_one_range() {
        let component = Component::pulse_counter(DividerConfig::new(500).unwrap(), 8, false).unwrap();
        let map = component.map();
        let ranges = mapped(map);
        let words: u32 = ranges.iter().map(|(first, last)| last - first + 1).sum();
        assert_eq!(words, map.registers().iter().map(Register::words).sum::<u32>());
        assert!(ranges.windows(2).all(|pair| pair[0].1 + 1 < pair[1].0));
    }

    #[test]
    fn the_magic_word_is_read_through_either_bridge() {
        let component = Component::pulse_counter(DividerConfig::new(500).unwrap(), 8, false).unwrap();
        let magic = u64::from(component.map().register("magic").unwrap().reset());
        for (bus, request, answer) in [
            (BridgedBus::AxiLite, vec!["s_axi_arvalid"], "s_axi_rdata"),
            (
                BridgedBus::Wishbone { pipelined: true },
                vec!["wb_cyc", "wb_stb"],
                "wb_dat_r",
            ),
        ] {
            let mut model = BusComponent::new(&component, bus, 1);
            let place = |wanted: Direction, name: &str| {
                let ports = model.ports().iter().filter(|port| port.direction == wanted);
                ports.clone().position(|port| port.name == name).unwrap()
            };
            let requests: Vec<usize> = request.iter().map(|name| place(Direction::Input, name)).collect();
            let answer = place(Direction::Output, answer);
            let mut inputs = vec![0; model.ports().iter().filter(|p| p.direction == Direction::Input).count()];
            let mut outputs = vec![0; model.ports().len() - inputs.len()];
            let mut found = Vec::new();
            for clock in 0..8 {
                requests
                    .iter()
                    .for_each(|request| inputs[*request] = u64::from(clock >= 1));
                model.step(&inputs, &mut outputs).unwrap();
                found.push(outputs[answer]);
            }
            assert_eq!(found[7], magic, "{bus:?}");
        }
    }
}
