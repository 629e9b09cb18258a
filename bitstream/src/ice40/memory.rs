//! Simulates a block RAM of iCE40.

use super::netlist::MemoryCell;
use crate::network::{LOW, NetIndex};

/// A block RAM. A word that is read while it is written is the old one.
#[derive(Debug, Clone)]
pub(crate) struct MemoryState {
    cell: MemoryCell,
    data_out: [NetIndex; 16],
    words: Vec<u16>,
    read_word: u16,
}

impl MemoryState {
    pub(crate) fn new(cell: &MemoryCell) -> Self {
        let mut data_out = [LOW; 16];
        data_out.copy_from_slice(cell.port("RDATA"));
        Self {
            data_out,
            words: cell.contents.clone(),
            read_word: 0,
            cell: cell.clone(),
        }
    }

    /// A rising edge of the clock.
    pub(crate) fn clock(&mut self, level: &dyn Fn(NetIndex) -> bool) {
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

    /// The nets of the read port and their levels.
    pub(crate) fn outputs(&self) -> impl Iterator<Item = (NetIndex, bool)> + '_ {
        let nets = self.data_out.iter().enumerate();
        nets.map(|(bit, net)| (*net, self.read_word >> bit & 1 == 1))
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

/// The wire of a port of this mode that belongs to a bit of the word: of 8, 4 and 2 bits, the wires are 0, 2, 4, …; 1, 5, 9, 13; and
/// 3, 11.
fn wire_of(mode: u8, bit: u32) -> u32 {
    match mode {
        1 => bit / 2 * 2,
        2 => bit / 4 * 4 + 1,
        3 => bit / 8 * 8 + 3,
        _ => bit,
    }
}

/// The wires of a port, each at all the bits among which the address selects.
fn spread(mode: u8, data: u16) -> u16 {
    (0..16).fold(0, |word, bit| word | (data >> wire_of(mode, bit) & 1) << bit)
}

/// The selected bits at the wires of a port.
fn gathered(mode: u8, word: u16) -> u16 {
    (0..16).fold(0, |wires, bit| wires | (word >> bit & 1) << wire_of(mode, bit))
}

#[cfg(test)]
mod tests {
    use super::*;

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
