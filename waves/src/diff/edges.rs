//! Compares at the edges of the clock, and pairs the edges of both files.

use super::clocking::Slots;
use super::engine::{Engine, PROGRESS_SAMPLES, Progress};
use super::gather::Gathering;
use super::options::SamplingEdge;
use super::result::{Difference, seconds};
use super::rule::View;
use super::side::{ClockEdge, slot_of};
use super::value::Shown;
use crate::WaveError;

impl Engine<'_> {
    /// Compares at the edges of the clock.
    pub(super) fn at_edges(&mut self, clock: Slots, progress: &mut dyn FnMut(Progress)) -> Result<(), WaveError> {
        self.start()?;
        let mut last: Option<[u128; 2]> = None;
        let mut period_fs = 0;
        loop {
            let mut a = self.a.next_edge(&mut self.touched)?;
            let mut b = self.b.next_edge(&mut self.touched)?;
            let recorded = ![a, b].into_iter().flatten().any(|edge| edge.gap);
            if let (Some(edge_a), Some(edge_b)) = (a, b)
                && edge_a.gap != edge_b.gap
            {
                (a, b) = self.meet_again(edge_a, edge_b, last, period_fs)?;
            }
            let (a, b) = match (a, b) {
                (Some(a), Some(b)) => (a, b),
                (None, None) => {
                    self.look_behind_last_edge();
                    return Ok(());
                }
                (Some(_), None) if self.b.feed().cut().is_some() => return Ok(()),
                (None, Some(_)) if self.a.feed().cut().is_some() => return Ok(()),
                (Some(edge), None) => {
                    self.b.cut_off()?;
                    return self.count_surplus(clock, edge, true);
                }
                (None, Some(edge)) => {
                    self.a.cut_off()?;
                    return self.count_surplus(clock, edge, false);
                }
            };
            if a.time_fs != b.time_fs && self.shifted_fs.is_none() {
                self.shifted_fs = Some(a.time_fs);
            }
            if let Some([last_a, last_b]) = last
                && recorded
            {
                // The shorter one: an edge that one file lacks does not make the period longer.
                period_fs = (a.time_fs - last_a).min(b.time_fs - last_b);
            }
            last = Some([a.time_fs, b.time_fs]);
            if self.options.end_fs.is_some_and(|end| a.time_fs > end) {
                return Ok(());
            }
            let sample = u128::from(self.samples);
            for side in [&mut self.a, &mut self.b] {
                side.pend(sample)?;
                side.release(sample, &mut self.touched);
            }
            if self.options.start_fs.is_none_or(|start| a.time_fs >= start) {
                if self.samples == 0 && self.options.start_fs.is_some() {
                    self.a.hidden.forget();
                    self.b.hidden.forget();
                }
                self.compare(a.time_fs, progress);
                if self.is_stopped() {
                    return Ok(());
                }
                if let Some(times_fs) = self.follow_alike(true, progress)? {
                    last = Some([times_fs[0]; 2]);
                    period_fs = times_fs[0] - times_fs[1];
                }
                if let Some(times_fs) = self.sample_quiet_edges(progress) {
                    last = Some([times_fs[0]; 2]);
                    period_fs = times_fs[0] - times_fs[1];
                }
            }
        }
    }

    /// Counts the next samples up to which nothing changes in either file, so that their result is that of the sample before. Returns the
    /// times of the last of them and of the one before it.
    fn sample_quiet_edges(&mut self, progress: &mut dyn FnMut(Progress)) -> Option<[u128; 2]> {
        let unit_fs = self.a.unit_fs();
        let is_gathering = self.context.as_ref().is_some_and(Gathering::is_missing_some);
        if is_gathering || self.options.end_fs.is_some() || unit_fs != self.b.unit_fs() {
            return None;
        }
        let now = self.a.step()?.time;
        let (a, b) = (self.a.quiet_edges(), self.b.quiet_edges());
        let count = a.iter().zip(b).take_while(|(a, b)| a.time == b.time).count();
        let last = a.get(..count)?.last()?.time;
        let before = count.checked_sub(2).map_or(now, |at| a[at].time);
        let times_fs = [last, before].map(|time| u128::from(time) * unit_fs);
        self.a.skip_edges(count);
        self.b.skip_edges(count);
        if let Some((_, before_fs)) = &mut self.before {
            *before_fs = times_fs[0];
        }
        let reported = self.samples / PROGRESS_SAMPLES;
        self.samples += count as u64;
        if self.samples / PROGRESS_SAMPLES > reported {
            self.report(progress);
        }
        Some(times_fs)
    }

    /// After a period that one file does not record, pairs edges by their time, with the same offset as before.
    fn meet_again(
        &mut self,
        mut a: ClockEdge,
        mut b: ClockEdge,
        last: Option<[u128; 2]>,
        period_fs: u128,
    ) -> Result<(Option<ClockEdge>, Option<ClockEdge>), WaveError> {
        // The times are compared in a common scale: each file's own time relative to its last common edge.
        let [last_a, last_b] = last.unwrap_or_default();
        loop {
            let (time_a, time_b) = (a.time_fs + last_b, b.time_fs + last_a);
            if time_a.abs_diff(time_b) <= period_fs / 2 {
                return Ok((Some(a), Some(b)));
            }
            self.unrecorded += 1;
            let behind = if time_a < time_b {
                (&mut self.a, &mut a)
            } else {
                (&mut self.b, &mut b)
            };
            match behind.0.next_edge(&mut self.touched)? {
                Some(edge) => *behind.1 = edge,
                // The remaining edges of the other file have no partner that could have been recorded.
                None => return Ok((None, None)),
            }
        }
    }

    /// Counts a difference of the clock if one file has more edges than the other, from the first edge without a
    /// partner.
    fn count_surplus(&mut self, clock: Slots, edge: ClockEdge, of_a: bool) -> Result<(), WaveError> {
        let within = |edge: ClockEdge| self.options.end_fs.is_none_or(|end| edge.time_fs <= end);
        if !within(edge) {
            return Ok(());
        }
        let side = if of_a { &mut self.a } else { &mut self.b };
        let mut count = 1;
        while side.next_edge(&mut self.touched)?.is_some_and(within) {
            count += 1;
        }
        let digit = if self.options.edge == SamplingEdge::Rising {
            "1"
        } else {
            "0"
        };
        let shown = Shown::Bits(digit.to_owned());
        let slots = [slot_of(clock, false), slot_of(clock, true)].map(Some);
        let at = self.hot.iter().position(|hot| [hot.a, hot.b] == slots);
        self.surplus = Some(Difference {
            signal: at.map_or_else(String::new, |at| self.states[at].name.clone()),
            time: seconds(edge.time_fs),
            a: if of_a { shown.clone() } else { Shown::Missing },
            b: if of_a { Shown::Missing } else { shown },
            count,
            persistent: true,
            a_number: None,
            b_number: None,
            largest: None,
            view: View::Bits,
        });
        Ok(())
    }
}
