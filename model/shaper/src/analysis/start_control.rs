//! Vibration after a rectangular start of a motion through half sums: the exact residual `R` and dynamic coefficient
//! `K`.
//!
//! A force `F_0` of height 1 and duration `T` is passed through half sums with delays `τ_k` (the cascade of
//! [`crate::design::vibrationless`]) and acts on an undamped oscillator, whose deflection is in units of its static
//! deflection:
//!
//! ```text
//! r(t) = ω ∫ F(s) sin ω(t − s) ds = Σ_j w_j (1 − cos ω(t − b_j)),  b_j ≤ t      w_j = +2^−n at t_j, −2^−n at t_j + T
//! K(ω) = max |r| / max |F|                                                       how far the load swings on the way
//! R(ω) = (amplitude of r after the end) / max |F| = 2 |sin(ωT/2)| · |P(ω)| / max |F|
//! ```
//!
//! Between two breakpoints `r = c − |Z| cos(ωt + φ)`, so its extremes are known and nothing is sampled. `K = 1`
//! together with a small `R` needs `T > Σ τ_k` ([`StartControl::check_length`]): only then does `F` reach the height
//! of the start.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::design::vibrationless::half_sum_cascade;
use crate::design::{DesignError, JointError};
use crate::impulse::Impulse;

/// A start control of height 1 behind half sums.
#[derive(Debug, Clone, PartialEq)]
pub struct StartControl {
    length_s: f64,
    delays_s: Vec<f64>,
    impulses: Vec<Impulse>,
}

/// `K`, `R` and the height that both refer to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartFigures {
    /// Dynamic coefficient: largest deflection, in units of the static deflection under the largest force.
    pub dynamic_coefficient: f64,
    /// Amplitude of the remaining vibration, in the same unit.
    pub residual: f64,
    /// Largest force, in units of the start's.
    pub force: f64,
}

impl StartControl {
    /// A start of `length_s` seconds passed through half sums with these delays.
    ///
    /// # Errors
    /// [`DesignError::NoSequence`] for a delay that is not above 0 or is beyond `f64`, and for a length that is not
    /// above 0.
    pub fn new(length_s: f64, delays_s: &[f64]) -> Result<Self, DesignError> {
        let cascade = half_sum_cascade(delays_s).map_err(|cause| DesignError::NoSequence {
            what: "half sums".into(),
            cause,
        })?;
        if !(length_s > 0.0 && length_s.is_finite()) {
            return Err(JointError::StartLength(length_s).into());
        }
        Ok(Self {
            length_s,
            delays_s: delays_s.to_vec(),
            impulses: cascade.impulses().to_vec(),
        })
    }

    /// Checks `T > Σ τ_k`, without which the published properties do not hold.
    ///
    /// # Errors
    /// [`JointError::ShortStart`] where it does not hold.
    pub fn check_length(&self) -> Result<(), JointError> {
        let filter_s: f64 = self.delays_s.iter().sum();
        if self.length_s > filter_s {
            Ok(())
        } else {
            Err(JointError::ShortStart {
                start_s: self.length_s,
                filter_s,
            })
        }
    }

    /// Times of the force's steps, with their heights, in order of time.
    fn steps(&self) -> Vec<(f64, f64)> {
        let up = self.impulses.iter().map(|i| (i.time_s, i.amplitude));
        let down = self.impulses.iter().map(|i| (i.time_s + self.length_s, -i.amplitude));
        let mut steps: Vec<(f64, f64)> = up.chain(down).collect();
        steps.sort_by(|a, b| a.0.total_cmp(&b.0));
        steps
    }

    /// `K`, `R` and the largest force for an oscillator of `omega` rad/s.
    pub fn figures(&self, omega: f64) -> StartFigures {
        let steps = self.steps();
        // A step up and a step down at one time, to rounding, cancel: what lies between them never acted.
        let least_s = 1e-12 * steps.last().map_or(0.0, |(time_s, _)| *time_s);
        let (mut force, mut most_force, mut most) = (0.0, 0.0, 0.0f64);
        let mut phasor = Complex::new(0.0, 0.0);
        for (index, (time_s, height)) in steps.iter().enumerate() {
            force += height;
            phasor += Complex::from_polar(*height, -omega * time_s);
            let Some((end_s, _)) = steps.get(index + 1) else {
                break;
            };
            if end_s - time_s > least_s {
                most_force = f64::max(most_force, force.abs());
                most = most.max(largest(force, phasor, omega, *time_s, *end_s));
            }
        }
        // After the end, r oscillates round 0.
        let after = phasor.norm();
        StartFigures {
            dynamic_coefficient: most.max(after) / most_force,
            residual: after / most_force,
            force: most_force,
        }
    }
}

/// Largest `|force − Re(phasor · e^{jωt})|` in an interval.
fn largest(force: f64, phasor: Complex<f64>, omega: f64, start_s: f64, end_s: f64) -> f64 {
    let phase = |time_s: f64| omega * time_s + phasor.arg();
    let at = |time_s: f64| (force - phasor.norm() * phase(time_s).cos()).abs();
    let ends = at(start_s).max(at(end_s));
    // It is stationary where the phase is a multiple of π: lowest at the even ones, highest at the odd ones.
    let has = |offset: f64| ((phase(start_s) - offset) / TAU).ceil() * TAU + offset <= phase(end_s);
    let low = if has(0.0) { (force - phasor.norm()).abs() } else { 0.0 };
    let high = if has(PI) { (force + phasor.norm()).abs() } else { 0.0 };
    ends.max(low).max(high)
}
