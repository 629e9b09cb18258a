//! The `smooth_*` kinds: continuous kernels with which the command is convolved, in place of impulses.
//!
//! Printer firmware ("input smoothers" of Klipper's advanced-features branch, of Danger Klipper and Kalico) offers such kernels for an
//! axis, named after the impulse shapers that they resemble: the shaped command has no jump of its own. Its polynomials, of
//! degree 6 to 10, come from a numerical search for the least duration. The kernels here are not these: they are
//! derived from the conditions below, with as many free coefficients as conditions, and are longer (docs/shaper-design.md compares the
//! durations).
//!
//! ```text
//! w(t) ∝ e^(−σt) · g(x),   x = 2t/T − 1 in −1 … 1,   g(x) = (1 − x²) · q(x²) ≥ 0,   ∫ w = 1
//! ```
//!
//! `g` is 0 at both ends, so that the kernel is continuous. The factor `e^(−σt)` makes it asymmetric by as much as the mode's
//! damping asks: with `θ = ω_d T/2`,
//!
//! ```text
//! ∫ w(t) e^((σ + jω_d)t) dt ∝ e^(jθ) G(θ),       G(θ) = ∫ g(x) cos θx dx over −1 … 1
//! ```
//!
//! so a zero without damping is one with it. The conditions, `V` being the residual and the mode at 1:
//!
//! | kind | `q(y)` | conditions | `T/T_d`, undamped, 5 % |
//! |---|---|---|---|
//! | `smooth_zv` | `y`, the shortest of degree 1 that is nowhere negative | `V(1) = 0` | 0.7961 |
//! | `smooth_mzv` | `(y − c)²` | the zeros of `mzv`: `V(1) = V(5/3) = 0` | 0.9435 |
//! | `smooth_ei` | `(y − c)²` | `V(1)` is the tolerance, as a peak between two zeros | 1.259 |
//! | `smooth_zvd` | `(y − c)²` | `V(1) = V′(1) = 0` | 1.2656 |
//! | `smooth_si` | `1 + by + cy²` | `V(1) = 0`, above it two humps as high as the tolerance and then lower ones: no frequency above the mode has more | 1.4724 |
//! | `smooth_zvd_ei` | `(y + d)(y − c)²` | `V(1) = V′(1) = 0`, above it a hump as high as the tolerance, then a zero | 1.5071 |
//! | `smooth_2hump_ei` | `(y + d)(y − c)²` | `V(1) = 0`, a hump as high as the tolerance on either side, and zeros beyond | 1.7599 |
//!
//! The conditions of `smooth_zvd_ei` and `smooth_si`, which have no impulse shaper of their name, and the zeros of `smooth_mzv`
//! are what one finds in the response of the firmware's kernels at the damping of 0.1 for which they were made. Its frequency is that of the
//! lowest zero; here it is the mode's, which for `smooth_ei` and `smooth_2hump_ei` is in the middle, as in `ei` and `two-hump-ei`.
//!
//! `smooth_ei` has the tolerance at a damped mode, too, as far as that is possible. The shapes of the kinds with humps beside
//! the mode depend on the tolerance alone: with damping the humps are lower.
//!
//! On the sample grid each tap is the integral of the kernel over one cell, so that they sum to 1. Where a table of 256 taps is too
//! short, a cell is several samples. A zero at the mode survives sampling up to what the cells fold back from multiples of their
//! rate, which the report shows.

mod conditions;
mod humps;
mod moments;
#[cfg(test)]
mod tests;

use self::conditions::{Conditions, most_damping, theta_zv};
use self::moments::Shape;
use super::DesignError;
use super::kind::{Design, KindRow, Promise, ShaperKind};
use crate::digitise::TAPS_MAX;
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// Pieces of a cell, or of a whole kernel, over which Gauss' rule integrates.
const PIECES: u32 = 8;
/// Largest deviation of the kernel's residual at the mode from what its kind promises.
const ACCURACY: f64 = 1e-9;

/// `smooth_zv`.
pub(super) const ZV: KindRow = KindRow::new(
    "smooth_zv",
    Promise::Zero,
    Design::Kernel(|_, _, _| {
        Ok(Form {
            theta: theta_zv(),
            shape: [0.0, 1.0, 0.0, 0.0],
        })
    }),
    "a kernel without jumps, a zero at the mode; the shortest smooth kind",
);

/// `smooth_mzv`.
pub(super) const MZV: KindRow = KindRow::new(
    "smooth_mzv",
    Promise::Zero,
    Design::Kernel(|kind, mode, _| humps::mzv(kind, mode)),
    "a kernel with the zeros of `mzv`",
);

/// `smooth_ei`.
pub(super) const EI: KindRow = KindRow::new(
    "smooth_ei",
    Promise::Tolerance,
    Design::Kernel(between_zeros),
    "a kernel with `tolerance` at the mode, between two zeros",
);

/// `smooth_zvd`.
pub(super) const ZVD: KindRow = KindRow::new(
    "smooth_zvd",
    Promise::Zero,
    Design::Kernel(between_zeros),
    "a kernel with a double zero at the mode",
);

/// `smooth_si`.
pub(super) const SI: KindRow = KindRow::new(
    "smooth_si",
    Promise::Zero,
    Design::Kernel(|kind, mode, tolerance| humps::solve(&humps::SI, kind, mode, tolerance)),
    "a kernel with at most `tolerance`, 0.01 to 0.4, at every frequency above the mode",
);

/// `smooth_zvd_ei`.
pub(super) const ZVD_EI: KindRow = KindRow::new(
    "smooth_zvd_ei",
    Promise::Zero,
    Design::Kernel(|kind, mode, tolerance| humps::solve(&humps::ZVD_EI, kind, mode, tolerance)),
    "a kernel with a double zero at the mode and `tolerance`, 0.0001 to 0.4, above it",
);

/// `smooth_2hump_ei`.
pub(super) const TWO_HUMP_EI: KindRow = KindRow::new(
    "smooth_2hump_ei",
    Promise::Zero,
    Design::Kernel(|kind, mode, tolerance| humps::solve(&humps::TWO_HUMP_EI, kind, mode, tolerance)),
    "a kernel with at most `tolerance`, 0.0001 to 0.4, on either side of the mode",
);

/// A kernel for the damped frequency of its mode: `θ` at the mode, and `q`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Form {
    theta: f64,
    shape: Shape,
}

/// The kernel with what its kind promises as a peak, or a double zero, at the mode.
fn between_zeros(kind: ShaperKind, mode: &Mode, tolerance: f64) -> Result<Form, DesignError> {
    let promised = kind.promised(tolerance).unwrap_or_default();
    let ratio = mode.decay() / mode.omega_damped();
    let (theta, c) = Conditions { promised, ratio }
        .solve()
        .ok_or_else(|| DesignError::Damping {
            kind,
            mode: *mode,
            most: most_damping(promised),
            instead: ShaperKind::SmoothZvd,
        })?;
    Ok(Form {
        theta,
        shape: [c * c, -2.0 * c, 1.0, 0.0],
    })
}

/// A kernel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kernel {
    shape: Shape,
    /// `T` in seconds.
    pub duration_s: f64,
    /// `σ` in 1/s.
    decay: f64,
}

impl Kernel {
    /// The kernel of a kind for a mode; `tolerance` is that of the kinds with humps.
    ///
    /// # Errors
    /// [`DesignError::Mode`] for an invalid mode, [`DesignError::OtherFamily`] for a kind that is not smooth,
    /// [`DesignError::Damping`] where `smooth_ei` does not exist, [`DesignError::Tolerance`] where another kind with humps does not.
    pub fn new(kind: ShaperKind, mode: &Mode, tolerance: f64) -> Result<Self, DesignError> {
        DesignError::check_mode(mode)?;
        let Design::Kernel(design) = kind.row().design else {
            return Err(DesignError::OtherFamily { kind });
        };
        let Form { theta, shape } = design(kind, mode, tolerance)?;
        let promised = kind.promised(tolerance).unwrap_or_default();
        let kernel = Self {
            shape,
            duration_s: 2.0 * theta / mode.omega_damped(),
            decay: mode.decay(),
        };
        DesignError::verify(kind, mode, kernel.residual(mode), promised, ACCURACY)?;
        Ok(kernel)
    }

    /// Kernel at a time, not yet divided by its integral; 0 outside `0 … T`.
    pub(crate) fn value(&self, time_s: f64) -> f64 {
        let x = 2.0 * time_s / self.duration_s - 1.0;
        let y = x * x;
        let q = self
            .shape
            .iter()
            .rev()
            .fold(0.0, |value, coefficient| value * y + coefficient);
        (1.0 - y).max(0.0) * q * (-self.decay * time_s).exp()
    }

    /// Residual vibration that the kernel leaves at a mode, at its end.
    fn residual(&self, mode: &Mode) -> f64 {
        let weighted = |trigonometric: fn(f64) -> f64| {
            let value = |time_s: f64| {
                let growth = (mode.decay() * (time_s - self.duration_s)).exp();
                self.value(time_s) * growth * trigonometric(mode.omega_damped() * time_s)
            };
            integral(&value, 0.0, self.duration_s, 8 * PIECES)
        };
        let whole = integral(&|time_s| self.value(time_s), 0.0, self.duration_s, 8 * PIECES);
        weighted(f64::sin).hypot(weighted(f64::cos)) / whole
    }

    /// Number of cells of `cell_s` seconds.
    fn cells(&self, cell_s: f64) -> f64 {
        (self.duration_s / cell_s - 1e-9).ceil().max(1.0)
    }

    /// The kernel on a grid: each impulse is the integral over the cell that begins at its time.
    ///
    /// # Errors
    /// [`DesignError::NoSequence`] where times leave the range of `f64`.
    pub fn sampled(&self, kind: ShaperKind, cell_s: f64) -> Result<ImpulseSequence, DesignError> {
        let cells = self.cells(cell_s).min(TAPS_MAX as f64) as u32;
        let amounts = (0..cells).map(|cell| {
            let begin_s = f64::from(cell) * cell_s;
            let end_s = (begin_s + cell_s).min(self.duration_s);
            integral(&|time_s| self.value(time_s), begin_s, end_s, PIECES)
        });
        let amounts: Vec<f64> = amounts.collect();
        let whole: f64 = amounts.iter().sum();
        let impulses = amounts.iter().zip(0u32..).map(|(amount, cell)| Impulse {
            time_s: f64::from(cell) * cell_s,
            amplitude: amount / whole,
        });
        ImpulseSequence::new(impulses.collect()).map_err(|cause| DesignError::NoSequence {
            what: format!("shaper \"{kind}\""),
            cause,
        })
    }
}

/// Samples per cell with which kernels, one after the other, make at most as many taps as a table holds.
pub(super) fn samples_per_cell(kernels: &[Kernel], sample_hz: f64) -> f64 {
    let samples: f64 = kernels.iter().map(|kernel| kernel.duration_s * sample_hz).sum();
    let most = TAPS_MAX as f64;
    let taps = |step: f64| {
        let cells = kernels.iter().map(|kernel| kernel.cells(step / sample_hz) - 1.0);
        cells.sum::<f64>() + 1.0
    };
    let mut step = (samples / most).ceil().max(1.0);
    while step.is_finite() && taps(step) > most {
        // A number without units digits grows as well.
        step = (step + 1.0).max((step * 1.001).floor());
    }
    step
}

/// Integrates by Gauss' rule with five points on each of `pieces` pieces: exact for polynomials up to degree 9.
fn integral(value: &impl Fn(f64) -> f64, from: f64, to: f64, pieces: u32) -> f64 {
    let root = 2.0 * (10.0f64 / 7.0).sqrt();
    let [inner, outer] = [(5.0 - root).sqrt() / 3.0, (5.0 + root).sqrt() / 3.0];
    let [heavy, light] = [13.0, -13.0].map(|factor| (322.0 + factor * 70.0f64.sqrt()) / 900.0);
    let rule = [
        (-outer, light),
        (-inner, heavy),
        (0.0, 128.0 / 225.0),
        (inner, heavy),
        (outer, light),
    ];
    let half = (to - from) / f64::from(pieces) / 2.0;
    let piece = |index: u32| {
        let middle = from + half * (2.0 * f64::from(index) + 1.0);
        rule.iter()
            .map(|(x, weight)| weight * value(middle + half * x))
            .sum::<f64>()
            * half
    };
    (0..pieces).map(piece).sum()
}
