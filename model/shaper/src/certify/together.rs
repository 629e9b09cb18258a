//! Checks the proofs of a joint design: that no lesser common duration has a common delay, and no lesser delay exists at
//! the duration.
//!
//! A shaper of at most `N` samples within the tolerances has `Re Σ ȳ_p c_p ≤ Σ |y_p| tolerance_p` for any weights `y_p`
//! (see [`check_shorter`]). So its mean delay is
//!
//! ```text
//! Σ a_i i ≥ Σ a_i (i + h_i) − Σ |y_p| tolerance_p,      h_i = Σ Re(ȳ_p z_p^(N−i))
//! ```
//!
//! and the sum on the right has a least value over all amplitudes that the command allows. With `−i` in place of `i` it
//! is an upper bound. If the lower bound of one axis, with its lag, is above the upper bound of another, then no shapers
//! of at most `N` samples have one delay.

use super::shorter::Gains;
use super::{CheckedBound, ShorterError, UNIT, check_shorter};
use posicast_optimal::{DelayBound, Partner, Request, Shorter, Together};

/// The proofs of a joint design, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedTogether {
    /// That no lesser common duration is possible.
    pub shorter: Option<Result<CheckedShorter, ShorterError>>,
    /// Lower bound of the common delay at this duration in samples, lags included.
    pub least_delay_samples: Option<Result<f64, ShorterError>>,
}

/// Why no lesser common duration is possible, checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CheckedShorter {
    /// One axis alone has no shorter shaper.
    Alone {
        /// Index of the axis.
        axis: usize,
        /// The bound of its residual.
        bound: CheckedBound,
    },
    /// Two axes have no common delay.
    Apart {
        /// Duration in samples of the shapers that it is about.
        samples: u32,
        /// Index of the axis that is always later.
        late_axis: usize,
        /// Index of the axis that is always earlier.
        early_axis: usize,
        /// Smallest difference of the two delays, in samples.
        gap_samples: f64,
    },
}

/// Checks a lower or an upper bound of the mean delay of every shaper that meets a request; returns it in samples, with
/// the rounding of its own arithmetic.
///
/// # Errors
/// [`ShorterError::Point`] for a point outside the bands.
pub fn check_delay(request: &Request, bound: &DelayBound) -> Result<f64, ShorterError> {
    let mut gains = Gains::of(request, bound.samples, &bound.points)?;
    let sign = if bound.is_upper { -1.0 } else { 1.0 };
    for ((gain, error), sample) in gains.values.iter_mut().zip(0u32..) {
        let delay = f64::from(sample);
        *gain += sign * delay;
        *error += 4.0 * UNIT * (gain.abs() + delay);
    }
    let least = gains.least(request.command);
    let rounding = 8.0 * UNIT * (least.abs() + gains.norm);
    Ok(sign * (least - gains.norm - rounding))
}

/// Checks the proofs of a joint design of these axes.
pub fn check_together(partners: &[Partner], found: &Together) -> CheckedTogether {
    let delay = |axis: usize, bound: &DelayBound| {
        let partner = partners.get(axis).ok_or(ShorterError::Point { index: 0 })?;
        Ok(check_delay(&partner.request, bound)? + partner.lag_samples)
    };
    let shorter = |proof: &Shorter| match proof {
        Shorter::Alone { axis, proof } => {
            let partner = partners.get(*axis).ok_or(ShorterError::Point { index: 0 })?;
            let bound = check_shorter(&partner.request, proof)?;
            Ok(CheckedShorter::Alone { axis: *axis, bound })
        }
        Shorter::Apart {
            late_axis,
            earliest,
            early_axis,
            latest,
        } => {
            let samples = earliest.samples.min(latest.samples);
            let gap_samples = delay(*late_axis, earliest)? - delay(*early_axis, latest)?;
            if gap_samples > 0.0 && !earliest.is_upper && latest.is_upper {
                Ok(CheckedShorter::Apart {
                    samples,
                    late_axis: *late_axis,
                    early_axis: *early_axis,
                    gap_samples,
                })
            } else {
                Err(ShorterError::Loose { samples, ratio: 0.0 })
            }
        }
    };
    let earlier = found
        .earlier
        .as_ref()
        .filter(|bound| !bound.is_upper && bound.samples >= found.samples);
    CheckedTogether {
        shorter: found.shorter.as_ref().map(shorter),
        least_delay_samples: earlier.map(|bound| delay(found.latest_axis, bound)),
    }
}
