//! Smoothers of Klipper's branch `advanced-features` and of Kalico's `bleeding-edge-v2`: a polynomial with which the command is convolved.
//!
//! ```text
//! shaper_type_x: smoother,  smooth_time_x: T,  coeffs_x: c_n, …, c_0
//! w(t) ∝ Σ c_k (t/T)^k,   −T/2 … T/2,   ∫ w = 1        at most 12 coefficients; the firmware divides by the integral
//! ```
//!
//! A `smooth_*` kernel of posicast ([`Kernel`]) is not a polynomial. The one here is nearest to it by least squares among those that are 0 at both ends and leave
//! at the mode what the kernel leaves.

use crate::design::smooth::Kernel;
use crate::mode::Mode;
use nalgebra::{Complex, DMatrix, DVector};

/// Largest number of coefficients.
const COEFFICIENTS: usize = 12;
/// Points at which kernel and polynomial are compared.
const POINTS: usize = 200;
/// Intervals of Simpson's rule.
const INTERVALS: usize = 2000;

/// A polynomial kernel.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoother {
    /// `T` in seconds.
    pub duration_s: f64,
    /// Coefficients of increasing powers of `t/T`, with an integral of 1 over `t/T` from −½ to ½.
    pub coefficients: Vec<f64>,
}

impl Smoother {
    /// The polynomial nearest to the kernel of a mode; `None` where the equations have no solution.
    pub fn near(kernel: &Kernel, mode: &Mode) -> Option<Self> {
        let duration_s = kernel.duration_s;
        // In Legendre polynomials of x = 2t/T, which are nearly orthogonal on the points.
        let wanted = |x: f64| kernel.value(0.5 * (x + 1.0) * duration_s);
        let whole = integral(&wanted) / 2.0;
        let points: Vec<f64> = (0..POINTS)
            .map(|n| 2.0 * (n as f64 + 0.5) / POINTS as f64 - 1.0)
            .collect();
        let basis = DMatrix::from_fn(POINTS, COEFFICIENTS, |row, degree| legendre(degree, points[row]));
        let values = DVector::from_iterator(POINTS, points.iter().map(|x| wanted(*x) / whole));
        // Integral, both ends, and the pole sum at the mode, referred to the end.
        let pole = |function: &dyn Fn(f64) -> f64| pole_sum(function, duration_s, mode);
        let poles: Vec<Complex<f64>> = (0..COEFFICIENTS).map(|degree| pole(&|x| legendre(degree, x))).collect();
        let target = pole(&|x| wanted(x) / whole);
        let constraints = DMatrix::from_fn(5, COEFFICIENTS, |row, degree| match row {
            0 => {
                if degree == 0 {
                    1.0
                } else {
                    0.0
                }
            }
            1 => 1.0,
            2 => {
                if degree % 2 == 0 {
                    1.0
                } else {
                    -1.0
                }
            }
            3 => poles[degree].re,
            _ => poles[degree].im,
        });
        let bounds = DVector::from_vec(vec![1.0, 0.0, 0.0, target.re, target.im]);
        let size = COEFFICIENTS + 5;
        let mut system = DMatrix::zeros(size, size);
        system
            .view_mut((0, 0), (COEFFICIENTS, COEFFICIENTS))
            .copy_from(&(basis.transpose() * &basis / POINTS as f64));
        system
            .view_mut((COEFFICIENTS, 0), (5, COEFFICIENTS))
            .copy_from(&constraints);
        system
            .view_mut((0, COEFFICIENTS), (COEFFICIENTS, 5))
            .copy_from(&constraints.transpose());
        let mut right = DVector::zeros(size);
        right
            .rows_mut(0, COEFFICIENTS)
            .copy_from(&(basis.transpose() * values / POINTS as f64));
        right.rows_mut(COEFFICIENTS, 5).copy_from(&bounds);
        let solution = system.lu().solve(&right)?;
        Some(Self {
            duration_s,
            coefficients: powers(&solution.as_slice()[..COEFFICIENTS]),
        })
    }

    /// Residual vibration that the smoother leaves at a mode.
    pub fn residual(&self, mode: &Mode) -> f64 {
        let value = |x: f64| self.coefficients.iter().rev().fold(0.0, |sum, c| sum * 0.5 * x + c);
        let whole = integral(&value) / 2.0;
        pole_sum(&|x| value(x) / whole, self.duration_s, mode).norm()
    }
}

/// Legendre polynomial of a degree.
fn legendre(degree: usize, x: f64) -> f64 {
    let (mut before, mut value) = (1.0, x);
    if degree == 0 {
        return before;
    }
    for k in 1..degree {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k + 1.0) * x * value - k * before) / (k + 1.0));
    }
    value
}

/// Coefficients of powers of `t/T = x/2` of a sum of Legendre polynomials.
fn powers(of_legendre: &[f64]) -> Vec<f64> {
    let count = of_legendre.len();
    let mut sum = vec![0.0; count];
    let (mut before, mut value) = (vec![0.0; count], vec![0.0; count]);
    for (degree, coefficient) in of_legendre.iter().enumerate() {
        let next = match degree {
            0 => {
                let mut one = vec![0.0; count];
                one[0] = 1.0;
                one
            }
            _ => {
                let k = degree as f64 - 1.0;
                let shifted = |at: usize| if at == 0 { 0.0 } else { value[at - 1] };
                (0..count)
                    .map(|at| ((2.0 * k + 1.0) * shifted(at) - k * before[at]) / (k + 1.0))
                    .collect()
            }
        };
        for (sum, next) in sum.iter_mut().zip(&next) {
            *sum += coefficient * next;
        }
        (before, value) = (value, next);
    }
    let doubled = std::iter::successors(Some(1.0), |power| Some(2.0 * power));
    sum.iter()
        .zip(doubled)
        .map(|(coefficient, power)| coefficient * power)
        .collect()
}

/// Integral over x from −1 to 1 by Simpson's rule.
fn integral(function: &dyn Fn(f64) -> f64) -> f64 {
    let step = 2.0 / INTERVALS as f64;
    let weight = |n: usize| match n {
        0 | INTERVALS => 1.0,
        _ if n % 2 == 1 => 4.0,
        _ => 2.0,
    };
    (0..=INTERVALS)
        .map(|n| weight(n) * function(n as f64 * step - 1.0))
        .sum::<f64>()
        * step
        / 3.0
}

/// `½ ∫ w(x) e^{(σ + jω_d)(t − T)} dx`, `t = T(x + 1)/2`.
fn pole_sum(function: &dyn Fn(f64) -> f64, duration_s: f64, mode: &Mode) -> Complex<f64> {
    let at = |x: f64| {
        let before_end_s = 0.5 * (x - 1.0) * duration_s;
        let decay = (mode.decay() * before_end_s).exp();
        (decay * function(x), mode.omega_damped() * before_end_s)
    };
    let part = |of: fn(f64) -> f64| {
        integral(&|x| {
            let (value, angle) = at(x);
            value * of(angle)
        }) / 2.0
    };
    Complex::new(part(f64::cos), part(f64::sin))
}
