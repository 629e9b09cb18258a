//! Registers behind a bridge, and requests for them.

use posicast_blocks::link::{Bus, MOST_WORDS, Request};

use super::random_inputs::Random;

/// Number of registers.
pub(crate) const REGISTERS: u16 = 64;

/// Registers that count their accesses.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Registers {
    pub(crate) words: [u32; REGISTERS as usize],
    pub(crate) accesses: u32,
}

impl Registers {
    pub(crate) const NEW: Self = Self {
        words: [0; REGISTERS as usize],
        accesses: 0,
    };
}

impl Bus for Registers {
    fn read(&mut self, address: u16) -> u32 {
        self.accesses += 1;
        self.words[usize::from(address)]
    }

    fn write(&mut self, address: u16, word: u32) {
        self.accesses += 1;
        self.words[usize::from(address)] = word;
    }
}

/// A request of any kind, for addresses inside and outside.
pub(crate) fn request(random: &mut Random) -> Request {
    let most = if random.below(8) == 0 { u64::from(MOST_WORDS) } else { 4 };
    let count = 1 + random.below(most) as u8;
    let address = random.below(u64::from(REGISTERS)) as u16;
    let words: Vec<u32> = (0..count)
        .map(|_| random.next() as u32 & random.next() as u32 & random.next() as u32)
        .collect();
    let places: Vec<u16> = (0..count).map(|_| random.below(u64::from(REGISTERS)) as u16).collect();
    match random.below(4) {
        0 => Request::Read { address, count },
        1 => Request::Write { address, words },
        2 => Request::ReadList(places),
        _ => Request::WriteList(places.into_iter().zip(words).collect()),
    }
}
