//! Packed changes of a period of time, passed from the thread that reads to the one that compares.
//!
//! ```text
//!  steps    time 0, ends at 3 │ time 5, ends at 4, edge │ …        all that happens at one time is one step
//!  changes  slot, word │ slot, word │ slot, word ║ slot, word ║ …
//!  words    bits, unknown │ bits, unknown │ …                       as many of each as the slot's kind asks for
//! ```

use super::header::Kind;
use super::values::words_of;

/// A batch is handed over when it has this many changes.
const CHANGES: usize = 1 << 13;
const WORDS: usize = 1 << 16;

/// All changes at one time.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Step {
    /// Time in the file's unit.
    pub(crate) time: u64,
    /// End of its changes; they start at the end of the previous step.
    pub(super) end: usize,
    /// Whether the watched clock has its edge here.
    pub(crate) edge: bool,
    /// Whether nothing is recorded from here on (`$dumpoff`), until a later step.
    pub(crate) off: bool,
}

/// A slot and the position of its words.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change {
    pub(super) slot: u32,
    pub(super) word: u32,
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
}

/// The bit whose edges are marked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Watch {
    /// Slot of a signal of one bit.
    pub(crate) slot: u32,
    /// Whether the falling edge is marked.
    pub(crate) falling: bool,
}

/// Collects changes into steps, and steps into a batch.
pub(super) struct Gatherer {
    pub(super) batch: Batch,
    kinds: Vec<Kind>,
    watch: Option<Watch>,
    /// The clock before this step, and now: bit and unknown.
    clock: [[u64; 2]; 2],
    time: u64,
    off: bool,
    was_off: bool,
    /// Start of the step in the changes and in the words.
    from: (usize, usize),
    /// With more words than this, the step is compacted.
    press_at: usize,
}

impl Gatherer {
    pub(super) fn new(kinds: Vec<Kind>, watch: Option<Watch>) -> Self {
        Self {
            batch: Batch::default(),
            kinds,
            watch,
            clock: [[0, 1]; 2],
            time: 0,
            off: false,
            was_off: false,
            from: (0, 0),
            press_at: 2 * WORDS,
        }
    }

    pub(super) fn kind(&self, slot: u32) -> Kind {
        self.kinds[slot as usize]
    }

    /// Adds a known or unknown value of at most 64 bits, or a real number.
    #[inline]
    pub(super) fn put_word(&mut self, slot: u32, bits: u64, unknown: u64) {
        let batch = &mut self.batch;
        let word = batch.words.len() as u32;
        batch.changes.push(Change { slot, word });
        batch.words.extend_from_slice(&[bits, unknown]);
        if let Some(watch) = self.watch
            && watch.slot == slot
        {
            self.clock[1] = [bits, unknown];
        }
        if self.batch.words.len() > self.press_at {
            self.press();
        }
    }

    /// Adds a value of the slot's kind and returns its words, all zero.
    pub(super) fn put_words(&mut self, slot: u32) -> &mut [u64] {
        if self.batch.words.len() > self.press_at {
            self.press();
        }
        let batch = &mut self.batch;
        let from = batch.words.len();
        let word = from as u32;
        batch.changes.push(Change { slot, word });
        batch.words.resize(from + words_of(self.kinds[slot as usize]), 0);
        &mut batch.words[from..]
    }

    /// Checks the value that was added last, if it is the clock's.
    pub(super) fn watch_last(&mut self, slot: u32) {
        let words = &self.batch.words;
        if let (Some(watch), [.., bits, unknown]) = (self.watch, words.as_slice())
            && watch.slot == slot
        {
            self.clock[1] = [*bits, *unknown];
        }
    }

    pub(super) fn off(&mut self, off: bool) {
        self.off = off;
    }

    /// Advances the time, which must not go back. Returns whether the batch is full and must be handed over.
    #[inline]
    pub(super) fn advance(&mut self, time: u64) -> bool {
        if time == self.time {
            return false;
        }
        self.end_step();
        self.time = time;
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
        let (before, after) = if self.watch.is_some_and(|watch| watch.falling) {
            (1, 0)
        } else {
            (0, 1)
        };
        self.batch.steps.push(Step {
            time: self.time,
            end,
            edge: self.clock == [[before, 0], [after, 0]],
            off: self.off,
        });
        self.clock[0] = self.clock[1];
        self.was_off = self.off;
        self.from = (end, self.batch.words.len());
    }

    /// Takes the complete steps out, leaving `empty` in their place. The current step must have ended.
    pub(super) fn take(&mut self, mut empty: Batch) -> Batch {
        empty.clear();
        self.from = (0, 0);
        self.press_at = 2 * WORDS;
        std::mem::replace(&mut self.batch, empty)
    }

    /// Keeps only the last change of each slot in the current step, since a file may have any number of changes at
    /// one time.
    fn press(&mut self) {
        let mut seen = vec![false; self.kinds.len()];
        let (first, first_word) = self.from;
        let mut kept: Vec<Change> = Vec::new();
        for change in self.batch.changes[first..].iter().rev() {
            if !std::mem::replace(&mut seen[change.slot as usize], true) {
                kept.push(*change);
            }
        }
        kept.reverse();
        let mut words = Vec::new();
        for change in &mut kept {
            let from = change.word as usize;
            change.word = (first_word + words.len()) as u32;
            words.extend_from_slice(&self.batch.words[from..from + words_of(self.kinds[change.slot as usize])]);
        }
        self.batch.changes.truncate(first);
        self.batch.changes.extend(kept);
        self.batch.words.truncate(first_word);
        self.batch.words.extend(words);
        // At least as much again comes in before the next time, so that the cost per change stays the same.
        self.press_at = (2 * self.batch.words.len()).max(2 * WORDS);
    }
}
