//! Insensitivity: by how much a mode's frequency may differ from the modelled one.
//!
//! It is the connected interval of `r = f/f_0` round 1 on which `V(r) ≤ tolerance · (1 + 1e-6)`, for the impulses of
//! the whole axis, with the damping and the other modes fixed. The factor lets the humps of an EI shaper, which touch
//! the tolerance, count as inside.
//!
//! A fixed grid would step over a narrow crossing, or take minutes to avoid that. So each step is chosen such that it
//! *cannot* cross: with `P = V²` and `|P''| ≤ M` on the next stretch,
//!
//! ```text
//! P(r + s) ≤ P(r) + P'(r)·s + M·s²/2        step to the s at which this bound meets the limit
//! ```
//!
//! which is Newton's method from the safe side: it converges to a crossing quadratically and never passes one. The
//! bound comes from the sequence itself: with `q_i = σ(t_i − t_n) + jω_d(t_i − t_n/2)` and `B_k = Σ |A_i| |q_i|^k`,
//! `M = 2(B_0 B_2 + B_1²)` (decay factors included). Shifting `t_i` by `t_n/2` changes nothing but the phase of the
//! sum.

use nalgebra::Complex;

use super::residual::last_time_s;
use crate::impulse::Impulse;
use crate::mode::Mode;

/// Frequency ratio up to which the upper end is searched.
pub const INSENSITIVITY_LIMIT: f64 = 10.0;

/// Longest step in `r`; the decay that tightens `M` is valid over it.
const LONGEST_STEP: f64 = 0.05;
/// Step in `r` below which the crossing counts as found.
const RESOLUTION: f64 = 1e-13;
/// Number of evaluations of one impulse after which a side ends where the tolerance is proven to hold: about a
/// second.
const BUDGET: usize = 10_000_000;

/// Interval of `f/f_0` round 1 on which the residual stays within the tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Insensitivity {
    /// Lower end, a frequency ratio in [0, 1].
    pub low: f64,
    /// Upper end, a frequency ratio; `None` if still within the tolerance at [`INSENSITIVITY_LIMIT`].
    pub high: Option<f64>,
}

/// Insensitivity of `impulses` at `mode` for `tolerance`; `None` if the residual at the mode itself exceeds it.
///
/// Where a sequence is so long against the mode's period that the search would take more than a second or so, an end
/// is the ratio up to which the tolerance is proven to hold: the interval is never too wide, at worst too narrow.
pub fn insensitivity(impulses: &[Impulse], mode: &Mode, tolerance: f64) -> Option<Insensitivity> {
    let search = Search::new(impulses, mode, tolerance * (1.0 + 1e-6));
    if search.is_inside(1.0) {
        let high = search.walk(1.0, INSENSITIVITY_LIMIT);
        Some(Insensitivity {
            low: search.walk(1.0, 0.0),
            high: (high < INSENSITIVITY_LIMIT).then_some(high),
        })
    } else {
        None
    }
}

/// One impulse with its exponent per unit of `r`.
struct Term {
    amplitude: f64,
    exponent: Complex<f64>,
}

struct Search {
    terms: Vec<Term>,
    limit_squared: f64,
}

impl Search {
    fn new(impulses: &[Impulse], mode: &Mode, limit: f64) -> Self {
        let end_s = last_time_s(impulses);
        let (decay, omega_damped) = (mode.decay(), mode.omega_damped());
        let terms = impulses.iter().filter(|i| i.amplitude != 0.0).map(|i| Term {
            amplitude: i.amplitude,
            exponent: Complex::new(
                decay * (i.time_s - end_s).min(0.0),
                omega_damped * (i.time_s - end_s / 2.0),
            ),
        });
        Self {
            terms: terms.collect(),
            limit_squared: limit * limit,
        }
    }

    /// `V²` and its derivative at `r`.
    fn power(&self, ratio: f64) -> (f64, f64) {
        let mut sum = Complex::new(0.0, 0.0);
        let mut derivative = Complex::new(0.0, 0.0);
        for term in &self.terms {
            let value = (term.exponent * ratio).exp() * term.amplitude;
            sum += value;
            derivative += value * term.exponent;
        }
        (sum.norm_sqr(), 2.0 * (sum.conj() * derivative).re)
    }

    fn is_inside(&self, ratio: f64) -> bool {
        self.power(ratio).0 <= self.limit_squared
    }

    /// Bound of `|P''|` at every ratio from `lowest` on; the decay factors only fall with `r`.
    fn curvature(&self, lowest: f64) -> f64 {
        let mut moments = [0.0; 3];
        for term in &self.terms {
            let size = term.amplitude.abs() * (term.exponent.re * lowest).exp();
            let rate = term.exponent.norm();
            moments[0] += size;
            moments[1] += size * rate;
            moments[2] += size * rate * rate;
        }
        2.0 * (moments[0] * moments[2] + moments[1] * moments[1])
    }

    /// Walks from a ratio inside towards `end`; returns the last ratio up to which the tolerance is met, or `end`.
    fn walk(&self, start: f64, end: f64) -> f64 {
        let direction = if end < start { -1.0 } else { 1.0 };
        let mut ratio = start;
        for _ in 0..BUDGET / self.terms.len().max(1) {
            let (power, slope) = self.power(ratio);
            let gap = self.limit_squared - power;
            let lowest = if direction < 0.0 {
                (ratio - LONGEST_STEP).max(0.0)
            } else {
                ratio
            };
            let step = safe_step(gap, slope * direction, self.curvature(lowest)).min(LONGEST_STEP);
            if step.is_nan() || step <= RESOLUTION {
                return ratio;
            }
            if step >= (end - ratio).abs() {
                return end;
            }
            ratio += direction * step;
        }
        ratio
    }
}

/// The `s ≥ 0` at which `slope·s + curvature·s²/2` reaches `gap`, in a form without cancellation.
fn safe_step(gap: f64, slope: f64, curvature: f64) -> f64 {
    if gap <= 0.0 {
        return 0.0;
    }
    let root = (slope * slope + 2.0 * curvature * gap).sqrt();
    if slope > 0.0 {
        2.0 * gap / (slope + root)
    } else if curvature > 0.0 {
        (root - slope) / curvature
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::residual_vibration;
    use std::f64::consts::PI;

    const ONE_HZ: Mode = Mode {
        frequency_hz: 1.0,
        damping: 0.0,
    };

    fn impulses(pairs: &[(f64, f64)]) -> Vec<Impulse> {
        pairs
            .iter()
            .map(|&(time_s, amplitude)| Impulse { time_s, amplitude })
            .collect()
    }

    #[test]
    fn zv_has_the_closed_form_interval() {
        let zv = impulses(&[(0.0, 0.5), (0.5, 0.5)]);
        let found = insensitivity(&zv, &ONE_HZ, 0.05).unwrap();
        // V = |cos(πr/2)|
        let half_width = 2.0 / PI * (0.05f64 * (1.0 + 1e-6)).asin();
        assert!((found.low - (1.0 - half_width)).abs() < 1e-12);
        assert!((found.high.unwrap() - (1.0 + half_width)).abs() < 1e-12);
    }

    #[test]
    fn the_hump_of_an_ei_counts_as_inside() {
        let ei = impulses(&[(0.0, 0.2625), (0.5, 0.475), (1.0, 0.2625)]);
        let found = insensitivity(&ei, &ONE_HZ, 0.05).unwrap();
        assert!(found.low < 0.81 && found.high.unwrap() > 1.19, "{found:?}");
    }

    #[test]
    fn no_interval_above_the_tolerance_and_open_ends_below_it() {
        assert_eq!(insensitivity(&impulses(&[(0.0, 1.0)]), &ONE_HZ, 0.05), None);
        // The tolerance is above every residual, so both sides are open.
        let zv = impulses(&[(0.0, 0.5), (0.5, 0.5)]);
        let open = insensitivity(&zv, &ONE_HZ, 1.5).unwrap();
        assert_eq!((open.low, open.high), (0.0, None));
        assert_eq!(insensitivity(&[], &ONE_HZ, 0.05).unwrap().high, None);
    }

    #[test]
    fn a_spike_far_narrower_than_any_grid_is_found() {
        // A ZV for 1 Hz after a comb of long echoes: V = |cos(πr/2)| · |0.95 + 0.05 e^{jωτ}|-like ripple of period 1e-3 in r.
        let sequence = impulses(&[(0.0, 0.476), (0.5, 0.476), (1000.0, 0.024), (1000.5, 0.024)]);
        let limit = 0.05;
        let found = insensitivity(&sequence, &ONE_HZ, limit).unwrap();
        let high = found.high.unwrap();
        let at = |ratio| residual_vibration(&sequence, &ONE_HZ.scaled(ratio));
        assert!((at(high) - limit * (1.0 + 1e-6)).abs() < 1e-9);
        let samples = 200_000;
        let worst = (0..samples)
            .map(|k| at(1.0 + (high - 1.0) * f64::from(k) / f64::from(samples)))
            .fold(0.0, f64::max);
        assert!(worst <= limit * (1.0 + 1e-6) + 1e-12);
    }

    #[test]
    fn absurd_durations_end() {
        let sequence = impulses(&[(0.0, 0.25), (0.5, 0.25), (1e12, 0.25), (1e12 + 0.5, 0.25)]);
        let found = insensitivity(&sequence, &ONE_HZ, 0.05).unwrap();
        assert!(found.low <= 1.0 && found.high.unwrap() >= 1.0);
    }
}
