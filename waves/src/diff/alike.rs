//! Follows stretches in which both files are equal byte for byte.
//!
//! Between two samples, the engine knows the values of both files, and the places at which they continue. If the bytes
//! from there on are equal, only one file has to be parsed ([`Twins`]): the samples are counted, and the latest values
//! are taken over. A pair that differs continues to differ until one of its signals changes, which ends the stretch.

use super::cells::GENERAL;
use super::engine::{Engine, Progress};
use crate::WaveError;
use crate::reader::{NOWHERE, Stretch, Twins};

/// Number of bytes of the first file that are read separately before the next attempt.
const BETWEEN_TRIES: u64 = if cfg!(test) { 0 } else { 1 << 23 };

/// Decides whether and when to look for such a stretch.
#[derive(Default)]
pub(super) struct Alike {
    twins: Option<Twins>,
    next_try: u64,
}

impl Engine<'_> {
    /// Looks for such stretches from now on, if these files may have them.
    pub(super) fn look_for_alike(&mut self) {
        let same_slots = self.hot.iter().all(|pair| pair.a.is_some() && pair.a == pair.b);
        let plain = self.a.is_plain() && self.b.is_plain() && self.a.unit_fs() == self.b.unit_fs();
        if same_slots && plain && self.options.end_fs.is_none() {
            self.alike.twins = Twins::new(self.a.feed(), self.b.feed());
        }
    }

    /// Follows the files as long as they are equal from here on. `at_edge` tells that the current step of both is an
    /// edge that was just sampled. Returns the times of the last sample and of the previous one, if there were any.
    pub(super) fn follow_alike(
        &mut self,
        at_edge: bool,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Option<[u128; 2]>, WaveError> {
        let bytes = self.a.bytes();
        if self.alike.twins.is_none() || bytes < self.alike.next_try || !self.may_be_alike() {
            return Ok(None);
        }
        self.alike.next_try = bytes + BETWEEN_TRIES;
        let (Some(step_a), Some(step_b)) = (self.a.step(), self.b.step()) else {
            return Ok(None);
        };
        let places = [step_a.place, step_b.place];
        if step_a.time != step_b.time || places.contains(&NOWHERE) {
            return Ok(None);
        }
        let Some(twins) = self.alike.twins.clone() else {
            return Ok(None);
        };
        let Some(stretch) = self.follow(&twins, places, progress) else {
            return Ok(None);
        };
        let [feed_a, feed_b] = twins.resume(&stretch)?;
        self.a.go_on(feed_a, at_edge)?;
        self.b.go_on(feed_b, at_edge)?;
        self.alike.next_try = stretch.places[0] + BETWEEN_TRIES;
        let unit_fs = self.a.unit_fs();
        let [last, before] = stretch.times.map(|time| time.map(|time| u128::from(time) * unit_fs));
        self.samples += stretch.samples;
        if let (Some((_, before_fs)), Some(last)) = (&mut self.before, last) {
            *before_fs = last;
        }
        Ok(last.zip(before).map(|(last, before)| [last, before]))
    }

    fn may_be_alike(&self) -> bool {
        let context_is_whole = self.context.as_ref().is_none_or(|context| !context.is_missing_some());
        let recorded = !self.a.is_off() && !self.b.is_off();
        // Up to the first sample, signals that have had no value yet are noted as changed.
        let started = self.samples > 0;
        let released = self.a.reset_slot().is_none() && self.b.reset_slot().is_none();
        context_is_whole && recorded && started && released
    }

    fn follow(&mut self, twins: &Twins, places: [u64; 2], progress: &mut dyn FnMut(Progress)) -> Option<Stretch> {
        let mut stop = vec![false; self.a.values.count()];
        for pair in &self.hot {
            let Some(slot) = pair.a else { continue };
            stop[slot as usize] |= match pair.cell {
                GENERAL => self.a.values.words(slot) != self.b.values.words(slot),
                cell => !self.touched.cells.is_equal(cell),
            };
        }
        let samples = self.samples;
        let total_bytes = self.total_bytes;
        let Self {
            a, b, touched, before, ..
        } = self;
        let mut apply = |slot: u32, words: &[u64], state: u64| {
            touched.states.set_both(slot, state, a.values.count());
            let cell = touched.cells.of(0, slot);
            if cell != GENERAL
                && let [bits, unknown] = *words
            {
                touched.cells.set_both(cell, [bits, unknown]);
                return;
            }
            a.values.set(slot, words);
            b.values.set(slot, words);
            if let Some((before, _)) = before.as_mut() {
                for pair in a.pairs_of(slot) {
                    before.set(*pair, words);
                }
            }
        };
        let mut on_progress = |stretch: &Stretch| {
            progress(Progress {
                samples: samples + stretch.samples,
                bytes: stretch.places.iter().sum(),
                total_bytes,
            });
        };
        twins.follow(places, &stop, &mut apply, &mut on_progress)
    }
}
