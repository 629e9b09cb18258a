//! Compares the pulses and entries with those that the recorded pins must give.

use super::counted::{at, of_quadrature, of_steps, pin};
use super::passages::{Passage, Row, While, high, of_row, pulses};
use super::touches::{Edge, edges, waiting};
use super::{AXIS_PINS, Armed, Entry, Positions, SHARED_PINS};
use crate::fault_campaign::kind::FaultKind;
use crate::fault_campaign::machine::TICK_CLOCKS;
use crate::stage_bench::{PinChange, StageBench};
use posicast_testbench::Error;

/// Clocks from a write on the bus to the block, at most.
pub(super) const WRITE_CLOCKS: u64 = 4;
/// Clocks of a step over a position of the list, and a few more at the start.
const LIST_STEP_CLOCKS: u64 = 3;
const START_CLOCKS: u64 = 8;
/// Clocks about `ready` in which a count may pass or not.
const READY_CLOCKS: u64 = 2;
/// Clocks in which a pulse shows in `compare_passes`.
const PASSES_CLOCKS: u64 = 2;
/// A position of an absolute encoder is as old as a tick and a reading, at most.
const ABSOLUTE_CLOCKS: u64 = 2 * TICK_CLOCKS;
/// Counts by which readings that are extrapolated may be off: the velocity changes little in so few ticks.
const EXTRAPOLATED_COUNTS: i64 = 2;

/// Clocks until a row is ready, after the write: a step for each position, at most.
pub(super) fn ready_clocks(row: &Row) -> u64 {
    let step = if row.in_list { LIST_STEP_CLOCKS } else { 1 };
    WRITE_CLOCKS + START_CLOCKS + step * row.positions.len() as u64
}

/// The record of a case.
struct Record<'a> {
    changes: &'a [PinChange],
    /// The first clock after it.
    end: u64,
    /// Clock of a reset in the case.
    reset: Option<u64>,
    /// First clock after the first reset.
    start: u64,
}

impl Record<'_> {
    fn of(bench: &StageBench) -> Record<'_> {
        let changes = bench.recorded_pins();
        let resets = pin(changes, 0);
        let mut falls = resets.iter().filter(|change| !change.1).map(|change| change.0);
        let start = falls.next().unwrap_or(0);
        let again = resets.iter().find(|change| change.1 && change.0 > start);
        Record {
            changes,
            end: bench.now(),
            reset: again.map(|change| change.0),
            start,
        }
    }

    /// The recorded changes of a pin of an axis.
    fn axis_pin(&self, axis: usize, pin_of_axis: usize) -> Vec<(u64, bool)> {
        pin(self.changes, SHARED_PINS + axis * AXIS_PINS + pin_of_axis)
    }

    /// Clock from which on nothing happens any more.
    fn until(&self, clock: u64) -> u64 {
        self.reset.map_or(clock, |reset| clock.min(reset + 1))
    }
}

impl Positions {
    /// Judges pulses and entries; returns descriptions of what is wrong.
    pub(in crate::fault_campaign) fn judge(&self, bench: &mut StageBench) -> Result<Vec<String>, Error> {
        let mut failures = Vec::new();
        let mut counts = Vec::new();
        for axis in 0..2 {
            let name = bench.axes()[axis].clone();
            if self.armed[axis].is_empty() {
                counts.push(bench.recorded_counts(axis).to_vec());
                continue;
            }
            let passes = bench.read(&format!("{name}_compare_passes"))?;
            let record = Record::of(bench);
            let lines = [0, 1].map(|line| record.axis_pin(axis, line));
            let counted = if bench.plant(axis).has_steps() {
                of_steps(&lines[0], &lines[1])
            } else {
                of_quadrature(lines, self.encoder_filter_clocks[axis], record.end)
            };
            let found = self.pulses(&record, axis, &counted, passes);
            failures.extend(found.into_iter().map(|what| format!("{name}: compare: {what}")));
            counts.push(counted);
        }
        let record = Record::of(bench);
        let found = self.entries(&record, bench, &counts);
        failures.extend(found.into_iter().map(|what| format!("capture: {what}")));
        Ok(failures)
    }

    /// Judges the pulses of an axis. Where a write or `ready` meets an edge, either order is right.
    fn pulses(&self, record: &Record<'_>, axis: usize, counts: &[(u64, i64)], passes: u32) -> Vec<String> {
        let mut failures = Vec::new();
        for armed in &self.armed[axis] {
            let took = armed.ready - armed.written;
            if took > ready_clocks(&armed.row) {
                failures.push(format!("not ready {took} clocks after it was armed"));
            }
        }
        let until = record.until(record.end);
        let seen = high(&record.axis_pin(axis, 2), record.end);
        let possible = possible(&self.armed[axis], counts);
        let all: Vec<Passage> = possible.last().cloned().unwrap_or_default().concat();
        let right = possible.iter().find(|rows| pulses(&rows.concat(), until).0 == seen);
        let Some(rows) = right else {
            let wanted = pulses(&all, until).0;
            let place = wanted.iter().zip(&seen).take_while(|(one, other)| one == other).count();
            failures.push(format!(
                "{} pulses instead of {}; pulse {place}: clocks {:?} instead of {:?}",
                seen.len(),
                wanted.len(),
                seen.get(place),
                wanted.get(place)
            ));
            return failures;
        };
        let last = rows.last().map_or(&[][..], Vec::as_slice);
        let by = |clock: u64| last.iter().filter(|passage| passage.clock <= clock).count() as u32;
        let most = [record.end - 2 * PASSES_CLOCKS, record.end].map(by);
        let are = if record.reset.is_some() { [0, 0] } else { most };
        if !(are[0]..=are[1]).contains(&passes) {
            failures.push(format!("{passes} passes instead of {}", are[1]));
        }
        let merged = pulses(&rows.concat(), self.flags.clock).1;
        failures.extend(self.compare_flags(axis, merged));
        let ends = matches!(self.kind, FaultKind::CompareArmed | FaultKind::CompareDisarmed);
        if ends && rows.first().is_none_or(Vec::is_empty) {
            failures.push("no pulse before the row ended".to_owned());
        }
        let dense = matches!(self.kind, FaultKind::CompareGlitch | FaultKind::CompareFast);
        if dense && seen.len() < 100 {
            failures.push(format!("only {} pulses over a position on every count", seen.len()));
        }
        failures
    }

    fn compare_flags(&self, axis: usize, merged: bool) -> Vec<String> {
        let is_cleared = matches!(self.kind, FaultKind::ClearFaults | FaultKind::Reset);
        let mut failures = Vec::new();
        let [is_merged, jumped, refused] = self.flags.compare[axis];
        if is_merged != merged && !is_cleared {
            failures.push(format!("`compare_merged` is {is_merged}"));
        }
        if jumped {
            failures.push("`compare_jumped` is set".to_owned());
        }
        if refused != (self.kind == FaultKind::CompareWritten) {
            failures.push(format!("`compare_refused` is {refused}"));
        }
        if self.kind == FaultKind::CompareOverlaps && !is_merged {
            failures.push("no pulse met another".to_owned());
        }
        failures
    }

    fn entries(&self, record: &Record<'_>, bench: &StageBench, counts: &[Vec<(u64, i64)>]) -> Vec<String> {
        let line = pin(record.changes, 1);
        let late = if self.is_cleared { 0..=WRITE_CLOCKS } else { 0..=0 };
        let possible = late.map(|late| {
            let found = match record.reset {
                Some(_) => Vec::new(),
                None => edges(&self.touched, &line, [self.from + late, self.flags.clock]),
            };
            self.differences(record, bench, counts, &found)
        });
        let possible: Vec<_> = possible.collect();
        let right = possible.iter().find(|failures| failures.is_empty());
        right.or(possible.first()).cloned().unwrap_or_default()
    }

    /// Differences from these edges.
    fn differences(
        &self,
        record: &Record<'_>,
        bench: &StageBench,
        counts: &[Vec<(u64, i64)>],
        found: &[Edge],
    ) -> Vec<String> {
        let mut failures = Vec::new();
        let window_count = |axis: usize, clock: u64| {
            if bench.plant(axis).is_absolute() {
                self.absolute_count(axis, &counts[axis], clock, record.start)
            } else {
                at(&counts[axis], clock)
            }
        };
        let (mut entries, mut full, outside) = waiting(&self.touched, found, window_count);
        if self.kind == FaultKind::ProbeTaken {
            (entries, full) = (found.to_vec(), false);
        }
        let is = [self.flags.overflowed, self.flags.outside];
        if self.flags.edges as usize != found.len() || is != [full, outside] {
            failures.push(format!(
                "{} edges, overflowed and outside {is:?} instead of {}, {:?}",
                self.flags.edges,
                found.len(),
                [full, outside]
            ));
        }
        if self.taken.len() != entries.len() {
            failures.push(format!("{} entries instead of {}", self.taken.len(), entries.len()));
        }
        for (entry, edge) in self.taken.iter().zip(&entries) {
            let stamp = (edge.clock - record.start) as u32;
            let is_right = |axis: usize| {
                if bench.plant(axis).is_absolute() {
                    let is_lost = self.lost[axis].is_some_and(|lost| edge.clock >= lost);
                    is_lost || self.within(&counts[axis], edge.clock, entry.counts[axis])
                } else {
                    entry.counts[axis] == at(&counts[axis], edge.clock)
                }
            };
            if entry.rising != edge.rising || entry.stamp != stamp || !(0..2).all(is_right) {
                let positions = [0, 1].map(|axis| at(&counts[axis], edge.clock));
                let wanted = Entry {
                    counts: positions,
                    stamp,
                    rising: edge.rising,
                };
                failures.push(format!("{entry:?} instead of {wanted:?}"));
                break;
            }
        }
        failures.extend(self.of_kind(found.len()));
        failures
    }

    /// Whether the plant had this count within a tick and a reading before the clock. Readings that fail are extrapolated.
    fn within(&self, counts: &[(u64, i64)], clock: u64, count: i64) -> bool {
        let off_by = if self.kind == FaultKind::AbsoluteBrief {
            EXTRAPOLATED_COUNTS
        } else {
            0
        };
        let had = read_before(counts, clock);
        had.iter().any(|change| (change.1 - count).abs() <= off_by)
    }

    /// The count of an absolute encoder that is compared with a window: that of the entry. An edge without an entry may have been
    /// outside if any count of a tick and a reading before was.
    fn absolute_count(&self, axis: usize, counts: &[(u64, i64)], clock: u64, start: u64) -> i64 {
        let stamp = (clock - start) as u32;
        if let Some(entry) = self.taken.iter().find(|entry| entry.stamp == stamp) {
            return entry.counts[axis];
        }
        let is_outside = |count: i64| {
            let window = self.touched.window;
            window.is_some_and(|(_, first, last)| !(first..=last).contains(&count))
        };
        let mut had = read_before(counts, clock).iter().map(|change| change.1);
        had.find(|count| is_outside(*count)).unwrap_or(at(counts, clock))
    }

    /// What a kind must lead to, whatever its random settings: edges before the two of the touch at rest.
    fn of_kind(&self, edges: usize) -> Option<String> {
        let rest = self.touched.wanted.iter().filter(|wanted| **wanted).count();
        let is_right = match self.kind {
            FaultKind::ProbeBounces => edges == 2 + rest,
            FaultKind::ProbeShort | FaultKind::ProbeStuck => edges == rest,
            FaultKind::ProbeFull => edges > 16 + rest && self.flags.overflowed,
            FaultKind::ProbeTaken => edges == 30 + rest && self.taken.len() == edges,
            FaultKind::ProbeWindow => edges == 12 + rest,
            _ => true,
        };
        (!is_right).then(|| format!("{edges} edges are not those of this kind"))
    }
}

/// The counts of a plant within a tick and a reading before the clock.
fn read_before(counts: &[(u64, i64)], clock: u64) -> &[(u64, i64)] {
    let from = counts.partition_point(|change| change.0 + ABSOLUTE_CLOCKS <= clock);
    let to = counts.partition_point(|change| change.0 <= clock);
    &counts[from.saturating_sub(1)..to]
}

/// The passages of each row, for each order in which writes and `ready` may meet edges.
fn possible(armed: &[Armed], counts: &[(u64, i64)]) -> Vec<Vec<Vec<Passage>>> {
    let mut all = vec![Vec::new()];
    for armed in armed {
        let begins = armed.ready.saturating_sub(READY_CLOCKS)..=armed.ready + READY_CLOCKS;
        let ends = match armed.ended {
            Some(written) => written.saturating_sub(READY_CLOCKS)..=written + WRITE_CLOCKS,
            None => u64::MAX..=u64::MAX,
        };
        let mut of_this: Vec<Vec<Passage>> = Vec::new();
        for begin in begins {
            for end in ends.clone() {
                let passages = of_row(&armed.row, While { clocks: [begin, end] }, counts);
                if !of_this.contains(&passages) {
                    of_this.push(passages);
                }
            }
        }
        all = all
            .iter()
            .flat_map(|before: &Vec<Vec<Passage>>| {
                of_this.iter().map(|passages| {
                    let mut rows = before.clone();
                    rows.push(passages.clone());
                    rows
                })
            })
            .collect();
    }
    all
}
