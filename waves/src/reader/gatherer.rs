//! Collects the changes of a file into batches, and marks the edges of the clock.

use std::sync::Arc;

use super::batch::{Batch, Change, NOWHERE, Step};
use super::digits::UNKNOWN;
use super::header::Kind;
use super::lines::Lines;
use super::since_edge::SinceEdge;
use super::values::words_of;

/// A batch is handed over when it has this many changes or words.
const CHANGES: usize = 1 << 14;
const WORDS: usize = 1 << 15;

/// The bit whose edges are marked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Watch {
    /// Slot of a signal of one bit.
    pub(crate) slot: u32,
    /// Whether the falling edge is marked.
    pub(crate) falling: bool,
}

impl Watch {
    /// Whether a change of the clock from one digit to another is an edge.
    #[inline]
    pub(super) fn is_edge(self, before: u8, after: u8) -> bool {
        before == self.before_edge() && after == u8::from(!self.falling)
    }

    /// The digit of the clock just before its edge.
    #[inline]
    pub(super) fn before_edge(self) -> u8 {
        u8::from(self.falling)
    }
}

/// Collects changes into steps, and steps into a batch.
pub(super) struct Gatherer {
    pub(super) batch: Batch,
    kinds: Arc<[Kind]>,
    watch: Option<Watch>,
    /// The slot of the watched clock, or one that no signal has.
    watched: u32,
    /// The digits of the clock before this step, and now.
    clock: [u8; 2],
    time: u64,
    /// The first time of the file.
    first_time: Option<u64>,
    place: u64,
    off: bool,
    was_off: bool,
    /// Whether the current step counts although nothing changes in it.
    is_kept: bool,
    /// What changed since the last edge.
    since_edge: SinceEdge,
    /// Start of the step in the changes and in the words.
    from: (usize, usize),
    /// With more changes or words than this, the step is compacted.
    press_at: (usize, usize),
    /// Whether the file repeats all values at the moment.
    pub(super) in_dump: bool,
    /// Whether each slot got a value of another kind than declared; empty if none did.
    odd: Vec<bool>,
    /// The keys of the notes so far.
    noted: Vec<&'static str>,
}

impl Gatherer {
    pub(super) fn new(kinds: impl Into<Arc<[Kind]>>, watch: Option<Watch>) -> Self {
        Self {
            batch: Batch::default(),
            kinds: kinds.into(),
            watch,
            watched: watch.map_or(u32::MAX, |watch| watch.slot),
            clock: [UNKNOWN; 2],
            time: 0,
            first_time: None,
            place: NOWHERE,
            off: false,
            was_off: false,
            is_kept: false,
            since_edge: SinceEdge::default(),
            from: (0, 0),
            press_at: (2 * CHANGES, 2 * WORDS),
            in_dump: false,
            odd: Vec::new(),
            noted: Vec::new(),
        }
    }

    /// Continues in the middle of a file, after a time, with the clock as it is just before its edge.
    pub(super) fn resumed(kinds: impl Into<Arc<[Kind]>>, watch: Option<Watch>, time: u64) -> Self {
        let mut gatherer = Self::new(kinds, watch);
        gatherer.time = time;
        gatherer.first_time = Some(time);
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
        if unknown > 0 {
            let words = self.put_words(slot);
            words.copy_from_slice(&[bits, unknown]);
            self.watch_last(slot);
            return;
        }
        if self.watched == slot {
            self.clock[1] = bits as u8 & 1;
        }
        self.batch.changes.push(Change::known(slot));
        self.batch.words.push(bits);
        self.press_if_long();
    }

    /// Adds a single digit: bit 0 is its value, bit 1 tells whether it is unknown.
    #[inline]
    pub(super) fn put_digit(&mut self, slot: u32, digit: u8) {
        if self.watched == slot {
            self.clock[1] = digit;
        }
        self.batch.changes.push(Change::digit(slot, digit));
        self.press_if_long();
    }

    /// Adds changes to digits and to known words; the word of a digit does not count.
    #[inline]
    pub(super) fn put_changes(&mut self, changes: impl ExactSizeIterator<Item = (Change, u64)>) {
        let count = changes.len();
        let Batch {
            changes: pile, words, ..
        } = &mut self.batch;
        for (place, (change, word)) in pile.room(count).iter_mut().zip(changes) {
            *place = change;
            let has_word = change.count_words(|| 0) > 0;
            if has_word {
                words.push(word);
            }
            if change.slot() == self.watched {
                self.clock[1] = if has_word { word as u8 & 1 } else { change.as_digit() };
            }
        }
        pile.grow(count);
        self.press_if_long();
    }

    /// Adds the changes of lines of the common forms from `at` on, and returns the position after them.
    #[inline]
    pub(super) fn put_lines(&mut self, lines: &Lines, data: &[u8], mut at: usize) -> usize {
        let mut clock = None;
        loop {
            let mut count = 0;
            let Batch { changes, words, .. } = &mut self.batch;
            let room = changes.room(1);
            let places = room.len();
            for place in room {
                // Tried first: if any signal is left out, most are.
                while let Some(next) = lines.left_out(data, at) {
                    at = next;
                }
                if let Some(line) = lines.bit(data, at) {
                    if line.is_clock {
                        clock = Some(line.digit);
                    }
                    *place = Change::digit(line.slot, line.digit);
                    at = line.next;
                } else if let Some(line) = lines.word(data, at) {
                    words.push(line.word);
                    *place = if line.unknown == 0 {
                        Change::known(line.slot)
                    } else {
                        words.push(line.unknown);
                        Change::words(line.slot)
                    };
                    at = line.next;
                } else {
                    break;
                }
                count += 1;
            }
            changes.grow(count);
            if count < places {
                break;
            }
        }
        if let Some(digit) = clock {
            self.clock[1] = digit;
        }
        self.press_if_long();
        at
    }

    /// Whether all signals got their values at the first time, and nothing has happened since.
    pub(super) fn has_all_values(&self) -> bool {
        let mut has_value = vec![false; self.kinds.len()];
        for change in self.batch.changes.as_slice() {
            has_value[change.slot() as usize] = true;
        }
        let is_odd = |slot: usize| self.odd.get(slot).copied().unwrap_or(false);
        let needs_none = |kind: &Kind| matches!(kind, Kind::Event | Kind::Bits(0));
        let mut slots = self.kinds.iter().zip(has_value).enumerate();
        self.batch.steps.is_empty()
            && self.first_time == Some(self.time)
            && slots.all(|(slot, (kind, has_value))| has_value || is_odd(slot) || needs_none(kind))
    }

    pub(super) fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    pub(super) fn kinds_shared(&self) -> Arc<[Kind]> {
        Arc::clone(&self.kinds)
    }

    /// Returns the clock whose edges are marked.
    pub(super) fn watch(&self) -> Option<Watch> {
        self.watch
    }

    /// Returns the digits of the clock before the current step, and now.
    pub(super) fn clock(&self) -> [u8; 2] {
        self.clock
    }

    /// Says whether the clock has its edge in the current step, where its changes are not put.
    #[inline]
    pub(super) fn set_edge(&mut self, is_edge: bool) {
        self.clock = match self.watch {
            Some(watch) if is_edge => [watch.before_edge(), 1 - watch.before_edge()],
            _ => [UNKNOWN; 2],
        };
    }

    /// Returns the slot of the clock, if its edges are marked.
    pub(super) fn watched(&self) -> Option<u32> {
        self.watch.map(|watch| watch.slot)
    }

    #[inline]
    pub(super) fn press_if_long(&mut self) {
        if self.batch.changes.len() > self.press_at.0 || self.batch.words.len() > self.press_at.1 {
            self.press();
        }
    }

    /// Adds a value of the slot's kind and returns its words, all zero.
    pub(super) fn put_words(&mut self, slot: u32) -> &mut [u64] {
        self.press_if_long();
        let batch = &mut self.batch;
        let from = batch.words.len();
        batch.changes.push(Change::words(slot));
        batch.words.resize(from + words_of(self.kinds[slot as usize]), 0);
        &mut batch.words[from..]
    }

    /// Checks the value that was added last with [`Gatherer::put_words`], if it is the clock's.
    pub(super) fn watch_last(&mut self, slot: u32) {
        if self.watched == slot
            && let [.., bits, unknown] = self.batch.words.as_slice()
        {
            self.clock[1] = (unknown << 1 & 2 | bits & 1) as u8;
        }
    }

    /// Notes the state beside the value of the change that was added last.
    pub(super) fn note_state(&mut self, state: u64) {
        let change = (self.batch.changes.len() as u32).saturating_sub(1);
        match self.batch.states.last_mut() {
            Some(last) if last.0 == change => last.1 = state,
            _ => self.batch.states.push((change, state)),
        }
    }

    /// Notes that an event happens. A dump of all values, such as after a period without recording, does not say whether an event happens;
    /// at the first time, the file only gives the initial state of its events.
    pub(super) fn put_event(&mut self, slot: u32) {
        let begins = self.first_time.is_none_or(|first| first == self.time);
        if begins || self.in_dump || self.off || self.was_off {
            return;
        }
        self.batch.changes.push(Change::known(slot));
        self.batch.words.push(1);
        self.press_if_long();
    }

    /// Notes that a slot got a value of another kind than declared, which is not kept.
    pub(super) fn put_odd(&mut self, slot: u32) {
        if self.odd.is_empty() {
            self.odd = vec![false; self.kinds.len()];
        }
        if !std::mem::replace(&mut self.odd[slot as usize], true) {
            self.batch.odd.push(slot);
        }
    }

    /// Adds a note for the reader of the result, once for each `key`.
    pub(super) fn note_once(&mut self, key: &'static str, note: impl FnOnce() -> String) {
        if !self.noted.contains(&key) {
            self.noted.push(key);
            self.batch.notes.push(note());
        }
    }

    /// Makes the current step count even if nothing changes in it.
    pub(super) fn keep_step(&mut self) {
        self.is_kept = true;
    }

    pub(super) fn off(&mut self, off: bool) {
        self.off = off;
    }

    /// Advances the time, which is written at byte `place` of the file and must not go back. Returns whether the batch
    /// is full and must be handed over.
    #[inline]
    pub(super) fn advance(&mut self, time: u64, place: u64) -> bool {
        self.first_time.get_or_insert(time);
        if time == self.time {
            if self.place == NOWHERE && self.batch.changes.len() == self.from.0 {
                self.place = place;
            }
            return false;
        }
        self.end_step();
        self.time = time;
        self.place = place;
        let Batch {
            steps, changes, words, ..
        } = &self.batch;
        changes.len() >= CHANGES || words.len() >= WORDS || steps.len() >= CHANGES
    }

    pub(super) fn time(&self) -> u64 {
        self.time
    }

    /// Ends the current step, if anything happened in it.
    pub(super) fn end_step(&mut self) {
        let end = self.batch.changes.len();
        if end == self.from.0 && self.off == self.was_off && !std::mem::take(&mut self.is_kept) {
            return;
        }
        let edge = self
            .watch
            .is_some_and(|watch| watch.is_edge(self.clock[0], self.clock[1]));
        if edge || self.watch.is_none() {
            self.since_edge.begin();
        }
        let changes = &self.batch.changes.as_slice()[..end];
        let again = self
            .since_edge
            .add(changes, self.from.0, self.watched, self.kinds.len());
        self.batch.steps.push(Step {
            again,
            time: self.time,
            place: self.place,
            end: end as u32,
            words_end: self.batch.words.len() as u32,
            edge,
            off: self.off,
        });
        self.clock[0] = self.clock[1];
        self.was_off = self.off;
        self.is_kept = false;
        self.from = (end, self.batch.words.len());
    }

    /// Discards the current step.
    pub(super) fn drop_step(&mut self) {
        let (changes, words) = self.from;
        self.batch.changes.truncate(changes);
        self.batch.words.truncate(words);
        self.batch.states.retain(|(change, _)| (*change as usize) < changes);
    }

    /// Takes the complete steps out, leaving `empty` in their place. The current step must have ended.
    pub(super) fn take(&mut self, mut empty: Batch) -> Batch {
        empty.clear();
        self.since_edge.forget_batch();
        self.from = (0, 0);
        self.press_at = (2 * CHANGES, 2 * WORDS);
        std::mem::replace(&mut self.batch, empty)
    }

    /// Keeps only the last change of each slot in the current step, since a file may have any number of changes at
    /// one time.
    fn press(&mut self) {
        let (first, first_word) = self.from;
        let mut places = Vec::new();
        let mut at = first_word;
        for change in &self.batch.changes.as_slice()[first..] {
            let from = at;
            at += change.count_words(|| words_of(self.kinds[change.slot() as usize]));
            places.push(from..at);
        }
        let mut seen = vec![false; self.kinds.len()];
        let mut kept = Vec::new();
        for (at, (change, place)) in (first..)
            .zip(self.batch.changes.as_slice()[first..].iter().zip(places))
            .collect::<Vec<_>>()
            .into_iter()
            .rev()
        {
            if !std::mem::replace(&mut seen[change.slot() as usize], true) {
                kept.push((*change, place, self.batch.state(at)));
            }
        }
        kept.reverse();
        let words: Vec<u64> = kept
            .iter()
            .flat_map(|(_, place, _)| &self.batch.words[place.clone()])
            .copied()
            .collect();
        self.batch.changes.truncate(first);
        self.batch.states.retain(|(change, _)| (*change as usize) < first);
        for (change, _, state) in kept {
            if state != 0 {
                self.batch.states.push((self.batch.changes.len() as u32, state));
            }
            self.batch.changes.push(change);
        }
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
