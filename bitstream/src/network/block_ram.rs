//! A block RAM whose ports have words of the same width.

use super::NetIndex;

/// A block RAM. A port that reads a word in the clock in which any port writes it reads the old one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlockRam {
    /// Its name in Verilog.
    pub name: String,
    /// Width of its words.
    pub bits: u32,
    /// Contents after configuration.
    pub contents: Vec<u64>,
    /// Its ports.
    pub ports: Vec<RamPort>,
}

/// A port of a block RAM.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RamPort {
    /// Its clock.
    pub clock: NetIndex,
    /// Nothing happens unless this is high.
    pub enable: NetIndex,
    /// Address, lowest bit first.
    pub address: Vec<NetIndex>,
    /// How it writes; `None` if it only reads.
    pub write: Option<RamWrite>,
    /// Outputs, lowest bit first, which keep their levels in a clock in which the port writes; none if it only writes.
    pub outputs: Vec<NetIndex>,
}

/// How a port of a block RAM writes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RamWrite {
    /// It writes while this is high.
    pub enable: NetIndex,
    /// Data, lowest bit first.
    pub data: Vec<NetIndex>,
    /// Enables of the parts of a word, each of as many bits as divide the word evenly; the lowest part comes first.
    pub parts: Vec<NetIndex>,
}

/// The state of a block RAM in a simulation.
#[derive(Debug, Clone)]
pub(super) struct BlockRamState {
    ram: BlockRam,
    words: Vec<u64>,
    /// What each port has read.
    read: Vec<u64>,
}

impl BlockRamState {
    pub(super) fn new(ram: &BlockRam) -> Self {
        Self {
            words: ram.contents.clone(),
            read: vec![0; ram.ports.len()],
            ram: ram.clone(),
        }
    }

    /// The nets of the ports' outputs and their levels.
    pub(super) fn outputs(&self) -> impl Iterator<Item = (NetIndex, bool)> + '_ {
        let ports = self.ram.ports.iter().zip(&self.read);
        ports.flat_map(|(port, read)| {
            let nets = port.outputs.iter().enumerate();
            nets.map(move |(bit, net)| (*net, read >> bit & 1 == 1))
        })
    }

    /// A rising edge of the clock.
    pub(super) fn clock(&mut self, level: &dyn Fn(NetIndex) -> bool) {
        let number = |nets: &[NetIndex]| {
            let bits = nets.iter().enumerate();
            bits.fold(0u64, |number, (bit, net)| number | u64::from(level(*net)) << bit)
        };
        let enabled = |port: &RamPort| level(port.enable);
        let writes = |port: &RamPort| {
            port.write
                .as_ref()
                .filter(|write| enabled(port) && level(write.enable))
                .cloned()
        };
        for (port, read) in self.ram.ports.iter().zip(&mut self.read) {
            if enabled(port) && writes(port).is_none() {
                *read = self.words[number(&port.address) as usize];
            }
        }
        for port in &self.ram.ports {
            let Some(write) = writes(port) else {
                continue;
            };
            let part_bits = self.ram.bits / write.parts.len().max(1) as u32;
            let parts = write.parts.iter().enumerate().filter(|(_, net)| level(**net));
            let mask = parts.fold(0u64, |mask, (part, _)| {
                mask | ((1 << part_bits) - 1) << (part_bits * part as u32)
            });
            let word = &mut self.words[number(&port.address) as usize];
            *word = *word & !mask | number(&write.data) & mask;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{HIGH, LOW};

    /// Address at nets 2 and 3, data at 4 to 7, enables of the halves at 8 and 9.
    #[test]
    fn halves_of_a_word_are_written_apart_and_old_words_are_read() {
        let write = RamWrite {
            enable: HIGH,
            data: vec![4, 5, 6, 7],
            parts: vec![8, 9],
        };
        let port = |write, outputs| RamPort {
            clock: LOW,
            enable: HIGH,
            address: vec![2, 3],
            write,
            outputs,
        };
        let ram = BlockRam {
            name: "ram".to_owned(),
            bits: 4,
            contents: vec![0, 0, 0, 0b0110],
            ports: vec![port(Some(write), vec![]), port(None, vec![10, 11, 12, 13])],
        };
        let mut state = BlockRamState::new(&ram);
        let mut clock = |high: &[NetIndex]| {
            state.clock(&|net| net == HIGH || high.contains(&net));
            state.read[1]
        };
        assert_eq!(clock(&[2, 3, 4, 5, 6, 7, 8]), 0b0110);
        assert_eq!(clock(&[2, 3]), 0b0111);
        assert_eq!(clock(&[2, 3, 9]), 0b0111);
        assert_eq!(clock(&[2, 3]), 0b0011);
        assert_eq!(clock(&[]), 0);
    }
}
