//! Designs the shapers of several axes together, with one delay, so that the axes arrive together.
//!
//! The shapers of an axis that last at most `N` samples and meet its tolerances form a convex set, and their mean delay is linear. So the
//! possible delays of the axis form a range from an earliest to a latest one, each the solution of a cone program. Several axes have a
//! common delay if their ranges meet. The ranges only grow with `N`, so the least common duration is found by bisection; there, the least
//! common delay is the largest of the earliest ones. The axis that determines it gets its shaper of least delay, and the others are
//! designed for that delay by their preferences.

use crate::prefer::{NONE, levels, preferred, support};
use crate::program::Objective;
use crate::refine::{Points, Refined, SLACK, extreme_delay, refine, significant};
use crate::{DelayBound, LowerBound, OptimalError, Request, Shortest, Tap};

/// Amplitudes below this are not larger than the solver's accuracy.
const NOTHING: f64 = 1e-8;

/// An axis of a joint design.
#[derive(Debug, Clone, PartialEq)]
pub struct Partner {
    /// Requirements of its shaper.
    pub request: Request,
    /// Its shortest shaper alone.
    pub alone: Shortest,
    /// Delay in samples of the axis in addition to that of its shaper.
    pub lag_samples: f64,
}

/// Shapers with one delay.
#[derive(Debug, Clone, PartialEq)]
pub struct Together {
    /// Their taps, in the order of the axes, each with sum 1.
    pub taps: Vec<Vec<Tap>>,
    /// Least common duration in samples.
    pub samples: u32,
    /// Common delay in samples, with the axes' own lags.
    pub delay_samples: f64,
    /// Proof that no shapers of a lesser common duration have a common delay.
    pub shorter: Option<Shorter>,
    /// The axis that decides the delay.
    pub latest_axis: usize,
    /// Lower bound of that axis's delay at this duration, without its lag, for its full tolerances. The taps leave a part of these for
    /// rounding, if the duration has room for it, and are later by the benefit of that part.
    pub earlier: Option<DelayBound>,
}

/// Why a lesser common duration is not enough.
#[derive(Debug, Clone, PartialEq)]
pub enum Shorter {
    /// One axis has no shaper that is shorter.
    Alone {
        /// Index of the axis.
        axis: usize,
        /// The proof.
        proof: LowerBound,
    },
    /// The earliest that one axis can be is later than the latest that another can be.
    Apart {
        /// Index of the axis that is always later.
        late_axis: usize,
        /// Lower bound of its delay, without its lag.
        earliest: DelayBound,
        /// Index of the axis that is always earlier.
        early_axis: usize,
        /// Upper bound of its delay, without its lag.
        latest: DelayBound,
    },
}

/// Why there is no joint design, and the axis that prevents it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{cause}")]
pub struct TogetherError {
    /// Index of the axis.
    pub axis: usize,
    /// The error.
    pub cause: OptimalError,
}

/// An end of the range of an axis's delays.
struct End {
    /// The delay with the axis's lag.
    delay: f64,
    bound: Option<DelayBound>,
}

/// Designs shapers with one delay: of the least common duration and, at that duration, of the least delay.
///
/// # Errors
/// [`TogetherError`], with [`OptimalError::Apart`] if no duration up to the longest has a common delay.
pub fn together(partners: &[Partner]) -> Result<Together, TogetherError> {
    let durations = partners.iter().map(|partner| partner.alone.least_samples).enumerate();
    let Some((slowest, least)) = durations.max_by_key(|(_, samples)| *samples) else {
        return Ok(Together {
            taps: Vec::new(),
            samples: 0,
            delay_samples: 0.0,
            shorter: None,
            latest_axis: 0,
            earlier: None,
        });
    };
    let proof = partners.get(slowest).and_then(|partner| partner.alone.shorter.clone());
    let mut shorter = proof.map(|proof| Shorter::Alone { axis: slowest, proof });
    let longest = partners.iter().map(|partner| partner.request.longest_samples).min();
    let longest = longest.unwrap_or(least);
    let (mut low, mut high, mut reach) = (None, least, 1);
    let mut ends = loop {
        match ends(partners, high)? {
            Ok(ends) => break ends,
            Err(apart) if high >= longest => {
                return Err(TogetherError {
                    axis: apart.late_axis,
                    cause: OptimalError::Apart {
                        longest_samples: longest,
                        gap_samples: apart.gap,
                    },
                });
            }
            Err(apart) => {
                (low, shorter) = (Some(high), apart.proof);
                high = high.saturating_add(reach).min(longest);
                reach *= 2;
            }
        }
    };
    while let Some(below) = low.filter(|below| high - below > 1) {
        let middle = below + (high - below) / 2;
        match self::ends(partners, middle)? {
            Ok(found) => (high, ends) = (middle, found),
            Err(apart) => (low, shorter) = (Some(middle), apart.proof),
        }
    }
    at(partners, high, ends, shorter)
}

/// Two axes whose ranges do not meet.
struct Apart {
    /// The axis that is always later.
    late_axis: usize,
    /// Samples between them.
    gap: f64,
    proof: Option<Shorter>,
}

/// Returns the earliest shaper of each axis at a common duration, or why there is no common delay.
fn ends(partners: &[Partner], samples: u32) -> Result<Result<Vec<End>, Apart>, TogetherError> {
    let mut earliest = Vec::with_capacity(partners.len());
    let mut latest = Vec::with_capacity(partners.len());
    for (axis, partner) in partners.iter().enumerate() {
        let of_axis = |cause| TogetherError { axis, cause };
        earliest.push(end(partner, samples, false).map_err(of_axis)?);
        latest.push(end(partner, samples, true).map_err(of_axis)?);
    }
    let by_delay = |a: &(usize, &End), b: &(usize, &End)| a.1.delay.total_cmp(&b.1.delay);
    let (late, early) = (
        earliest.iter().enumerate().max_by(by_delay),
        latest.iter().enumerate().min_by(by_delay),
    );
    let (Some((late_axis, late)), Some((early_axis, early))) = (late, early) else {
        return Ok(Ok(earliest));
    };
    let gap = late.delay - early.delay;
    if gap <= 0.0 {
        return Ok(Ok(earliest));
    }
    let proof = late.bound.clone().zip(early.bound.clone());
    let proof = proof.map(|(earliest, latest)| Shorter::Apart {
        late_axis,
        earliest,
        early_axis,
        latest,
    });
    Ok(Err(Apart { late_axis, gap, proof }))
}

/// Returns an end of the range of an axis's delays.
fn end(partner: &Partner, samples: u32, latest: bool) -> Result<End, OptimalError> {
    let all: Vec<u32> = (0..=samples).collect();
    let mut points = Points::new(&partner.request);
    for level in [1.0, 1.0 + SLACK / 2.0] {
        if let Some((taps, bound)) = extreme_delay(&partner.request, &all, &mut points, latest, level)? {
            return Ok(End {
                delay: mean(&taps) + partner.lag_samples,
                bound: Some(bound),
            });
        }
    }
    // At the least duration there may be no solution within the solver's accuracy; then the shortest shaper is used.
    Ok(End {
        delay: mean(&partner.alone.taps) + partner.lag_samples,
        bound: None,
    })
}

/// Returns the taps of least delay at a duration, with room for rounding if there is any.
fn earliest_taps(partner: &Partner, samples: u32) -> Result<Vec<Tap>, OptimalError> {
    let request = &partner.request;
    let all: Vec<u32> = (0..=samples).collect();
    let mut points = Points::new(request);
    for level in levels(request) {
        let Some((taps, _)) = extreme_delay(request, &all, &mut points, false, level)? else {
            continue;
        };
        let few = extreme_delay(request, &support(&taps, NONE), &mut points, false, level)?;
        return Ok(few.map_or_else(|| significant(&taps), |(few, _)| few));
    }
    if partner.alone.taps.last().is_none_or(|tap| tap.0 <= samples) {
        Ok(partner.alone.taps.clone())
    } else {
        Err(OptimalError::Solver {
            samples,
            status: "the shaper of least delay was not found".into(),
        })
    }
}

fn mean(taps: &[Tap]) -> f64 {
    taps.iter()
        .map(|(sample, amplitude)| f64::from(*sample) * amplitude)
        .sum()
}

/// Designs all axes for the least common delay at a duration.
fn at(partners: &[Partner], samples: u32, ends: Vec<End>, shorter: Option<Shorter>) -> Result<Together, TogetherError> {
    let decisive = ends.iter().enumerate().max_by(|a, b| a.1.delay.total_cmp(&b.1.delay));
    let latest_axis = decisive.map_or(0, |(axis, _)| axis);
    let mut decided = Vec::new();
    let mut delay_samples = 0.0;
    if let Some(partner) = partners.get(latest_axis) {
        let of_axis = |cause| TogetherError {
            axis: latest_axis,
            cause,
        };
        decided = earliest_taps(partner, samples).map_err(of_axis)?;
        delay_samples = mean(&decided) + partner.lag_samples;
    }
    let mut taps = Vec::with_capacity(partners.len());
    for (axis, partner) in partners.iter().enumerate() {
        let found = if axis == latest_axis {
            Ok(decided.clone())
        } else {
            with_delay(&partner.request, samples, delay_samples - partner.lag_samples)
        };
        let found = found.and_then(|found| within_budget(&partner.request, samples, found));
        taps.push(found.map_err(|cause| TogetherError { axis, cause })?);
    }
    Ok(Together {
        taps,
        samples,
        delay_samples,
        shorter,
        latest_axis,
        earlier: ends.into_iter().nth(latest_axis).and_then(|end| end.bound),
    })
}

/// Returns the preferred taps of a delay within a duration.
fn with_delay(request: &Request, samples: u32, delay: f64) -> Result<Vec<Tap>, OptimalError> {
    let request = Request {
        delay_samples: Some(delay),
        ..request.clone()
    };
    let all: Vec<u32> = (0..=samples).collect();
    let mut points = Points::new(&request);
    match refine(&request, &all, &mut points, Objective::Ratio, 1.0)? {
        Refined::Within(held) => Ok(exactly(preferred(&request, held, &mut points)?, delay)),
        Refined::Beyond(_) => Err(OptimalError::Solver {
            samples,
            status: format!("no shaper with a delay of {delay:.3} samples was found"),
        }),
    }
}

/// Leaves out end taps that only result from the solver's accuracy, and corrects the delay by moving amplitude between the two largest
/// taps.
fn exactly(mut taps: Vec<Tap>, delay: f64) -> Vec<Tap> {
    let is_nothing = |tap: Option<&Tap>| tap.is_some_and(|tap| tap.1.abs() < NOTHING);
    while taps.len() > 2 && is_nothing(taps.last()) {
        taps.pop();
    }
    while taps.len() > 2 && is_nothing(taps.first()) {
        taps.remove(0);
    }
    let mut order: Vec<usize> = (0..taps.len()).collect();
    order.sort_by(|a, b| taps[*b].1.abs().total_cmp(&taps[*a].1.abs()));
    if let [first, second, ..] = order.as_slice() {
        taps[*first].1 += 1.0 - taps.iter().map(|tap| tap.1).sum::<f64>();
        let apart = f64::from(taps[*second].0) - f64::from(taps[*first].0);
        let moved = (delay - mean(&taps)) / apart;
        taps[*first].1 -= moved;
        taps[*second].1 += moved;
    }
    taps
}

/// Refuses more taps than a budget allows.
fn within_budget(request: &Request, samples: u32, taps: Vec<Tap>) -> Result<Vec<Tap>, OptimalError> {
    if taps.len() <= request.most_taps {
        Ok(taps)
    } else {
        Err(OptimalError::TapBudget {
            budget: request.most_taps,
            fewest: taps.len(),
            samples,
            longest_samples: samples,
        })
    }
}
