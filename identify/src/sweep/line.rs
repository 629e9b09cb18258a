//! Finds the straight line of a sweep in the group delays of a log.

use super::record::Grid;
use super::transfer::Lines;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Bandwidth in Hz, and number of lines, over which a group delay is averaged.
const AVERAGED_HZ: f64 = 0.3;
const AVERAGED_LINES: usize = 8;
/// Smallest coherence of a group delay that counts.
const COHERENT: f64 = 0.5;
/// Rates in Hz/s that are tried, and the ratio of neighbours.
const RATES: (f64, f64) = (0.05, 25.0);
const NEXT_RATE: f64 = 1.004;
/// Number of intervals of the log in which the coverage of a line is counted, and the smallest fraction that it must
/// cover.
const INTERVALS: usize = 100;
const LEAST_COVERED: f64 = 0.3;

/// Group delay of a band.
#[derive(Clone, Copy)]
pub(super) struct Delay {
    pub(super) frequency_hz: f64,
    /// Time from the start of the grid.
    pub(super) time_s: f64,
}

/// A straight line `t = start_s + f·slope`.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub(super) start_s: f64,
    pub(super) slope: f64,
}

impl Line {
    pub(super) fn time_s(&self, frequency_hz: f64) -> f64 {
        self.start_s + frequency_hz * self.slope
    }

    fn off_s(&self, delay: &Delay) -> f64 {
        delay.time_s - self.time_s(delay.frequency_hz)
    }
}

/// Returns the line of this rate with the median start of the delays.
pub(super) fn with_rate(delays: &[Delay], rate_hz_per_s: f64) -> Line {
    let starts_s = delays
        .iter()
        .map(|delay| delay.time_s - delay.frequency_hz / rate_hz_per_s);
    Line {
        start_s: middle(starts_s.collect()),
        slope: 1.0 / rate_hz_per_s,
    }
}

pub(super) fn middle(mut values: Vec<f64>) -> f64 {
    let half = values.len() / 2;
    if values.is_empty() {
        0.0
    } else {
        *values.select_nth_unstable_by(half, f64::total_cmp).1
    }
}

/// Group delays of the bands that have one.
pub(super) fn delays(lines: &Lines, grid: &Grid) -> Vec<Delay> {
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
pub(super) fn line(delays: &[Delay], grid: &Grid, seconds: f64) -> Option<(Line, Vec<Delay>)> {
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
        // The order changes little from one rate to the next.
        insertion_sort(&mut intercepts);
        // Counts the intervals that the delays within the tolerance cover, while a window moves over the intercepts.
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
            // Of lines that cover equally much, the one with more delays is better.
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

/// Sorts values that are almost sorted by their first component.
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
    /// Gap in Hz that a run may have, and as a fraction of the frequency.
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

/// Fits a line to delays by least squares, in which distant delays count less.
fn straight(delays: &[Delay]) -> Option<Line> {
    /// Distance in seconds above which a delay counts less, because a mode delays its frequencies.
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
