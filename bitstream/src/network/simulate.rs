//! Simulates a network clock by clock.
//!
//! The gates are in the order of their dependence, and only those gates and registers are evaluated whose inputs have changed. A register
//! whose inputs stay as they were in the clock before keeps its value: it holds it, takes the same data again, or is reset again.

use super::block_ram::BlockRamState;
use super::{Gate, HIGH, NetIndex, Network, NetworkMemory, State, TableWrite};
use crate::BitstreamError;
use crate::ice40::MemoryState;
use std::collections::{HashMap, HashSet};

/// A running simulation. All registers have the values that configuration gives them.
#[derive(Debug, Clone)]
pub struct NetlistSimulation {
    levels: Vec<bool>,
    gates: Vec<Gate>,
    /// The gates and registers that read each net, by their bits in `pending`.
    readers: Vec<Vec<u32>>,
    /// Gates whose inputs have changed, a bit each, and then, from the word `state_words` on, registers.
    pending: Vec<u64>,
    state_words: usize,
    states: Vec<State>,
    /// Those of them with an asynchronous reset.
    asynchronous: Vec<State>,
    /// Nets that change with the clock, and their levels after it; kept between clocks to save an allocation.
    next: Vec<(NetIndex, bool)>,
    memories: Vec<Memory>,
    /// What writes into tables, each with the index of its gate.
    table_writes: Vec<(usize, TableWrite)>,
    inputs: HashMap<String, NetIndex>,
    outputs: HashMap<String, NetIndex>,
}

/// A memory's state.
#[derive(Debug, Clone)]
enum Memory {
    Ice40(Box<MemoryState>),
    Plain(BlockRamState),
}

impl Memory {
    fn new(memory: &NetworkMemory) -> Self {
        match memory {
            NetworkMemory::Ice40(cell) => Self::Ice40(Box::new(MemoryState::new(cell))),
            NetworkMemory::Plain(ram) => Self::Plain(BlockRamState::new(ram)),
        }
    }

    /// A rising edge of the clock; adds the nets of its outputs with their levels to `next`.
    fn clock(&mut self, level: &dyn Fn(NetIndex) -> bool, next: &mut Vec<(NetIndex, bool)>) {
        match self {
            Self::Ice40(state) => {
                state.clock(level);
                next.extend(state.outputs());
            }
            Self::Plain(state) => {
                state.clock(level);
                next.extend(state.outputs());
            }
        }
    }
}

impl NetlistSimulation {
    /// A simulation with one clock, at this pin.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] if a cell has another clock, a net has two drivers, or gates depend on themselves.
    pub fn new(network: &Network, clock_pin: &str) -> Result<Self, BitstreamError> {
        let inputs: HashMap<String, NetIndex> = network.inputs.iter().cloned().collect();
        let clock = inputs.get(clock_pin).copied();
        let clock =
            clock.ok_or_else(|| BitstreamError::UnknownCell(format!("no input at the clock's pin {clock_pin}")))?;
        let name = |net: NetIndex| network.names.get(net as usize).map_or("", String::as_str);
        if let Some(other) = network.states.iter().find(|state| state.clock != clock) {
            return Err(BitstreamError::UnknownCell(format!(
                "another clock of {}",
                name(other.output)
            )));
        }
        if let Some(other) = network.table_writes.iter().find(|write| write.clock != clock) {
            return Err(BitstreamError::UnknownCell(format!(
                "another clock of the distributed RAM {}",
                name(other.output)
            )));
        }
        let has_clock = |memory: &NetworkMemory| memory.clocks().iter().all(|net| *net == clock);
        if let Some(other) = network.memories.iter().find(|memory| !has_clock(memory)) {
            return Err(BitstreamError::UnknownCell(format!(
                "another clock at the memory {}",
                other.place()
            )));
        }
        let mut driven: HashSet<NetIndex> = inputs.values().copied().collect();
        let gates = network.gates.iter().map(|gate| gate.output);
        let states = network.states.iter().map(|state| state.output);
        let memories = network.memories.iter().flat_map(NetworkMemory::outputs);
        if let Some(twice) = gates.chain(states).chain(memories).find(|net| !driven.insert(*net)) {
            return Err(BitstreamError::UnknownCell(format!("{} has two drivers", name(twice))));
        }
        let mut levels = vec![false; network.names.len()];
        levels[HIGH as usize] = true;
        for state in &network.states {
            levels[state.output as usize] = state.initial;
        }
        let gates = in_order(&network.gates)?;
        let table_writes = network.table_writes.iter().map(|write| {
            let gate = gates.iter().position(|gate| gate.output == write.output);
            let missing = || BitstreamError::UnknownCell(format!("no table at {}", name(write.output)));
            Ok((gate.ok_or_else(missing)?, *write))
        });
        let table_writes = table_writes.collect::<Result<Vec<_>, BitstreamError>>()?;
        let mut readers = vec![Vec::new(); network.names.len()];
        for (index, gate) in gates.iter().enumerate() {
            for net in gate.inputs {
                readers[net as usize].push(index as u32);
            }
        }
        let state_words = gates.len().div_ceil(64);
        for (index, state) in network.states.iter().enumerate() {
            for net in [state.data, state.enable, state.reset] {
                readers[net as usize].push((64 * state_words + index) as u32);
            }
        }
        // At first, everything has to be evaluated.
        let pending = [gates.len(), network.states.len()].into_iter().flat_map(all_bits);
        Ok(Self {
            pending: pending.collect(),
            state_words,
            next: Vec::new(),
            levels,
            gates,
            readers,
            states: network.states.clone(),
            asynchronous: network
                .states
                .iter()
                .filter(|state| state.is_asynchronous)
                .copied()
                .collect(),
            memories: network.memories.iter().map(Memory::new).collect(),
            table_writes,
            inputs,
            outputs: network.outputs.iter().cloned().collect(),
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
        if self.levels[net as usize] != level {
            self.levels[net as usize] = level;
            for reader in &self.readers[net as usize] {
                self.pending[*reader as usize / 64] |= 1 << (reader % 64);
            }
        }
    }

    /// The level of a net after [`settle`](Self::settle).
    #[must_use]
    pub fn level(&self, net: NetIndex) -> bool {
        self.levels[net as usize]
    }

    /// Lets all levels follow the inputs and registers.
    pub fn settle(&mut self) {
        self.settle_gates();
        // Each register changes at most once: it has then the value of its reset.
        while let Some(state) = self
            .asynchronous
            .iter()
            .copied()
            .find(|state| self.levels[state.reset as usize] && self.levels[state.output as usize] != state.reset_to)
        {
            self.set(state.output, state.reset_to);
            self.settle_gates();
        }
    }

    fn settle_gates(&mut self) {
        for word in 0..self.state_words {
            // A gate is read only by those that come after it, perhaps in the same word.
            while self.pending[word] != 0 {
                let bit = self.pending[word].trailing_zeros();
                self.pending[word] &= self.pending[word] - 1;
                let gate = self.gates[64 * word + bit as usize];
                let [a, b, c, d] = gate.inputs.map(|net| u16::from(self.levels[net as usize]));
                self.set(gate.output, gate.table >> (a | b << 1 | c << 2 | d << 3) & 1 == 1);
            }
        }
    }

    /// A rising edge of the clock, after [`settle`](Self::settle).
    pub fn clock(&mut self) {
        let level = |net: NetIndex| self.levels[net as usize];
        let mut next = std::mem::take(&mut self.next);
        for (word, pending) in self.pending[self.state_words..].iter_mut().enumerate() {
            while *pending != 0 {
                let state = &self.states[64 * word + pending.trailing_zeros() as usize];
                *pending &= *pending - 1;
                let is_enabled = level(state.enable);
                if level(state.reset) && (is_enabled || !state.reset_needs_enable) {
                    next.push((state.output, state.reset_to));
                } else if is_enabled {
                    next.push((state.output, level(state.data)));
                }
            }
        }
        for memory in &mut self.memories {
            memory.clock(&level, &mut next);
        }
        for (gate, write) in &self.table_writes {
            if level(write.enable) {
                let address = write.address.iter().rev();
                let entry = address.fold(0, |entry, net| entry << 1 | u16::from(level(*net)));
                let table = &mut self.gates[*gate].table;
                *table = *table & !(1 << entry) | u16::from(level(write.data)) << entry;
                self.pending[gate / 64] |= 1 << (gate % 64);
            }
        }
        for (net, level) in next.drain(..) {
            self.set(net, level);
        }
        self.next = next;
    }
}

/// Words in which this many bits are set, the lowest first.
fn all_bits(count: usize) -> impl Iterator<Item = u64> {
    (0..count.div_ceil(64)).map(move |word| match count - 64 * word {
        64.. => u64::MAX,
        rest => (1 << rest) - 1,
    })
}

/// The gates, each after those on which it depends.
fn in_order(gates: &[Gate]) -> Result<Vec<Gate>, BitstreamError> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ice40::IceboxNetlist;

    #[test]
    fn a_counter_of_one_bit_divides_the_clock() {
        let text = "module chip (input pin_1, output pin_2);\nreg n1 = 0;\n\
                    assign n2 = /* LUT 1 1 0 */ !n1;\n/* FF 1 1 0 */ always @(posedge pin_1) if (1'b1) n1 <= 1'b0 ? 1'b0 : n2;\n\
                    assign pin_2 = n1;\nendmodule\n";
        let netlist = IceboxNetlist::read(text).unwrap();
        let mut simulation = NetlistSimulation::new(&netlist.network(), "1").unwrap();
        let output = simulation.output("2").unwrap();
        let seen = [false, true, false, true].map(|_| {
            simulation.settle();
            let level = simulation.level(output);
            simulation.clock();
            level
        });
        assert_eq!(seen, [false, true, false, true]);
        assert!(NetlistSimulation::new(&netlist.network(), "2").is_err());
    }

    #[test]
    fn an_asynchronous_reset_acts_before_the_clock() {
        let [clock, reset, output, shown] = [2, 3, 4, 5];
        let state = State {
            output,
            clock,
            data: HIGH,
            enable: HIGH,
            reset,
            is_asynchronous: true,
            reset_to: false,
            reset_needs_enable: false,
            initial: false,
        };
        let network = Network {
            names: ["low", "high", "clock", "reset", "output", "shown"]
                .map(str::to_owned)
                .to_vec(),
            inputs: vec![("1".to_owned(), clock), ("2".to_owned(), reset)],
            outputs: vec![("3".to_owned(), shown)],
            gates: vec![Gate::wire(shown, output)],
            states: vec![state],
            table_writes: vec![],
            memories: vec![],
        };
        let mut simulation = NetlistSimulation::new(&network, "1").unwrap();
        let mut clock = |level| {
            simulation.set(reset, level);
            simulation.settle();
            let seen = simulation.level(shown);
            simulation.clock();
            seen
        };
        assert_eq!(
            [false, false, true, false, false].map(&mut clock),
            [false, true, false, false, true]
        );
    }

    /// Nets 3 to 6 address what is read, 7 to 10 what is written.
    #[test]
    fn a_table_is_written_at_the_clock_and_read_at_once() {
        let [clock, output, enable, data] = [2, 11, 12, 13];
        let network = Network {
            names: (0..14).map(|net| format!("n{net}")).collect(),
            inputs: [2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 13]
                .map(|net: NetIndex| (net.to_string(), net))
                .to_vec(),
            outputs: vec![("q".to_owned(), output)],
            gates: vec![Gate::new(output, &[3, 4, 5, 6], 0b0100)],
            table_writes: vec![TableWrite {
                output,
                clock,
                enable,
                address: [7, 8, 9, 10],
                data,
            }],
            ..Network::default()
        };
        let mut simulation = NetlistSimulation::new(&network, "2").unwrap();
        let mut step = |read: usize, written: Option<(usize, bool)>| {
            for (bit, net) in (3..7).enumerate() {
                simulation.set(net, read >> bit & 1 == 1);
            }
            let (entry, level) = written.unwrap_or((read, true));
            for (bit, net) in (7..11).enumerate() {
                simulation.set(net, entry >> bit & 1 == 1);
            }
            simulation.set(enable, written.is_some());
            simulation.set(data, level);
            simulation.settle();
            let level = simulation.level(output);
            simulation.clock();
            level
        };
        assert!(step(2, None) && !step(4, None));
        // What is read in the clock of a write is the old entry; another entry is not touched.
        assert!(!step(13, Some((13, true))));
        assert!(step(13, None) && !step(11, None) && step(2, Some((2, false))));
        assert!(!step(2, None) && step(13, None));
    }

    #[test]
    fn a_net_with_two_drivers_is_refused() {
        let text = "module chip (input pin_1, output pin_2);\nassign pin_2 = /* LUT 1 1 0 */ !pin_1;\nassign pin_2 = pin_1;\nendmodule\n";
        let netlist = IceboxNetlist::read(text).unwrap();
        let error = NetlistSimulation::new(&netlist.network(), "1").unwrap_err().to_string();
        assert!(error.ends_with("pin_2 has two drivers"), "{error}");
    }

    #[test]
    fn cells_that_depend_on_themselves_are_refused() {
        let text = "module chip (input pin_1, output pin_2);\nassign pin_2 = /* LUT 1 1 0 */ !pin_2;\nendmodule\n";
        let netlist = IceboxNetlist::read(text).unwrap();
        assert!(NetlistSimulation::new(&netlist.network(), "1").is_err());
    }
}
