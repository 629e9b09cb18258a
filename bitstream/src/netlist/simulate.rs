//! Simulates the netlist of the bits: every cell once per clock, in the order of their dependence.

use super::{BitsNetlist, HIGH, LOW, MemoryCell, NetIndex};
use crate::BitstreamError;
use std::collections::HashMap;

/// The values of a majority of three inputs.
const MAJORITY: u16 = 0b1110_1000;
/// The values of a wire.
const WIRE: u16 = 0b10;

/// A cell without state: a table over at most four nets.
#[derive(Debug, Clone, Copy)]
struct Gate {
    output: NetIndex,
    inputs: [NetIndex; 4],
    table: u16,
}

#[derive(Debug, Clone, Copy)]
struct State {
    output: NetIndex,
    data: NetIndex,
    enable: NetIndex,
    reset: NetIndex,
    reset_to: bool,
}

/// A running simulation. All registers are 0 at first, as after configuration.
#[derive(Debug, Clone)]
pub struct NetlistSimulation {
    levels: Vec<bool>,
    gates: Vec<Gate>,
    states: Vec<State>,
    memories: Vec<Memory>,
    next: Vec<bool>,
    inputs: HashMap<String, NetIndex>,
    outputs: HashMap<String, NetIndex>,
}

impl NetlistSimulation {
    /// A simulation with one clock, at this pin.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] if a cell has another clock, or cells without state depend on themselves.
    pub fn new(netlist: &BitsNetlist, clock_pin: &str) -> Result<Self, BitstreamError> {
        let inputs: HashMap<String, NetIndex> = netlist.inputs.iter().cloned().collect();
        let clock = inputs.get(clock_pin).copied();
        let clock =
            clock.ok_or_else(|| BitstreamError::UnknownCell(format!("no input at the clock's pin {clock_pin}")))?;
        let table = |output, nets: &[NetIndex], table| {
            let mut inputs = [LOW; 4];
            inputs[..nets.len()].copy_from_slice(nets);
            Gate { output, inputs, table }
        };
        let mut gates: Vec<Gate> = netlist
            .luts
            .iter()
            .map(|lut| table(lut.output, &lut.inputs, lut.table))
            .collect();
        gates.extend(
            netlist
                .carries
                .iter()
                .map(|carry| table(carry.output, &carry.inputs, MAJORITY)),
        );
        gates.extend(
            netlist
                .joins
                .iter()
                .map(|(output, input)| table(*output, &[*input], WIRE)),
        );
        let mut states = Vec::new();
        for cell in &netlist.cells {
            match cell.flop {
                None => gates.push(table(cell.output, &[cell.data], WIRE)),
                Some(flop) if flop.clock == clock => states.push(State {
                    output: cell.output,
                    data: cell.data,
                    enable: flop.enable,
                    reset: flop.reset,
                    reset_to: flop.reset_to,
                }),
                Some(_) => {
                    return Err(BitstreamError::UnknownCell(format!("another clock at {}", cell.place)));
                }
            }
        }
        let has_clock = |memory: &MemoryCell| ["WCLK", "RCLK"].iter().all(|port| memory.port(port) == [clock]);
        if let Some(other) = netlist.memories.iter().find(|memory| !has_clock(memory)) {
            return Err(BitstreamError::UnknownCell(format!(
                "another clock at the memory {}",
                other.place
            )));
        }
        let mut levels = vec![false; netlist.names.len()];
        levels[HIGH as usize] = true;
        Ok(Self {
            next: vec![false; states.len()],
            levels,
            gates: in_order(gates)?,
            states,
            memories: netlist.memories.iter().map(Memory::new).collect(),
            inputs,
            outputs: netlist.outputs.iter().cloned().collect(),
        })
    }

    /// The net of an output pin.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] if the bits drive no such pin.
    pub fn output(&self, pin: &str) -> Result<NetIndex, BitstreamError> {
        let missing = || BitstreamError::UnknownCell(format!("the bits drive no pin {pin}"));
        self.outputs.get(pin).copied().ok_or_else(missing)
    }

    /// The net of an input pin.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] if the bits read no such pin.
    pub fn input(&self, pin: &str) -> Result<NetIndex, BitstreamError> {
        let missing = || BitstreamError::UnknownCell(format!("the bits read no pin {pin}"));
        self.inputs.get(pin).copied().ok_or_else(missing)
    }

    /// Sets the level of an input.
    pub fn set(&mut self, net: NetIndex, level: bool) {
        self.levels[net as usize] = level;
    }

    /// The level of a net after [`settle`](Self::settle).
    #[must_use]
    pub fn level(&self, net: NetIndex) -> bool {
        self.levels[net as usize]
    }

    /// Lets all levels follow the inputs and registers.
    pub fn settle(&mut self) {
        let levels = &mut self.levels;
        for gate in &self.gates {
            let [a, b, c, d] = gate.inputs.map(|net| u16::from(levels[net as usize]));
            levels[gate.output as usize] = gate.table >> (a | b << 1 | c << 2 | d << 3) & 1 == 1;
        }
    }

    /// A rising edge of the clock, after [`settle`](Self::settle).
    pub fn clock(&mut self) {
        let level = |net: NetIndex| self.levels[net as usize];
        for (next, state) in self.next.iter_mut().zip(&self.states) {
            *next = match (level(state.enable), level(state.reset)) {
                (false, _) => level(state.output),
                (true, true) => state.reset_to,
                (true, false) => level(state.data),
            };
        }
        for memory in &mut self.memories {
            memory.clock(&level);
        }
        for (next, state) in self.next.iter().zip(&self.states) {
            self.levels[state.output as usize] = *next;
        }
        for memory in &self.memories {
            for (bit, net) in memory.data_out.iter().enumerate() {
                self.levels[*net as usize] = memory.read_word >> bit & 1 == 1;
            }
        }
    }
}

/// The gates, each after those on which it depends.
fn in_order(gates: Vec<Gate>) -> Result<Vec<Gate>, BitstreamError> {
    let drivers: HashMap<NetIndex, usize> = gates
        .iter()
        .enumerate()
        .map(|(index, gate)| (gate.output, index))
        .collect();
    let mut waits = vec![0u32; gates.len()];
    let mut readers: Vec<Vec<usize>> = vec![Vec::new(); gates.len()];
    for (index, gate) in gates.iter().enumerate() {
        for driver in gate.inputs.iter().filter_map(|net| drivers.get(net)) {
            waits[index] += 1;
            readers[*driver].push(index);
        }
    }
    let mut ready: Vec<usize> = (0..gates.len()).filter(|index| waits[*index] == 0).collect();
    let mut next = 0;
    while let Some(index) = ready.get(next).copied() {
        next += 1;
        for reader in &readers[index] {
            waits[*reader] -= 1;
            if waits[*reader] == 0 {
                ready.push(*reader);
            }
        }
    }
    if ready.len() < gates.len() {
        return Err(BitstreamError::UnknownCell(
            "cells without state that depend on themselves".to_owned(),
        ));
    }
    Ok(ready.into_iter().map(|index| gates[index]).collect())
}

/// A block RAM. A word that is read while it is written is the old one.
#[derive(Debug, Clone)]
struct Memory {
    cell: MemoryCell,
    data_out: [NetIndex; 16],
    words: Vec<u16>,
    read_word: u16,
}

impl Memory {
    fn new(cell: &MemoryCell) -> Self {
        let mut data_out = [LOW; 16];
        data_out.copy_from_slice(cell.port("RDATA"));
        Self {
            data_out,
            words: cell.contents.clone(),
            read_word: 0,
            cell: cell.clone(),
        }
    }

    fn clock(&mut self, level: &dyn Fn(NetIndex) -> bool) {
        let word = |port: &str| {
            let nets = self.cell.port(port).iter().enumerate();
            nets.fold(0u16, |word, (bit, net)| word | u16::from(level(*net)) << bit)
        };
        let high = |port: &str| self.cell.port(port).first().is_some_and(|net| level(*net));
        if high("RE") && high("RCLKE") {
            let address = word("RADDR");
            let part = address >> 8;
            let stored = self.words[usize::from(address & 0xFF)];
            self.read_word = gathered(self.cell.read_mode, stored & !other_bits(self.cell.read_mode, part));
        }
        if high("WE") && high("WCLKE") {
            let address = word("WADDR");
            let kept = match self.cell.write_mode {
                0 => word("MASK"),
                mode => other_bits(mode, address >> 8),
            };
            let data = spread(self.cell.write_mode, word("WDATA"));
            let stored = &mut self.words[usize::from(address & 0xFF)];
            *stored = *stored & kept | data & !kept;
        }
    }
}

/// The bits of a word that a port of this mode leaves alone, by the upper bits of its address.
fn other_bits(mode: u8, part: u16) -> u16 {
    match mode {
        1 => !(0x5555 << (part & 1)),
        2 => !(0x1111 << (part & 3)),
        3 => !(0x0101 << (part & 7)),
        _ => 0,
    }
}

/// The wires of a narrow port, each at all the bits among which the address selects: of 8, 4 and 2 bits, the wires are
/// 0, 2, 4, …; 1, 5, 9, 13; and 3, 11.
fn spread(mode: u8, data: u16) -> u16 {
    let from = |bit: u32| match mode {
        1 => bit / 2 * 2,
        2 => bit / 4 * 4 + 1,
        3 => bit / 8 * 8 + 3,
        _ => bit,
    };
    (0..16).fold(0, |word, bit| word | (data >> from(bit) & 1) << bit)
}

/// The selected bits at the wires of a narrow port.
fn gathered(mode: u8, word: u16) -> u16 {
    let to = |bit: u32| match mode {
        1 => bit / 2 * 2,
        2 => bit / 4 * 4 + 1,
        3 => bit / 8 * 8 + 3,
        _ => bit,
    };
    (0..16).fold(0, |wires, bit| wires | (word >> bit & 1) << to(bit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_counter_of_one_bit_divides_the_clock() {
        let text = "module chip (input pin_1, output pin_2);\nreg n1 = 0;\n\
                    assign n2 = /* LUT 1 1 0 */ !n1;\n/* FF 1 1 0 */ always @(posedge pin_1) if (1'b1) n1 <= 1'b0 ? 1'b0 : n2;\n\
                    assign pin_2 = n1;\nendmodule\n";
        let netlist = BitsNetlist::read(text).unwrap();
        let mut simulation = NetlistSimulation::new(&netlist, "1").unwrap();
        let output = simulation.output("2").unwrap();
        let seen = [false, true, false, true].map(|_| {
            simulation.settle();
            let level = simulation.level(output);
            simulation.clock();
            level
        });
        assert_eq!(seen, [false, true, false, true]);
        assert!(NetlistSimulation::new(&netlist, "2").is_err());
    }

    #[test]
    fn cells_that_depend_on_themselves_are_refused() {
        let text = "module chip (input pin_1, output pin_2);\nassign pin_2 = /* LUT 1 1 0 */ !pin_2;\nendmodule\n";
        let netlist = BitsNetlist::read(text).unwrap();
        assert!(NetlistSimulation::new(&netlist, "1").is_err());
    }

    #[test]
    fn narrow_ports_of_a_memory_keep_their_words_apart() {
        for (mode, width, parts) in [(1u8, 8u32, 2u16), (2, 4, 4), (3, 2, 8)] {
            let step = 16 / width;
            let first = [0, 0, 1, 3][usize::from(mode)];
            let wire = |bit: u32| bit * step + first;
            let mut stored = 0u16;
            for part in 0..parts {
                let value = part.wrapping_mul(7) + 1;
                let data = (0..width).fold(0, |data, bit| data | (value >> bit & 1) << wire(bit));
                let kept = other_bits(mode, part);
                stored = stored & kept | spread(mode, data) & !kept;
            }
            for part in 0..parts {
                let value = part.wrapping_mul(7) + 1;
                let wires = gathered(mode, stored & !other_bits(mode, part));
                let read = (0..width).fold(0, |read, bit| read | (wires >> wire(bit) & 1) << bit);
                assert_eq!(read, value & ((1 << width) - 1), "mode {mode}, part {part}");
            }
        }
    }
}
