//! The memory of the command FIFO, and the rules for writing to it.

use super::entry::{CUBIC, ENTRY_WORDS, Entry, MORE, POINT, RESERVED, TICK_BITS, too_wide};

/// Entries that are held: those that wait, those of a batch that is being written, and the one that plays.
pub const ENTRIES_MAX: u8 = 64;
const SLOTS: usize = ENTRIES_MAX as usize;

/// Result of writing a word.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Written {
    pub(super) refused: bool,
    pub(super) malformed: bool,
}

/// Pointers and what is known of the entry and the batch that are being written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Pointers {
    head: u8,
    level: u8,
    /// Entries of the batch that is being written, in the slots after those that wait.
    staged: u8,
    /// An entry of the batch was dropped: so is the rest of it.
    spoilt: bool,
    /// Words 0 to 2 of the entry were written.
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

    /// Drops all entries that wait, and the one that is being written; of a batch that has begun also what is still to come.
    pub(super) fn flush(&mut self) {
        self.pointers = Pointers {
            head: self.pointers.head,
            spoilt: self.pointers.spoilt || self.pointers.staged > 0,
            ..Pointers::default()
        };
    }

    /// Empties the FIFO and forgets a batch that has begun: the next entries start a new one.
    pub(super) fn begin_anew(&mut self) {
        self.pointers = Pointers {
            head: self.pointers.head,
            ..Pointers::default()
        };
    }

    /// Takes one word of the entry that is being written; word 3 commits it, or keeps it for its batch.
    pub(super) fn write(&mut self, word: u8, data: u32, closed: bool, plays: bool) -> Written {
        let pointers = &mut self.pointers;
        let before = (pointers.written, pointers.too_wide);
        let at = usize::from(word);
        let is_last = at == ENTRY_WORDS - 1;
        if is_last {
            (pointers.written, pointers.too_wide) = Default::default();
        }
        let more = data & MORE != 0;
        if closed || pointers.level + pointers.staged + u8::from(plays) == ENTRIES_MAX {
            if is_last {
                (pointers.staged, pointers.spoilt) = (0, more);
            }
            return Written {
                refused: true,
                malformed: false,
            };
        }
        let slot = pointers.head + pointers.level + pointers.staged;
        self.words[usize::from(slot % ENTRIES_MAX)][at] = data;
        if let Some(written) = pointers.written.get_mut(at) {
            *written = true;
            if at == 1 {
                pointers.too_wide = too_wide(data);
            }
            return Written::default();
        }
        let ([first, second, third], jerk_too_wide) = before;
        let complete = first
            && second
            && match data & (POINT | CUBIC) {
                0 => !jerk_too_wide,
                POINT | CUBIC => third,
                _ => false,
            };
        let ticks = data & ((1 << TICK_BITS) - 1);
        let malformed = !complete || ticks == 0 || data & RESERVED != 0 || pointers.spoilt;
        (pointers.staged, pointers.spoilt) = match (malformed, more) {
            (true, _) => (0, more),
            (false, true) => (pointers.staged + 1, false),
            (false, false) => {
                pointers.level += pointers.staged + 1;
                (0, false)
            }
        };
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
