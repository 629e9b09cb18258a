//! The netlist of the bits in the form that is simulated: gates of at most four inputs, registers, and memories, of which the smallest are
//! gates whose table is written.

mod block_ram;
mod outputs;
mod simulate;
mod verilog;

pub use block_ram::{BlockRam, RamPort, RamWrite};
pub(crate) use outputs::OutputNets;
pub use simulate::NetlistSimulation;

use std::collections::HashSet;

use crate::ice40::MemoryCell;

/// A net. The first two are the constants.
pub type NetIndex = u32;
/// The net that is always 0.
pub const LOW: NetIndex = 0;
/// The net that is always 1.
pub const HIGH: NetIndex = 1;

/// A netlist.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Network {
    /// Names of the nets.
    pub names: Vec<String>,
    /// Pins that are inputs, with their nets.
    pub inputs: Vec<(String, NetIndex)>,
    /// Pins that are outputs, with their nets.
    pub outputs: Vec<(String, NetIndex)>,
    /// Cells without state, and those whose table is a memory.
    pub gates: Vec<Gate>,
    /// What writes into tables of gates.
    pub table_writes: Vec<TableWrite>,
    /// Registers.
    pub states: Vec<State>,
    /// Memories.
    pub memories: Vec<NetworkMemory>,
}

/// A memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NetworkMemory {
    /// A block RAM of iCE40.
    Ice40(MemoryCell),
    /// Any other.
    Plain(BlockRam),
}

impl NetworkMemory {
    /// Its clocks.
    pub fn clocks(&self) -> Vec<NetIndex> {
        match self {
            Self::Ice40(cell) => ["WCLK", "RCLK"]
                .iter()
                .flat_map(|port| cell.port(port).to_vec())
                .collect(),
            Self::Plain(ram) => ram.ports.iter().map(|port| port.clock).collect(),
        }
    }

    /// The nets that it drives.
    pub fn outputs(&self) -> Vec<NetIndex> {
        match self {
            Self::Ice40(cell) => cell.port("RDATA").to_vec(),
            Self::Plain(ram) => ram.ports.iter().flat_map(|port| port.outputs.clone()).collect(),
        }
    }

    /// Its name for errors.
    pub fn place(&self) -> String {
        match self {
            Self::Ice40(cell) => cell.place.to_string(),
            Self::Plain(ram) => ram.name.clone(),
        }
    }
}

impl Network {
    /// A network of the two constants alone.
    #[must_use]
    pub fn of_constants() -> Self {
        Self {
            names: vec!["low".to_owned(), "high".to_owned()],
            ..Self::default()
        }
    }

    /// Adds a net, which nothing drives yet.
    pub fn new_net(&mut self, name: String) -> NetIndex {
        let net = self.names.len() as NetIndex;
        self.names.push(name);
        net
    }

    /// The nets that an input, a gate, a register or a memory drives.
    #[must_use]
    pub fn driven(&self) -> HashSet<NetIndex> {
        let read = self.memories.iter().flat_map(NetworkMemory::outputs);
        (self.inputs.iter().map(|(_, net)| *net))
            .chain(self.gates.iter().map(|gate| gate.output))
            .chain(self.states.iter().map(|state| state.output))
            .chain(read)
            .collect()
    }
}

/// A cell without state: a table over at most four nets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Gate {
    /// Its output.
    pub output: NetIndex,
    /// Its inputs; those that it does not have are [`LOW`].
    pub inputs: [NetIndex; 4],
    /// Its values: bit `i` for inputs whose levels are the bits of `i`.
    pub table: u16,
}

/// A port that writes into the table of a gate at the rising edge of its clock: a bit of a distributed RAM, which the gate reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TableWrite {
    /// Output of the gate.
    pub output: NetIndex,
    /// Its clock.
    pub clock: NetIndex,
    /// Nothing is written while this is low.
    pub enable: NetIndex,
    /// The entry: the level of each net stands for that of the gate's input.
    pub address: [NetIndex; 4],
    /// The entry's new value.
    pub data: NetIndex,
}

/// A register at the rising edge of its clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct State {
    /// Its output.
    pub output: NetIndex,
    /// Its clock.
    pub clock: NetIndex,
    /// Its next value.
    pub data: NetIndex,
    /// Nothing is taken while this is low.
    pub enable: NetIndex,
    /// Sets or resets it while high.
    pub reset: NetIndex,
    /// Whether it does so at once, without waiting for the clock.
    pub is_asynchronous: bool,
    /// The value after that.
    pub reset_to: bool,
    /// Whether `enable` must be high for a reset, too.
    pub reset_needs_enable: bool,
    /// The value after configuration.
    pub initial: bool,
}

impl Gate {
    /// A gate of at most four inputs. Entries of the table that constant or equal inputs cannot select get the value of one that they can,
    /// so that equal functions of the same inputs are equal gates.
    #[must_use]
    pub fn new(output: NetIndex, nets: &[NetIndex], table: u16) -> Self {
        let mut inputs = [LOW; 4];
        inputs[..nets.len()].copy_from_slice(nets);
        let selected = |entry: usize| {
            (0..inputs.len()).fold(0, |selected, input| {
                let first = inputs.iter().position(|net| *net == inputs[input]).unwrap_or(input);
                let level = match inputs[input] {
                    LOW => 0,
                    HIGH => 1,
                    _ => entry >> first & 1,
                };
                selected | level << input
            })
        };
        let table = (0..16).fold(0, |values, entry| values | (table >> selected(entry) & 1) << entry);
        Self { output, inputs, table }
    }

    /// A choice: `low` while `select` is low, else `high`.
    #[must_use]
    pub fn choice(output: NetIndex, select: NetIndex, [low, high]: [NetIndex; 2]) -> Self {
        Self::new(output, &[select, low, high], 0b1110_0100)
    }

    /// The sum of a stage of a carry chain: the exclusive or of its function and the carry into it.
    #[must_use]
    pub fn sum(output: NetIndex, function: NetIndex, carry: NetIndex) -> Self {
        Self::new(output, &[function, carry], 0b0110)
    }

    /// The carry out of a stage of a carry chain: the carry into it while its function is high, else the entry of the table `generated` that
    /// the two inputs select.
    #[must_use]
    pub fn carry(
        output: NetIndex,
        (function, carry): (NetIndex, NetIndex),
        inputs: [NetIndex; 2],
        generated: u16,
    ) -> Self {
        let table = (0..16u16).fold(0, |values, index| {
            let generates = generated >> (index >> 2) & 1;
            let value = if index & 1 == 1 { index >> 1 & 1 } else { generates };
            values | value << index
        });
        Self::new(output, &[function, carry, inputs[0], inputs[1]], table)
    }

    /// A gate whose output is its input.
    #[must_use]
    pub fn wire(output: NetIndex, input: NetIndex) -> Self {
        Self::new(output, &[input], 0b10)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_of_two_stages_adds_two_bits() {
        let value = |gate: Gate, levels: &dyn Fn(NetIndex) -> u16| {
            let entry = gate.inputs.iter().rev().fold(0, |entry, net| entry << 1 | levels(*net));
            gate.table >> entry & 1
        };
        // The function is the exclusive or of a and b, and where that is low, a is the carry.
        let [function, carry, a, b, out] = [2, 3, 4, 5, 6];
        for case in 0..8u16 {
            let [of_a, of_b, of_carry] = [0, 1, 2].map(|bit| case >> bit & 1);
            let levels = |net: NetIndex| match net {
                2 => of_a ^ of_b,
                3 => of_carry,
                4 => of_a,
                5 => of_b,
                _ => 0,
            };
            let sum = value(Gate::sum(out, function, carry), &levels);
            let over = value(Gate::carry(out, (function, carry), [a, b], 0b1010), &levels);
            assert_eq!(2 * over + sum, of_a + of_b + of_carry, "{case:03b}");
            let chosen = value(Gate::choice(out, carry, [a, b]), &levels);
            assert_eq!(chosen, if of_carry == 1 { of_b } else { of_a });
        }
    }

    #[test]
    fn entries_that_cannot_be_selected_do_not_distinguish_gates() {
        let [out, a, b] = [2, 3, 4];
        let and = Gate::new(out, &[a, HIGH, b], 0b1100_1000);
        assert_eq!(
            and,
            Gate::new(out, &[a, HIGH, b], 0b1000_1000 | 0b0100_0000 | 0b0001_0000)
        );
        assert_ne!(and, Gate::new(out, &[a, HIGH, b], 0b1000_0000));
        // The same net twice: both bits are equal.
        assert_eq!(Gate::new(out, &[a, a], 0b1000), Gate::new(out, &[a, a], 0b1110));
        assert_eq!(Gate::wire(out, a).table, 0xAAAA);
    }
}
