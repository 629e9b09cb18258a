//! The netlist of the bits, as icebox_vlog decodes it.
//!
//! icebox_vlog knows what each bit of the device's tiles connects and sets. Its Verilog is regular, with the place of each cell in a
//! comment; [`IceboxNetlist::read`] takes exactly that form, and refuses anything else by its line.

use crate::network::{Gate, NetIndex, Network, NetworkMemory, State};
use std::collections::HashMap;
use std::fmt;

/// Words of a block RAM.
pub const MEMORY_WORDS: usize = 256;

/// A logic cell: column, row, and index in its tile; of a memory the index is 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CellPlace {
    /// Column of the tile.
    pub x: u8,
    /// Row of the tile.
    pub y: u8,
    /// Index of the cell in its tile.
    pub cell: u8,
}

impl fmt::Display for CellPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "X{}/Y{}/{}", self.x, self.y, self.cell)
    }
}

/// A look-up table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LutCell {
    /// Its cell.
    pub place: CellPlace,
    /// Its output, before a flip-flop.
    pub output: NetIndex,
    /// The nets on which it depends, at most four.
    pub inputs: Vec<NetIndex>,
    /// Its values: bit `i` for inputs whose levels are the bits of `i`.
    pub table: u16,
}

/// The output of a logic cell: of its flip-flop, or of its look-up table past the flip-flop.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellOutput {
    /// Its cell.
    pub place: CellPlace,
    /// The net.
    pub output: NetIndex,
    /// The output of the look-up table.
    pub data: NetIndex,
    /// The flip-flop, if it is in use.
    pub flop: Option<Flop>,
}

/// A flip-flop with enable and synchronous set or reset, at the rising edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Flop {
    /// Its clock.
    pub clock: NetIndex,
    /// Nothing changes while this is low.
    pub enable: NetIndex,
    /// Sets or resets it while high.
    pub reset: NetIndex,
    /// The value after that.
    pub reset_to: bool,
}

/// A carry: the majority of its inputs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CarryCell {
    /// Its cell.
    pub place: CellPlace,
    /// Its output.
    pub output: NetIndex,
    /// The two inputs from the cell, and the carry below.
    pub inputs: [NetIndex; 3],
}

/// A block RAM with its write and its read port, both at the rising edge.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemoryCell {
    /// Its lower tile.
    pub place: CellPlace,
    /// Mode of the write port: 0 to 3 for words of 16, 8, 4 and 2 bits.
    pub write_mode: u8,
    /// Mode of the read port.
    pub read_mode: u8,
    /// Contents after configuration.
    pub contents: Vec<u16>,
    /// Connections by port; the lowest bit comes first.
    pub ports: HashMap<String, Vec<NetIndex>>,
}

impl MemoryCell {
    /// The nets of a port, lowest bit first; none if there is no such port.
    #[must_use]
    pub fn port(&self, name: &str) -> &[NetIndex] {
        self.ports.get(name).map_or(&[], Vec::as_slice)
    }
}

/// The netlist of the bits.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct IceboxNetlist {
    /// Names of the nets.
    pub names: Vec<String>,
    /// Pins that are inputs, with their nets.
    pub inputs: Vec<(String, NetIndex)>,
    /// Pins that are outputs, with their nets.
    pub outputs: Vec<(String, NetIndex)>,
    /// Look-up tables.
    pub luts: Vec<LutCell>,
    /// Outputs of logic cells.
    pub cells: Vec<CellOutput>,
    /// Carries.
    pub carries: Vec<CarryCell>,
    /// Memories.
    pub memories: Vec<MemoryCell>,
    /// Nets that are another net.
    pub joins: Vec<(NetIndex, NetIndex)>,
}

/// The values of a majority of three inputs.
const MAJORITY: u16 = 0b1110_1000;

impl IceboxNetlist {
    /// The same netlist in the form that is simulated.
    #[must_use]
    pub fn network(&self) -> Network {
        let luts = self
            .luts
            .iter()
            .map(|lut| Gate::new(lut.output, &lut.inputs, lut.table));
        let carries = self
            .carries
            .iter()
            .map(|carry| Gate::new(carry.output, &carry.inputs, MAJORITY));
        let joins = self.joins.iter().map(|(output, input)| Gate::wire(*output, *input));
        let mut gates: Vec<Gate> = luts.chain(carries).chain(joins).collect();
        let mut states = Vec::new();
        for cell in &self.cells {
            match cell.flop {
                None => gates.push(Gate::wire(cell.output, cell.data)),
                Some(flop) => states.push(State {
                    output: cell.output,
                    clock: flop.clock,
                    data: cell.data,
                    enable: flop.enable,
                    reset: flop.reset,
                    is_asynchronous: false,
                    reset_to: flop.reset_to,
                    reset_needs_enable: true,
                    initial: false,
                }),
            }
        }
        Network {
            names: self.names.clone(),
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
            gates,
            states,
            table_writes: Vec::new(),
            memories: self.memories.iter().cloned().map(NetworkMemory::Ice40).collect(),
        }
    }
}
