//! Packed changes of a period of time, passed from the thread that reads to the one that compares.
//!
//! ```text
//!  steps    time 0, ends at 3 │ time 5, ends at 4, edge │ …        all that happens at one time is one step
//!  changes  slot, value │ slot, value │ slot, place of its words ║ slot, value ║ …
//!  words    bits, unknown │ bits, unknown │ …                       as many of each as the slot's kind needs
//! ```
//!
//! Values of at most 64 bits that are known, and shorter unknown ones, need no words, which are nearly all.

use super::header::Kind;
use super::values::words_of;

/// A batch is handed over when it has this many changes or words.
const CHANGES: usize = 1 << 13;
const WORDS: usize = 1 << 15;

/// Place of a step to which reading cannot return.
pub(crate) const NOWHERE: u64 = u64::MAX;

/// All changes at one time.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Step {
    /// Time in the file's unit.
    pub(crate) time: u64,
    /// Byte of the file at which its time is written, or [`NOWHERE`].
    pub(crate) place: u64,
    /// End of its changes; they start at the end of the previous step.
    pub(super) end: u32,
    /// Whether the watched clock has its edge here.
    pub(crate) edge: bool,
    /// Whether nothing is recorded from here on (`$dumpoff`), until a later step.
    pub(crate) off: bool,
}

/// Marks a change whose value is in the words of the batch.
const IN_WORDS: u32 = u32::MAX;

/// A slot and its value, or the position of its words.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    slot: u32,
    /// The unknown bits, or [`IN_WORDS`].
    unknown: u32,
    /// The bits, or the position of the words.
    value: u64,
}

impl Change {
    #[inline]
    pub(super) fn slot(self) -> u32 {
        self.slot
    }

    /// Returns the value, if it needs no words: its bits, and a mask of the unknown ones.
    #[inline]
    pub(super) fn small(self) -> Option<[u64; 2]> {
        (self.unknown != IN_WORDS).then_some([self.value, self.unknown.into()])
    }

    /// Returns the position of its words.
    #[inline]
    pub(super) fn words_at(self) -> usize {
        self.value as usize
    }
}

/// Steps to be handed over.
#[derive(Debug, Default)]
pub(super) struct Batch {
    pub(super) steps: Vec<Step>,
    pub(super) changes: Vec<Change>,
    pub(super) words: Vec<u64>,
    /// Number of bytes of the file that were read up to here.
    pub(super) bytes: u64,
}

impl Batch {
    pub(super) fn clear(&mut self) {
        self.steps.clear();
        self.changes.clear();
        self.words.clear();
    }

    /// Calls `each` with the slots and values of the changes from `first` to `end`. `lengths` has the number of words of
    /// each slot.
    #[inline]
    pub(super) fn each(&self, first: usize, end: usize, lengths: &[u32], mut each: impl FnMut(u32, Changed<'_>)) {
        for change in &self.changes[first..end] {
            let slot = change.slot();
            each(
                slot,
                match change.small() {
                    Some(words) => Changed::Word(words),
                    None => {
                        let from = change.words_at();
                        Changed::Words(&self.words[from..from + lengths[slot as usize] as usize])
                    }
                },
            );
        }
    }
}

/// A new value.
///
/// Short values are passed on without a place in memory: to read them from where they were just written to, in other
/// pieces, would cost more than everything else that happens to a change.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Changed<'a> {
    /// Its bits, and a mask of the unknown ones.
    Word([u64; 2]),
    /// The words of the slot's kind.
    Words(&'a [u64]),
}

impl Changed<'_> {
    /// Returns the words of the slot's kind.
    #[inline]
    pub(crate) fn words(&self) -> &[u64] {
        match self {
            Self::Word(words) => words,
            Self::Words(words) => words,
        }
    }

    /// Returns the bits and the mask of the unknown ones, if each is one word.
    #[inline]
    pub(crate) fn pair(self) -> Option<[u64; 2]> {
        match self {
            Self::Word(words) => Some(words),
            Self::Words(words) => words.try_into().ok(),
        }
    }
}

/// The bit whose edges are marked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Watch {
    /// Slot of a signal of one bit.
    pub(crate) slot: u32,
    /// Whether the falling edge is marked.
    pub(crate) falling: bool,
}

impl Watch {
    /// Whether a change of the clock from `before` to `after` is an edge. Each value is a bit, and 1 if it is unknown.
    pub(super) fn is_edge(self, before: [u64; 2], after: [u64; 2]) -> bool {
        let [from, to] = if self.falling { [1, 0] } else { [0, 1] };
        before == [from, 0] && after == [to, 0]
    }

    /// The value of the clock just before its edge.
    pub(super) fn before_edge(self) -> [u64; 2] {
        [u64::from(self.falling), 0]
    }
}

/// Collects changes into steps, and steps into a batch.
pub(super) struct Gatherer {
    pub(super) batch: Batch,
    kinds: Vec<Kind>,
    watch: Option<Watch>,
    /// The slot of the watched clock, or one that no signal has.
    watched: u32,
    /// The clock before this step, and now: bit and unknown.
    clock: [[u64; 2]; 2],
    time: u64,
    place: u64,
    off: bool,
    was_off: bool,
    /// Start of the step in the changes and in the words.
    from: (usize, usize),
    /// With more changes or words than this, the step is compacted.
    press_at: (usize, usize),
}

impl Gatherer {
    pub(super) fn new(kinds: Vec<Kind>, watch: Option<Watch>) -> Self {
        Self {
            batch: Batch::default(),
            kinds,
            watch,
            watched: watch.map_or(u32::MAX, |watch| watch.slot),
            clock: [[0, 1]; 2],
            time: 0,
            place: NOWHERE,
            off: false,
            was_off: false,
            from: (0, 0),
            press_at: (2 * CHANGES, 2 * WORDS),
        }
    }

    /// Continues in the middle of a file, after a time, with the clock as it is just before its edge.
    pub(super) fn resumed(kinds: Vec<Kind>, watch: Option<Watch>, time: u64) -> Self {
        let mut gatherer = Self::new(kinds, watch);
        gatherer.time = time;
        if let Some(watch) = watch {
            gatherer.clock = [watch.before_edge(); 2];
        }
        gatherer
    }

    /// Returns the number of words of each slot's values.
    pub(super) fn lengths(&self) -> Vec<u32> {
        self.kinds.iter().map(|kind| words_of(*kind) as u32).collect()
    }

    #[inline]
    pub(super) fn kind(&self, slot: u32) -> Kind {
        self.kinds[slot as usize]
    }

    /// Adds a known or unknown value of at most 64 bits, or a real number.
    #[inline]
    pub(super) fn put_word(&mut self, slot: u32, bits: u64, unknown: u64) {
        if unknown >= u64::from(IN_WORDS) {
            let words = self.put_words(slot);
            words.copy_from_slice(&[bits, unknown]);
            self.watch_last(slot);
            return;
        }
        self.batch.changes.push(Change {
            slot,
            unknown: unknown as u32,
            value: bits,
        });
        if self.watched == slot {
            self.clock[1] = [bits, unknown];
        }
        if self.batch.changes.len() > self.press_at.0 {
            self.press();
        }
    }

    /// Adds a single digit: bit 0 is its value, bit 1 tells whether it is unknown.
    #[inline]
    pub(super) fn put_digit(&mut self, slot: u32, digit: u8) {
        self.put_word(slot, u64::from(digit & 1), u64::from(digit >> 1));
    }

    /// Adds a value of the slot's kind and returns its words, all zero.
    pub(super) fn put_words(&mut self, slot: u32) -> &mut [u64] {
        if self.batch.changes.len() > self.press_at.0 || self.batch.words.len() > self.press_at.1 {
            self.press();
        }
        let batch = &mut self.batch;
        let from = batch.words.len();
        batch.changes.push(Change {
            slot,
            unknown: IN_WORDS,
            value: from as u64,
        });
        batch.words.resize(from + words_of(self.kinds[slot as usize]), 0);
        &mut batch.words[from..]
    }

    /// Checks the value that was added last with [`Gatherer::put_words`], if it is the clock's.
    pub(super) fn watch_last(&mut self, slot: u32) {
        if self.watched == slot
            && let [.., bits, unknown] = self.batch.words.as_slice()
        {
            self.clock[1] = [*bits, *unknown];
        }
    }

    pub(super) fn off(&mut self, off: bool) {
        self.off = off;
    }

    /// Advances the time, which is written at byte `place` of the file and must not go back. Returns whether the batch
    /// is full and must be handed over.
    #[inline]
    pub(super) fn advance(&mut self, time: u64, place: u64) -> bool {
        if time == self.time {
            if self.place == NOWHERE && self.batch.changes.len() == self.from.0 {
                self.place = place;
            }
            return false;
        }
        self.end_step();
        self.time = time;
        self.place = place;
        self.batch.changes.len() >= CHANGES || self.batch.words.len() >= WORDS
    }

    pub(super) fn time(&self) -> u64 {
        self.time
    }

    /// Ends the current step, if anything happened in it.
    pub(super) fn end_step(&mut self) {
        let end = self.batch.changes.len();
        if end == self.from.0 && self.off == self.was_off {
            return;
        }
        self.batch.steps.push(Step {
            time: self.time,
            place: self.place,
            end: end as u32,
            edge: self
                .watch
                .is_some_and(|watch| watch.is_edge(self.clock[0], self.clock[1])),
            off: self.off,
        });
        self.clock[0] = self.clock[1];
        self.was_off = self.off;
        self.from = (end, self.batch.words.len());
    }

    /// Discards the current step.
    pub(super) fn drop_step(&mut self) {
        let (changes, words) = self.from;
        self.batch.changes.truncate(changes);
        self.batch.words.truncate(words);
    }

    /// Takes the complete steps out, leaving `empty` in their place. The current step must have ended.
    pub(super) fn take(&mut self, mut empty: Batch) -> Batch {
        empty.clear();
        self.from = (0, 0);
        self.press_at = (2 * CHANGES, 2 * WORDS);
        std::mem::replace(&mut self.batch, empty)
    }

    /// Keeps only the last change of each slot in the current step, since a file may have any number of changes at
    /// one time.
    fn press(&mut self) {
        let mut seen = vec![false; self.kinds.len()];
        let (first, first_word) = self.from;
        let mut kept: Vec<Change> = Vec::new();
        for change in self.batch.changes[first..].iter().rev() {
            if !std::mem::replace(&mut seen[change.slot() as usize], true) {
                kept.push(*change);
            }
        }
        kept.reverse();
        let mut words = Vec::new();
        for change in &mut kept {
            if change.small().is_none() {
                let from = change.words_at();
                change.value = (first_word + words.len()) as u64;
                words.extend_from_slice(&self.batch.words[from..from + words_of(self.kinds[change.slot() as usize])]);
            }
        }
        self.batch.changes.truncate(first);
        self.batch.changes.extend(kept);
        self.batch.words.truncate(first_word);
        self.batch.words.extend(words);
        // At least as much again comes in before the next time, so that the cost per change stays the same.
        let twice = |length: usize, least: usize| (2 * length).max(2 * least);
        self.press_at = (
            twice(self.batch.changes.len(), CHANGES),
            twice(self.batch.words.len(), WORDS),
        );
    }
}
