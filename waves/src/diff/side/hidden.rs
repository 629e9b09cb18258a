//! Counts changes that no sample sees: values that others replace before the next edge of the clock, or at the same time.
//!
//! Only a new value is a change; a value that is written again is not. If a signal changes *n* times from one edge to the next, no sample
//! sees *n* - 1 of these changes, whatever the last value is; after the last edge, no sample sees any of the *n*.
//!
//! Most designs change each signal at most once between two edges. The reader reports this ([`Feed::is_simple_until_edge`]), and only other
//! stretches are examined change by change.
//!
//! [`Feed::is_simple_until_edge`]: crate::reader::Feed::is_simple_until_edge

use std::collections::BTreeMap;

use super::Side;
use crate::diff::cells::GENERAL;
use crate::diff::touched::Touched;
use crate::reader::Kind;

/// What no sample sees, in a file.
#[derive(Debug, Default)]
pub(in crate::diff) struct Hidden {
    /// Whether changes are counted at the moment.
    is_counting: bool,
    /// Number of the stretch from sample to sample.
    interval: u32,
    /// The stretch in which each slot changed last, and a hash of its value since; empty until they are needed.
    last: Vec<(u32, u64)>,
    /// Number of replaced values by slot: in the stretches before, and in this one.
    counts: BTreeMap<u32, u64>,
    now: BTreeMap<u32, u64>,
    /// The clock, which is not counted.
    clock: Option<u32>,
}

impl Hidden {
    pub(in crate::diff) fn set_clock(&mut self, clock: u32) {
        self.clock = Some(clock);
        // What comes before the first edge is counted, too.
        self.begin(true);
    }

    /// Begins the next stretch.
    pub(super) fn begin(&mut self, is_counting: bool) {
        self.interval += 1;
        self.is_counting = is_counting;
        while let Some((slot, count)) = self.now.pop_first() {
            *self.counts.entry(slot).or_default() += count;
        }
    }

    /// Forgets what was counted so far.
    pub(in crate::diff) fn forget(&mut self) {
        self.counts.clear();
        self.now.clear();
    }

    /// Returns the slots with replaced values and the number of these, once for each stretch in which they are counted.
    pub(in crate::diff) fn counts(&self) -> impl Iterator<Item = (u32, u64)> {
        self.counts.iter().chain(&self.now).map(|(slot, count)| (*slot, *count))
    }

    /// Returns the slots that changed in the current stretch, and how often; these changes are no longer among the others.
    pub(in crate::diff) fn take_now(&mut self) -> Vec<(u32, u64)> {
        let replaced = std::mem::take(&mut self.now);
        let last = (0..).zip(&self.last);
        last.filter(|(_, (interval, _))| *interval == self.interval)
            .map(|(slot, _)| (slot, 1 + replaced.get(&slot).copied().unwrap_or(0)))
            .collect()
    }
}

impl Side {
    /// Begins the stretch that follows an edge.
    pub(super) fn begin_interval(&mut self) {
        let is_counting = self.reset.is_none() && !self.feed.is_simple_until_edge();
        self.hidden.begin(is_counting);
    }

    /// Counts the values that the changes of the current step replace within a stretch. It is called before they are taken
    /// in.
    pub(super) fn count_hidden(&mut self, touched: &Touched) {
        // The first step gives every signal its first value, often after an `x`.
        if !self.hidden.is_counting || !self.began || self.reset.is_some() {
            return;
        }
        let Hidden {
            interval,
            last,
            now,
            clock,
            ..
        } = &mut self.hidden;
        if last.is_empty() {
            last.resize(self.values.count(), (0, 0));
        }
        for (slot, changed) in self.feed.changes() {
            let is_compared = !self.pairs.get(slot).is_empty()
                || self.parts.get(slot as usize).is_some_and(|parts| !parts.is_empty());
            if Some(slot) == *clock || !is_compared || self.values.kind(slot) == Kind::Event {
                continue;
            }
            let value = hash(changed.words());
            let known = &mut last[slot as usize];
            if known.0 == *interval {
                if known.1 != value {
                    *now.entry(slot).or_default() += 1;
                    known.1 = value;
                }
                continue;
            }
            let before = match touched.cells.of(self.number, slot) {
                GENERAL => hash(self.values.words(slot)),
                cell => hash(touched.cells.both(cell)[self.number]),
            };
            if before != value {
                *known = (*interval, value);
            }
        }
    }

    /// Returns a pair that uses this slot, or a vector that this slot is a part of.
    pub(in crate::diff) fn pair_of(&self, slot: u32) -> Option<u32> {
        let parts = self.parts.get(slot as usize).into_iter().flatten();
        let slots = std::iter::once(slot).chain(parts.map(|part| part.whole));
        slots.into_iter().find_map(|slot| self.pairs.get(slot).first().copied())
    }
}

fn hash(words: &[u64]) -> u64 {
    words.iter().fold(0x9e37_79b9_7f4a_7c15, |hash: u64, word| {
        (hash ^ word).wrapping_mul(0xff51_afd7_ed55_8ccd).rotate_left(29)
    })
}
