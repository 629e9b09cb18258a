//! Packed changes of a period of time, passed from the thread that reads to the one that compares.
//!
//! ```text
//!  steps    time 0, ends at 3, words at 2 │ time 5, ends at 4, words at 2, edge │ …    all that happens at one time is one step
//!  changes  slot, bit │ slot, known word │ slot, bit ║ slot, words ║ …                 four bytes each
//!  words                bits                            bits, unknown bits             in the order of their changes
//! ```
//!
//! Most changes are single bits, and most others are known vectors of at most 64 bits. Passing a change between threads costs as much as
//! processing it, so each takes only a few bytes.

use crate::pile::Pile;

/// Place of a step to which reading cannot return.
pub(crate) const NOWHERE: u64 = u64::MAX;

/// All changes at one time.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Step {
    /// Time in the file's unit.
    pub(crate) time: u64,
    /// Byte of the file at which its time is written, or [`NOWHERE`].
    pub(crate) place: u64,
    /// End of its changes, and of their words; they start at the end of the previous step.
    pub(super) end: u32,
    pub(super) words_end: u32,
    /// Whether the watched clock has its edge here.
    pub(crate) edge: bool,
    /// Whether a signal other than the clock changes again here: it has changed since the last edge, or twice at this time.
    /// Without a clock, only the latter counts.
    pub(crate) again: bool,
    /// Whether nothing is recorded from here on (`$dumpoff`), until a later step.
    pub(crate) off: bool,
}

/// A slot, and its digit or where its value is.
///
/// Bit 31 tells whether the value is in the words of the batch: one known word if bit 0 is set, else all words of the
/// slot's kind. Without bit 31, bits 0 and 1 are the digit, as in [`super::digits`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Change(u32);

const IN_WORDS: u32 = 1 << 31;
const KNOWN: u32 = 1;
/// The bits of a slot's number, which is below 2^22 for a signal of a file.
const SLOT_SHIFT: u32 = 2;

impl Change {
    /// A change to a digit: bit 0 is its value, bit 1 tells whether it is unknown.
    #[inline]
    pub(super) fn digit(slot: u32, digit: u8) -> Self {
        Self(slot << SLOT_SHIFT | u32::from(digit))
    }

    /// A change to a known word, which is the next of the batch's words.
    #[inline]
    pub(super) fn known(slot: u32) -> Self {
        Self(slot << SLOT_SHIFT | IN_WORDS | KNOWN)
    }

    /// A change to the next words of the batch, as many as the slot's kind has.
    #[inline]
    pub(super) fn words(slot: u32) -> Self {
        Self(slot << SLOT_SHIFT | IN_WORDS)
    }

    /// Returns the digit, if it is a change to one.
    #[inline]
    pub(super) fn as_digit(self) -> u8 {
        self.0 as u8 & 3
    }

    /// Whether all words of the slot's kind belong to it.
    #[inline]
    pub(super) fn is_words(self) -> bool {
        self.0 & (IN_WORDS | KNOWN) == IN_WORDS
    }

    #[inline]
    pub(super) fn slot(self) -> u32 {
        (self.0 & !IN_WORDS) >> SLOT_SHIFT
    }

    /// Returns how many of the batch's words belong to it; `length` is that of its slot's kind.
    #[inline]
    pub(super) fn count_words(self, length: impl FnOnce() -> usize) -> usize {
        match self.0 & (IN_WORDS | KNOWN) {
            IN_WORDS => length(),
            both => usize::from(both > IN_WORDS),
        }
    }
}

impl Default for Change {
    fn default() -> Self {
        Self::digit(0, 0)
    }
}

/// Steps to be handed over.
#[derive(Debug, Default)]
pub(super) struct Batch {
    pub(super) steps: Vec<Step>,
    pub(super) changes: Pile<Change>,
    pub(super) words: Vec<u64>,
    /// States beside the values, by the number of the change ([`super::digits::state`]).
    pub(super) states: Vec<(u32, u64)>,
    /// Slots that got a value of another kind than declared, each once.
    pub(super) odd: Vec<u32>,
    /// What is unusual in the file.
    pub(super) notes: Vec<String>,
    /// Number of bytes of the file that were read up to here.
    pub(super) bytes: u64,
}

impl Batch {
    pub(super) fn clear(&mut self) {
        self.steps.clear();
        self.changes.truncate(0);
        self.words.clear();
        self.states.clear();
        self.odd.clear();
        self.notes.clear();
    }

    /// Returns the state of the change with this number; 0 if it has none beside its value.
    #[inline]
    pub(super) fn state(&self, change: usize) -> u64 {
        let found = self
            .states
            .binary_search_by_key(&(change as u32), |(change, _)| *change);
        found.map_or(0, |at| self.states[at].1)
    }

    /// Returns the changes from `first` to `end`, whose words begin at `first_word`. `lengths` has the number of words of each slot.
    #[inline]
    pub(super) fn changes<'a>(
        &'a self,
        (first, first_word): (usize, usize),
        end: usize,
        lengths: &'a [u32],
    ) -> Changes<'a> {
        Changes {
            changes: self.changes.as_slice()[first..end].iter(),
            words: &self.words[first_word..],
            lengths,
        }
    }
}

/// Changes of a step: slots and values.
#[derive(Clone)]
pub(crate) struct Changes<'a> {
    changes: std::slice::Iter<'a, Change>,
    /// The words of the changes that are left, and more.
    words: &'a [u64],
    lengths: &'a [u32],
}

impl Changes<'_> {
    /// Returns the next change if it is to a digit.
    #[inline(always)] // a call for each change takes as long as the rest of it
    pub(crate) fn next_digit(&mut self) -> Option<(u32, u8)> {
        let (change, others) = self.changes.as_slice().split_first()?;
        if change.0 & IN_WORDS != 0 {
            return None;
        }
        self.changes = others.iter();
        Some((change.slot(), change.0 as u8 & 3))
    }
}

impl ExactSizeIterator for Changes<'_> {
    fn len(&self) -> usize {
        self.changes.len()
    }
}

impl<'a> Iterator for Changes<'a> {
    type Item = (u32, Changed<'a>);

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Item> {
        let change = *self.changes.next()?;
        let slot = change.slot();
        if change.0 & IN_WORDS == 0 {
            return Some((slot, Changed::Digit(change.0 as u8 & 3)));
        }
        let count = change.count_words(|| self.lengths[slot as usize] as usize);
        let (words, others) = self.words.split_at(count);
        self.words = others;
        let changed = match words {
            [bits] => Changed::Word([*bits, 0]),
            words => Changed::Words(words),
        };
        Some((slot, changed))
    }
}

/// A new value.
///
/// Short values are passed by value: reading them back from memory right after they were written there in other pieces would cost more than
/// the rest of the work for a change.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Changed<'a> {
    /// The digit of a signal of one bit, as in [`super::digits`].
    Digit(u8),
    /// Its bits, and a mask of the unknown ones.
    Word([u64; 2]),
    /// The words of the slot's kind.
    Words(&'a [u64]),
}

/// The words of each digit.
const DIGIT_WORDS: [[u64; 2]; 4] = [[0, 0], [1, 0], [0, 1], [1, 1]];

impl Changed<'_> {
    /// Returns the words of the slot's kind.
    #[inline]
    pub(crate) fn words(&self) -> &[u64] {
        match self {
            Self::Digit(digit) => &DIGIT_WORDS[usize::from(digit & 3)],
            Self::Word(words) => words,
            Self::Words(words) => words,
        }
    }

    /// Returns the bits and the mask of the unknown ones, if each is one word.
    #[inline]
    pub(crate) fn pair(self) -> Option<[u64; 2]> {
        match self {
            Self::Digit(digit) => Some(DIGIT_WORDS[usize::from(digit & 3)]),
            Self::Word(words) => Some(words),
            Self::Words(words) => words.try_into().ok(),
        }
    }
}
