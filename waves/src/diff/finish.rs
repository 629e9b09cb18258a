//! Converts the engine's findings into the result.

use std::collections::BTreeSet;

use super::engine::Engine;
use super::result::{Comparison, CutFile, Difference, Unsampled, seconds};
use crate::wording::{counted, time};

impl Engine<'_> {
    /// Returns what no sample saw; `None` if there is nothing.
    fn unsampled(&self, has_clock: bool) -> Option<Unsampled> {
        let mut unsampled = Unsampled::default();
        let mut signals = BTreeSet::new();
        for side in [&self.a, &self.b] {
            for (slot, count) in side.hidden.counts() {
                if let Some(pair) = side.pair_of(slot) {
                    signals.insert(pair);
                    unsampled.changes += count;
                }
            }
        }
        let name = |pair: &u32| self.states[*pair as usize].name.clone();
        unsampled.between_edges = has_clock;
        unsampled.signals = signals.iter().map(name).collect();
        unsampled.changes_after = self.behind_changes;
        unsampled.signals_after = self.behind.keys().map(name).collect();
        let differ = self.behind.iter().filter(|(_, differs)| **differs);
        unsampled.differ_after = differ.map(|(pair, _)| name(pair)).collect();
        (unsampled.changes + unsampled.changes_after > 0).then_some(unsampled)
    }

    /// Writes the findings into the result.
    pub(super) fn finish(self, comparison: &mut Comparison) {
        for at in &self.collapsed {
            comparison.collapsed.push(self.states[*at as usize].name.clone());
        }
        if let [first, ..] = comparison.collapsed.as_slice() {
            comparison.notes.push(format!(
                "equal only after reducing other states to 0, 1, x and z (VHDL's L to 0, H to 1, U, W and - to x; an EVCD's drivers and \
                 strengths): {}, such as {first}",
                counted(comparison.collapsed.len() as u64, "signal")
            ));
            comparison.exact = false;
        }
        for at in &self.rounded {
            comparison.rounded.push(self.states[*at as usize].name.clone());
        }
        comparison.unsampled = self.unsampled(comparison.clock.is_some());
        comparison
            .notes
            .extend(comparison.unsampled.iter().flat_map(Unsampled::notes));
        if let [first, ..] = comparison.rounded.as_slice() {
            comparison.notes.push(format!(
                "equal to 16 digits, as many as a VCD has of a real number, but not to the last bit of the FST: {}, such as {first}",
                counted(comparison.rounded.len() as u64, "signal")
            ));
            comparison.exact = false;
        }
        for (side, file) in [(&self.a, "first"), (&self.b, "second")] {
            let notes = side.feed().notes().iter();
            comparison
                .notes
                .extend(notes.map(|note| format!("the {file} file: {note}")));
        }
        let mut differences: Vec<(u128, Difference)> = Vec::new();
        for state in self.states {
            // A difference at the end of the files has no end within the tolerance.
            let persistent = state.since.is_some();
            let since = state.since.as_ref().map_or(0, |(since, _)| self.samples - since);
            let Some(first) = state.first.or(state.since.map(|(_, first)| first)) else {
                continue;
            };
            let difference = Difference {
                signal: state.name,
                time: seconds(first.time_fs),
                a: first.a,
                b: first.b,
                count: state.count + since,
                persistent,
                a_number: first.a_number,
                b_number: first.b_number,
                largest: state.largest.filter(|largest| *largest > 0.0),
                view: state.rule.reading(),
            };
            differences.push((first.time_fs, difference));
        }
        // The sort is stable: signals with the same first time stay in the order of the file.
        differences.sort_by_key(|(time_fs, _)| *time_fs);
        let mut differences: Vec<Difference> = differences.into_iter().map(|(_, difference)| difference).collect();
        differences.extend(self.surplus);
        if let Some(time_fs) = self.shifted_fs {
            comparison.notes.push(format!(
                "the clock's edges lie at different times from {} on: compared edge by edge",
                time(time_fs)
            ));
        }
        let [held_a, held_b] = [self.a.held_in_reset, self.b.held_in_reset];
        if held_a + held_b > 0 {
            comparison.notes.push(format!(
                "not compared while in reset: {} of the first file, {held_b} of the second",
                counted(held_a, "edge")
            ));
        }
        if self.unrecorded > 0 {
            comparison.notes.push(format!(
                "not recorded in one file ($dumpoff) and not compared: {}",
                counted(self.unrecorded, "sample")
            ));
            comparison.exact = false;
        }
        if self.forgiven > 0 {
            comparison.notes.push(format!(
                "no longer than the time tolerance and not counted: {}",
                counted(self.forgiven, "difference")
            ));
        }
        for (side, file) in [(&self.a, "first"), (&self.b, "second")] {
            if let Some(byte) = side.feed().cut() {
                let place = format!("byte {byte}");
                comparison.notes.push(format!(
                    "the {file} file is cut off at {place}: compared up to the last whole time before it"
                ));
                comparison.cut.push(CutFile { file, place });
            }
        }
        if !self.state.is_empty() {
            comparison
                .notes
                .push("stopped at the first difference: what comes after it was not compared".to_owned());
            comparison.state = self.state;
        }
        for file in self
            .is_empty
            .iter()
            .zip(["first", "second"])
            .filter(|(empty, _)| **empty && self.samples == 0)
        {
            comparison.notes.push(format!("the {} file has no change", file.1));
        }
        comparison.context = self.context.map(|gathering| gathering.context);
        comparison.conclude(self.samples, differences);
    }
}
