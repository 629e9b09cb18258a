//! Reads both files in step and compares what changed.
//!
//! The cost of a sample is the number of signals that changed since the last one: a pair that did not change stays as
//! equal or as different as it was, and its count is added up when that ends.

use super::equality;
use super::matching::Pair;
use super::result::{Comparison, Difference, Shown};
use crate::Error;
use crate::reader::Reader;

const PROGRESS_SAMPLES: u64 = 1 << 16;

struct First {
    time_fs: u128,
    a: Shown,
    b: Shown,
}

struct State {
    pair: Pair,
    tolerance: Option<f64>,
    /// Sample since which it differs.
    since: Option<u64>,
    count: u64,
    first: Option<First>,
    touched: bool,
}

/// Pairs to look at again.
struct Touched {
    /// For each slot: its pairs.
    of_a: Vec<Vec<u32>>,
    of_b: Vec<Vec<u32>>,
    list: Vec<u32>,
}

pub(super) struct Engine {
    a: Reader,
    b: Reader,
    states: Vec<State>,
    touched: Touched,
    samples: u64,
    /// Edges of the clock that the other file does not have.
    surplus: Option<Difference>,
    /// First time at which paired edges lie at different times.
    shifted_fs: Option<u128>,
}

impl Engine {
    pub(super) fn new(a: Reader, b: Reader, pairs: impl Iterator<Item = (Pair, Option<f64>)>) -> Self {
        let mut touched = Touched {
            of_a: vec![Vec::new(); a.slot_count()],
            of_b: vec![Vec::new(); b.slot_count()],
            list: Vec::new(),
        };
        let states: Vec<State> = pairs
            .map(|(pair, tolerance)| State {
                pair,
                tolerance,
                since: None,
                count: 0,
                first: None,
                touched: true,
            })
            .collect();
        for (at, state) in (0..).zip(&states) {
            let put = |lists: &mut Vec<Vec<u32>>, slot: Option<u32>| {
                if let Some(slot) = slot {
                    lists[slot as usize].push(at);
                }
            };
            put(&mut touched.of_a, state.pair.a);
            put(&mut touched.of_b, state.pair.b);
            touched.list.push(at);
        }
        Self {
            a,
            b,
            states,
            touched,
            samples: 0,
            surplus: None,
            shifted_fs: None,
        }
    }

    /// Compares at the rising edges of the clock.
    pub(super) fn at_edges(&mut self, clock: (u32, u32), progress: &mut dyn FnMut(u64)) -> Result<(), Error> {
        loop {
            let a = next_edge(
                &mut self.a,
                clock.0,
                &self.touched.of_a,
                &mut self.touched.list,
                &mut self.states,
            )?;
            let b = next_edge(
                &mut self.b,
                clock.1,
                &self.touched.of_b,
                &mut self.touched.list,
                &mut self.states,
            )?;
            match (a, b) {
                (Some(a), Some(b)) => {
                    if a != b && self.shifted_fs.is_none() {
                        self.shifted_fs = Some(a);
                    }
                    self.compare(a, progress);
                }
                (None, None) => return Ok(()),
                (Some(time), None) => {
                    self.b.cut_off()?;
                    return self.count_surplus(clock, time, true);
                }
                (None, Some(time)) => {
                    self.a.cut_off()?;
                    return self.count_surplus(clock, time, false);
                }
            }
        }
    }

    /// One file has more edges than the other: a difference of the clock, from the first edge that is alone.
    fn count_surplus(&mut self, clock: (u32, u32), time_fs: u128, of_a: bool) -> Result<(), Error> {
        let (reader, slot, lists) = if of_a {
            (&mut self.a, clock.0, &self.touched.of_a)
        } else {
            (&mut self.b, clock.1, &self.touched.of_b)
        };
        let mut count = 1;
        while next_edge(reader, slot, lists, &mut self.touched.list, &mut self.states)?.is_some() {
            count += 1;
        }
        let edge = Shown::Bits("1".to_owned());
        let name = self
            .states
            .iter()
            .find(|s| (s.pair.a, s.pair.b) == (Some(clock.0), Some(clock.1)));
        self.surplus = Some(Difference {
            signal: name.map_or_else(String::new, |s| s.pair.name.clone()),
            time: seconds(time_fs),
            a: if of_a { edge.clone() } else { Shown::Missing },
            b: if of_a { Shown::Missing } else { edge },
            count,
        });
        Ok(())
    }

    /// Compares at every time at which something changes.
    pub(super) fn at_changes(&mut self, progress: &mut dyn FnMut(u64)) -> Result<(), Error> {
        let mut next_a = next_step(&mut self.a)?;
        let mut next_b = next_step(&mut self.b)?;
        while let Some(time) = [next_a, next_b].into_iter().flatten().min() {
            if next_a == Some(time) {
                self.a
                    .commit(touch(&self.touched.of_a, &mut self.touched.list, &mut self.states));
                next_a = next_step(&mut self.a)?;
            }
            if next_b == Some(time) {
                self.b
                    .commit(touch(&self.touched.of_b, &mut self.touched.list, &mut self.states));
                next_b = next_step(&mut self.b)?;
            }
            self.compare(time, progress);
            match (next_a, next_b) {
                (Some(_), None) => self.b.cut_off()?,
                (None, Some(_)) => self.a.cut_off()?,
                _ => {}
            }
        }
        Ok(())
    }

    fn compare(&mut self, time_fs: u128, progress: &mut dyn FnMut(u64)) {
        let sample = self.samples;
        for at in self.touched.list.drain(..) {
            let state = &mut self.states[at as usize];
            state.touched = false;
            let a = state.pair.a.map(|slot| self.a.now(slot));
            let b = state.pair.b.map(|slot| self.b.now(slot));
            let equal = match (a, b) {
                (Some(a), Some(b)) => equality::equal(a, b, state.tolerance),
                _ => false,
            };
            match (equal, state.since) {
                (true, Some(since)) => {
                    state.count += sample - since;
                    state.since = None;
                }
                (false, None) => {
                    state.since = Some(sample);
                    if state.first.is_none() {
                        let (a, b) = equality::shown(a, b, state.tolerance.is_some());
                        state.first = Some(First { time_fs, a, b });
                    }
                }
                (true, None) | (false, Some(_)) => {}
            }
        }
        self.samples += 1;
        if self.samples.is_multiple_of(PROGRESS_SAMPLES) {
            progress(self.samples);
        }
    }

    /// Writes what was found into the result.
    pub(super) fn finish(self, comparison: &mut Comparison) {
        let mut differences: Vec<(u128, Difference)> = Vec::new();
        for state in self.states {
            let Some(first) = state.first else { continue };
            let since = state.since.map_or(0, |since| self.samples - since);
            let difference = Difference {
                signal: state.pair.name,
                time: seconds(first.time_fs),
                a: first.a,
                b: first.b,
                count: state.count + since,
            };
            differences.push((first.time_fs, difference));
        }
        // Stable: signals that differ first at the same time stay in the order of the file.
        differences.sort_by_key(|(time_fs, _)| *time_fs);
        let mut differences: Vec<Difference> = differences.into_iter().map(|(_, difference)| difference).collect();
        differences.extend(self.surplus);
        if let Some(time_fs) = self.shifted_fs {
            comparison.notes.push(format!(
                "the clock's edges lie at different times from {} s on: compared edge by edge",
                seconds(time_fs)
            ));
        }
        comparison.conclude(self.samples, differences);
    }
}

/// Seconds, correctly rounded.
fn seconds(time_fs: u128) -> f64 {
    time_fs as f64 / 1e15
}

fn next_step(reader: &mut Reader) -> Result<Option<u128>, Error> {
    let unit_fs = u128::from(reader.unit_fs());
    Ok(reader.read_step()?.map(|time| u128::from(time) * unit_fs))
}

/// Goes on to the next rising edge; then `now` holds the values just before it.
fn next_edge(
    reader: &mut Reader,
    clock: u32,
    lists: &[Vec<u32>],
    list: &mut Vec<u32>,
    states: &mut [State],
) -> Result<Option<u128>, Error> {
    loop {
        reader.commit(touch(lists, list, states));
        let Some(time) = next_step(reader)? else {
            return Ok(None);
        };
        if reader.now(clock).is_bit(0) && reader.next(clock).is_bit(1) {
            return Ok(Some(time));
        }
    }
}

/// Marks the pairs of a slot that changed.
fn touch(lists: &[Vec<u32>], list: &mut Vec<u32>, states: &mut [State]) -> impl FnMut(u32) {
    move |slot| {
        for at in &lists[slot as usize] {
            let state = &mut states[*at as usize];
            if !state.touched {
                state.touched = true;
                list.push(*at);
            }
        }
    }
}
