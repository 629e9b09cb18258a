//! Finds the description of a sweep in a log.
//!
//! A sweep is a straight line in time and frequency: `t = start_s + (f − start_hz)/rate`. The group delay of the log's transform, from the
//! phase between neighbouring lines, gives the time at which each frequency was strongest. Harmonics lie on other lines, which cover
//! less of the time. Where the line begins and ends, the sweep does; the first frequency follows from the phase as well.

use super::excitation::{QuarterOrder, Rise, Sweep, SweptAcceleration};
use super::record::Grid;
use super::reduce::{KEPT_HZ, Reduced};
use super::transfer::{Band, Lines};
use super::wave::spectrum;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Highest frequency of a sweep that is looked for, over the rate of the samples; that in Hz is what is kept of every log.
const HIGHEST_PART: f64 = 0.47;
/// Bandwidth in Hz, and number of lines, over which a group delay is averaged.
const AVERAGED_HZ: f64 = 0.3;
const AVERAGED_LINES: usize = 8;
/// Coherence from which on a group delay counts.
const COHERENT: f64 = 0.5;
/// Rates in Hz/s that are tried, and the ratio of neighbours.
const RATES: (f64, f64) = (0.05, 25.0);
const NEXT_RATE: f64 = 1.004;
/// Intervals of the log that a line should cover, and the fraction that it must.
const INTERVALS: usize = 100;
const LEAST_COVERED: f64 = 0.3;

/// `max_freq` of Klipper before December 2024 in Hz: 10 m/s² at 75 mm/s² per Hz.
const KLIPPERS_OLD_END_HZ: f64 = 1e4 / 75.0;

/// Group delay of a band.
#[derive(Clone, Copy)]
struct Delay {
    frequency_hz: f64,
    /// Time from the start of the grid.
    time_s: f64,
}

/// A straight line `t = start_s + f·slope`.
#[derive(Clone, Copy)]
struct Line {
    start_s: f64,
    slope: f64,
}

impl Line {
    fn time_s(&self, frequency_hz: f64) -> f64 {
        self.start_s + frequency_hz * self.slope
    }

    fn off_s(&self, delay: &Delay) -> f64 {
        delay.time_s - self.time_s(delay.frequency_hz)
    }
}

/// What a log tells of its sweep without trying any.
pub(super) struct Course {
    lines: Lines,
    line: Line,
    rate_hz_per_s: f64,
    /// Lowest frequency on the line, and that at which the line is when the motion begins, where the log shows that.
    lowest_hz: f64,
    begins_hz: Option<f64>,
    /// Time from the start of the grid at which the motion stops.
    end_s: f64,
    highest_hz: f64,
}

/// The course of the sweep in the direction with the most power; `None` where it shows no line.
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
    let rate_hz_per_s = round_rate(1.0 / line.slope, log.seconds());
    let line = Line {
        slope: 1.0 / rate_hz_per_s,
        start_s: middle(
            inliers
                .iter()
                .map(|d| d.time_s - d.frequency_hz / rate_hz_per_s)
                .collect(),
        ),
    };
    // A mode's lateness may take the first delays off the line.
    let known = inliers.get(inliers.len() / 4).unwrap_or(first);
    let begins_hz = record
        .begins_s(line.time_s(known.frequency_hz), log.sample_s())
        .map(|begins_s| (begins_s - line.start_s) / line.slope);
    Some(Course {
        begins_hz,
        end_s: record.stops_s(line.time_s(last.frequency_hz), log.sample_s()),
        lowest_hz: first.frequency_hz,
        highest_hz: 0.499 / log.fine_s,
        lines,
        line,
        rate_hz_per_s,
    })
}

impl Course {
    /// Whether a sweep rises like this one, to the same frequency.
    pub(super) fn is_of(&self, sweep: &Sweep) -> bool {
        /// How far rate and end may be off.
        const RATE: f64 = 0.02;
        const HZ: f64 = 1.0;
        (self.rate_hz_per_s / sweep.rate_hz_per_s - 1.0).abs() < RATE
            && (self.end_hz(sweep.start_hz) - sweep.end_hz).abs() < HZ
    }

    /// Sweeps that the log may be of, the likeliest first: those that begin with the motion, then those that begin where the line does.
    pub(super) fn sweeps(&self) -> impl Iterator<Item = Sweep> + '_ {
        let by_motion = self.begins_hz.filter(|hz| *hz > 0.5).map(Range::Around);
        let by_line = Range::LowerThan(self.lowest_hz);
        let starts = [by_motion, Some(by_line)].into_iter().flatten();
        let starts = starts.flat_map(|range| starts_in(self, &range).into_iter().take(4));
        let sweeps = starts.map(|start_hz| Sweep {
            start_hz,
            end_hz: self.end_hz(start_hz).min(self.highest_hz),
            rate_hz_per_s: self.rate_hz_per_s,
            ..Sweep::default()
        });
        sweeps.filter(|sweep| sweep.end_hz > sweep.start_hz)
    }

    /// The last frequency of a sweep with this first one, which ends half a period after it reached that.
    fn end_hz(&self, start_hz: f64) -> f64 {
        let raw = (self.end_s - self.line.start_s) / self.line.slope;
        let raw = raw - 0.5 * self.rate_hz_per_s / raw.max(start_hz);
        let tolerance_hz = 0.12_f64.max(0.06 * self.rate_hz_per_s);
        match (raw - KLIPPERS_OLD_END_HZ).abs() < 1.5 * tolerance_hz {
            true => KLIPPERS_OLD_END_HZ,
            false => snapped(raw, &[5.0, 1.0, 0.5], tolerance_hz),
        }
    }
}

/// A rate, or the round one that it is likely to be.
fn round_rate(raw: f64, seconds: f64) -> f64 {
    /// By how much it may be off a multiple of 0.5 Hz/s: a mode bends the line.
    const OFF: f64 = 0.012;
    let half = (raw / 0.5).round() * 0.5;
    match half > 0.0 && (half / raw - 1.0).abs() < OFF {
        true => half,
        false => snapped(raw, &[0.1, 0.05], (3e-3 + 0.2 / seconds) * raw),
    }
}

/// A number, or the multiple of one of these steps that is within a tolerance of it, the first where several are.
fn snapped(number: f64, steps: &[f64], tolerance: f64) -> f64 {
    let multiples = steps.iter().map(|step| (number / step).round() * step);
    let near = multiples
        .into_iter()
        .find(|multiple| (multiple - number).abs() <= tolerance && *multiple > 0.0);
    near.unwrap_or_else(|| (number * 1e3).round() / 1e3)
}

fn middle(mut values: Vec<f64>) -> f64 {
    let half = values.len() / 2;
    match values.is_empty() {
        true => 0.0,
        false => *values.select_nth_unstable_by(half, f64::total_cmp).1,
    }
}

/// Group delays of the bands that have one.
fn delays(lines: &Lines, grid: &Grid) -> Vec<Delay> {
    let width = ((AVERAGED_HZ / lines.resolution_hz) as usize).max(AVERAGED_LINES);
    let turns: Vec<Complex<f64>> = lines
        .values
        .windows(2)
        .map(|pair| {
            let turn = pair[1] * pair[0].conj();
            // Only the phase is used: a tone would outweigh its neighbours.
            turn / turn.norm().max(f64::MIN_POSITIVE)
        })
        .collect();
    let starts = (0..turns.len().saturating_sub(width)).step_by(width.div_ceil(2));
    let delays = starts.map(|start| {
        let sum: Complex<f64> = turns[start..start + width].iter().sum();
        let late = (-sum.arg() / TAU).rem_euclid(1.0);
        let delay = Delay {
            frequency_hz: lines.frequency_hz(start) + 0.5 * width as f64 * lines.resolution_hz,
            time_s: late * grid.seconds(),
        };
        (sum.norm() / width as f64, delay)
    });
    let coherent = delays.filter(|(coherence, _)| *coherence > COHERENT);
    coherent.map(|(_, delay)| delay).collect()
}

/// The line that covers most of the log, and the delays on it.
fn line(delays: &[Delay], grid: &Grid, seconds: f64) -> Option<(Line, Vec<Delay>)> {
    let tolerance_s = 0.3_f64.max(0.004 * seconds);
    let rates = ((RATES.1 / RATES.0).ln() / NEXT_RATE.ln()) as i32;
    let mut best: Option<(f64, Line)> = None;
    let interval_s = seconds / INTERVALS as f64;
    let interval = |delay: &Delay| (((delay.time_s - grid.before_s()) / interval_s).max(0.0) as usize).min(INTERVALS);
    let mut intercepts: Vec<(f64, Delay, usize)> = delays.iter().map(|delay| (0.0, *delay, interval(delay))).collect();
    for n in 0..rates {
        let slope = 1.0 / (RATES.0 * NEXT_RATE.powi(n));
        for (intercept, delay, _) in &mut intercepts {
            *intercept = delay.time_s - delay.frequency_hz * slope;
        }
        // From one rate to the next the order hardly changes.
        insertion_sort(&mut intercepts);
        // The intervals that the delays within the tolerance cover, as a window moves over the intercepts.
        let mut counts = [0u32; INTERVALS + 1];
        let (mut covered, mut begin) = (0usize, 0);
        for (end, (intercept, _, interval)) in intercepts.iter().enumerate() {
            let slot = &mut counts[*interval];
            *slot += 1;
            covered += usize::from(*slot == 1);
            while intercept - intercepts[begin].0 > 2.0 * tolerance_s {
                let slot = &mut counts[intercepts[begin].2];
                *slot -= 1;
                covered -= usize::from(*slot == 0);
                begin += 1;
            }
            // Of lines that cover as much, that with more delays is better.
            let score = covered as f64 + 1e-3 * (end - begin) as f64;
            if best.as_ref().is_none_or(|(most, _)| score > *most) {
                let start_s = 0.5 * (intercepts[begin].0 + intercept);
                best = Some((score, Line { start_s, slope }));
            }
        }
    }
    let (covered, mut line) = best?;
    if covered < LEAST_COVERED * INTERVALS as f64 {
        return None;
    }
    let mut inliers = Vec::new();
    for tolerance_s in [2.0 * tolerance_s, tolerance_s, 0.5 * tolerance_s, 0.5 * tolerance_s] {
        inliers = run(delays, |delay| line.off_s(delay).abs() < tolerance_s);
        line = straight(&inliers)?;
    }
    Some((line, inliers))
}

/// Sorts what is almost sorted by its first value.
fn insertion_sort<T>(values: &mut [(f64, Delay, T)]) {
    for end in 1..values.len() {
        let mut at = end;
        while at > 0 && values[at - 1].0 > values[at].0 {
            values.swap(at - 1, at);
            at -= 1;
        }
    }
}

/// The longest run of delays that are on a line, with small interruptions.
fn run(delays: &[Delay], is_on: impl Fn(&Delay) -> bool) -> Vec<Delay> {
    /// Frequencies in Hz that a run may lack, and as a fraction.
    const LACKS_HZ: f64 = 6.0;
    const LACKS: f64 = 0.3;
    let (mut longest, mut now): (Vec<Delay>, Vec<Delay>) = (Vec::new(), Vec::new());
    for delay in delays.iter().filter(|delay| is_on(delay)) {
        let goes_on = now
            .last()
            .is_none_or(|last| delay.frequency_hz - last.frequency_hz < LACKS_HZ.max(LACKS * last.frequency_hz));
        if !goes_on {
            if now.len() > longest.len() {
                longest = std::mem::take(&mut now);
            }
            now.clear();
        }
        now.push(*delay);
    }
    if now.len() > longest.len() { now } else { longest }
}

/// The line through delays, by least squares in which those far off count less.
fn straight(delays: &[Delay]) -> Option<Line> {
    /// Distance in seconds from which on a delay counts less: a mode delays its frequencies.
    const FAR_S: f64 = 0.02;
    if delays.len() < 8 {
        return None;
    }
    let mut line: Option<Line> = None;
    for _ in 0..8 {
        let weight = |delay: &Delay| line.map_or(1.0, |line| FAR_S / line.off_s(delay).abs().max(FAR_S));
        let total: f64 = delays.iter().map(weight).sum();
        let mean_hz = delays.iter().map(|d| weight(d) * d.frequency_hz).sum::<f64>() / total;
        let mean_s = delays.iter().map(|d| weight(d) * d.time_s).sum::<f64>() / total;
        let spread: f64 = delays
            .iter()
            .map(|d| weight(d) * (d.frequency_hz - mean_hz).powi(2))
            .sum();
        let shared: f64 = delays
            .iter()
            .map(|d| weight(d) * (d.frequency_hz - mean_hz) * (d.time_s - mean_s))
            .sum();
        let slope = shared / spread;
        if !slope.is_finite() || slope <= 0.0 {
            return None;
        }
        line = Some(Line {
            start_s: mean_s - slope * mean_hz,
            slope,
        });
    }
    line
}

/// Lines whose size is not far above the usual one: the harmonics of a square wave would outweigh the sweep.
fn clipped(lines: &[Complex<f64>]) -> Vec<Complex<f64>> {
    const FAR: f64 = 2.5;
    let usual = middle(lines.iter().map(|line| line.norm()).collect());
    let clip = |line: &Complex<f64>| line * (FAR * usual / line.norm().max(f64::MIN_POSITIVE)).min(1.0);
    lines.iter().map(clip).collect()
}

/// Where a first frequency is looked for.
#[derive(Clone, Copy)]
enum Range {
    /// Around that at which the motion begins: an antiresonance or a slow mode's phase hides the beginning of the line, but not that
    /// something moves.
    Around(f64),
    /// From below the lowest frequency on the line, as the slowest pulses are the weakest.
    LowerThan(f64),
}

/// First frequencies of a sweep along a line, the likeliest first: those whose first pulses, beginning on the line, are like the log's
/// lines around it. The axis follows them, so that the ratio of the two is real.
fn starts_in(course: &Course, range: &Range) -> Vec<f64> {
    /// Half the range around the lowest frequency, how much lower it may be, and half the range of the lines that are compared, in Hz.
    const RANGE_HZ: f64 = 2.0;
    const LOWER_HZ: f64 = 5.0;
    const COMPARED_HZ: f64 = 3.0;
    /// Half the range around the beginning of the motion, in Hz and in seconds.
    const AROUND_HZ: f64 = 0.12;
    const AROUND_S: f64 = 0.15;
    /// Delay in seconds that is tried on either side, and its step.
    const TRIED_S: f64 = 0.08;
    const STEP_S: f64 = 2e-3;
    /// Likeness over the best's from which on a round number is as good, in the wide range and in the small one.
    const AS_LIKE: f64 = 0.97;
    const AS_LIKE_AROUND: f64 = 0.85;
    /// The same for the usual one.
    const NEARLY: f64 = 0.8;
    let Course { lines, line, .. } = course;
    let (rate, end_s) = (course.rate_hz_per_s, course.end_s);
    let wider_hz = |least: f64| least.max(1.5 * rate.sqrt());
    let reach_hz = wider_hz(COMPARED_HZ);
    let (about_hz, lowest_hz, highest_hz, as_like) = match *range {
        Range::Around(hz) => {
            let around_hz = AROUND_HZ + AROUND_S * rate;
            (hz, hz - around_hz, hz + around_hz, AS_LIKE_AROUND)
        }
        Range::LowerThan(hz) => {
            let range_hz = wider_hz(RANGE_HZ);
            let lowest_hz = (hz - range_hz - LOWER_HZ).max(0.4 * hz);
            (hz, lowest_hz, hz + range_hz, AS_LIKE)
        }
    };
    let band = ((lowest_hz - reach_hz).max(0.3 * about_hz).max(0.6), about_hz + reach_hz);
    let first = ((band.0 / lines.resolution_hz) as usize).saturating_sub(lines.first);
    let last = ((band.1 / lines.resolution_hz) as usize)
        .saturating_sub(lines.first)
        .min(lines.values.len());
    if last < first + 8 {
        return Vec::new();
    }
    let compared = Lines {
        first: lines.first + first,
        resolution_hz: lines.resolution_hz,
        dense: lines.dense,
        values: clipped(&lines.values[first..last]),
    };
    let power = compared.power();
    let like = |start_hz: f64| -> f64 {
        let sweep = Sweep {
            start_hz,
            end_hz: (about_hz + 3.0 * reach_hz)
                .min((end_s - line.start_s) / line.slope)
                .max(start_hz + 0.1),
            rate_hz_per_s: rate,
            ..Sweep::default()
        };
        let pulses = SweptAcceleration::new(&sweep, QuarterOrder::Mirrored, Rise::HalfPeriod);
        let expected = spectrum(&pulses, &compared, 1.0, line.time_s(start_hz));
        let square: f64 = expected.iter().map(Complex::norm_sqr).sum();
        let cross: Vec<Complex<f64>> = compared
            .values
            .iter()
            .zip(&expected)
            .map(|(y, u)| y * u.conj())
            .collect();
        let steps = (TRIED_S / STEP_S) as i32;
        let at = |step: i32| {
            let angle = |frequency_hz: f64| Complex::from_polar(1.0, TAU * frequency_hz * f64::from(step) * STEP_S);
            let (mut turn, next) = (angle(compared.frequency_hz(0)), angle(compared.resolution_hz));
            let mut sum = 0.0;
            for cross in &cross {
                sum += (cross * turn).re;
                turn *= next;
            }
            sum.powi(2) / (square * power).max(f64::MIN_POSITIVE)
        };
        (-steps..=steps).map(at).fold(0.0, f64::max)
    };
    let mut tried: Vec<(f64, f64)> = Vec::new();
    for step in [1.0, 0.5, 0.1] {
        let from = (lowest_hz.max(0.5) / step).ceil() as i64;
        let to = (highest_hz / step).floor() as i64;
        tried.extend(
            (from..=to)
                .map(|n| n as f64 * step)
                .map(|start_hz| (start_hz, like(start_hz))),
        );
    }
    let best = tried.iter().map(|(_, like)| *like).fold(0.0, f64::max);
    // The usual one comes first, then those on the coarser steps.
    let usual = Sweep::default().start_hz;
    let is_usual = tried
        .iter()
        .any(|(start_hz, like)| *start_hz == usual && *like > NEARLY * best);
    let mut found: Vec<f64> = if is_usual { vec![usual] } else { Vec::new() };
    for (start_hz, like) in &tried {
        if *like >= as_like * best && !found.iter().any(|other| (other - start_hz).abs() < 1e-6) {
            found.push(*start_hz);
        }
    }
    found
}
