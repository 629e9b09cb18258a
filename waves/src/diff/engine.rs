//! Compares what changed, at the samples or at every change.
//!
//! The cost of a sample is the number of signals that changed since the previous one: a pair that did not change
//! stays as equal or as different as it was, and its count is added when that state ends.

use std::collections::{BTreeMap, BTreeSet};

use super::alike::Alike;
use super::cells::{GENERAL, cells};
use super::gather::Gathering;
use super::matching::Pair;
use super::options::DiffOptions;
use super::result::{Difference, SignalState};
use super::rule::Rule;
use super::side::Side;
use super::touched::Touched;
use super::value::Shown;
use crate::WaveError;
use crate::reader::{Kind, Value, Values, value};

pub(super) const PROGRESS_SAMPLES: u64 = 1 << 14;

/// Progress of a comparison.
#[derive(Debug, Clone, Copy, Default)]
pub struct Progress {
    /// Number of samples compared.
    pub samples: u64,
    /// Number of bytes read from both files.
    pub bytes: u64,
    /// Length of both files in bytes; `None` if one is a pipe.
    pub total_bytes: Option<u64>,
}

#[derive(Debug, Clone)]
pub(super) struct First {
    pub(super) time_fs: u128,
    pub(super) a: Shown,
    pub(super) b: Shown,
    pub(super) a_number: Option<f64>,
    pub(super) b_number: Option<f64>,
}

/// Data that the comparison of words needs, close together in memory.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hot {
    pub(super) a: Option<u32>,
    pub(super) b: Option<u32>,
    /// The cell that holds its values, or [`GENERAL`].
    pub(super) cell: u32,
    pub(super) different: bool,
}

#[derive(Debug)]
pub(super) struct State {
    pub(super) name: String,
    pub(super) rule: Rule,
    /// Sample and time since which the pair differs, and its values then.
    pub(super) since: Option<(u64, First)>,
    pub(super) count: u64,
    pub(super) first: Option<First>,
    /// The largest distance of its two numbers where they differ; `None` where a value was no number.
    pub(super) largest: Option<f64>,
}

pub(super) struct Engine<'a> {
    pub(super) a: Side,
    pub(super) b: Side,
    pub(super) hot: Vec<Hot>,
    pub(super) states: Vec<State>,
    pub(super) touched: Touched,
    pub(super) options: &'a DiffOptions,
    pub(super) samples: u64,
    pub(super) total_bytes: Option<u64>,
    /// Values per pair when the pair was last equal; kept until the first difference.
    pub(super) before: Option<(Values, u128)>,
    pub(super) context: Option<Gathering>,
    /// Edges of the clock that the other file does not have.
    pub(super) surplus: Option<Difference>,
    /// First time at which paired edges are at different times.
    pub(super) shifted_fs: Option<u128>,
    /// Number of samples that one file does not record.
    pub(super) unrecorded: u64,
    /// Number of differences that did not last longer than the time tolerance.
    pub(super) forgiven: u64,
    pub(super) alike: Alike,
    /// Whether each file has no change.
    pub(super) is_empty: [bool; 2],
    /// Pairs that are equal only as 0, 1, `x` and `z`, while the files have further states.
    pub(super) collapsed: BTreeSet<u32>,
    /// Pairs of real numbers that are equal only to the digits that a VCD has.
    pub(super) rounded: BTreeSet<u32>,
    /// Pairs with changes after the last edge, and whether their values then differ; and the number of these changes.
    pub(super) behind: BTreeMap<u32, bool>,
    pub(super) behind_changes: u64,
    /// All signals at the first difference, if they were requested.
    pub(super) state: Vec<SignalState>,
}

impl<'a> Engine<'a> {
    pub(super) fn new(
        a: Side,
        b: Side,
        pairs: Vec<(Pair, Rule)>,
        options: &'a DiffOptions,
        total_bytes: Option<u64>,
    ) -> Self {
        let mut before = Values::default();
        let mut hot = Vec::new();
        let mut states = Vec::new();
        let (cells, cell_of) = cells(&a, &b, &pairs);
        for ((pair, rule), cell) in pairs.into_iter().zip(cell_of) {
            let kinds = [
                pair.a.map(|slot| a.values.kind(slot)),
                pair.b.map(|slot| b.values.kind(slot)),
            ];
            before.add(kinds.into_iter().flatten().next().unwrap_or(Kind::Event));
            hot.push(Hot {
                a: pair.a,
                b: pair.b,
                cell,
                different: false,
            });
            states.push(State {
                name: pair.name,
                rule,
                since: None,
                count: 0,
                first: None,
                largest: Some(0.0),
            });
        }
        let mut touched = Touched::new(states.len());
        touched.leave_to(cells, |at| hot[at as usize].cell != GENERAL);
        Self {
            a,
            b,
            touched,
            hot,
            states,
            options,
            samples: 0,
            total_bytes,
            before: Some((before, 0)),
            context: None,
            surplus: None,
            shifted_fs: None,
            unrecorded: 0,
            forgiven: 0,
            alike: Alike::default(),
            is_empty: [false; 2],
            collapsed: BTreeSet::new(),
            rounded: BTreeSet::new(),
            behind: BTreeMap::new(),
            behind_changes: 0,
            state: Vec::new(),
        }
    }

    /// Excludes these pairs from the comparison until a delayed value has arrived.
    pub(super) fn wait_for(&mut self, pairs: impl Iterator<Item = u32>) {
        for pair in pairs {
            self.touched.waiting[pair as usize] = true;
        }
    }

    /// Reads the first step of both files.
    pub(super) fn start(&mut self) -> Result<(), WaveError> {
        for (side, empty) in [&mut self.a, &mut self.b].into_iter().zip(&mut self.is_empty) {
            side.start()?;
            *empty = side.has_ended();
        }
        Ok(())
    }

    /// Compares at every time at which something changes.
    pub(super) fn at_changes(&mut self, progress: &mut dyn FnMut(Progress)) -> Result<(), WaveError> {
        self.start()?;
        let glitch_fs = self.options.glitch_fs;
        loop {
            self.follow_alike(false, progress)?;
            match (self.a.has_ended(), self.b.has_ended()) {
                (true, true) => {
                    self.a.forget_delayed();
                    self.b.forget_delayed();
                }
                (false, true) if self.b.feed().cut().is_some() => return Ok(()),
                (true, false) if self.a.feed().cut().is_some() => return Ok(()),
                (false, true) => self.b.cut_off()?,
                (true, false) => self.a.cut_off()?,
                (false, false) => {}
            }
            let next = [self.a.next_time(), self.b.next_time()].into_iter().flatten().min();
            let Some(time) = next else { return Ok(()) };
            // With a glitch filter, a value takes effect when it has lasted long enough; it began before.
            let began = time.saturating_sub(glitch_fs);
            if self.options.end_fs.is_some_and(|end| began > end) {
                return Ok(());
            }
            let in_a = self.a.next_time() == Some(time) && self.a.advance_to(time, &mut self.touched)?;
            let in_b = self.b.next_time() == Some(time) && self.b.advance_to(time, &mut self.touched)?;
            let wanted = self.options.start_fs.is_none_or(|start| began >= start);
            if (in_a || in_b) && wanted {
                if self.a.is_off() || self.b.is_off() {
                    self.unrecorded += 1;
                    self.forget_events();
                } else {
                    self.compare(began, progress);
                    if self.is_stopped() {
                        return Ok(());
                    }
                }
            }
        }
    }

    /// Returns whether the first difference was found and no other was requested.
    pub(super) fn is_stopped(&self) -> bool {
        self.options.first && self.context.is_some()
    }

    pub(super) fn compare(&mut self, time_fs: u128, progress: &mut dyn FnMut(Progress)) {
        let Self {
            a,
            b,
            hot,
            states,
            touched,
            before,
            rounded,
            ..
        } = self;
        let mut diverged: Vec<u32> = Vec::new();
        let mut ended: Vec<u32> = Vec::new();
        if !touched.cells.all_equal() {
            let cells = &touched.cells;
            for cell in cells.noted() {
                let equal = cells.is_equal(cell);
                let list = if equal { &mut ended } else { &mut diverged };
                let pairs = cells.pairs.get(cell).iter();
                list.extend(pairs.filter(|pair| equal == hot[**pair as usize].different));
            }
            for list in [&mut ended, &mut diverged] {
                list.sort_unstable();
                list.dedup();
            }
        }
        let is_waiting = std::mem::take(&mut touched.waiting);
        touched.drain(|at| {
            if is_waiting[at as usize] {
                return;
            }
            let pair = hot[at as usize];
            let state = &mut states[at as usize];
            let equal = match (pair.a, pair.b) {
                (Some(slot_a), Some(slot_b)) => {
                    let (a, b) = (a.values.get(slot_a), b.values.get(slot_b));
                    let equal = state.rule.equal(a, b);
                    if equal && state.rule.rounds(a, b) {
                        rounded.insert(at);
                    }
                    if !equal {
                        let largest = state.largest.zip(state.rule.distance(a, b));
                        state.largest = largest.map(|(largest, distance)| largest.max(distance));
                    }
                    equal
                }
                _ => false,
            };
            if equal && let (Some((before, _)), Some(slot)) = (before.as_mut(), pair.a) {
                before.set(at, a.values.words(slot));
            }
            if equal == pair.different {
                if equal { ended.push(at) } else { diverged.push(at) }
            }
        });
        touched.waiting = is_waiting;
        for at in ended {
            self.end(at as usize, time_fs);
        }
        // They are in the order of the file, so that the report does not depend on the order of the changes.
        diverged.sort_unstable();
        for at in &diverged {
            self.begin(*at as usize, time_fs);
        }
        self.gather(&diverged, time_fs);
        for at in self.touched.states.take() {
            let pair = self.hot[at as usize];
            if let (Some(a), Some(b), false) = (pair.a, pair.b, pair.different)
                && self.touched.states.get(0, a) != self.touched.states.get(1, b)
            {
                self.collapsed.insert(at);
            }
        }
        self.touched.cells.forget_noted();
        self.forget_events();
        self.samples += 1;
        if self.samples.is_multiple_of(PROGRESS_SAMPLES) {
            self.report(progress);
        }
    }

    pub(super) fn report(&self, progress: &mut dyn FnMut(Progress)) {
        progress(Progress {
            samples: self.samples,
            bytes: self.a.bytes() + self.b.bytes(),
            total_bytes: self.total_bytes,
        });
    }

    /// Looks at what comes after the last edge, which no sample sees.
    pub(super) fn look_behind_last_edge(&mut self) {
        let mut behind = Vec::new();
        for side in [&mut self.a, &mut self.b] {
            for (slot, count) in side.hidden.take_now() {
                self.behind_changes += count;
                behind.extend(side.pair_of(slot));
            }
        }
        for pair in behind {
            let equal = match self.values(pair as usize) {
                (Some(a), Some(b)) => self.states[pair as usize].rule.equal(a, b),
                _ => true,
            };
            let was_equal = !self.hot[pair as usize].different;
            self.behind.insert(pair, was_equal && !equal);
        }
    }

    /// Returns the slots of each file with values of another kind than declared.
    pub(super) fn odd(&self) -> [BTreeSet<u32>; 2] {
        [&self.a, &self.b].map(|side| side.odd().into_iter().collect())
    }

    fn forget_events(&mut self) {
        self.a.forget_events(&mut self.touched);
        self.b.forget_events(&mut self.touched);
    }

    pub(super) fn values(&self, at: usize) -> (Option<Value<'_>>, Option<Value<'_>>) {
        let pair = self.hot[at];
        if let (true, Some(slot)) = (pair.cell != GENERAL, pair.a) {
            let both = self.touched.cells.both(pair.cell);
            let [a, b] = both.map(|words| value(self.a.values.kind(slot), words));
            return (Some(a), Some(b));
        }
        (
            pair.a.map(|slot| self.a.values.get(slot)),
            pair.b.map(|slot| self.b.values.get(slot)),
        )
    }

    /// Returns the value of a pair at the previous sample, when both were equal.
    fn shown_before(&self, at: usize, before: &Values) -> (Shown, Shown) {
        let pair = self.hot[at];
        let words;
        let value = match (pair.a, pair.b) {
            (Some(slot), Some(_)) if pair.cell != GENERAL => {
                words = self.touched.cells.before(pair.cell);
                Some(value(self.a.values.kind(slot), &words))
            }
            (Some(_), Some(_)) => Some(before.get(at as u32)),
            _ => None,
        };
        self.states[at].rule.shown(value, value)
    }

    fn state_of_all(&self, before: Option<&Values>) -> Vec<SignalState> {
        let state = |at: usize| {
            let rule = self.states[at].rule;
            let (a, b) = self.values(at);
            let (a, b) = rule.shown(a, b);
            SignalState {
                signal: self.states[at].name.clone(),
                before: before.map_or(Shown::Missing, |before| self.shown_before(at, before).0),
                a,
                b,
                view: rule.reading(),
            }
        };
        (0..self.states.len()).map(state).collect()
    }

    fn begin(&mut self, at: usize, time_fs: u128) {
        let (a, b) = self.values(at);
        let rule = self.states[at].rule;
        let (a_number, b_number) = (rule.number(a), rule.number(b));
        let (a, b) = rule.shown(a, b);
        let first = First {
            time_fs,
            a,
            b,
            a_number,
            b_number,
        };
        self.hot[at].different = true;
        self.touched.cells.different += usize::from(self.hot[at].cell != GENERAL);
        self.states[at].since = Some((self.samples, first));
    }

    fn end(&mut self, at: usize, time_fs: u128) {
        self.hot[at].different = false;
        self.touched.cells.different -= usize::from(self.hot[at].cell != GENERAL);
        let state = &mut self.states[at];
        let Some((since, first)) = state.since.take() else {
            return;
        };
        if time_fs - first.time_fs <= self.options.time_tolerance_fs {
            self.forgiven += 1;
            return;
        }
        state.count += self.samples - since;
        state.first.get_or_insert(first);
    }

    /// Collects the values around the first divergence of all: the last equal sample, the diverging one, and some
    /// after it.
    fn gather(&mut self, diverged: &[u32], time_fs: u128) {
        if self.context.is_none() && !diverged.is_empty() {
            let of = |at: usize| (self.states[at].name.clone(), self.states[at].rule.reading());
            let mut gathering = Gathering::new(self.samples, diverged, of);
            let before = self.before.take().filter(|_| self.samples > 0);
            if let Some((before, before_fs)) = &before {
                gathering.add(*before_fs, |at| self.shown_before(at, before));
            }
            if self.options.first {
                self.state = self.state_of_all(before.as_ref().map(|(before, _)| before));
            }
            self.context = Some(gathering);
        }
        if let Some((_, before_fs)) = &mut self.before {
            *before_fs = time_fs;
        }
        if let Some(mut gathering) = self.context.take() {
            gathering.add_behind(time_fs, |at| {
                let (a, b) = self.values(at);
                self.states[at].rule.shown(a, b)
            });
            self.context = Some(gathering);
        }
    }
}
