//! Chooses among the sweep descriptions that fit a log.
//!
//! If a sweep begins or ends otherwise than described, its first or last pulses are missing or too many, and the transfer function has
//! ripples beside that end, which no mode explains. So descriptions are compared by the residual of the modes there.

use super::follow::{Followed, Known};
use super::transfer::Band;
use super::{FoundInSweep, Sweep, SweepError};
use crate::parallel::both;

/// Smallest width in Hz of the parts of a band that are compared, and number of points in each.
const PART_HZ: f64 = 1.0;
const PART_POINTS: f64 = 20.0;
/// Width of the range that is compared beside the end in which two descriptions differ: in Hz, and over the band that a sweep passes while
/// it shakes a frequency (`√rate`).
const BESIDE_HZ: f64 = 6.0;
const BESIDE: f64 = 6.0;
/// The second description, which is the less usual one, counts as likelier above this sum of the logarithms of the ratios of their
/// residuals in each part. By chance, the logarithm of a part differs by 0.3.
const LIKELIER: f64 = 2.5;
/// The same for an earlier end beside a square wave: the motion after that end is then unknown, and so cannot contradict it.
const LIKELIER_EARLIER: f64 = 10.0;

/// Returns the likeliest of the earlier result and the results of some descriptions, the more usual ones first. `described` gets the
/// likeliest so far, if there is one.
pub(super) fn likelier(
    before: Option<Followed>,
    sweeps: &[Sweep],
    described: impl Fn(&Sweep, Option<Known<'_>>) -> Result<Followed, SweepError> + Sync,
) -> Option<Followed> {
    let (mut best, mut rest, mut is_first) = (before, sweeps, true);
    while let [sweep, others @ ..] = rest {
        let known = best.as_ref().map(Followed::known);
        // The first one has both threads for its own fit.
        let beside = others.first().filter(|_| known.is_some());
        let (second, first) = both(
            || beside.map(|sweep| described(sweep, known)),
            || described(sweep, known),
        );
        // The other descriptions rise in the same way, and would explain as little.
        if is_first && matches!(first, Err(SweepError::Unrelated(_))) {
            return best;
        }
        (rest, is_first) = (&others[usize::from(beside.is_some())..], false);
        for followed in [Some(first), second].into_iter().flatten().flatten() {
            best = match best {
                Some(best) if gain(&best.found, &followed.found) < least_gain(&best.found, &followed.found) => {
                    Some(best)
                }
                _ => Some(followed),
            };
        }
    }
    best
}

fn least_gain(first: &FoundInSweep, second: &FoundInSweep) -> f64 {
    if second.wave.is_some() && second.sweep.end_hz < first.sweep.end_hz {
        LIKELIER_EARLIER
    } else {
        LIKELIER
    }
}

/// Returns by how much the second residual is smaller than the first: the sum of the logarithms of the ratios, over parts of the band.
fn gain(first: &FoundInSweep, second: &FoundInSweep) -> f64 {
    let mut common = Band {
        low_hz: first.covered.low_hz.max(second.covered.low_hz),
        high_hz: first.covered.high_hz.min(second.covered.high_hz),
    };
    let beside_hz = BESIDE_HZ.max(BESIDE * first.sweep.rate_hz_per_s.sqrt());
    let (one, other) = (&first.sweep, &second.sweep);
    if one.rate_hz_per_s == other.rate_hz_per_s && one.start_hz == other.start_hz {
        common.low_hz = common.low_hz.max(common.high_hz - beside_hz);
    } else if one.rate_hz_per_s == other.rate_hz_per_s && one.end_hz == other.end_hz {
        common.high_hz = common.high_hz.min(common.low_hz + beside_hz);
    }
    let width_hz = common.high_hz - common.low_hz;
    if width_hz <= 0.0 {
        return 0.0;
    }
    let points = first.transfer.points.len().max(second.transfer.points.len()).max(1);
    let part_hz = PART_HZ.max(PART_POINTS * width_hz / points as f64);
    let parts = ((width_hz / part_hz) as usize).max(1);
    let (first, second) = (left(first, &common, parts), left(second, &common, parts));
    let ratios = first.iter().zip(&second).filter(|(a, b)| **a > 0.0 && **b > 0.0);
    ratios.map(|(a, b)| (a / b).ln()).sum()
}

/// Mean square of the residual that the modes leave of a transfer function, in equal parts of a band.
fn left(found: &FoundInSweep, band: &Band, parts: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0usize); parts];
    for (point, fitted) in found.transfer.points.iter().zip(&found.fitted) {
        let part = (point.frequency_hz - band.low_hz) / (band.high_hz - band.low_hz) * parts as f64;
        if let Some((sum, count)) = sums.get_mut(part.floor() as usize).filter(|_| part >= 0.0) {
            *sum += (point.value - fitted).norm_sqr();
            *count += 1;
        }
    }
    sums.iter().map(|(sum, count)| sum / (*count).max(1) as f64).collect()
}
