//! Equations on the residual of a shaper, with exact derivatives, from which the EI and the negative kinds are
//! solved.
//!
//! Times are in undamped periods, frequencies are ratios `w` to the mode's. Everything is referred to the last
//! impulse, as the residual is, so that nothing grows. With `p = 2π(ζ + j√(1−ζ²))`,
//!
//! ```text
//! R(w) = Σ A_i e^{q_i w},   q_i = p t_i − 2πζ t_n            V(w) = |R(w)|
//! zero at w:          R(w) = 0                                two equations
//! stationary zero:    R(w) = 0 and R′(w) = 0                  four: dV/dω = 0 and dV/dζ = 0 besides
//! hump at w:          |R(w)| = V and Re(conj(R) R′) = 0       two: as high as the tolerance, and a peak
//! ```
//!
//! The unknowns are, in this order: the amplitudes (none where they are fixed), the times after the first, and some
//! of the ratios. Every row also has its derivative along a path of damping and tolerance, along which
//! [`super::path`] follows the equations.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};

/// A position on the path of a system of equations, with the direction of the path there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    /// Damping ratio.
    pub damping: f64,
    /// Tolerance, which is the height of the humps.
    pub tolerance: f64,
    /// Change of the damping along the path.
    pub damping_rate: f64,
    /// Change of the tolerance along the path.
    pub tolerance_rate: f64,
}

/// A frequency ratio at which a condition is set.
#[derive(Debug, Clone, Copy)]
pub(super) enum Ratio {
    /// A given ratio.
    Fixed(f64),
    /// An unknown ratio: its value, and its index among the unknown ratios.
    Free(f64, usize),
}

/// Values of the equations with their derivatives.
#[derive(Debug, Clone)]
pub(super) struct Linearised {
    /// Values, which a solution makes zero.
    pub values: DVector<f64>,
    /// Derivatives with respect to the unknowns.
    pub jacobian: DMatrix<f64>,
    /// Derivatives along the path.
    pub path: DVector<f64>,
}

/// Builder of the rows for one set of impulses.
pub(super) struct Equations<'a> {
    amplitudes: &'a [f64],
    times: &'a [f64],
    amplitudes_free: bool,
    point: Point,
    /// `p` and its derivative with respect to the damping.
    pole: Complex<f64>,
    pole_rate: Complex<f64>,
    system: Linearised,
    row: usize,
}

/// `R` and `R′` at a ratio, or a derivative of both.
type Pair = [Complex<f64>; 2];

impl<'a> Equations<'a> {
    /// Starts a system of `count` rows for as many unknowns.
    pub(super) fn new(
        amplitudes: &'a [f64],
        times: &'a [f64],
        amplitudes_free: bool,
        point: Point,
        count: usize,
    ) -> Self {
        let sine = (1.0 - point.damping * point.damping).sqrt();
        Self {
            amplitudes,
            times,
            amplitudes_free,
            point,
            pole: TAU * Complex::new(point.damping, sine),
            pole_rate: TAU * Complex::new(1.0, -point.damping / sine),
            system: Linearised {
                values: DVector::zeros(count),
                jacobian: DMatrix::zeros(count, count),
                path: DVector::zeros(count),
            },
            row: 0,
        }
    }

    /// Adds the condition that the amplitudes sum to one.
    pub(super) fn unit_sum(mut self) -> Self {
        self.system.values[self.row] = self.amplitudes.iter().sum::<f64>() - 1.0;
        for column in 0..self.amplitudes.len() {
            self.system.jacobian[(self.row, column)] = 1.0;
        }
        self.row += 1;
        self
    }

    /// Adds the condition that the residual is zero at the ratio.
    pub(super) fn zero(mut self, ratio: Ratio) -> Self {
        self.rows(
            ratio,
            |[sum, _]| [sum.re, sum.im],
            |[sum, _]| [sum.re, sum.im],
            [0.0; 2],
        );
        self
    }

    /// Adds the conditions that the residual and its first derivative are zero at the mode.
    pub(super) fn stationary_zero(mut self) -> Self {
        let mode = Ratio::Fixed(1.0);
        self.rows(mode, |[sum, _]| [sum.re, sum.im], |[sum, _]| [sum.re, sum.im], [0.0; 2]);
        self.rows(
            mode,
            |[_, slope]| [slope.re, slope.im],
            |[_, slope]| [slope.re, slope.im],
            [0.0; 2],
        );
        self
    }

    /// Adds the conditions that the residual has a peak of the height of the tolerance at the ratio.
    pub(super) fn hump(mut self, ratio: Ratio) -> Self {
        let [sum, slope] = self.at(ratio).0;
        let power = self.point.tolerance * self.point.tolerance;
        let height = sum.norm_sqr() / power;
        let rise = (sum.conj() * slope).re / power;
        let relative_rate = self.point.tolerance_rate / self.point.tolerance;
        self.rows(
            ratio,
            |_| [(height - 1.0) / 2.0, rise],
            |[d_sum, d_slope]| {
                [
                    (sum.conj() * d_sum).re / power,
                    (d_sum.conj() * slope + sum.conj() * d_slope).re / power,
                ]
            },
            [-height * relative_rate, -2.0 * rise * relative_rate],
        );
        self
    }

    /// Returns the system once it has all its rows.
    pub(super) fn finish(self) -> Linearised {
        self.system
    }

    /// Adds two rows: values from `R` and `R′`, derivatives from theirs. `tolerance_path` is the derivative with
    /// respect to what else changes along the path.
    fn rows(
        &mut self,
        ratio: Ratio,
        values: impl Fn(Pair) -> [f64; 2],
        derivatives: impl Fn(Pair) -> [f64; 2],
        tolerance_path: [f64; 2],
    ) {
        let (sums, columns, by_damping) = self.at(ratio);
        let values = values(sums);
        let path = derivatives(by_damping);
        for offset in 0..2 {
            self.system.values[self.row + offset] = values[offset];
            self.system.path[self.row + offset] = path[offset] * self.point.damping_rate + tolerance_path[offset];
        }
        for (column, pair) in columns {
            let entries = derivatives(pair);
            self.system.jacobian[(self.row, column)] = entries[0];
            self.system.jacobian[(self.row + 1, column)] = entries[1];
        }
        self.row += 2;
    }

    /// `R` and `R′` at a ratio, their derivatives with respect to the unknowns, each with its column, and with
    /// respect to the damping.
    fn at(&self, ratio: Ratio) -> (Pair, Vec<(usize, Pair)>, Pair) {
        let w = match ratio {
            Ratio::Fixed(w) | Ratio::Free(w, _) => w,
        };
        let impulses = self.amplitudes.len();
        let end = self.times[impulses - 1];
        let times_from = if self.amplitudes_free { impulses } else { 0 };
        let zero = Complex::new(0.0, 0.0);
        let (mut sum, mut slope, mut curvature) = (zero, zero, zero);
        let mut by_damping = [zero; 2];
        let mut columns = Vec::with_capacity(2 * impulses);
        for (index, (&amplitude, &time)) in self.amplitudes.iter().zip(self.times).enumerate() {
            let rate = self.pole * time - self.pole.re * end;
            let factor = (rate * w).exp();
            let term = factor * amplitude;
            sum += term;
            slope += term * rate;
            curvature += term * rate * rate;
            let rate_by_damping = self.pole_rate * time - TAU * end;
            by_damping[0] += term * rate_by_damping * w;
            by_damping[1] += term * rate_by_damping * (rate * w + 1.0);
            if self.amplitudes_free {
                columns.push((index, [factor, factor * rate]));
            }
            if index > 0 {
                let by_time = term * self.pole;
                columns.push((times_from + index - 1, [by_time * w, by_time * (rate * w + 1.0)]));
            }
        }
        // The last time is also the reference of all terms.
        if let Some((_, [by_sum, by_slope])) = columns.last_mut() {
            *by_sum -= sum * (self.pole.re * w);
            *by_slope -= (sum + slope * w) * self.pole.re;
        }
        if let Ratio::Free(_, place) = ratio {
            columns.push((times_from + impulses - 1 + place, [slope, curvature]));
        }
        ([sum, slope], columns, by_damping)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A system with every kind of row, for three impulses and two unknown ratios; the unknowns are one vector.
    fn system(x: &DVector<f64>, damping: f64, tolerance: f64) -> Linearised {
        let point = Point {
            damping,
            tolerance,
            damping_rate: 0.7,
            tolerance_rate: -0.3,
        };
        let x = x.as_slice();
        let times = [0.0, x[3], x[4]];
        Equations::new(&x[..3], &times, true, point, 7)
            .unit_sum()
            .zero(Ratio::Free(x[5], 0))
            .hump(Ratio::Free(x[6], 1))
            .hump(Ratio::Fixed(1.0))
            .finish()
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        let x = DVector::from_row_slice(&[0.3, 0.45, 0.28, 0.52, 1.03, 0.86, 1.1]);
        let (damping, tolerance, step) = (0.13, 0.08, 1e-6);
        let found = system(&x, damping, tolerance);
        for column in 0..7 {
            let mut ahead = x.clone();
            let mut behind = x.clone();
            ahead[column] += step;
            behind[column] -= step;
            let slope =
                (system(&ahead, damping, tolerance).values - system(&behind, damping, tolerance).values) / (2.0 * step);
            let error = (slope - found.jacobian.column(column)).amax();
            assert!(error < 1e-6, "column {column}: {error}");
        }
        let along = |s: f64| system(&x, damping + 0.7 * s, tolerance - 0.3 * s).values;
        let slope = (along(step) - along(-step)) / (2.0 * step);
        assert!((slope - found.path).amax() < 1e-6);
    }

    #[test]
    fn a_stationary_zero_is_that_of_zvd() {
        let point = Point {
            damping: 0.0,
            tolerance: 1.0,
            damping_rate: 1.0,
            tolerance_rate: 0.0,
        };
        let found = Equations::new(&[0.25, 0.5, 0.25], &[0.0, 0.5, 1.0], false, point, 4).stationary_zero();
        assert!(found.finish().values.amax() < 1e-15);
    }
}
