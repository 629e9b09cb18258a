//! Computes the benefit of longer durations: fewer taps, or less residual.

use crate::prefer::fewest_at;
use crate::refine::{Points, least_ratio, peaks};
use crate::search::check;
use crate::{OptimalError, Prefer, Request, Tap, shortest};

/// A duration, and its benefit.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontPoint {
    /// Duration in samples.
    pub samples: u32,
    /// Few taps that meet every tolerance, of this duration or of a shorter one.
    pub taps: Vec<Tap>,
    /// Smallest worst ratio of residual to tolerance that was found at this duration, with any number of taps.
    pub least_ratio: f64,
}

/// Returns the smallest worst ratio of residual to tolerance of any shaper of at most `samples` samples, with any number of taps, to a part
/// in ten thousand.
///
/// # Errors
/// [`OptimalError`] for bands or tolerances that are out of range, or if the solver does not converge.
pub fn least_ratio_at(request: &Request, samples: u32) -> Result<f64, OptimalError> {
    check(request)?;
    let all: Vec<u32> = (0..=samples).collect();
    least_ratio(request, &all, &mut Points::new(request))
}

/// Returns the benefit of each of these durations; a duration after the first is left out if the solver does not converge for it. None may
/// be below [`Shortest::least_samples`](crate::Shortest::least_samples).
///
/// # Errors
/// [`OptimalError::Solver`], also for a duration that is too short.
pub fn front(request: &Request, durations: &[u32]) -> Result<Vec<FrontPoint>, OptimalError> {
    let request = Request {
        prefer: Prefer::FewestTaps,
        ..request.clone()
    };
    let mut points = Points::new(&request);
    let mut front = Vec::with_capacity(durations.len());
    // A shaper of one duration is also one of each longer duration.
    let mut least = f64::INFINITY;
    let mut fewest: Vec<Tap> = Vec::new();
    for &samples in durations {
        let all: Vec<u32> = (0..=samples).collect();
        let taps = match fewest_at(&request, samples, &mut points) {
            Err(OptimalError::Solver { .. }) if !front.is_empty() => continue,
            Err(OptimalError::Solver { .. }) => Some(shortest(&request)?.taps),
            other => other?,
        };
        let taps = taps.ok_or_else(|| OptimalError::Solver {
            samples,
            status: "no shaper of this duration keeps the tolerances".into(),
        })?;
        // Rounding errors end some programs early; the ratio of the few taps is then used instead.
        let ratio = match least_ratio(&request, &all, &mut points) {
            Err(OptimalError::Solver { .. }) => peaks(&request, &taps).first().map_or(0.0, |peak| peak.0),
            other => other?,
        };
        least = ratio.min(least);
        if fewest.is_empty() || taps.len() < fewest.len() {
            fewest = taps;
        }
        front.push(FrontPoint {
            samples,
            taps: fewest.clone(),
            least_ratio: least,
        });
    }
    Ok(front)
}
