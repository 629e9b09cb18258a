//! Finds the least duration by bisection over the samples, on a coarse grid first.
//!
//! A duration that is enough on a coarse grid is enough on the full one, so the coarse one gives an upper bound at a
//! fraction of the work. A shaper of `N` samples is one of `N + 1` whose last amplitude is 0, and vibration only
//! decays: if `N` is enough, so is `N + 1`.

use crate::prefer;
use crate::program::Objective;
use crate::refine::{Points, Refined, refine};
use crate::{Command, LowerBound, OptimalError, Request, Tap};

/// The shortest shaper, with its proof.
#[derive(Debug, Clone, PartialEq)]
pub struct Shortest {
    /// Its taps, in order, with sum 1.
    pub taps: Vec<Tap>,
    /// Least duration in samples, whatever the number of taps.
    pub least_samples: u32,
    /// Proof that no shorter shaper exists, for one sample less than `least_samples`; `None` if that is 0 samples.
    pub shorter: Option<LowerBound>,
}

/// Approximate number of samples of a coarse grid.
const COARSE: u32 = 64;
/// Smallest number of samples of a coarse grid per period of the highest mode.
const SAMPLES_PER_PERIOD: f64 = 8.0;

/// Designs the shortest shaper.
///
/// # Errors
/// [`OptimalError`].
pub fn shortest(request: &Request) -> Result<Shortest, OptimalError> {
    check(request)?;
    let mut points = Points::new(request);
    let Least { held, shorter } = least(request, &mut points)?;
    Ok(Shortest {
        least_samples: held.last().map_or(0, |tap| tap.0),
        taps: prefer::choose(request, held, &mut points)?,
        shorter,
    })
}

pub(crate) fn check(request: &Request) -> Result<(), OptimalError> {
    let half_sample_hz = request.sample_hz / 2.0;
    let most_samples = request.longest_samples.saturating_add(1);
    if let (Command::Amplitudes { high, .. }, false) =
        (request.command, request.command.reaches_one(most_samples as usize))
    {
        return Err(OptimalError::Amplitudes {
            high,
            samples: most_samples,
        });
    }
    for (index, band) in request.bands.iter().enumerate() {
        let [low_hz, high_hz] = band.frequency_hz;
        let rings = band.damping.iter().all(|damping| (0.0..1.0).contains(damping));
        if !(0.0 < band.tolerance && band.tolerance < 1.0) {
            return Err(OptimalError::Tolerance {
                band: index,
                tolerance: band.tolerance,
            });
        }
        if !(low_hz > 0.0 && low_hz <= high_hz && high_hz < half_sample_hz && rings) {
            return Err(OptimalError::Band {
                band: index,
                low_hz,
                high_hz,
                half_sample_hz,
            });
        }
    }
    Ok(())
}

/// Returns every `step`-th sample of a grid that ends at `last`.
fn grid(last: u32, step: u32) -> Vec<u32> {
    (0..=last)
        .rev()
        .step_by(step as usize)
        .collect::<Vec<_>>()
        .into_iter()
        .rev()
        .collect()
}

/// Tests whether a duration is enough.
fn holds(request: &Request, samples: u32, step: u32, points: &mut Points) -> Result<Refined, OptimalError> {
    points.prune();
    refine(request, &grid(samples, step), points, Objective::Ratio, 1.0)
}

/// The least duration.
struct Least {
    /// Amplitudes on all its samples that meet the tolerances.
    held: Vec<Tap>,
    /// Proof that one sample less is not enough.
    shorter: Option<LowerBound>,
}

fn least(request: &Request, points: &mut Points) -> Result<Least, OptimalError> {
    let longest = request.longest_samples;
    let frequencies = || request.bands.iter().map(|band| band.frequency_hz);
    let lowest_hz = frequencies().fold(f64::INFINITY, |least, [low, _]| least.min(low));
    let highest_hz = frequencies().fold(0.0f64, |most, [_, high]| most.max(high));
    let widest = (request.sample_hz / (SAMPLES_PER_PERIOD * highest_hz)).clamp(1.0, 1e6) as u32;
    let step_of = |samples: u32| (samples / COARSE).clamp(1, widest);
    // The search goes upwards from half a period of the lowest frequency, on coarse grids.
    let first = (request.sample_hz / lowest_hz / 2.0)
        .ceil()
        .clamp(1.0, f64::from(longest)) as u32;
    let (mut low, mut high) = (0, first);
    loop {
        let step = if high == longest { 1 } else { step_of(high) };
        match holds(request, high, step, points)? {
            Refined::Within(_) => break,
            Refined::Beyond(bound) if high == longest => {
                return Err(OptimalError::TooLong {
                    longest_samples: longest,
                    sample_hz: request.sample_hz,
                    ratio: bound.map_or(1.0, |bound| bound.ratio),
                });
            }
            Refined::Beyond(_) => {
                low = high;
                high = (high.saturating_mul(3).div_ceil(2)).min(longest);
            }
        }
    }
    // Then it bisects, still on coarse grids, to within a step of the grid.
    while high - low > step_of(high) {
        let middle = low + (high - low) / 2;
        match holds(request, middle, step_of(high), points)? {
            Refined::Within(_) => high = middle,
            Refined::Beyond(_) => low = middle,
        }
    }
    on_full_grid(request, high, points)
}

/// Finds the least duration on the full grid, from one that is enough: downwards until one is not, then by bisection.
fn on_full_grid(request: &Request, mut high: u32, points: &mut Points) -> Result<Least, OptimalError> {
    let (mut reach, mut held) = (1, None);
    let (mut low, mut shorter) = loop {
        let below = high.saturating_sub(reach);
        match holds(request, below, 1, points)? {
            Refined::Within(taps) => (high, held) = (below, Some(taps)),
            Refined::Beyond(bound) => break (below, bound),
        }
        reach *= 2;
    };
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        match holds(request, middle, 1, points)? {
            Refined::Within(taps) => (high, held) = (middle, Some(taps)),
            Refined::Beyond(bound) => (low, shorter) = (middle, bound),
        }
    }
    let held = match held {
        Some(taps) => taps,
        None => match holds(request, high, 1, points)? {
            Refined::Within(taps) => taps,
            Refined::Beyond(_) => {
                return Err(OptimalError::Solver {
                    samples: high,
                    status: "a duration that held on a coarse grid does not hold on the full one".into(),
                });
            }
        },
    };
    Ok(Least { held, shorter })
}
