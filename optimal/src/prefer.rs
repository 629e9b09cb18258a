//! Chooses among the shapers of least duration: few taps, least residual or least delay.
//!
//! The number of taps is not a convex objective. The amplitudes of one program are the weights of the next, so that
//! small ones become smaller (reweighted L1); then the program is solved again on the remaining samples, and taps are
//! left out one by one as long as the rest meets the tolerances.

use crate::band::Point;
use crate::program::Objective;
use crate::refine::{Points, Refined, SLACK, refine, significant, step};
use crate::{OptimalError, Prefer, Request, Tap};

/// Part of each tolerance that is reserved for rounding to integers, if the duration allows it: with two dozen taps of
/// 16 fraction bits, the units of the last place add up to about this.
const ROUNDING: f64 = 8e-5;
/// Largest part of a tolerance that is reserved for rounding.
const MOST_ROUNDING: f64 = 0.02;
/// Number of rounds of reweighting.
const REWEIGHTS: i32 = 6;
/// Reweighting drives amplitudes below this to 0.
const NOTHING: f64 = 1e-3;
/// Amplitudes below this count as 0.
pub(crate) const NONE: f64 = 1e-5;
/// Longest duration at which a budget of taps is tried, as a multiple of the least duration.
const BUDGET_REACH: u32 = 4;

/// Returns the taps of the preferred shaper within the budget of taps, of at least the least duration.
pub(crate) fn choose(request: &Request, held: Vec<Tap>, points: &mut Points) -> Result<Vec<Tap>, OptimalError> {
    let least = held.last().map_or(0, |tap| tap.0);
    let taps = preferred(request, held, points)?;
    if taps.len() <= request.most_taps {
        Ok(taps)
    } else {
        within_budget(request, least, points)
    }
}

/// Returns the levels of the tolerances that are tried: with room for rounding first, the full tolerances last.
pub(crate) fn levels(request: &Request) -> [f64; 4] {
    let tolerance = request
        .bands
        .iter()
        .fold(f64::INFINITY, |least, band| least.min(band.tolerance));
    let room = (ROUNDING / tolerance).min(MOST_ROUNDING);
    [1.0 - room, 1.0 - room / 4.0, 1.0, 1.0 + SLACK / 2.0]
}

/// Returns the preferred taps at a duration, from amplitudes on all its samples that meet the tolerances.
pub(crate) fn preferred(request: &Request, held: Vec<Tap>, points: &mut Points) -> Result<Vec<Tap>, OptimalError> {
    let spread = spread(request, held.last().map_or(0, |tap| tap.0));
    for level in levels(request) {
        let found = match request.prefer {
            Prefer::FewestTaps => fewest_taps(request, &held, points, level)?,
            Prefer::LeastResidual => pruned(request, &held, points, Objective::Squares(&spread), level)?,
            Prefer::LeastDelay => pruned(request, &held, points, Objective::Delay, level)?,
        };
        if let Some(taps) = found {
            return Ok(taps);
        }
    }
    Ok(significant(&held))
}

fn spread(request: &Request, samples: u32) -> Vec<Point> {
    let bands = request.bands.iter().enumerate();
    bands
        .flat_map(|(index, band)| band.spread_points(index, samples, request.sample_hz))
        .collect()
}

/// Returns the samples of the taps that are not 0, and the first and the last sample.
pub(crate) fn support(taps: &[Tap], least: f64) -> Vec<u32> {
    let ends = [taps.first(), taps.last()].map(|tap| tap.map(|tap| tap.0));
    let kept = taps
        .iter()
        .filter(|tap| tap.1.abs() > least || ends.contains(&Some(tap.0)));
    kept.map(|tap| tap.0).collect()
}

/// Optimises an objective on all samples of `taps`, then again on those that have an amplitude; returns `None` if the
/// level cannot be met.
fn pruned(
    request: &Request,
    held: &[Tap],
    points: &mut Points,
    objective: Objective<'_>,
    level: f64,
) -> Result<Option<Vec<Tap>>, OptimalError> {
    let samples: Vec<u32> = held.iter().map(|tap| tap.0).collect();
    let Refined::Within(found) = refine(request, &samples, points, objective, level)? else {
        return Ok(None);
    };
    match refine(request, &support(&found, NONE), points, objective, level)? {
        Refined::Within(few) => Ok(Some(few)),
        Refined::Beyond(_) => Ok(Some(significant(&found))),
    }
}

/// Returns few taps, from amplitudes on all samples that meet the tolerances; `None` if the level cannot be met.
fn fewest_taps(
    request: &Request,
    held: &[Tap],
    points: &mut Points,
    level: f64,
) -> Result<Option<Vec<Tap>>, OptimalError> {
    let samples: Vec<u32> = held.iter().map(|tap| tap.0).collect();
    let mut taps = held.to_vec();
    let mut supports = vec![support(held, NONE)];
    for round in 0..REWEIGHTS {
        let floor = 0.03 * 0.3f64.powi(round);
        let weights: Vec<f64> = taps.iter().map(|tap| floor / (tap.1.abs() + floor)).collect();
        let Some(found) = step(request, &samples, points, Objective::Weighted(&weights), level)? else {
            break;
        };
        taps = found;
        let kept = support(&taps, NOTHING);
        let settled = supports.last() == Some(&kept);
        supports.push(kept);
        if settled {
            break;
        }
    }
    supports.dedup();
    for kept in supports.iter().rev() {
        points.prune();
        if let Refined::Within(found) = refine(request, kept, points, Objective::Ratio, level)? {
            return leave_out(request, found, points, level).map(Some);
        }
    }
    Ok(None)
}

/// Leaves out taps as long as the others meet the tolerances, the smallest first. A tap that cannot be left out of many
/// taps cannot be left out of fewer either, so each is tried only once.
fn leave_out(request: &Request, mut taps: Vec<Tap>, points: &mut Points, level: f64) -> Result<Vec<Tap>, OptimalError> {
    // With a required delay the duration is a limit only: the first and the last sample may be left out as well.
    let ends = match request.delay_samples {
        Some(_) => [None, None],
        None => [taps.first(), taps.last()],
    };
    let mut tried: Vec<u32> = ends.into_iter().flatten().map(|tap| tap.0).collect();
    loop {
        let untried = taps.iter().filter(|tap| !tried.contains(&tap.0));
        let Some(&(smallest, _)) = untried.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs())) else {
            return Ok(taps);
        };
        tried.push(smallest);
        let rest = taps.iter().map(|tap| tap.0).filter(|sample| *sample != smallest);
        let rest: Vec<u32> = rest.collect();
        points.prune();
        if let Refined::Within(found) = refine(request, &rest, points, Objective::Ratio, level)? {
            taps = found;
        }
    }
}

/// Returns the few taps at a duration; `None` if it is too short.
pub(crate) fn fewest_at(
    request: &Request,
    samples: u32,
    points: &mut Points,
) -> Result<Option<Vec<Tap>>, OptimalError> {
    let all: Vec<u32> = (0..=samples).collect();
    points.prune();
    match refine(request, &all, points, Objective::Ratio, 1.0)? {
        Refined::Within(held) => preferred(request, held, points).map(Some),
        Refined::Beyond(_) => Ok(None),
    }
}

/// Returns the shortest duration found at which the budget of taps is met, and its taps.
fn within_budget(request: &Request, least: u32, points: &mut Points) -> Result<Vec<Tap>, OptimalError> {
    let few = Request {
        prefer: Prefer::FewestTaps,
        ..request.clone()
    };
    let longest = request.longest_samples.min(least.saturating_mul(BUDGET_REACH));
    let mut fewest = (usize::MAX, least);
    let mut attempt = |samples: u32, points: &mut Points| -> Result<Option<Vec<Tap>>, OptimalError> {
        let Some(taps) = fewest_at(&few, samples, points)? else {
            return Ok(None);
        };
        if taps.len() < fewest.0 {
            fewest = (taps.len(), samples);
        }
        Ok((taps.len() <= request.most_taps).then_some(taps))
    };
    let (mut low, mut high) = (least, least);
    let mut step = least.div_ceil(64).max(1);
    let mut found = loop {
        if let Some(taps) = attempt(high, points)? {
            break taps;
        }
        if high == longest {
            return Err(OptimalError::TapBudget {
                budget: request.most_taps,
                fewest: fewest.0,
                samples: fewest.1,
                longest_samples: longest,
            });
        }
        low = high;
        high = high.saturating_add(step).min(longest);
        step *= 2;
    };
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        match attempt(middle, points)? {
            Some(taps) => (high, found) = (middle, taps),
            None => low = middle,
        }
    }
    let spread = spread(request, high);
    let objective = match request.prefer {
        Prefer::FewestTaps => return Ok(found),
        Prefer::LeastResidual => Objective::Squares(&spread),
        Prefer::LeastDelay => Objective::Delay,
    };
    for level in levels(request) {
        let samples: Vec<u32> = found.iter().map(|tap| tap.0).collect();
        if let Refined::Within(taps) = refine(request, &samples, points, objective, level)? {
            return Ok(taps);
        }
    }
    Ok(found)
}
