//! Checks the proof that no shorter shaper exists.
//!
//! Let a shaper of the samples `0…N` leave `c_p = Σ a_i z_p^(N−i)` at a point `p` of a band, with `z_p = e^(−p)`. For
//! any weights `y_p`
//!
//! ```text
//! Σ Re(ȳ_p c_p) ≤ Σ |y_p| |c_p| ≤ Σ |y_p| tolerance_p · max |c_p|/tolerance_p
//! ```
//!
//! and the left side is `Σ a_i h_i` with `h_i = Σ Re(ȳ_p z_p^(N−i))`. Amplitudes of sum 1 that are not negative have `Σ
//! a_i h_i ≥ min h_i`. With partial sums `s_i` of which the last is 1, `Σ a_i h_i = h_N + Σ s_i (h_i − h_{i+1})`, and
//! each term is least at a bound of `s_i`. With amplitudes within bounds and any `μ`, `Σ a_i h_i = μ + Σ a_i (h_i − μ)`,
//! and each term is least at a bound of `a_i`; the best `μ` is one of the `h_i`. So the least left side over all allowed commands, divided by `Σ |y_p|
//! tolerance_p`, is a lower bound of the largest ratio of residual to tolerance. A bound above 1 proves that every
//! shaper of `N` samples breaks a tolerance. So does every shorter one, since it is a shaper of `N` samples whose last
//! amplitudes are 0, and vibration only decays.
//!
//! This is Farkas' lemma. The weights come from the solver's dual solution, but the proof holds for weights of any origin.

use super::{UNIT, exponential_error};
use crate::mode::Mode;
use posicast_optimal::{Command, LowerBound, Request, WeightedPoint};

/// A bound that was checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckedBound {
    /// Duration, in samples, of the shapers that the bound holds for.
    pub samples: u32,
    /// Smallest ratio of residual to tolerance that each of them leaves somewhere in a band.
    pub ratio: f64,
    /// Points of the bands that prove it.
    pub points: usize,
}

/// Reason why weights are not a proof.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ShorterError {
    /// A point is outside all bands, or its weight is not a number.
    #[error("point {} of the proof is not in a band of the modes, or its weight is not a number", index + 1)]
    Point {
        /// Index of the point.
        index: usize,
    },
    /// The bound excludes no shaper.
    #[error(
        "the proof bounds the residual of every shaper of {samples} samples only to at least {ratio:.9} of a tolerance, which rules out no shaper"
    )]
    Loose {
        /// Duration.
        samples: u32,
        /// The bound.
        ratio: f64,
    },
}

/// Checks that no shaper of `proof.samples` samples or fewer meets `request`.
///
/// # Errors
/// [`ShorterError`].
pub fn check_shorter(request: &Request, proof: &LowerBound) -> Result<CheckedBound, ShorterError> {
    if let (Command::Amplitudes { high, .. }, true) = (request.command, proof.points.is_empty()) {
        return too_few(high, proof.samples);
    }
    let gains = Gains::of(request, proof.samples, &proof.points)?;
    let ratio = gains.least(request.command) / gains.norm * (1.0 - 8.0 * UNIT);
    if ratio > 1.0 {
        Ok(CheckedBound {
            samples: proof.samples,
            ratio,
            points: proof.points.len(),
        })
    } else {
        Err(ShorterError::Loose {
            samples: proof.samples,
            ratio,
        })
    }
}

/// Checks that amplitudes of at most `high` on the samples of a duration do not sum to 1.
fn too_few(high: f64, samples: u32) -> Result<CheckedBound, ShorterError> {
    let most = (f64::from(samples) + 1.0) * high * (1.0 + 4.0 * UNIT);
    if most < 1.0 {
        Ok(CheckedBound {
            samples,
            ratio: f64::INFINITY,
            points: 0,
        })
    } else {
        Err(ShorterError::Loose { samples, ratio: 0.0 })
    }
}

/// `h_i` with a bound of its error, and `Σ |y_p| tolerance_p`, rounded up.
pub(super) struct Gains {
    pub(super) values: Vec<(f64, f64)>,
    pub(super) norm: f64,
}

impl Gains {
    pub(super) fn of(request: &Request, samples: u32, points: &[WeightedPoint]) -> Result<Self, ShorterError> {
        let mut values = vec![(0.0, 0.0); samples as usize + 1];
        let mut norm = 0.0;
        // Each sum below rounds once per point.
        let adding = 4.0 * (points.len() as f64 + 1.0) * UNIT;
        for (index, point) in points.iter().enumerate() {
            let [re, im] = point.weight;
            let within = |value: f64, [low, high]: [f64; 2]| low <= value && value <= high;
            let band = request
                .bands
                .get(point.band)
                .filter(|band| within(point.frequency_hz, band.frequency_hz) && within(point.damping, band.damping));
            let Some(band) = band.filter(|_| re.is_finite() && im.is_finite()) else {
                return Err(ShorterError::Point { index });
            };
            let size = re.hypot(im) * (1.0 + 4.0 * UNIT);
            norm += size * band.tolerance;
            let mode = Mode {
                frequency_hz: point.frequency_hz,
                damping: point.damping,
            };
            let (decay, turn) = (
                mode.decay() / request.sample_hz,
                mode.omega_damped() / request.sample_hz,
            );
            let radius = mode.omega() / request.sample_hz;
            for (sample, (gain, error)) in (0..=samples).rev().zip(values.iter_mut()) {
                let remaining = f64::from(sample);
                let (sin, cos) = (turn * remaining).sin_cos();
                *gain += (-decay * remaining).exp() * (re * cos - im * sin);
                *error += size * (exponential_error(radius * remaining) + adding);
            }
        }
        norm *= 1.0 + adding;
        Ok(Self { values, norm })
    }

    /// Least `Σ a_i h_i` of all amplitudes that a command allows.
    pub(super) fn least(&self, command: Command) -> f64 {
        match command {
            Command::Positive => {
                let gains = self.values.iter().map(|(gain, error)| gain - error);
                gains.fold(f64::INFINITY, f64::min)
            }
            Command::PartialSums { low, high } => self.least_over_sums(low, high),
            Command::Amplitudes { low, high } => self.least_over_amplitudes(low, high),
        }
    }

    /// Least `h_N + Σ s_i (h_i − h_{i+1})` with every `s_i` within the bounds.
    fn least_over_sums(&self, low: f64, high: f64) -> f64 {
        let (mut least, mut size) = (0.0, 0.0);
        for pair in self.values.windows(2) {
            let [(gain, error), (next, next_error)] = [pair[0], pair[1]];
            let (step, spread) = (gain - next, (error + next_error) * (1.0 + 4.0 * UNIT));
            let terms = [low, high].map(|bound| bound * step - bound.abs() * spread);
            let term = terms[0].min(terms[1]);
            least += term;
            size += term.abs() + bound_size(low, high) * step.abs();
        }
        let last = self.values.last().map_or(0.0, |(gain, error)| gain - error);
        let rounding = 4.0 * (self.values.len() as f64 + 1.0) * UNIT * (size + last.abs());
        least + last - rounding
    }

    /// Least `Σ a_i h_i` with every `a_i` within the bounds, and the sum 1: `μ + Σ min(low (h_i − μ), high (h_i − μ))` at
    /// the `μ` where it is largest, which is the `h_i` up to which the samples at `high` are enough.
    fn least_over_amplitudes(&self, low: f64, high: f64) -> f64 {
        let mut order: Vec<f64> = self.values.iter().map(|(gain, _)| *gain).collect();
        order.sort_by(f64::total_cmp);
        let count = order.len() as f64;
        let enough = ((1.0 - low * count) / (high - low)).floor().clamp(0.0, count - 1.0);
        let Some(&level) = order.get(enough as usize) else {
            return f64::NEG_INFINITY;
        };
        let (mut least, mut size) = (level, level.abs());
        for (gain, error) in &self.values {
            let step = gain - level;
            let terms = [low, high].map(|bound| bound * step - bound.abs() * error * (1.0 + 4.0 * UNIT));
            least += terms[0].min(terms[1]);
            size += bound_size(low, high) * (step.abs() + error);
        }
        least - 4.0 * (count + 1.0) * UNIT * size
    }
}

fn bound_size(low: f64, high: f64) -> f64 {
    low.abs().max(high.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_optimal::{Band, Prefer};

    /// One undamped mode of 4 samples per period, exactly known, amplitudes not negative.
    fn request(tolerance: f64) -> Request {
        Request {
            sample_hz: 4.0,
            bands: vec![Band {
                frequency_hz: [1.0; 2],
                damping: [0.0; 2],
                tolerance,
            }],
            command: Command::Positive,
            prefer: Prefer::default(),
            most_taps: 256,
            longest_samples: 100,
            delay_samples: None,
        }
    }

    fn proof(samples: u32, frequency_hz: f64) -> LowerBound {
        LowerBound {
            samples,
            points: vec![WeightedPoint {
                band: 0,
                frequency_hz,
                damping: 0.0,
                // Along the bisector of 1 and e^(−jπ/2).
                weight: [0.5f64.sqrt(), -(0.5f64.sqrt())],
            }],
            ratio: 9.9,
        }
    }

    #[test]
    fn two_samples_leave_the_side_of_a_square() {
        // Amplitudes a and 1 − a at a quarter of a period: |a + j(1 − a)| ≥ 1/√2.
        let found = check_shorter(&request(0.05), &proof(1, 1.0)).unwrap();
        let exact = 0.5f64.sqrt() / 0.05;
        assert!(
            found.ratio <= exact && found.ratio > exact * (1.0 - 1e-13),
            "{found:?} {exact}"
        );
        // Half a period is enough for zv, so the same weights must not prove the opposite.
        let loose = check_shorter(&request(0.05), &proof(2, 1.0)).unwrap_err();
        assert!(matches!(loose, ShorterError::Loose { samples: 2, .. }), "{loose}");
        assert!(check_shorter(&request(0.71), &proof(1, 1.0)).is_err());
    }

    #[test]
    fn a_point_beside_the_band_is_no_proof() {
        let error = check_shorter(&request(0.05), &proof(1, 1.0 + 1e-12)).unwrap_err();
        assert_eq!(error, ShorterError::Point { index: 0 });
        let mut no_band = proof(1, 1.0);
        no_band.points[0].band = 1;
        assert!(check_shorter(&request(0.05), &no_band).is_err());
    }

    #[test]
    fn bounded_amplitudes_leave_what_their_bound_makes_them() {
        let bounded = |high: f64, tolerance| Request {
            command: Command::Amplitudes { low: -high, high },
            ..request(tolerance)
        };
        // Two amplitudes of at most ½ are both ½, as those that leave least are without a bound.
        let exact = 0.5f64.sqrt() / 0.05;
        for high in [0.5, 0.8] {
            let found = check_shorter(&bounded(high, 0.05), &proof(1, 1.0)).unwrap();
            assert!((found.ratio - exact).abs() < 1e-11, "{found:?}");
        }
        // Of three at 0, 90 and 180°, (a, 1 − 2a, a) leaves 1 − 2a: with a ≤ 0.4 that is 0.2.
        let third = LowerBound {
            samples: 2,
            points: vec![WeightedPoint {
                band: 0,
                frequency_hz: 1.0,
                damping: 0.0,
                weight: [0.0, -1.0],
            }],
            ratio: 9.9,
        };
        let found = check_shorter(&bounded(0.4, 0.05), &third).unwrap();
        assert!((found.ratio - 0.2 / 0.05).abs() < 1e-11, "{found:?}");
        assert!(check_shorter(&bounded(0.5, 0.05), &third).is_err());
        assert!(check_shorter(&bounded(0.4, 0.21), &third).is_err());
    }

    #[test]
    fn too_few_bounded_amplitudes_do_not_sum_to_one() {
        let bounded = Request {
            command: Command::Amplitudes { low: 0.0, high: 0.1 },
            ..request(0.05)
        };
        let of = |samples| LowerBound {
            samples,
            points: Vec::new(),
            ratio: f64::INFINITY,
        };
        assert_eq!(check_shorter(&bounded, &of(8)).unwrap().points, 0);
        assert!(check_shorter(&bounded, &of(9)).is_err());
        assert!(
            check_shorter(&request(0.05), &of(1)).is_err(),
            "without points and without a bound"
        );
    }

    #[test]
    fn sums_between_bounds_reach_less() {
        // s_0 within −1 … 1, s_1 = 1: |s_0 + (1 − s_0)(−j)·…| is least at s_0 = ½, as without negative ones.
        let signed = Request {
            command: Command::PartialSums { low: -1.0, high: 1.0 },
            ..request(0.05)
        };
        let found = check_shorter(&signed, &proof(1, 1.0)).unwrap();
        let exact = 0.5f64.sqrt() / 0.05;
        assert!((found.ratio - exact).abs() < 1e-11, "{found:?}");
    }
}
