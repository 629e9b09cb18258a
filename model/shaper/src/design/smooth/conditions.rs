//! The kinds that are as their impulse shapers at the mode: `smooth_zv`, `smooth_zvd` and `smooth_ei`.

use super::moments::{moments, sines};
use super::{PIECES, integral};
use std::f64::consts::PI;

/// `θ` of `smooth_zv`, the first zero of `∫ (1 − x²) x² cos θx dx`: `θ = 0.796135240 π`.
const THETA_ZV: [f64; 2] = [0.7 * PI, 0.9 * PI];
/// Range in which `θ` of the other kinds lies.
const THETA_OTHER: [f64; 2] = [1.2 * PI, 1.27 * PI];
/// Steps of the search for a change of sign there.
const STEPS: u32 = 140;
/// Rounds of bisection, to the last bit.
const ROUNDS: u32 = 60;

/// Returns `θ` of `smooth_zv`.
pub(super) fn theta_zv() -> f64 {
    let response = |theta: f64| {
        let [_, first, second, ..] = moments(theta);
        first - second
    };
    let [low, high] = THETA_ZV;
    bisected(response, low, high)
}

/// Bisects between an argument of one sign and one of the other.
fn bisected(value: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let begins_positive = value(low) > 0.0;
    for _ in 0..ROUNDS {
        let middle = (low + high) / 2.0;
        if (value(middle) > 0.0) == begins_positive {
            low = middle
        } else {
            high = middle
        }
    }
    (low + high) / 2.0
}

/// Largest damping ratio at which `smooth_ei` has a solution.
pub(super) fn most_damping(promised: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0 - 1e-9);
    for _ in 0..24 {
        let damping: f64 = (low + high) / 2.0;
        let ratio = damping / (1.0 - damping * damping).sqrt();
        match (Conditions { promised, ratio }).solve() {
            Some(_) => low = damping,
            None => high = damping,
        }
    }
    (low * 1e4_f64).floor() / 1e4
}

/// The conditions of `smooth_zvd` and `smooth_ei` for `θ` and `c`.
pub(super) struct Conditions {
    /// Residual at the mode.
    pub(super) promised: f64,
    /// `σ/ω_d`.
    pub(super) ratio: f64,
}

impl Conditions {
    /// Returns `θ` and `c`.
    pub(super) fn solve(&self) -> Option<(f64, f64)> {
        let [from, to] = THETA_OTHER;
        let at = |step: u32| from + (to - from) * f64::from(step) / f64::from(STEPS);
        for step in 0..STEPS {
            let (low, high) = (at(step), at(step + 1));
            let (Some(before), Some(after)) = (self.slope(low), self.slope(high)) else {
                continue;
            };
            if (before > 0.0) != (after > 0.0) {
                let theta = bisected(|theta| self.slope(theta).unwrap_or(after), low, high);
                let c = self.centre(theta)?;
                return (0.0 < c && c < 1.0).then_some((theta, c));
            }
        }
        None
    }

    /// Returns the `c` at which the residual is the promised one. With `q = y² − 2cy + c²` it is a quadratic equation; its larger
    /// root has the minimum of `G` at the mode.
    fn centre(&self, theta: f64) -> Option<f64> {
        let moments = moments(theta);
        let size = |k: i32| {
            // Without a promise the integral has no effect.
            let value = |x: f64| (self.ratio * theta * (1.0 - x)).exp() * (1.0 - x * x) * x.powi(2 * k);
            if self.promised > 0.0 {
                integral(&value, -1.0, 1.0, 8 * PIECES)
            } else {
                0.0
            }
        };
        let [p0, p1, p2] = [0, 1, 2].map(|k| moments[k] - moments[k + 1] + self.promised * size(k as i32));
        let root = p1 * p1 - p2 * p0;
        (root >= 0.0).then(|| (p1 + root.sqrt()) / p0)
    }

    /// Returns `−G′` at the `c` of this `θ`.
    fn slope(&self, theta: f64) -> Option<f64> {
        let c = self.centre(theta)?;
        let sines = sines(theta, &moments(theta));
        let [s0, s1, s2] = [0, 1, 2].map(|k| sines[k] - sines[k + 1]);
        Some(s2 - 2.0 * c * s1 + c * c * s0)
    }
}
