//! What more duration buys: fewer taps, or less residual.

use crate::prefer::fewest_at;
use crate::refine::{Points, least_ratio};
use crate::{OptimalError, Prefer, Request, Tap};

/// A duration, and what it buys.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontPoint {
    /// Duration in samples.
    pub samples: u32,
    /// Few taps that hold every tolerance.
    pub taps: Vec<Tap>,
    /// Least largest ratio of residual to tolerance that any shaper of this duration reaches, with any number of taps.
    pub least_ratio: f64,
}

/// What each of these durations buys. They must hold: none is below [`Shortest::least_samples`](crate::Shortest::least_samples).
///
/// # Errors
/// [`OptimalError::Solver`], also for a duration that does not hold.
pub fn front(request: &Request, durations: &[u32]) -> Result<Vec<FrontPoint>, OptimalError> {
    let request = Request {
        prefer: Prefer::FewestTaps,
        ..request.clone()
    };
    let mut points = Points::new(&request);
    let mut front = Vec::with_capacity(durations.len());
    for &samples in durations {
        let taps = fewest_at(&request, samples, &mut points)?.ok_or_else(|| OptimalError::Solver {
            samples,
            status: "no shaper of this duration holds".into(),
        })?;
        let all: Vec<u32> = (0..=samples).collect();
        front.push(FrontPoint {
            samples,
            taps,
            least_ratio: least_ratio(&request, &all, &mut points)?,
        });
    }
    Ok(front)
}
