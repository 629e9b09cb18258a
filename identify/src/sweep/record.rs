//! The samples of a log on the grid of a transform; missing samples are filled with what the machine would have shown.
//!
//! The grid begins before the log and ends after it, because the machine rings beyond the log. The samples beyond the log and those missing
//! in it are found together with the transfer function: in turn, the transfer function follows from the filled record, and the filling from
//! the transfer function (expectation and maximisation: Dempster, Laird and Rubin 1977).

use super::excitation::SweptAcceleration;
use super::reduce::{Filter, Reduced};
use super::transfer::{Band, Lines};
use crate::modal::Lateness;
use crate::spectrum::{Transform, fast_length};
use nalgebra::Complex;
use std::ops::Range;

/// Time in seconds by which the grid is longer than the log, at either end.
const BEYOND_S: f64 = 1.0;

/// Grid of a log and the band of its lines.
pub(super) struct Grid {
    transform: Transform,
    filter: Filter,
    /// Time between the samples of the sensor, and between those of the grid.
    fine_s: f64,
    sample_s: f64,
    /// Samples of the grid before the first of the log.
    before: usize,
    samples: usize,
    length: usize,
    /// Number of lines for each independent one.
    dense: usize,
    band: Band,
    /// Whether the log ends within the sweep: the motion beyond the log is then unknown, and the excitation ends with the log.
    is_cut: bool,
}

/// Rate of the sensor in Hz below which the lines are twice as dense as independent lines. What the samples alias into low frequencies
/// comes up to a whole log later than what belongs there; on lines as far apart as independent ones it looks constant.
const SLOW_HZ: f64 = 1500.0;

/// One direction of a log.
#[derive(Clone)]
pub(super) struct Record {
    values: Vec<f64>,
    /// Samples of the grid that were not measured, in order: those before the log, its gaps, and those after it.
    unknown: Vec<Range<usize>>,
}

impl Grid {
    /// The grid of a log whose clock runs faster than that of the sweep by the factor `clock`.
    pub(super) fn new(log: &Reduced<'_>, clock: f64, band: Band) -> Self {
        let (fine_s, sample_s) = (log.fine_s / clock, log.sample_s() / clock);
        let before = (BEYOND_S / sample_s).ceil() as usize;
        let dense = if fine_s * SLOW_HZ > 1.0 { 2 } else { 1 };
        let length = fast_length(dense * (log.samples + 2 * before));
        Self {
            transform: Transform::new(length),
            filter: log.filter.clone(),
            fine_s,
            sample_s,
            before,
            samples: log.samples,
            length,
            dense,
            band,
            is_cut: false,
        }
    }

    /// Duration of the grid in seconds.
    pub(super) fn seconds(&self) -> f64 {
        self.length as f64 * self.sample_s
    }

    /// Ends the excitation with the log.
    pub(super) fn cut_to_log(&mut self) {
        self.is_cut = true;
    }

    /// Whether the excitation ends with the log.
    pub(super) fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Returns those of `all` lines that lie in the band of the grid.
    pub(super) fn band_of(&self, all: &[Complex<f64>]) -> Lines {
        self.cut(all, self.band)
    }

    /// Removes the part of an excitation that is beyond a log that ends within it.
    fn within_log(&self, mut excitation: Vec<f64>) -> Vec<f64> {
        if self.is_cut {
            excitation[..self.before].fill(0.0);
            excitation[self.before + self.samples..].fill(0.0);
        }
        excitation
    }

    /// Time between samples in seconds.
    pub(super) fn sample_s(&self) -> f64 {
        self.sample_s
    }

    /// Time between the samples of the sensor in seconds.
    pub(super) fn fine_s(&self) -> f64 {
        self.fine_s
    }

    /// Time in seconds from the start of the grid to the first sample of the grid that the log has.
    pub(super) fn before_s(&self) -> f64 {
        self.before as f64 * self.sample_s
    }

    /// Time in seconds from the start of the grid to the first sample of the log.
    pub(super) fn log_begins_s(&self) -> f64 {
        self.before_s() - self.filter.half() as f64 * self.fine_s
    }

    /// The record of a direction without its mean; `missing` are samples of the log.
    pub(super) fn record(&self, log: &[f64], missing: &[Range<usize>]) -> Record {
        let gaps = missing.iter().map(|gap| gap.start + self.before..gap.end + self.before);
        let unknown = std::iter::once(0..self.before).chain(gaps);
        let unknown = unknown
            .chain(std::iter::once(self.before + self.samples..self.length))
            .collect();
        let mut values = vec![0.0; self.length];
        values[self.before..self.before + self.samples].copy_from_slice(&log[..self.samples]);
        let mut record = Record { values, unknown };
        let mean = record.mean(|value, _| value);
        for value in &mut record.values[self.before..self.before + self.samples] {
            *value -= mean;
        }
        record
    }

    /// Lines of a record in the band, and all of them.
    pub(super) fn lines(&self, record: &Record) -> (Lines, Vec<Complex<f64>>) {
        let all = self.transform.forward(record.values.clone());
        (self.cut(&all, self.band), all)
    }

    /// Returns those of `all` lines that lie in a band.
    pub(super) fn cut(&self, all: &[Complex<f64>], band: Band) -> Lines {
        let resolution_hz = 1.0 / self.seconds();
        let first = (band.low_hz / resolution_hz).ceil() as usize;
        let last = ((band.high_hz / resolution_hz).floor() as usize).min(all.len() - 1);
        Lines {
            first,
            resolution_hz,
            dense: self.dense,
            values: all.get(first..=last).unwrap_or_default().to_vec(),
        }
    }

    /// Response of the grid's filter to an excitation that begins `start_s` after the start of the grid.
    fn driven(&self, excitation: &SweptAcceleration, start_s: f64, averages: bool) -> Vec<Complex<f64>> {
        let times = (-start_s, self.fine_s);
        let samples = self.filter.of_excitation(excitation, times, self.length, averages);
        self.transform.forward(self.within_log(samples))
    }

    /// Lines of an excitation that begins `start_s` after the start of the grid, without the aliases of its samples.
    pub(super) fn excitation(&self, excitation: &SweptAcceleration, start_s: f64) -> Lines {
        let all = self.driven(excitation, start_s, true);
        let mut lines = self.cut(&all, self.band);
        for line in 0..lines.values.len() {
            // The mean over a sample attenuates a line by sinc(f·T).
            let angle = std::f64::consts::PI * lines.frequency_hz(line) * self.fine_s;
            if angle > 0.0 {
                lines.values[line] *= angle / angle.sin();
            }
        }
        lines
    }

    /// All lines of the samples of an excitation, with their aliases.
    pub(super) fn sampled(&self, excitation: &SweptAcceleration, start_s: f64) -> Vec<Complex<f64>> {
        self.driven(excitation, start_s, false)
    }

    /// Aliases in the band of the samples of an excitation's first and second integral, given its lines without aliases.
    pub(super) fn folded_integrals(&self, excitation: &SweptAcceleration, lines: &Lines, start_s: f64) -> [Lines; 2] {
        let integrals = excitation.integrals(-start_s, self.sample_s, self.length);
        let mut power = 0;
        integrals.map(|integral| {
            power += 1;
            let ends = integral.last().copied().unwrap_or(0.0);
            // The integral of the integral need not end where it began; a straight line accounts for the difference.
            let step = ends / self.length as f64;
            let closed: Vec<f64> = integral.iter().enumerate().map(|(n, x)| x - step * n as f64).collect();
            let all = self.transform.forward(closed);
            let mut folded = self.cut(&all, self.band);
            for (n, line) in folded.values.iter_mut().enumerate() {
                let by = Complex::new(0.0, std::f64::consts::TAU * lines.frequency_hz(n)).powi(power);
                *line -= lines.values[n] / by;
            }
            folded
        })
    }

    /// The samples of all lines.
    pub(super) fn samples(&self, all: Vec<Complex<f64>>) -> Vec<f64> {
        let mut samples = self.transform.inverse(all);
        for sample in &mut samples {
            *sample /= self.length as f64;
        }
        samples
    }

    /// Lines of an excitation, from those of one that began `delay_s` earlier. This is exact if the grid contains both
    /// completely.
    pub(super) fn later(&self, lines: &Lines, delay_s: f64) -> Lines {
        let late = Lateness { delay_s, bend_s: 0.0 };
        let turned = lines.values.iter().enumerate();
        let turned = turned.map(|(n, line)| line * late.turn(lines.frequency_hz(n), self.band.high_hz));
        Lines {
            values: turned.collect(),
            ..*lines
        }
    }
}

impl Record {
    /// Counts the samples from `begin` on as missing.
    pub(super) fn forget_from(&mut self, begin: usize) {
        let begin = begin.min(self.values.len());
        self.unknown.retain(|gap| gap.start < begin);
        let begin = match self.unknown.last_mut() {
            Some(last) if last.end >= begin => self.unknown.pop().map_or(begin, |last| last.start),
            _ => begin,
        };
        self.unknown.push(begin..self.values.len());
        for gap in self.unknown.iter().rev().take(1) {
            self.values[gap.clone()].fill(0.0);
        }
    }

    /// Mean of a quantity over the samples that were measured.
    fn mean(&self, of: impl Fn(f64, usize) -> f64) -> f64 {
        let (mut sum, mut count) = (0.0, 0usize);
        for known in self.known() {
            sum += known.clone().map(|n| of(self.values[n], n)).sum::<f64>();
            count += known.len();
        }
        sum / count.max(1) as f64
    }

    /// Ranges of samples that were measured.
    fn known(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        self.unknown.windows(2).map(|pair| pair[0].end..pair[1].start)
    }

    /// Fraction of the samples from one time to another, in samples, that were measured.
    pub(super) fn seen(&self, from: f64, to: f64) -> f64 {
        let first = self.unknown.partition_point(|gap| (gap.end as f64) < from);
        let lost = self.unknown[first..].iter().take_while(|gap| (gap.start as f64) < to);
        let lost: f64 = lost
            .map(|gap| ((gap.end as f64).min(to) - (gap.start as f64).max(from)).max(0.0))
            .sum();
        1.0 - lost / (to - from).max(1.0)
    }

    /// Finds the time in seconds, from the start of the grid, at which a motion begins that is present at `known_s`: the first tenth of a
    /// second with more power than the quietest before, without a pause since. `None` if the log has no quiet part before.
    pub(super) fn begins_s(&self, known_s: f64, sample_s: f64) -> Option<f64> {
        /// Duration in seconds of the parts that are compared, and of the longest pause, in which the sensor may stand still.
        const COMPARED_S: f64 = 0.1;
        const PAUSE_S: f64 = 0.8;
        /// Power relative to the quietest part above which a part contains motion.
        const MOVES: f64 = 4.0;
        /// Number of parts after the beginning whose power is compared with that before.
        const AFTER: usize = 5;
        let first = self.unknown.first().map_or(0, |gap| gap.end);
        let width = ((COMPARED_S / sample_s) as usize).max(8);
        let last = ((known_s / sample_s).max(0.0) as usize).min(self.values.len());
        let parts = self.values.get(first..last)?.chunks_exact(width);
        let powers: Vec<f64> = parts
            .map(|part| {
                let mean = part.iter().sum::<f64>() / width as f64;
                part.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
            })
            .collect();
        let quietest = powers.iter().copied().fold(f64::INFINITY, f64::min);
        let pause = (PAUSE_S / COMPARED_S) as usize;
        let (mut begins, mut still) = (powers.len(), 0);
        for (n, power) in powers.iter().enumerate().rev() {
            if *power > MOVES * quietest {
                (begins, still) = (n, 0);
            } else {
                still += 1;
            }
            if still > pause {
                break;
            }
        }
        let mean = |powers: &[f64]| powers.iter().sum::<f64>() / powers.len().max(1) as f64;
        let (before, after) = powers.split_at(begins);
        let after = &after[..after.len().min(AFTER)];
        // A sweep that is present from the first sample on grows but does not begin.
        let has_begun = !before.is_empty() && !after.is_empty() && mean(after) > MOVES * mean(before);
        has_begun.then(|| (first + begins * width) as f64 * sample_s)
    }

    /// Finds the time in seconds, from the start of the grid, at which a motion of about this frequency stops that continues until about
    /// `expected_s`: the last period with more power than the rest afterwards.
    pub(super) fn stops_s(&self, expected_s: f64, frequency_hz: f64, sample_s: f64) -> f64 {
        /// Smallest power above that of the rest, as a fraction of the motion's, and the time around the expected end that is searched.
        const PART: f64 = 0.35;
        const AROUND_S: (f64, f64) = (1.0, 15.0);
        let sample = |time_s: f64| ((time_s / sample_s).max(0.0) as usize).min(self.values.len());
        let known = self.unknown.last().map_or(self.values.len(), |gap| gap.start);
        let (first, last) = (
            sample(expected_s - 2.0 * AROUND_S.0),
            sample(expected_s + AROUND_S.1).min(known),
        );
        let searched = self.values.get(first..last).unwrap_or_default();
        // Slow modes continue to ring after the end. The second difference over half a period leaves little of them.
        let half = ((0.5 / (frequency_hz * sample_s)).round() as usize).max(1);
        let fast = searched.windows(2 * half + 1);
        let powers: Vec<f64> = fast
            .map(|few| (few[0] - 2.0 * few[half] + few[2 * half]).powi(2))
            .collect();
        let period = 2 * half;
        let sums: Vec<f64> = powers.windows(period).map(|few| few.iter().sum()).collect();
        let usual = ((AROUND_S.0 / sample_s) as usize).min(sums.len());
        let before = sums[..usual].iter().sum::<f64>() / usual.max(1) as f64;
        // Periods of the rest differ by chance, so their mean is used.
        let rest = sums[usual..]
            .chunks(4 * period)
            .map(|few| few.iter().sum::<f64>() / few.len() as f64);
        let rest = rest.fold(before, f64::min);
        let moving = sums.iter().rposition(|sum| *sum > rest + PART * (before - rest));
        // The difference lasts until half a period after the motion, and a period with this fraction of it begins before its end.
        let end = moving.map_or(0.0, |window| window as f64 + (PART * period as f64).max(1.0));
        (first as f64 + end) * sample_s
    }

    /// Fills the missing samples; leaves those beyond the log at zero if `is_cut`. Returns the root mean square of the change, relative to
    /// that of the record.
    pub(super) fn fill(&mut self, predicted: &[f64], is_cut: bool) -> f64 {
        let offset = self.mean(|value, n| value - predicted[n]);
        let (mut change, mut square) = (0.0, 0.0);
        let ends = if is_cut { 1 } else { 0 };
        for gap in &self.unknown[ends..self.unknown.len() - ends] {
            for n in gap.clone() {
                change += (self.values[n] - predicted[n]).powi(2);
                self.values[n] = predicted[n];
            }
        }
        for known in self.unknown.windows(2).map(|pair| pair[0].end..pair[1].start) {
            for value in &mut self.values[known] {
                *value -= offset;
                square += *value * *value;
            }
        }
        (change / square.max(f64::MIN_POSITIVE)).sqrt()
    }
}
