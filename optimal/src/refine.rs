//! Extends a solution from points to bands: solves, finds the worst points of the whole bands, adds them, and solves
//! again.

use crate::band::Point;
use crate::cone::Unsolved;
use crate::program::{Found, Objective, Program, powers};
use crate::{Command, DelayBound, LowerBound, OptimalError, Request, Tap, WeightedPoint};
use num_complex::Complex64;

/// Slack of a tolerance, as of every insensitivity.
pub(crate) const SLACK: f64 = 1e-6;
/// Largest number of rounds; each adds the peaks of the previous round, and a handful are enough.
const ROUNDS: usize = 40;
/// Weights below this part of their sum are left out of a bound.
const IDLE: f64 = 1e-7;

/// Result on chosen samples.
pub(crate) enum Refined {
    /// These amplitudes are within every tolerance times the level, over the whole bands.
    Within(Vec<Tap>),
    /// No amplitudes are within the tolerances; with the proof, if the ratio was the objective.
    Beyond(Option<LowerBound>),
}

/// Points of the bands that are in the program.
#[derive(Debug, Clone)]
pub(crate) struct Points {
    points: Vec<Point>,
    /// Whether the last program needed the point.
    used: Vec<bool>,
}

impl Points {
    pub(crate) fn new(request: &Request) -> Self {
        let bands = request.bands.iter().enumerate();
        let points: Vec<Point> = bands.flat_map(|(index, band)| band.first_points(index)).collect();
        Self {
            used: vec![true; points.len()],
            points,
        }
    }

    /// Removes the points that the last program did not need, because the points of another duration are elsewhere.
    pub(crate) fn prune(&mut self) {
        let mut used = self.used.iter();
        self.points.retain(|_| used.next().copied().unwrap_or(true));
        self.used = vec![true; self.points.len()];
    }

    /// Adds the peaks above a level.
    fn join(&mut self, peaks: &[(f64, Point)], level: f64) {
        let above = peaks.iter().filter(|(ratio, _)| *ratio > level * (1.0 + 0.1 * SLACK));
        for (_, point) in above {
            self.points.push(*point);
            self.used.push(true);
        }
    }
}

/// Solves on `samples` for an objective, with as many points as necessary.
pub(crate) fn refine(
    request: &Request,
    samples: &[u32],
    points: &mut Points,
    objective: Objective<'_>,
    level: f64,
) -> Result<Refined, OptimalError> {
    let limit = (level * (1.0 + SLACK)).min(1.0 + SLACK);
    let mut last = f64::INFINITY;
    if !request.command.reaches_one(samples.len()) {
        return Ok(Refined::Beyond(Some(too_few(samples))));
    }
    for _ in 0..ROUNDS {
        let Some(found) = solve_once(request, samples, points, objective, level)? else {
            return Ok(Refined::Beyond(None));
        };
        if matches!(objective, Objective::Ratio) && request.delay_samples.is_none() {
            let bound = lower_bound(request, samples, &points.points, &found.weights);
            if bound.ratio > level {
                return Ok(Refined::Beyond(Some(bound)));
            }
        }
        // With a required delay there is no such bound; the least ratio at some of the points is also a bound.
        if request.delay_samples.is_some() && found.ratio.is_some_and(|ratio| ratio > level * (1.0 + 10.0 * SLACK)) {
            return Ok(Refined::Beyond(None));
        }
        let peaks = peaks(request, &found.taps);
        let worst = peaks.first().map_or(0.0, |peak| peak.0);
        if worst <= limit {
            return Ok(Refined::Within(found.taps));
        }
        // The peaks no longer change, so the solver has reached its accuracy.
        if worst >= last && worst <= level * (1.0 + 10.0 * SLACK) {
            break;
        }
        last = worst;
        points.join(&peaks, level);
    }
    Ok(Refined::Beyond(None))
}

/// Finds the shaper of least or of greatest mean delay on `samples` within a level of the tolerances, with the bound that
/// proves it; `None` if the level cannot be met.
pub(crate) fn extreme_delay(
    request: &Request,
    samples: &[u32],
    points: &mut Points,
    latest: bool,
    level: f64,
) -> Result<Option<(Vec<Tap>, DelayBound)>, OptimalError> {
    let objective = if latest { Objective::Latest } else { Objective::Delay };
    let limit = (level * (1.0 + SLACK)).min(1.0 + SLACK);
    for _ in 0..ROUNDS {
        let Some(found) = solve_once(request, samples, points, objective, level)? else {
            return Ok(None);
        };
        let bound = delay_bound(request, samples, &points.points, &found.weights, latest);
        let peaks = peaks(request, &found.taps);
        if peaks.first().is_none_or(|peak| peak.0 <= limit) {
            return Ok(Some((found.taps, bound)));
        }
        points.join(&peaks, level);
    }
    Ok(None)
}

/// Relative accuracy of the smallest worst ratio.
const NEAR: f64 = 1e-4;

/// Finds the smallest worst ratio of residual to tolerance over the bands, on chosen samples.
pub(crate) fn least_ratio(request: &Request, samples: &[u32], points: &mut Points) -> Result<f64, OptimalError> {
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        points.prune();
        let Some(found) = solve_once(request, samples, points, Objective::Ratio, 1.0)? else {
            break;
        };
        let bound = lower_bound(request, samples, &points.points, &found.weights).ratio;
        let peaks = peaks(request, &found.taps);
        least = least.min(peaks.first().map_or(0.0, |peak| peak.0));
        if least <= bound * (1.0 + NEAR) + NEAR * NEAR {
            break;
        }
        points.join(&peaks, bound);
    }
    Ok(least)
}

/// Solves once at the present points, and adds the peaks of the solution: a step of a search that ends with [`refine`].
pub(crate) fn step(
    request: &Request,
    samples: &[u32],
    points: &mut Points,
    objective: Objective<'_>,
    level: f64,
) -> Result<Option<Vec<Tap>>, OptimalError> {
    let Some(found) = solve_once(request, samples, points, objective, level)? else {
        return Ok(None);
    };
    points.prune();
    points.join(&peaks(request, &found.taps), level);
    Ok(Some(found.taps))
}

/// Solves one program; returns `None` if it has no solution.
fn solve_once(
    request: &Request,
    samples: &[u32],
    points: &mut Points,
    objective: Objective<'_>,
    level: f64,
) -> Result<Option<Found>, OptimalError> {
    if !request.command.reaches_one(samples.len()) {
        return Ok(None);
    }
    let program = Program {
        request,
        samples,
        points: &points.points,
        level,
    };
    match program.solve(objective) {
        Ok(found) => {
            let shares = found.weights.iter().zip(&points.points);
            let shares: Vec<f64> = shares.map(|(weight, point)| weight.norm() * point.tolerance).collect();
            let all: f64 = shares.iter().sum();
            points.used = shares.iter().map(|share| *share > IDLE * all).collect();
            Ok(Some(found))
        }
        Err(Unsolved::Infeasible) => Ok(None),
        Err(Unsolved::Stopped(status)) => Err(OptimalError::Solver {
            samples: samples.last().copied().unwrap_or(0),
            status,
        }),
    }
}

/// Returns the peaks of all bands, highest first.
pub(crate) fn peaks(request: &Request, taps: &[Tap]) -> Vec<(f64, Point)> {
    let taps: Vec<Tap> = significant(taps);
    let bands = request.bands.iter().enumerate();
    let mut peaks: Vec<(f64, Point)> = bands
        .flat_map(|(index, band)| band.peaks(index, &taps, request.sample_hz))
        .collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    peaks
}

/// Returns the taps without those of amplitude 0, except the last, at which the residual is measured.
pub(crate) fn significant(taps: &[Tap]) -> Vec<Tap> {
    let last = taps.last().map(|tap| tap.0);
    let kept = taps.iter().filter(|tap| tap.1.abs() > 1e-13 || Some(tap.0) == last);
    kept.copied().collect()
}

/// Returns the bound that amplitudes on these samples cannot sum to 1.
fn too_few(samples: &[u32]) -> LowerBound {
    LowerBound {
        samples: samples.last().copied().unwrap_or(0),
        points: Vec::new(),
        ratio: f64::INFINITY,
    }
}

/// Returns the least `Σ a_i gain_i` of amplitudes within bounds and of sum 1: each sample is at the lower bound, and the missing amount
/// goes to the samples with the least gain.
fn least_over_amplitudes(gains: &[f64], low: f64, high: f64) -> f64 {
    let mut order = gains.to_vec();
    order.sort_by(f64::total_cmp);
    let mut missing = 1.0 - low * order.len() as f64;
    let mut least = 0.0;
    for gain in order {
        let more = missing.clamp(0.0, high - low);
        missing -= more;
        least += gain * (low + more);
    }
    least
}

/// Returns the bound of the delay that the weights of a program prove, for amplitudes on its samples.
fn delay_bound(
    request: &Request,
    samples: &[u32],
    points: &[Point],
    weights: &[Complex64],
    is_upper: bool,
) -> DelayBound {
    let sign = if is_upper { -1.0 } else { 1.0 };
    let kept: Vec<(&Complex64, &Point)> = weights
        .iter()
        .zip(points)
        .filter(|(weight, _)| weight.norm() > 0.0)
        .collect();
    let mut gains: Vec<f64> = samples.iter().map(|sample| sign * f64::from(*sample)).collect();
    let mut allowed = 0.0;
    for (weight, point) in &kept {
        for (gain, power) in gains.iter_mut().zip(powers(samples, point.z(request.sample_hz))) {
            *gain += (weight.conj() * power).re;
        }
        allowed += weight.norm() * point.tolerance;
    }
    DelayBound {
        samples: samples.last().copied().unwrap_or(0),
        is_upper,
        points: kept
            .into_iter()
            .map(|(weight, point)| weighted(point, *weight))
            .collect(),
        delay_samples: sign * (least_gain(request.command, &gains) - allowed),
    }
}

fn weighted(point: &Point, weight: Complex64) -> WeightedPoint {
    WeightedPoint {
        band: point.band,
        frequency_hz: point.frequency_hz,
        damping: point.damping,
        weight: [weight.re, weight.im],
    }
}

/// Returns the least `Σ a_i gain_i` of all amplitudes that the command allows.
fn least_gain(command: Command, gains: &[f64]) -> f64 {
    match command {
        Command::Positive => gains.iter().copied().fold(f64::INFINITY, f64::min),
        Command::PartialSums { low, high } => {
            let steps = gains.windows(2).map(|pair| pair[0] - pair[1]);
            let least: f64 = steps.map(|step| (low * step).min(high * step)).sum();
            least + gains.last().copied().unwrap_or(0.0)
        }
        Command::Amplitudes { low, high } => least_over_amplitudes(gains, low, high),
    }
}

/// Returns the bound that the weights of a program prove, for amplitudes on its samples.
fn lower_bound(request: &Request, samples: &[u32], points: &[Point], weights: &[Complex64]) -> LowerBound {
    let pairs = weights.iter().zip(points);
    let all: f64 = pairs
        .clone()
        .map(|(weight, point)| weight.norm() * point.tolerance)
        .sum();
    let kept: Vec<(Complex64, &Point)> = pairs
        .filter(|(weight, point)| weight.norm() * point.tolerance > IDLE * all)
        .map(|(weight, point)| (*weight, point))
        .collect();
    let all: f64 = kept.iter().map(|(weight, point)| weight.norm() * point.tolerance).sum();
    let mut gains = vec![0.0; samples.len()];
    for (weight, point) in &kept {
        let weight = weight.conj() / all;
        for (gain, power) in gains.iter_mut().zip(powers(samples, point.z(request.sample_hz))) {
            *gain += (weight * power).re;
        }
    }
    let points = kept.iter().map(|(weight, point)| weighted(point, weight / all));
    LowerBound {
        samples: samples.last().copied().unwrap_or(0),
        points: points.collect(),
        ratio: least_gain(request.command, &gains),
    }
}
