//! The kinds with a zero at the mode and, beside it, further zeros or humps: `smooth_mzv`, `smooth_2hump_ei`,
//! `smooth_zvd_ei` and `smooth_si`.
//!
//! The unknowns are `θ` at the mode, the coefficients of `q` that are free, and the frequencies of the humps, relative to
//! the mode. With `R(θ) = G(θ)/G(0)`, the equations are
//!
//! ```text
//! R(θ) = 0                                       at the mode; smooth_zvd_ei: and R′(θ) = 0
//! R(5θ/3) = 0                                    smooth_mzv, where mzv has its second zero
//! R(wθ) = ± tolerance,  R′(wθ) = 0               for each hump: a peak as high as the tolerance
//! ```
//!
//! as many as unknowns. Newton's method solves them from the known solution at 5 %, in steps of the tolerance.
//!
//! The shape does not depend on damping. What a damped mode leaves is then no more: the zero at the mode stays, and the
//! humps become lower.

use super::super::DesignError;
use super::super::kind::ShaperKind;
use super::super::newton;
use super::Form;
use super::moments::{Shape, response, slope};
use crate::mode::Mode;
use nalgebra::DVector;
use std::f64::consts::PI;

/// The tolerance of the known solutions.
const KNOWN_TOLERANCE: f64 = 0.05;
/// Largest ratio of the tolerances of two neighbouring solutions.
const STEP: f64 = 1.3;
/// Largest residual of an equation.
const ACCURACY: f64 = 1e-12;
/// Second zero of `mzv`, relative to the mode: `√2 − 1 + (2 − √2) cos ¾πw` is 0 at 1 and at 5/3.
const MZV_ZERO: f64 = 5.0 / 3.0;

/// Properties of a kind.
pub(super) struct HumpConditions {
    /// `q` of its two coefficients.
    shape: fn(f64, f64) -> Shape,
    /// Whether the residual is flat at the mode.
    is_flat: bool,
    /// Signs of the humps.
    humps: &'static [f64],
    /// `θ/π`, the coefficients and the frequencies of the humps, approximately, at [`KNOWN_TOLERANCE`].
    known: &'static [f64],
    /// Range of the tolerance.
    tolerance: [f64; 2],
}

/// `q = (y + d)(y − c)²`, with four humps of the kernel, as many as there are impulses that have three zeros.
fn four_humps(c: f64, d: f64) -> Shape {
    [c * c * d, c * c - 2.0 * c * d, d - 2.0 * c, 1.0]
}

pub(super) const TWO_HUMP_EI: HumpConditions = HumpConditions {
    shape: four_humps,
    is_flat: false,
    humps: &[-1.0, 1.0],
    known: &[1.7599, 0.4786, 0.0381, 0.8204, 1.1871],
    tolerance: [1e-4, 0.4],
};

pub(super) const ZVD_EI: HumpConditions = HumpConditions {
    shape: four_humps,
    is_flat: true,
    humps: &[1.0],
    known: &[1.5071, 0.4842, 0.0511, 1.3544],
    tolerance: [1e-4, 0.4],
};

/// With the first two humps as high as the tolerance; in this range of the tolerance all others are lower. One coefficient, for the first
/// hump alone, would last 1.652 periods at 5 %, and reaches no tolerance below 4.2 %.
pub(super) const SI: HumpConditions = HumpConditions {
    shape: |first, second| [1.0, first, second, 0.0],
    is_flat: false,
    humps: &[-1.0, 1.0],
    known: &[1.4724, -0.8625, 1.4531, 1.2113, 1.8454],
    tolerance: [0.01, 0.4],
};

/// Returns the kernel of a kind with humps.
///
/// # Errors
/// [`DesignError::Tolerance`] for a tolerance out of the kind's range, and [`DesignError::NotSolved`] where Newton's method
/// loses the solution.
pub(super) fn solve(
    conditions: &HumpConditions,
    kind: ShaperKind,
    mode: &Mode,
    tolerance: f64,
) -> Result<Form, DesignError> {
    let [least, most] = conditions.tolerance;
    if !(least..=most).contains(&tolerance) {
        return Err(DesignError::Tolerance {
            kind,
            mode: *mode,
            tolerance,
            least,
            most,
        });
    }
    let way = (tolerance / KNOWN_TOLERANCE).ln();
    let steps = (way.abs() / STEP.ln()).ceil();
    let mut found = DVector::from_row_slice(conditions.known);
    for step in 0..=steps as u32 {
        let part = if steps > 0.0 { f64::from(step) / steps } else { 1.0 };
        let level = KNOWN_TOLERANCE * (part * way).exp();
        found = newton::solve(|unknowns| conditions.equations(unknowns, level), found, ACCURACY)
            .ok_or_else(|| lost(kind, mode, part))?;
    }
    Ok(Form {
        theta: PI * found[0],
        shape: (conditions.shape)(found[1], found[2]),
    })
}

fn lost(kind: ShaperKind, mode: &Mode, reached: f64) -> DesignError {
    DesignError::NotSolved {
        kind,
        mode: *mode,
        reached,
    }
}

impl HumpConditions {
    fn equations(&self, unknowns: &DVector<f64>, tolerance: f64) -> DVector<f64> {
        let theta = PI * unknowns[0];
        let shape = (self.shape)(unknowns[1], unknowns[2]);
        let mut values = vec![response(&shape, theta)];
        if self.is_flat {
            values.push(slope(&shape, theta));
        }
        for (sign, ratio) in self.humps.iter().zip(unknowns.iter().skip(3)) {
            values.push(response(&shape, ratio * theta) - sign * tolerance);
            values.push(slope(&shape, ratio * theta));
        }
        DVector::from_vec(values)
    }
}

/// Returns the kernel of `smooth_mzv`: `q = (y − c)²`, with three humps as `mzv` has three impulses, and the two zeros of `mzv`.
///
/// # Errors
/// [`DesignError::NotSolved`] where Newton's method does not find them.
pub(super) fn mzv(kind: ShaperKind, mode: &Mode) -> Result<Form, DesignError> {
    let shape = |c: f64| [c * c, -2.0 * c, 1.0, 0.0];
    let equations = |unknowns: &DVector<f64>| {
        let (theta, shape) = (PI * unknowns[0], shape(unknowns[1]));
        DVector::from_row_slice(&[1.0, MZV_ZERO].map(|ratio| response(&shape, ratio * theta)))
    };
    let found = newton::solve(equations, DVector::from_row_slice(&[0.9435, 0.2385]), ACCURACY)
        .ok_or_else(|| lost(kind, mode, 0.0))?;
    Ok(Form {
        theta: PI * found[0],
        shape: shape(found[1]),
    })
}
