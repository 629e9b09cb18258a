//! Finds the first frequency of a sweep whose line in time and frequency is known.

use super::excitation::{QuarterOrder, Rise, Sweep, SweptAcceleration};
use super::find::Course;
use super::line::middle;
use super::transfer::Lines;
use super::wave::spectrum;
use crate::parallel::mapped;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Limits the size of lines far above the usual size: otherwise the harmonics of a square wave would outweigh the sweep.
fn clipped(lines: &[Complex<f64>]) -> Vec<Complex<f64>> {
    const FAR: f64 = 2.5;
    let usual = middle(lines.iter().map(|line| line.norm()).collect());
    let clip = |line: &Complex<f64>| line * (FAR * usual / line.norm().max(f64::MIN_POSITIVE)).min(1.0);
    lines.iter().map(clip).collect()
}

/// Range in which the first frequency is sought.
#[derive(Clone, Copy)]
pub(super) enum Range {
    /// Around the frequency at which the motion begins: an antiresonance or a slow mode's phase hides the beginning of the line, but not
    /// that something moves.
    Around(f64),
    /// From below the lowest frequency on the line, because the slowest pulses are the weakest.
    LowerThan(f64),
}

/// First frequencies of a sweep along a line, the likeliest first: those whose first pulses, beginning on the line, resemble the log's
/// lines around it most. The axis follows these pulses, so the ratio of the two is real.
pub(super) fn starts_in(course: &Course, range: &Range) -> Vec<f64> {
    /// Half the range around the lowest frequency, how much lower it may be, and half the range of the lines that are compared, in Hz.
    const RANGE_HZ: f64 = 2.0;
    const LOWER_HZ: f64 = 5.0;
    const COMPARED_HZ: f64 = 3.0;
    /// Half the range around the beginning of the motion, in Hz and in seconds.
    const AROUND_HZ: f64 = 0.12;
    const AROUND_S: f64 = 0.15;
    /// Largest delay in seconds that is tried on either side, and its step.
    const TRIED_S: f64 = 0.08;
    const STEP_S: f64 = 2e-3;
    /// Likeness, relative to the best, above which a round number counts as equally good, in the wide range and in the small one.
    const AS_LIKE: f64 = 0.97;
    const AS_LIKE_AROUND: f64 = 0.93;
    /// The same for the usual first frequency.
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
        let starts_hz: Vec<f64> = (from..=to).map(|n| n as f64 * step).collect();
        tried.extend(mapped(&starts_hz, |&start_hz| (start_hz, like(start_hz))));
    }
    let best = tried.iter().map(|(_, like)| *like).fold(0.0, f64::max);
    // The usual frequency comes first, then those on the coarser steps.
    let usual = Sweep::default().start_hz;
    let is_usual = tried
        .iter()
        .any(|(start_hz, like)| *start_hz == usual && *like > NEARLY * best);
    let mut found: Vec<f64> = if is_usual { vec![usual] } else { Vec::new() };
    // Of numbers that are not round, the likeliest comes first.
    let is_round = |start_hz: f64| (2.0 * start_hz).fract() == 0.0;
    let (round, mut others): (Vec<_>, Vec<_>) = tried.into_iter().partition(|(start_hz, _)| is_round(*start_hz));
    others.sort_by(|a, b| b.1.total_cmp(&a.1));
    for (start_hz, like) in round.into_iter().chain(others) {
        if like >= as_like * best && !found.iter().any(|other| (other - start_hz).abs() < 1e-6) {
            found.push(start_hz);
        }
    }
    found
}
