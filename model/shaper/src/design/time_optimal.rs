//! The shortest bounded command that brings all modes to rest: a convex problem, solved by its dual.
//!
//! A shaped step is a command `u(t)`. The conditions that it stays between two bounds, and rests at 1 from `T` on,
//! are convex in `u`, and so is every constraint. With `s = T − t` and `u = centre + reach·v`, `|v| ≤ 1`:
//!
//! ```text
//! zero at p:           ∫ u·p e^{−ps} ds = 1            double zero at p: also  ∫ u·(1 − ps) e^{−ps} ds = 0
//! in real rows:        ∫_0^T v ψ_k ds = b_k(T)
//! T is long enough  ⟺  c·b ≤ L(c) = ∫_0^T |c·ψ| ds for every c              the shortest T has max c·b/L = 1
//! there                v = sign(c·ψ): the command jumps from bound to bound, where c·ψ changes sign
//! ```
//!
//! For fixed `T` the best `c` minimises the convex `½L² − c·b`, by Newton's method; gradient and Hessian follow from
//! the zeros of `c·ψ` without quadrature. `T` is bisected. The resulting switching times are the start of another
//! Newton's method, on the constraints themselves ([`super::simultaneous`]), so accuracy here matters only for its
//! convergence.

use nalgebra::{Complex, DMatrix, DVector};

use super::constraint::{Amplitudes, Constraint};

/// Samples per period of the fastest mode at which sign changes are looked for.
const SAMPLES_PER_PERIOD: f64 = 48.0;
/// Largest number of samples: with frequencies further apart the command has hundreds of switches anyway.
const SAMPLES_MAX: f64 = 8192.0;
const NEWTON_ROUNDS: usize = 60;
const BISECTIONS: usize = 22;

/// A command that switches between its bounds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BangBang {
    /// Times of the jumps after the first, which is at 0; the last is the end.
    pub(super) times: Vec<f64>,
    /// Whether the command starts at the upper bound.
    pub(super) starts_high: bool,
}

/// The poles `p = σ + jω` with their constraints, in any unit of time.
pub(super) struct Problem<'a> {
    pub(super) poles: &'a [(Complex<f64>, Constraint)],
    pub(super) amplitudes: Amplitudes,
}

impl Problem<'_> {
    /// The shortest command, to the accuracy of the bisection; `None` where none was found.
    pub(super) fn solve(&self) -> Option<BangBang> {
        let fastest = self.poles.iter().fold(0.0, |most: f64, (p, _)| most.max(p.im));
        let spacing = std::f64::consts::TAU / fastest / SAMPLES_PER_PERIOD;
        let half_periods = self.poles.iter().map(|(p, constraint)| match constraint {
            Constraint::Zv => 1.0 / p.im,
            Constraint::Zvd => 2.0 / p.im,
        });
        // This is what convolved positive shapers would take; with strong damping a bounded command may take longer.
        let mut long = std::f64::consts::PI * half_periods.sum::<f64>();
        let mut start = None;
        for _ in 0..4 {
            if long / spacing > SAMPLES_MAX {
                return None;
            }
            let grid = self.grid(spacing, long);
            let best = self.best(&grid, long, long, start.take())?;
            if best.ratio <= 1.0 {
                return self.shorten(&grid, long, best);
            }
            start = Some(best.weights);
            long *= 2.0;
        }
        None
    }

    /// Bisects for the shortest time, starting from one that is long enough.
    fn shorten(&self, grid: &[DVector<f64>], long: f64, found: Best) -> Option<BangBang> {
        let (mut low, mut high) = (0.0, long);
        let mut kept = found;
        for _ in 0..BISECTIONS {
            let middle = f64::midpoint(low, high);
            match self.best(grid, long, middle, Some(kept.weights.clone())) {
                Some(best) if best.ratio <= 1.0 => (high, kept) = (middle, best),
                Some(_) => low = middle,
                None => return None,
            }
        }
        let mut times: Vec<f64> = kept.zeros.iter().rev().map(|s| high - s).collect();
        times.push(high);
        // v at t = 0 is the sign of c·ψ at s = T.
        Some(BangBang {
            times,
            starts_high: kept.sign_at_end,
        })
    }

    /// The rows `ψ(s)`.
    fn rows(&self, s: f64) -> DVector<f64> {
        self.real_rows(|p| p * (-p * s).exp() / p.norm(), |p| (1.0 - p * s) * (-p * s).exp())
    }

    /// `∫_0^s ψ`.
    fn integrals(&self, s: f64) -> DVector<f64> {
        self.real_rows(|p| (1.0 - (-p * s).exp()) / p.norm(), |p| (-p * s).exp() * s)
    }

    /// The right-hand side `b(T)`.
    fn target(&self, end: f64) -> DVector<f64> {
        match self.amplitudes {
            Amplitudes::PartialSum => self.real_rows(|p| Complex::from(1.0 / p.norm()), |_| Complex::from(0.0)),
            Amplitudes::UnitMagnitude => {
                self.real_rows(|p| (1.0 + (-p * end).exp()) / p.norm(), |p| -(-p * end).exp() * end)
            }
        }
    }

    fn real_rows(
        &self,
        zero: impl Fn(Complex<f64>) -> Complex<f64>,
        derivative: impl Fn(Complex<f64>) -> Complex<f64>,
    ) -> DVector<f64> {
        let mut rows = Vec::with_capacity(4 * self.poles.len());
        for &(pole, constraint) in self.poles {
            let value = zero(pole);
            rows.extend([value.re, value.im]);
            if constraint == Constraint::Zvd {
                // The derivative is scaled by the pole's time, as the other rows are.
                let value = derivative(pole);
                rows.extend([value.re, value.im]);
            }
        }
        DVector::from_vec(rows)
    }

    fn grid(&self, spacing: f64, end: f64) -> Vec<DVector<f64>> {
        let samples = (end / spacing).ceil() as usize + 1;
        (0..samples)
            .map(|k| self.rows(end * k as f64 / (samples - 1) as f64))
            .collect()
    }

    /// The zeros in `[0, end]` at which `c·ψ` changes sign, ascending, and whether it is positive at `end`.
    fn sign_changes(&self, grid: &[DVector<f64>], long: f64, end: f64, weights: &DVector<f64>) -> (Vec<f64>, bool) {
        let spacing = long / (grid.len() - 1) as f64;
        let inside = grid
            .iter()
            .enumerate()
            .map(|(k, rows)| (k as f64 * spacing, weights.dot(rows)));
        let mut before: Option<(f64, f64)> = None;
        let mut zeros = Vec::new();
        let last = (end, weights.dot(&self.rows(end)));
        for (s, value) in inside.take_while(|(s, _)| *s < end).chain([last]) {
            if let Some((s_before, value_before)) = before.filter(|(_, v)| (*v > 0.0) != (value > 0.0)) {
                zeros.push(self.refine_zero(weights, (s_before, value_before), (s, value)));
            }
            before = Some((s, value));
        }
        (zeros, last.1 > 0.0)
    }

    /// Finds a zero between two samples of opposite sign by regula falsi with the Illinois correction.
    fn refine_zero(&self, weights: &DVector<f64>, low: (f64, f64), high: (f64, f64)) -> f64 {
        let ((mut a, mut at_a), (mut b, mut at_b)) = (low, high);
        for _ in 0..8 {
            let middle = (a * at_b - b * at_a) / (at_b - at_a);
            let value = weights.dot(&self.rows(middle));
            if !middle.is_finite() || value == 0.0 {
                break;
            }
            if (value > 0.0) == (at_b > 0.0) {
                (b, at_b) = (middle, value);
                at_a /= 2.0;
            } else {
                (a, at_a) = (middle, value);
                at_b /= 2.0;
            }
        }
        f64::midpoint(a, b)
    }

    /// `L`, its gradient, and the zeros.
    fn length(&self, grid: &[DVector<f64>], long: f64, end: f64, weights: &DVector<f64>) -> Length {
        let (zeros, sign_at_end) = self.sign_changes(grid, long, end, weights);
        let mut sign = if sign_at_end { 1.0 } else { -1.0 };
        let mut upper = self.integrals(end);
        let mut gradient = DVector::zeros(weights.len());
        for zero in zeros.iter().rev() {
            let lower = self.integrals(*zero);
            gradient += (&upper - &lower) * sign;
            upper = lower;
            sign = -sign;
        }
        gradient += upper * sign;
        Length {
            value: weights.dot(&gradient),
            gradient,
            zeros,
            sign_at_end,
        }
    }

    /// Maximises `c·b / L(c)` for one duration.
    fn best(&self, grid: &[DVector<f64>], long: f64, end: f64, start: Option<DVector<f64>>) -> Option<Best> {
        let target = self.target(end);
        let mut weights = start.unwrap_or_else(|| target.clone());
        let mut length = self.length(grid, long, end, &weights);
        // The start is scaled to its best multiple.
        let scale = target.dot(&weights) / (length.value * length.value);
        if !(scale.is_finite() && scale > 0.0) {
            weights = target.clone();
            length = self.length(grid, long, end, &weights);
        } else {
            weights *= scale;
            length.value *= scale;
        }
        let cost = |length: &Length, weights: &DVector<f64>| 0.5 * length.value * length.value - target.dot(weights);
        let mut damping = 1e-6;
        for _ in 0..NEWTON_ROUNDS {
            let slope = &length.gradient * length.value - &target;
            if slope.amax() <= 1e-9 * target.amax() {
                break;
            }
            let hessian = self.hessian(&length, &weights);
            let unit = hessian.diagonal().amax();
            let mut moved = false;
            for _ in 0..24 {
                let damped = &hessian + DMatrix::identity(weights.len(), weights.len()) * (damping * unit);
                let Some(step) = damped.lu().solve(&slope) else {
                    damping *= 10.0;
                    continue;
                };
                let next = &weights - step;
                let next_length = self.length(grid, long, end, &next);
                if cost(&next_length, &next) < cost(&length, &weights) {
                    (weights, length) = (next, next_length);
                    damping = f64::max(damping / 10.0, 1e-14);
                    moved = true;
                    break;
                }
                damping *= 10.0;
            }
            if !moved {
                break;
            }
        }
        let ratio = target.dot(&weights) / length.value;
        ratio.is_finite().then_some(Best {
            weights,
            ratio,
            zeros: length.zeros,
            sign_at_end: length.sign_at_end,
        })
    }

    /// Second derivatives of `½L²`.
    fn hessian(&self, length: &Length, weights: &DVector<f64>) -> DMatrix<f64> {
        let mut hessian = &length.gradient * length.gradient.transpose();
        for &zero in &length.zeros {
            const STEP: f64 = 1e-5;
            let rows = self.rows(zero);
            let width = STEP / self.poles.iter().fold(0.0, |most: f64, (p, _)| most.max(p.norm()));
            let slope = (weights.dot(&self.rows(zero + width)) - weights.dot(&self.rows(zero - width))) / (2.0 * width);
            let weight = 2.0 * length.value / slope.abs().max(1e-12);
            hessian += &rows * rows.transpose() * weight;
        }
        hessian
    }
}

struct Length {
    value: f64,
    gradient: DVector<f64>,
    zeros: Vec<f64>,
    sign_at_end: bool,
}

struct Best {
    weights: DVector<f64>,
    ratio: f64,
    zeros: Vec<f64>,
    sign_at_end: bool,
}
