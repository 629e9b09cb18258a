//! Finds the description of a sweep in a log.
//!
//! A sweep is a straight line in time and frequency: `t = start_s + (f − start_hz)/rate`. The group delay of the log's transform, from the
//! phase between neighbouring lines, gives the time at which each frequency was strongest. Harmonics lie on other lines, which cover less
//! of the time. The ends of the line are those of the sweep; the first frequency also follows from the phase.

use super::excitation::Sweep;
use super::first::{Range, starts_in};
use super::line::{Delay, Line, delays, line, with_rate};
use super::record::Grid;
use super::reduce::{KEPT_HZ, Reduced};
use super::transfer::{Band, Lines};

/// Highest frequency of a sweep that is sought, over the rate of the samples; its limit in Hz is [`KEPT_HZ`].
const HIGHEST_PART: f64 = 0.47;

/// `max_freq` of Klipper before December 2024 in Hz: 10 m/s² at 75 mm/s² per Hz.
const KLIPPERS_OLD_END_HZ: f64 = 1e4 / 75.0;

/// Properties of a log's sweep that are known without trying any description.
pub(super) struct Course {
    pub(super) lines: Lines,
    delays: Vec<Delay>,
    pub(super) line: Line,
    /// Rate of the line as measured, and the rate that is used.
    raw_rate_hz_per_s: f64,
    pub(super) rate_hz_per_s: f64,
    /// Lowest frequency on the line.
    lowest_hz: f64,
    /// Times from the start of the grid at which the motion begins, if the log shows that, and at which it stops.
    begins_s: Option<f64>,
    pub(super) end_s: f64,
    highest_hz: f64,
}

/// Finds the course of the sweep in the direction with the most power; `None` if it shows no line.
pub(super) fn course(log: &Reduced<'_>) -> Option<Course> {
    let band = Band {
        low_hz: 0.5,
        high_hz: KEPT_HZ.min(HIGHEST_PART / log.sample_s()),
    };
    let grid = Grid::new(log, 1.0, band);
    let records = log.directions.iter().map(|(_, values)| {
        let record = grid.record(values, log.missing);
        (grid.lines(&record).0, record)
    });
    let (lines, record) = records.max_by(|a, b| a.0.power().total_cmp(&b.0.power()))?;
    let delays = delays(&lines, &grid);
    let (line, inliers) = line(&delays, &grid, log.seconds())?;
    let (first, last) = (inliers.first()?, inliers.last()?);
    let raw_rate_hz_per_s = 1.0 / line.slope;
    let rate_hz_per_s = round_rate(raw_rate_hz_per_s, log.seconds());
    let line = with_rate(&inliers, rate_hz_per_s);
    // The lateness of a mode may move the first delays off the line.
    let known = inliers.get(inliers.len() / 4).unwrap_or(first);
    Some(Course {
        begins_s: record.begins_s(line.time_s(known.frequency_hz), log.sample_s()),
        end_s: record.stops_s(line.time_s(last.frequency_hz), last.frequency_hz, log.sample_s()),
        lowest_hz: first.frequency_hz,
        highest_hz: 0.499 / log.fine_s,
        delays: inliers,
        lines,
        line,
        raw_rate_hz_per_s,
        rate_hz_per_s,
    })
}

impl Course {
    /// Whether a sweep rises like this one, to the same frequency.
    pub(super) fn is_of(&self, sweep: &Sweep) -> bool {
        /// Largest relative difference of the rates, and largest difference of the ends in Hz.
        const RATE: f64 = 0.02;
        const HZ: f64 = 1.0;
        (self.rate_hz_per_s / sweep.rate_hz_per_s - 1.0).abs() < RATE
            && (self.end_hz(sweep.start_hz) - sweep.end_hz).abs() < HZ
    }

    /// Whether a sweep has this rate.
    pub(super) fn rises_as(&self, sweep: &Sweep) -> bool {
        const OFF: f64 = 1e-6;
        (self.rate_hz_per_s / sweep.rate_hz_per_s - 1.0).abs() < OFF
    }

    /// Whether the motion may begin at this frequency: nothing shows another one.
    pub(super) fn may_begin_at(&self, start_hz: f64) -> bool {
        /// Largest difference in Hz, because the slowest pulses are the weakest.
        const HZ: f64 = 2.0;
        self.begins_hz().is_none_or(|hz| (hz - start_hz).abs() < HZ)
    }

    /// The frequency of the line when the motion begins.
    fn begins_hz(&self) -> Option<f64> {
        self.begins_s
            .map(|begins_s| (begins_s - self.line.start_s) / self.line.slope)
    }

    /// Returns the same course with a round rate near the measured one, unless the rate is round already. The lateness of a slow mode turns
    /// the line of a short sweep.
    pub(super) fn at_round_rate(&self) -> Option<Self> {
        let round = round_half(self.raw_rate_hz_per_s, TURNED)?;
        (round != self.rate_hz_per_s).then(|| Self {
            lines: self.lines.clone(),
            delays: self.delays.clone(),
            line: with_rate(&self.delays, round),
            rate_hz_per_s: round,
            ..*self
        })
    }

    /// Sweeps that the log may contain, by their first frequency, the likeliest first: those that begin with the motion, then those that
    /// begin with the line.
    pub(super) fn by_start(&self) -> Vec<Sweep> {
        /// Largest number of either that is tried.
        const TRIED: usize = 4;
        let by_motion = self.begins_hz().filter(|hz| *hz > 0.5).map(Range::Around);
        let by_line = Range::LowerThan(self.lowest_hz);
        let mut starts: Vec<f64> = Vec::new();
        for range in [by_motion, Some(by_line)].into_iter().flatten() {
            for start_hz in starts_in(self, &range).into_iter().take(TRIED) {
                if !starts.iter().any(|other| (other - start_hz).abs() < 1e-6) {
                    starts.push(start_hz);
                }
            }
        }
        let sweeps = starts
            .into_iter()
            .map(|start_hz| self.sweep(start_hz, self.end_hz(start_hz)));
        sweeps.filter(|sweep| sweep.end_hz > sweep.start_hz).collect()
    }

    /// The same sweep with other possible last frequencies, because ringing after the end hides it.
    pub(super) fn by_end(&self, sweep: &Sweep) -> Vec<Sweep> {
        /// Time in seconds for which the motion may seem to continue, and smallest distance in Hz that is tried.
        const RINGS_S: f64 = 0.8;
        const LEAST_HZ: f64 = 0.8;
        /// Largest number of frequencies that are tried, and their distance.
        const TRIED: usize = 6;
        const STEP_HZ: f64 = 0.5;
        let raw = self.raw_end_hz(sweep.start_hz);
        let from = ((raw - LEAST_HZ.max(RINGS_S * self.rate_hz_per_s)) / STEP_HZ).ceil() as i64;
        let to = ((raw + self.end_tolerance_hz()) / STEP_HZ).floor() as i64;
        let near = |hz: f64| (KLIPPERS_OLD_END_HZ - hz).abs() < 1.5 * STEP_HZ;
        let ends = (from..=to)
            .rev()
            .map(|n| n as f64 * STEP_HZ)
            .chain(near(raw).then_some(KLIPPERS_OLD_END_HZ));
        let sweeps = ends.map(|end_hz| self.sweep(sweep.start_hz, end_hz)).take(TRIED);
        sweeps
            .filter(|other| other.end_hz > other.start_hz && (other.end_hz - sweep.end_hz).abs() > 1e-6)
            .collect()
    }

    fn sweep(&self, start_hz: f64, end_hz: f64) -> Sweep {
        Sweep {
            start_hz,
            end_hz: end_hz.min(self.highest_hz),
            rate_hz_per_s: self.rate_hz_per_s,
            ..Sweep::default()
        }
    }

    /// The last frequency of a sweep with this first one, which ends half a period after it reached the last frequency.
    fn raw_end_hz(&self, start_hz: f64) -> f64 {
        let raw = (self.end_s - self.line.start_s) / self.line.slope;
        raw - 0.5 * self.rate_hz_per_s / raw.max(start_hz)
    }

    fn end_tolerance_hz(&self) -> f64 {
        0.12_f64.max(0.06 * self.rate_hz_per_s)
    }

    /// The likeliest last frequency.
    fn end_hz(&self, start_hz: f64) -> f64 {
        let (raw, tolerance_hz) = (self.raw_end_hz(start_hz), self.end_tolerance_hz());
        if (raw - KLIPPERS_OLD_END_HZ).abs() < 1.5 * tolerance_hz {
            KLIPPERS_OLD_END_HZ
        } else {
            snapped(raw, &[5.0, 1.0, 0.5], tolerance_hz)
        }
    }
}

/// Relative distance of a rate from a multiple of 0.5 Hz/s up to which it is taken for that multiple, because a mode bends the line, and up
/// to which the multiple is tried.
const BENT: f64 = 0.012;
const TURNED: f64 = 0.04;

/// Returns a rate, or the round rate that is likely meant.
fn round_rate(raw: f64, seconds: f64) -> f64 {
    round_half(raw, BENT).unwrap_or_else(|| snapped(raw, &[0.1, 0.05], (3e-3 + 0.2 / seconds) * raw))
}

/// Returns the multiple of 0.5 Hz/s that differs from the rate by a smaller fraction than `off`.
fn round_half(raw: f64, off: f64) -> Option<f64> {
    let half = (raw / 0.5).round() * 0.5;
    (half > 0.0 && (half / raw - 1.0).abs() < off).then_some(half)
}

/// Returns the first multiple of one of these steps within a tolerance of a number, or else the number.
fn snapped(number: f64, steps: &[f64], tolerance: f64) -> f64 {
    let multiples = steps.iter().map(|step| (number / step).round() * step);
    let near = multiples
        .into_iter()
        .find(|multiple| (multiple - number).abs() <= tolerance && *multiple > 0.0);
    near.unwrap_or_else(|| (number * 1e3).round() / 1e3)
}
