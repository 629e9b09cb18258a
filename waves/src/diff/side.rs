//! One of the two files during the comparison: its current values, and the pairs that a change affects.
//!
//! ```text
//!              ┌─────────────────────────► values of the file ──┬──► pairs
//!  feed ─► step┤                              │    │            │
//!              └─► settle (no glitches) ──────┘    ├─► whole of ┘ a vector that is written in parts
//!                                                  └─► delay line ─► value as it was N samples, or a time, ago ──► pairs
//! ```

mod delayed;
mod hidden;
mod settle;

use std::collections::VecDeque;

use self::hidden::Hidden;
use self::settle::Settle;
use super::clocking::Slots;
use super::delay::DelayLine;
use super::parts::{Derived, PartOf, parts_by_slot};
use super::touched::{Listed, Lists, Touched};
use crate::WaveError;
use crate::reader::{Feed, Kind, Step, Values};

/// An edge of the clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct ClockEdge {
    pub(super) time_fs: u128,
    /// Whether a period without recording precedes this edge.
    pub(super) gap: bool,
}

/// One of the two files.
pub(super) struct Side {
    /// 0: the first file, 1: the second.
    number: usize,
    feed: Feed,
    pub(super) values: Values,
    unit_fs: u128,
    pairs: Lists,
    /// Parts by slot; empty if no slot needs them.
    parts: Vec<Vec<PartOf>>,
    /// Delay line and index in its slots, by slot.
    delayed: Vec<Vec<(u32, u32)>>,
    lines: Vec<DelayLine>,
    settle: Option<Settle>,
    /// The reset's slot and its active value, until it has been released.
    reset: Option<(u32, bool)>,
    /// Number of edges before the reset's release.
    pub(super) held_in_reset: u64,
    /// Whether the current step is an edge that was returned: it has not been taken in yet.
    at_edge: bool,
    off: bool,
    gap: bool,
    /// Events that happened since the last sample.
    events: Vec<u32>,
    /// Whether the first step has been taken in.
    began: bool,
    pub(super) hidden: Hidden,
}

/// A delayed signal: its delay, its slot, and the pair that uses it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Delayed {
    pub(super) by: u128,
    pub(super) pair: u32,
}

impl Side {
    /// Creates a side. `slots` are those of the pairs, in their order. Returns the slots that the pairs must use:
    /// delayed pairs get their own.
    pub(super) fn new(
        number: usize,
        feed: Feed,
        kinds: &[Kind],
        unit_fs: u64,
        derived: &[Derived],
        slots: &mut [Option<u32>],
        delays: &[Delayed],
    ) -> Self {
        let mut values = Values::new(kinds);
        let parts = parts_by_slot(derived.iter(), kinds.len());
        let mut lines: Vec<DelayLine> = Vec::new();
        let mut delayed = Vec::new();
        if !delays.is_empty() {
            delayed = vec![Vec::new(); kinds.len()];
        }
        for delay in delays {
            let Some(source) = slots[delay.pair as usize] else {
                continue;
            };
            let shown = values.add(kinds[source as usize]);
            slots[delay.pair as usize] = Some(shown);
            let line = match lines.iter().position(|line| line.by == delay.by) {
                Some(line) => line,
                None => {
                    lines.push(DelayLine::new(delay.by));
                    lines.len() - 1
                }
            };
            let place = lines[line].slots.len() as u32;
            delayed[source as usize].push((line as u32, place));
            lines[line].slots.push((source, shown));
            lines[line].is_changed.push(false);
            lines[line].mark(place);
        }
        let entries: Vec<(u32, u32)> = (0..)
            .zip(slots.iter())
            .filter_map(|(pair, slot)| Some(((*slot)?, pair)))
            .collect();
        let pairs = Lists::new(kinds.len() + delays.len(), &entries);
        Self {
            number,
            feed,
            values,
            unit_fs: u128::from(unit_fs),
            pairs,
            parts,
            delayed,
            lines,
            settle: None,
            reset: None,
            held_in_reset: 0,
            at_edge: false,
            off: false,
            gap: false,
            events: Vec::new(),
            began: false,
            hidden: Hidden::default(),
        }
    }

    pub(super) fn wait_for_release(&mut self, reset: u32, active: bool) {
        self.reset = Some((reset, active));
    }

    /// Removes values that last shorter than this.
    pub(super) fn without_glitches(&mut self, width_fs: u128, kinds: &[Kind]) {
        self.settle = Some(Settle {
            width_fs,
            next: Values::new(kinds),
            since: vec![None; kinds.len()],
            queue: VecDeque::new(),
        });
    }

    /// Returns whether the file records nothing at the moment.
    pub(super) fn is_off(&self) -> bool {
        self.off
    }

    pub(super) fn bytes(&self) -> u64 {
        self.feed.bytes()
    }

    pub(super) fn cut_off(&self) -> Result<(), WaveError> {
        self.feed.cut_off()
    }

    /// Reads the first step.
    pub(super) fn start(&mut self) -> Result<(), WaveError> {
        self.feed.advance()
    }

    /// Advances to the next edge of the clock after the reset's release; the values are then those just before it.
    ///
    /// The reader marks edges: a step is examined only to take its changes in.
    pub(super) fn next_edge(&mut self, touched: &mut Touched) -> Result<Option<ClockEdge>, WaveError> {
        if self.at_edge {
            self.begin_interval();
        }
        while let Some(step) = self.feed.step().copied() {
            if step.edge && !std::mem::take(&mut self.at_edge) {
                if self.reset.is_none_or(|reset| self.is_released(reset)) {
                    self.reset = None;
                    self.at_edge = true;
                    let gap = std::mem::take(&mut self.gap);
                    let time_fs = u128::from(step.time) * self.unit_fs;
                    return Ok(Some(ClockEdge { time_fs, gap }));
                }
                self.held_in_reset += 1;
                self.forget_events(touched);
            }
            self.off = step.off;
            self.gap |= step.off;
            self.count_hidden(touched);
            self.take_in(touched);
            self.feed.advance()?;
        }
        Ok(None)
    }

    /// Returns the next edges up to which nothing changes, if the current step is an edge that was returned.
    pub(super) fn quiet_edges(&self) -> &[Step] {
        if self.at_edge && self.reset.is_none() && self.lines.is_empty() {
            self.feed.quiet_edges()
        } else {
            &[]
        }
    }

    /// Treats the first `count` of [`Side::quiet_edges`] as returned.
    pub(super) fn skip_edges(&mut self, count: usize) {
        self.feed.skip(count);
    }

    fn is_released(&self, (slot, active): (u32, bool)) -> bool {
        *self.values.words(slot) == [u64::from(!active), 0]
    }

    /// Returns the time of the next step, or of a value that takes effect.
    pub(super) fn next_time(&self) -> Option<u128> {
        let step = self.feed.step().map(|step| u128::from(step.time) * self.unit_fs);
        let settled = self
            .settle
            .as_ref()
            .and_then(|settle| Some(settle.queue.front()?.0 + settle.width_fs));
        let lines = self.lines.iter().filter_map(|line| Some(line.queue.front()?.0)).min();
        [step, settled, lines].into_iter().flatten().min()
    }

    /// Discards delayed values after the end of both files, when they have nothing to be compared with.
    pub(super) fn forget_delayed(&mut self) {
        for line in &mut self.lines {
            line.queue.clear();
            line.words.clear();
        }
    }

    /// Returns whether the file has ended.
    pub(super) fn has_ended(&self) -> bool {
        self.feed.step().is_none()
    }

    /// Takes in everything at this time, which must not be after [`Side::next_time`]. Returns whether anything
    /// happened.
    pub(super) fn advance_to(&mut self, time_fs: u128, touched: &mut Touched) -> Result<bool, WaveError> {
        let mut happened = self.take_in_settled(time_fs, touched);
        if let Some(step) = self.feed.step()
            && u128::from(step.time) * self.unit_fs == time_fs
        {
            self.off = step.off;
            if self.settle.is_some() {
                self.hold_back(time_fs)?;
            } else {
                if step.again {
                    self.hidden.begin(true);
                    self.count_hidden(touched);
                }
                self.take_in(touched);
                happened = true;
            }
            self.feed.advance()?;
        }
        self.pend(time_fs)?;
        Ok(self.release(time_fs, touched) | happened)
    }

    fn take_in(&mut self, touched: &mut Touched) {
        if self.feed.has_states() || touched.states.any() {
            self.note_states(touched);
        }
        let Self {
            events,
            began,
            number,
            feed,
            values,
            pairs,
            parts,
            delayed,
            lines,
            ..
        } = self;
        let number = *number;
        let (pairs, parts, delayed) = (&*pairs, &**parts, &**delayed);
        let plain = parts.is_empty() && lines.is_empty();
        let Touched { cells, listed, .. } = touched;
        let from = events.len();
        cells.take(number, feed.changes(), |slot, changed| {
            if values.kind(slot) == Kind::Event {
                if !events[from..].contains(&slot) {
                    events.push(slot);
                }
                return;
            }
            if !values.set(slot, changed.words()) {
                return;
            }
            for pair in pairs.get(slot) {
                listed.touch(*pair);
            }
            if !plain {
                let following = Following { pairs, parts, delayed };
                following.follow(slot, values, lines, listed);
            }
        });
        *began = true;
        for slot in &events[from..] {
            let count = values.words(*slot)[0] + 1;
            values.set(*slot, &[count, 0]);
            for pair in pairs.get(*slot) {
                listed.touch(*pair);
            }
        }
    }

    /// Puts the states of the step's changes beside those of the other file.
    fn note_states(&mut self, touched: &mut Touched) {
        let slots = self.values.count();
        for (at, (slot, _)) in self.feed.changes().enumerate() {
            self.note_state(slot, self.feed.state(at), slots, touched);
        }
    }

    fn note_state(&self, slot: u32, state: u64, slots: usize, touched: &mut Touched) {
        let before = touched.states.set(self.number, slot, state, slots);
        for pair in self.pairs.get(slot) {
            touched.states.touch(*pair);
        }
        if before == state {
            return;
        }
        for (line, place) in self.delayed.get(slot as usize).into_iter().flatten() {
            let (_, shown) = self.lines[*line as usize].slots[*place as usize];
            self.note_state(shown, state, slots, touched);
        }
        // An assembled vector has a state as long as a part of it has one.
        let mixed = |state: u64| state.wrapping_mul(2 * u64::from(slot) + 1);
        for part in self.parts.get(slot as usize).into_iter().flatten() {
            let whole = touched.states.get(self.number, part.whole) ^ mixed(before) ^ mixed(state);
            self.note_state(part.whole, whole, slots, touched);
        }
    }

    /// Forgets the events since the last sample: they have been compared, or are not to be.
    pub(super) fn forget_events(&mut self, touched: &mut Touched) {
        for slot in self.events.drain(..) {
            if self.values.set(slot, &[0, 0]) {
                for pair in self.pairs.get(slot) {
                    touched.listed.touch(*pair);
                }
            }
        }
    }

    /// Returns the slots with values of another kind than declared that take part in the comparison.
    pub(super) fn odd(&self) -> Vec<u32> {
        let takes_part = |slot: &u32| {
            !self.pairs.get(*slot).is_empty()
                || self.parts.get(*slot as usize).is_some_and(|parts| !parts.is_empty())
                || self.delayed.get(*slot as usize).is_some_and(|lines| !lines.is_empty())
        };
        let mut odd: Vec<u32> = self.feed.odd().iter().copied().filter(takes_part).collect();
        odd.sort_unstable();
        odd.dedup();
        odd
    }

    /// Returns whether every value goes directly to the pairs: none is assembled, delayed or held back.
    pub(super) fn is_plain(&self) -> bool {
        self.parts.is_empty() && self.lines.is_empty() && self.settle.is_none()
    }

    /// Returns the current step.
    pub(super) fn step(&self) -> Option<Step> {
        self.feed.step().copied()
    }

    pub(super) fn feed(&self) -> &Feed {
        &self.feed
    }

    /// Returns the number of femtoseconds per unit of time.
    pub(super) fn unit_fs(&self) -> u128 {
        self.unit_fs
    }

    /// Returns the pairs that read a slot.
    pub(super) fn pairs_of(&self, slot: u32) -> &[u32] {
        self.pairs.get(slot)
    }

    /// Continues with another feed of the same file. Its first step is either an edge that was already returned or not
    /// an edge.
    pub(super) fn go_on(&mut self, feed: Feed, at_edge: bool) -> Result<(), WaveError> {
        let before = std::mem::replace(&mut self.feed, feed);
        self.feed.continue_from(before);
        self.feed.advance()?;
        self.at_edge = at_edge;
        Ok(())
    }

    /// Returns the slot of the reset, until it has been released.
    pub(super) fn reset_slot(&self) -> Option<u32> {
        self.reset.map(|(slot, _)| slot)
    }
}

/// Values that follow from a slot's value.
struct Following<'a> {
    pairs: &'a Lists,
    parts: &'a [Vec<PartOf>],
    delayed: &'a [Vec<(u32, u32)>],
}

impl Following<'_> {
    fn follow(&self, slot: u32, values: &mut Values, lines: &mut [DelayLine], listed: &mut Listed) {
        for (line, place) in self.delayed.get(slot as usize).into_iter().flatten() {
            lines[*line as usize].mark(*place);
        }
        for part in self.parts.get(slot as usize).into_iter().flatten() {
            part.copy(values);
            for pair in self.pairs.get(part.whole) {
                listed.touch(*pair);
            }
            self.follow(part.whole, values, lines, listed);
        }
    }
}

/// Returns the slot of a side.
pub(super) fn slot_of(slots: Slots, of_b: bool) -> u32 {
    slots[usize::from(of_b)]
}
