//! Impulse sequences: shapers in continuous time, before they are digitised.
//!
//! ```text
//! u(t) = Σ A_i · r(t − t_i)        t_1 = 0,   t_i strictly increasing,   Σ A_i = 1
//! ```
//!
//! Times are in seconds. Because the amplitudes sum to one, a constant command passes a shaper unchanged.
//!
//! ```
//! use posicast_shaper::impulse::{Impulse, ImpulseSequence};
//!
//! let half = |time_s| Impulse { time_s, amplitude: 0.5 };
//! let zv = ImpulseSequence::new(vec![half(0.0), half(0.005)]).unwrap();
//! assert_eq!(zv.delay_s(), 0.0025);
//! ```

use thiserror::Error;

/// Largest deviation of `Σ A_i` from one, which allows for a machine file with decimals of ten digits.
pub const SUM_TOLERANCE: f64 = 1e-9;

/// Impulses of a convolution this close, relative to its duration, are merged. Sums of a few times that are equal in
/// exact arithmetic differ by some units of the last place, and no design places two impulses that close on purpose.
const COINCIDENT: f64 = 64.0 * f64::EPSILON;

/// One impulse of a shaper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impulse {
    /// Time after the first impulse, in seconds.
    pub time_s: f64,
    /// Amplitude; the amplitudes of a sequence sum to one.
    pub amplitude: f64,
}

/// A shaper in continuous time: impulses in order of time, the first at 0, whose amplitudes sum to one.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpulseSequence {
    impulses: Vec<Impulse>,
}

/// Why a list of impulses is not a shaper. Positions in the list count from 1.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ImpulseError {
    /// The list is empty.
    #[error("no impulses: a shaper has at least one, [[0.0, 1.0]] changes nothing")]
    Empty,
    /// A time or an amplitude is NaN or infinite.
    #[error("impulse {position}: time {time_s} s, amplitude {amplitude}; both must be finite numbers")]
    NotFinite {
        /// Position in the list, from 1.
        position: usize,
        /// Its time in s.
        time_s: f64,
        /// Its amplitude.
        amplitude: f64,
    },
    /// The first impulse is not at time 0.
    #[error("the first impulse is at {0} s: it must be at 0; subtract {0} s from every time")]
    FirstTime(f64),
    /// The times do not strictly increase.
    #[error("impulse {position} is at {time_s} s, not after the one before it at {before_s} s: times must increase")]
    Order {
        /// Position in the list, from 1.
        position: usize,
        /// Its time in s.
        time_s: f64,
        /// Time of the impulse before it, in s.
        before_s: f64,
    },
    /// The amplitudes do not sum to one.
    #[error("the amplitudes sum to {0}: they must sum to 1 within {SUM_TOLERANCE:e}; divide each by {0}")]
    Sum(f64),
}

impl ImpulseSequence {
    /// Takes impulses that already form a shaper.
    ///
    /// # Errors
    /// [`ImpulseError`] names the rule that the list breaks, and the impulse.
    pub fn new(impulses: Vec<Impulse>) -> Result<Self, ImpulseError> {
        let first = impulses.first().ok_or(ImpulseError::Empty)?;
        for (index, impulse) in impulses.iter().enumerate() {
            if !(impulse.time_s.is_finite() && impulse.amplitude.is_finite()) {
                return Err(ImpulseError::NotFinite {
                    position: index + 1,
                    time_s: impulse.time_s,
                    amplitude: impulse.amplitude,
                });
            }
        }
        if first.time_s != 0.0 {
            return Err(ImpulseError::FirstTime(first.time_s));
        }
        for (index, pair) in impulses.windows(2).enumerate() {
            if pair[1].time_s <= pair[0].time_s {
                return Err(ImpulseError::Order {
                    position: index + 2,
                    time_s: pair[1].time_s,
                    before_s: pair[0].time_s,
                });
            }
        }
        let sum: f64 = impulses.iter().map(|i| i.amplitude).sum();
        let deviation = (sum - 1.0).abs();
        if deviation.is_nan() || deviation > SUM_TOLERANCE {
            return Err(ImpulseError::Sum(sum));
        }
        Ok(Self { impulses })
    }

    /// The shaper that changes nothing: one impulse of amplitude 1 at time 0.
    pub fn unity() -> Self {
        Self {
            impulses: vec![Impulse {
                time_s: 0.0,
                amplitude: 1.0,
            }],
        }
    }

    /// The impulses, in order of time.
    pub fn impulses(&self) -> &[Impulse] {
        &self.impulses
    }

    /// Convolves two shapers: every product of two amplitudes, at the sum of their times.
    ///
    /// The pole sums multiply, so a zero of either stays a zero. Products whose times are equal to rounding are
    /// merged.
    ///
    /// # Errors
    /// [`ImpulseError`] where times or amplitudes leave the range of `f64`.
    pub fn convolve(&self, other: &Self) -> Result<Self, ImpulseError> {
        let mut products: Vec<Impulse> = self
            .impulses
            .iter()
            .flat_map(|a| {
                other.impulses.iter().map(|b| Impulse {
                    time_s: a.time_s + b.time_s,
                    amplitude: a.amplitude * b.amplitude,
                })
            })
            .collect();
        products.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        let coincident_s = COINCIDENT * (self.duration_s() + other.duration_s());
        let mut merged: Vec<Impulse> = Vec::with_capacity(products.len());
        for product in products {
            match merged.last_mut() {
                Some(last) if product.time_s - last.time_s <= coincident_s => last.amplitude += product.amplitude,
                _ => merged.push(product),
            }
        }
        Self::new(merged)
    }

    /// Duration: time of the last impulse, in seconds.
    pub fn duration_s(&self) -> f64 {
        self.impulses.last().map_or(0.0, |i| i.time_s)
    }

    /// Delay `Σ A_i t_i` in seconds, by which the shaped command lags a ramp.
    pub fn delay_s(&self) -> f64 {
        self.impulses.iter().map(|i| i.amplitude * i.time_s).sum()
    }

    /// Smallest and largest of the partial sums `A_1 + … + A_k`: the range of the shaped unit step.
    pub fn partial_sums(&self) -> PartialSums {
        let mut sum = 0.0;
        let mut range = PartialSums {
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
        };
        for impulse in &self.impulses {
            sum += impulse.amplitude;
            range.min = range.min.min(sum);
            range.max = range.max.max(sum);
        }
        range
    }
}

/// Range of a shaped unit step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartialSums {
    /// Smallest partial sum; below 0 a shaped step first moves the wrong way.
    pub min: f64,
    /// Largest partial sum; above 1 a shaped step asks for more than the step.
    pub max: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sequence(pairs: &[(f64, f64)]) -> Result<ImpulseSequence, ImpulseError> {
        ImpulseSequence::new(
            pairs
                .iter()
                .map(|&(time_s, amplitude)| Impulse { time_s, amplitude })
                .collect(),
        )
    }

    #[test]
    fn each_broken_rule_has_its_error() {
        assert_eq!(sequence(&[]), Err(ImpulseError::Empty));
        assert_eq!(sequence(&[(0.1, 1.0)]), Err(ImpulseError::FirstTime(0.1)));
        assert_eq!(sequence(&[(0.0, 0.9), (1.0, 0.2)]), Err(ImpulseError::Sum(1.1)));
        assert!(matches!(
            sequence(&[(0.0, 0.5), (1.0, 0.25), (1.0, 0.25)]),
            Err(ImpulseError::Order { position: 3, .. })
        ));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(matches!(
                sequence(&[(0.0, 0.5), (bad, 0.5)]),
                Err(ImpulseError::NotFinite { position: 2, .. })
            ));
            assert!(matches!(
                sequence(&[(0.0, bad)]),
                Err(ImpulseError::NotFinite { position: 1, .. })
            ));
        }
        let huge = sequence(&[(0.0, f64::MAX), (1.0, f64::MAX)]);
        assert_eq!(huge, Err(ImpulseError::Sum(f64::INFINITY)));
    }

    #[test]
    fn convolution_sorts_and_merges_coincident_times() {
        let third = 1.0 / 3.0;
        let a = sequence(&[(0.0, 0.5), (third, 0.5)]).unwrap();
        let b = sequence(&[(0.0, 0.5), (2.0 * third, 0.25), (1.0, 0.25)]).unwrap();
        let both = a.convolve(&b).unwrap();
        // 1/3 + 2/3 and 1 are the same time, though not to the last bit in every order of addition.
        let amplitudes: Vec<f64> = both.impulses().iter().map(|i| i.amplitude).collect();
        assert_eq!(amplitudes, [0.25, 0.25, 0.125, 0.25, 0.125]);
        assert!(both.impulses().windows(2).all(|p| p[0].time_s < p[1].time_s));
    }

    #[test]
    fn figures_of_a_sequence() {
        let ps = sequence(&[(0.0, 1.0), (0.2, -2.0), (0.3, 2.0)]).unwrap();
        assert_eq!(ps.partial_sums(), PartialSums { min: -1.0, max: 1.0 });
        assert_eq!(ps.duration_s(), 0.3);
        assert!((ps.delay_s() - 0.2).abs() < 1e-15);
        assert_eq!(ImpulseSequence::unity().delay_s(), 0.0);
    }
}
