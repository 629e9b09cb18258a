//! Rounds to integers, and moves units between taps until the residual is within the tolerances again.
//!
//! Amplitudes that may not be negative or have bounds are rounded by largest remainder, and partial sums with bounds one by one. So the
//! bounds of the command hold for the integers too, and their sum is exactly `2^F`. If the residual of the integers then exceeds a
//! tolerance somewhere in a band, single units move from one tap to another, the best of all such moves each time.

use crate::band::Point;
use crate::refine::peaks;
use crate::{Command, Request, Tap};
use num_complex::Complex64;

/// Largest number of moves of one unit.
const MOVES: usize = 400;
/// Number of searches of the bands for new peaks.
const SEARCHES: usize = 12;
/// With more taps than this, units move only between near taps.
const MANY_TAPS: usize = 48;
/// Largest distance of near taps, in taps.
const NEAR: usize = 6;

/// A tap of whole units of `2^−F`.
type Units = (u32, i64);

/// Rounds amplitudes of sum 1 to integers of sum `2^F`. None of the integers is 0, and the last tap is kept.
pub fn round_taps(request: &Request, taps: &[Tap], fraction: u32) -> Vec<(u32, i64)> {
    let unity = 1i64 << fraction;
    let mut units = match request.command {
        Command::Positive => by_remainder(taps, unity, (i64::MIN, i64::MAX)),
        Command::Amplitudes { low, high } => by_remainder(taps, unity, in_units(low, high, unity)),
        Command::PartialSums { low, high } => by_sums(taps, unity, low, high),
    };
    units.retain(|(_, units)| *units != 0);
    let mut points: Vec<Point> = Vec::new();
    let mut best = units.clone();
    let mut least = f64::INFINITY;
    for _ in 0..SEARCHES {
        let found = peaks(request, &as_taps(&units, unity));
        let worst = found.first().map_or(0.0, |peak| peak.0);
        if worst < least {
            (least, best) = (worst, units.clone());
        }
        if worst <= 1.0 {
            break;
        }
        points.extend(
            found
                .iter()
                .filter(|(ratio, _)| *ratio > 0.9 * worst)
                .map(|(_, point)| *point),
        );
        if !improve(request, &mut units, &points, unity) {
            break;
        }
    }
    best
}

fn as_taps(units: &[Units], unity: i64) -> Vec<Tap> {
    let taps = units.iter();
    taps.map(|(sample, units)| (*sample, *units as f64 / unity as f64))
        .collect()
}

/// Returns bounds in whole units, none of them beyond the given ones.
fn in_units(low: f64, high: f64, unity: i64) -> (i64, i64) {
    ((low * unity as f64).ceil() as i64, (high * unity as f64).floor() as i64)
}

/// Rounds down, then adds a unit to the largest remainders, first of the taps that have room below the upper bound.
///
/// If integers within the bounds do not reach the sum, some of them exceed the bounds by a unit.
fn by_remainder(taps: &[Tap], unity: i64, (low, high): (i64, i64)) -> Vec<Units> {
    let exact = |tap: &Tap| tap.1 * unity as f64;
    let floor = |tap: &Tap| (exact(tap).floor() as i64).clamp(low, high);
    let mut units: Vec<Units> = taps.iter().map(|tap| (tap.0, floor(tap))).collect();
    let missing = unity - units.iter().map(|(_, units)| units).sum::<i64>();
    let mut order: Vec<usize> = (0..taps.len()).collect();
    let remainder = |index: &usize| exact(&taps[*index]) - exact(&taps[*index]).floor();
    order.sort_by(|a, b| remainder(b).total_cmp(&remainder(a)));
    // A clamped floor can be a unit above the exact amplitude, so the sum may also be too large.
    let step = missing.signum();
    let mut left = missing.unsigned_abs();
    // The units are added in the order of the remainders, repeatedly while a tap has room, and then without regard to the bounds.
    for regards_bounds in [true, false] {
        loop {
            let before = left;
            for index in &order {
                let moved = units[*index].1 + step;
                if left > 0 && (!regards_bounds || (low..=high).contains(&moved)) {
                    units[*index].1 = moved;
                    left -= 1;
                }
            }
            if left == 0 || left == before {
                break;
            }
        }
    }
    units
}

/// Rounds each partial sum to the nearest integer within the bounds; the last is `2^F`.
fn by_sums(taps: &[Tap], unity: i64, low: f64, high: f64) -> Vec<Units> {
    let (low, high) = in_units(low, high, unity);
    let (mut sum, mut before) = (0.0, 0);
    let last = taps.len().saturating_sub(1);
    let mut units = Vec::with_capacity(taps.len());
    for (index, tap) in taps.iter().enumerate() {
        sum += tap.1;
        let rounded = if index == last {
            unity
        } else {
            ((sum * unity as f64).round() as i64).clamp(low, high)
        };
        units.push((tap.0, rounded - before));
        before = rounded;
    }
    units
}

/// Moves units until the worst of the points is within its tolerance, or no move helps; returns whether anything moved.
fn improve(request: &Request, units: &mut [Units], points: &[Point], unity: i64) -> bool {
    let last = units.last().map_or(0, |tap| tap.0);
    // The effect of a unit of each tap at each point, in units of its tolerance.
    let shares: Vec<Vec<Complex64>> = units
        .iter()
        .map(|(sample, _)| {
            let share =
                |point: &Point| point.z(request.sample_hz).powu(last - sample) / (point.tolerance * unity as f64);
            points.iter().map(share).collect()
        })
        .collect();
    let mut sums: Vec<Complex64> = (0..points.len())
        .map(|point| {
            units
                .iter()
                .zip(&shares)
                .map(|((_, units), share)| share[point] * *units as f64)
                .sum()
        })
        .collect();
    let mut now = excess(sums.iter().copied());
    let mut moved = false;
    for _ in 0..MOVES {
        if now == 0.0 {
            break;
        }
        let mut best: Option<(f64, usize, usize)> = None;
        for from in 0..units.len() {
            for to in 0..units.len() {
                if from == to || (units.len() > MANY_TAPS && from.abs_diff(to) > NEAR) {
                    continue;
                }
                let after = sums.iter().zip(shares[to].iter().zip(&shares[from]));
                let found = excess(after.map(|(sum, (to, from))| sum + to - from));
                if found < best.map_or(now, |(least, ..)| least) && may_move(request, units, from, to, unity) {
                    best = Some((found, from, to));
                }
            }
        }
        let Some((found, from, to)) = best else {
            break;
        };
        units[from].1 -= 1;
        units[to].1 += 1;
        for (sum, (to, from)) in sums.iter_mut().zip(shares[to].iter().zip(&shares[from])) {
            *sum += to - from;
        }
        (now, moved) = (found, true);
    }
    moved
}

/// Returns the sum of `max(|ratio|² − 1, 0)²` over ratios of residual to tolerance; 0 if none exceeds 1.
///
/// The maximum alone would not do: with two equal peaks, most moves make one of them worse, and a search would end there.
fn excess(ratios: impl Iterator<Item = Complex64>) -> f64 {
    ratios.map(|ratio| (ratio.norm_sqr() - 1.0).max(0.0).powi(2)).sum()
}

/// Returns whether a unit may move: no tap vanishes, and the command stays within its bounds.
fn may_move(request: &Request, units: &[Units], from: usize, to: usize, unity: i64) -> bool {
    match request.command {
        Command::Positive => units[from].1 > 1,
        Command::Amplitudes { low, high } => {
            let (low, high) = in_units(low, high, unity);
            units[from].1 != 1 && units[to].1 != -1 && units[from].1 > low && units[to].1 < high
        }
        Command::PartialSums { low, high } => {
            let between = from.min(to)..from.max(to);
            let change = if from < to { -1 } else { 1 };
            let mut sum = 0;
            let sums = units.iter().enumerate().map(|(index, (_, units))| {
                sum += units;
                (index, sum)
            });
            units[from].1 != 1
                && units[to].1 != -1
                && sums.filter(|(index, _)| between.contains(index)).all(|(_, sum)| {
                    let moved = (sum + change) as f64 / unity as f64;
                    low <= moved && moved <= high
                })
        }
    }
}
