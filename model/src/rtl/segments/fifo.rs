//! The memory of the command FIFO, and the rules for writing to it.

use super::entry::{ENTRY_WORDS, Entry, POINT, RESERVED, TICK_BITS, too_wide};

/// Largest number of entries held: those that wait, and the one being played.
pub const ENTRIES_MAX: u8 = 64;
const SLOTS: usize = ENTRIES_MAX as usize;

/// Result of writing a word.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Written {
    pub(super) refused: bool,
    pub(super) malformed: bool,
}

/// Pointers of the FIFO, and the state of the entry being written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Pointers {
    head: u8,
    tail: u8,
    level: u8,
    /// Whether words 0, 1 and 2 of the entry were written.
    written: [bool; ENTRY_WORDS - 1],
    /// Whether word 1 is not a sign extension of 8 bits.
    too_wide: bool,
}

/// Memory and pointers.
pub(super) struct Fifo {
    words: [[u32; ENTRY_WORDS]; SLOTS],
    pub(super) pointers: Pointers,
}

impl Fifo {
    pub(super) fn new(seed: u64) -> Self {
        let word = |slot: usize, word: usize| {
            let place = seed.wrapping_add((slot * ENTRY_WORDS + word) as u64 + 1);
            (place.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as u32
        };
        Self {
            words: std::array::from_fn(|slot| std::array::from_fn(|at| word(slot, at))),
            pointers: Pointers::default(),
        }
    }

    pub(super) fn level(&self) -> u8 {
        self.pointers.level
    }

    /// Drops all entries; the memory keeps its contents.
    pub(super) fn reset(&mut self) {
        self.pointers = Pointers::default();
    }

    /// Drops all waiting entries, and the one being written.
    pub(super) fn flush(&mut self) {
        self.pointers = Pointers {
            head: self.pointers.head,
            tail: self.pointers.head,
            ..Pointers::default()
        };
    }

    /// Writes one word of an entry; word 3 commits it.
    pub(super) fn write(&mut self, word: u8, data: u32, closed: bool, plays: bool) -> Written {
        let pointers = &mut self.pointers;
        let before = (pointers.written, pointers.too_wide);
        let at = usize::from(word);
        let is_last = at == ENTRY_WORDS - 1;
        if is_last {
            (pointers.written, pointers.too_wide) = Default::default();
        }
        if closed || pointers.level + u8::from(plays) == ENTRIES_MAX {
            return Written {
                refused: true,
                malformed: false,
            };
        }
        self.words[usize::from(pointers.tail)][at] = data;
        if let Some(written) = pointers.written.get_mut(at) {
            *written = true;
            if at == 1 {
                pointers.too_wide = too_wide(data);
            }
            return Written::default();
        }
        let ([first, second, third], jerk_too_wide) = before;
        let complete = if data & POINT != 0 {
            first && second && third
        } else {
            first && second && !jerk_too_wide
        };
        let ticks = data & ((1 << TICK_BITS) - 1);
        let malformed = !complete || ticks == 0 || data & RESERVED != 0;
        if !malformed {
            pointers.tail = (pointers.tail + 1) % ENTRIES_MAX;
            pointers.level += 1;
        }
        Written {
            refused: false,
            malformed,
        }
    }

    /// Takes out the oldest entry, which must exist.
    pub(super) fn pop(&mut self) -> Entry {
        let pointers = &mut self.pointers;
        let slot = usize::from(pointers.head);
        pointers.head = (pointers.head + 1) % ENTRIES_MAX;
        pointers.level -= 1;
        Entry::from_words(&self.words[slot])
    }
}
