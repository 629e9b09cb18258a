//! `smooth_zv`, `smooth_zvd` and `smooth_ei`: continuous kernels with which the command is convolved, in place of impulses.
//!
//! Printer firmware offers such smoothers for an axis, named after the impulse shapers that they resemble: the shaped command
//! has no jump of its own. The kernels here are derived from the conditions below and are not the firmware's.
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
//! so what holds without damping holds with it. The conditions, each with the least `T`:
//!
//! | kind | `q(y)` | conditions | `T/T_d`, undamped |
//! |---|---|---|---|
//! | `smooth_zv` | `y`, the shortest of degree 1 that is nowhere negative | `G = 0` | 0.7961 |
//! | `smooth_zvd` | `(y − c)²` | `G = 0`, `G′ = 0` | 1.2656 |
//! | `smooth_ei` | `(y − c)²` | the residual at the mode is the tolerance, `G′ = 0` there | 1.259 at 5 % |
//!
//! On the sample grid each tap is the integral of the kernel over one cell, so that they sum to 1. Where a table of 256 taps is too
//! short, a cell is several samples. A zero at the mode survives sampling up to what the cells fold back from multiples of their
//! rate, which the report shows.

use super::DesignError;
use super::kind::ShaperKind;
use crate::digitise::TAPS_MAX;
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;
use std::f64::consts::PI;

/// `θ` of `smooth_zv`, the first zero of `∫ (1 − x²) x² cos θx dx`: `θ = 0.796135240 π`.
const THETA_ZV: [f64; 2] = [0.7 * PI, 0.9 * PI];
/// Range in which `θ` of the other kinds lies.
const THETA_OTHER: [f64; 2] = [1.2 * PI, 1.27 * PI];
/// Steps of the search for a change of sign there.
const STEPS: u32 = 140;
/// Rounds of bisection, to the last bit.
const ROUNDS: u32 = 60;
/// Pieces of a cell, or of a whole kernel, over which Gauss' rule integrates.
const PIECES: u32 = 8;
/// Largest deviation of the kernel's residual at the mode from what its kind promises.
const ACCURACY: f64 = 1e-9;

/// A kernel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kernel {
    /// Coefficients of `q`, beginning with that of `y⁰`.
    shape: [f64; 3],
    /// `T` in seconds.
    pub duration_s: f64,
    /// `σ` in 1/s.
    decay: f64,
}

impl Kernel {
    /// The kernel of a kind for a mode; `tolerance` is that of `smooth_ei`.
    ///
    /// # Errors
    /// [`DesignError::Mode`] for an invalid mode, [`DesignError::NotBuilt`] for a kind that is not smooth,
    /// [`DesignError::Damping`] where `smooth_ei` does not exist.
    pub fn new(kind: ShaperKind, mode: &Mode, tolerance: f64) -> Result<Self, DesignError> {
        DesignError::check_mode(mode)?;
        let ratio = mode.decay() / mode.omega_damped();
        let (theta, shape, promised) = match kind {
            ShaperKind::SmoothZv => (theta_zv(), [0.0, 1.0, 0.0], 0.0),
            ShaperKind::SmoothZvd | ShaperKind::SmoothEi => {
                let promised = if kind == ShaperKind::SmoothEi { tolerance } else { 0.0 };
                let (theta, c) = Conditions { promised, ratio }
                    .solve()
                    .ok_or_else(|| DesignError::Damping {
                        kind,
                        mode: *mode,
                        most: most_damping(promised),
                        instead: ShaperKind::SmoothZvd,
                    })?;
                (theta, [c * c, -2.0 * c, 1.0], promised)
            }
            _ => return Err(DesignError::NotBuilt { kind }),
        };
        let kernel = Self {
            shape,
            duration_s: 2.0 * theta / mode.omega_damped(),
            decay: mode.decay(),
        };
        DesignError::verify(kind, mode, kernel.residual(mode), promised, ACCURACY)?;
        Ok(kernel)
    }

    /// Kernel at a time, not yet divided by its integral; 0 outside `0 … T`.
    fn value(&self, time_s: f64) -> f64 {
        let x = 2.0 * time_s / self.duration_s - 1.0;
        let [c0, c1, c2] = self.shape;
        let y = x * x;
        ((1.0 - y).max(0.0) * (c0 + y * (c1 + y * c2))) * (-self.decay * time_s).exp()
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

/// `M_k = ∫ x^(2k) cos θx dx` over −1 … 1, for k = 0 … 3, by parts.
fn moments(theta: f64) -> [f64; 4] {
    let (sin, cos) = theta.sin_cos();
    let mut before = 0.0;
    [0.0, 1.0, 2.0, 3.0].map(|k: f64| {
        before =
            2.0 * sin / theta + 4.0 * k * cos / (theta * theta) - 2.0 * k * (2.0 * k - 1.0) / (theta * theta) * before;
        before
    })
}

fn theta_zv() -> f64 {
    let response = |theta: f64| {
        let [_, first, second, _] = moments(theta);
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
        match (value(middle) > 0.0) == begins_positive {
            true => low = middle,
            false => high = middle,
        }
    }
    (low + high) / 2.0
}

/// Largest damping ratio at which `smooth_ei` has a solution.
fn most_damping(promised: f64) -> f64 {
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
struct Conditions {
    /// Residual at the mode.
    promised: f64,
    /// `σ/ω_d`.
    ratio: f64,
}

impl Conditions {
    /// Returns `θ` and `c`.
    fn solve(&self) -> Option<(f64, f64)> {
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
        let moments = moments(theta);
        // ∫ x^(2k+1) sin θx dx, by parts.
        let sines =
            [0, 1, 2, 3].map(|k: usize| -2.0 * theta.cos() / theta + (2.0 * k as f64 + 1.0) / theta * moments[k]);
        let [s0, s1, s2] = [0, 1, 2].map(|k| sines[k] - sines[k + 1]);
        Some(s2 - 2.0 * c * s1 + c * c * s0)
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::residual_vibration;

    /// A kernel, and its samples on a fine grid.
    fn fine(kind: ShaperKind, mode: &Mode, tolerance: f64) -> (Kernel, ImpulseSequence) {
        let kernel = Kernel::new(kind, mode, tolerance).unwrap();
        let impulses = kernel.sampled(kind, kernel.duration_s / 256.0).unwrap();
        (kernel, impulses)
    }

    #[test]
    fn golden_durations_are_those_of_a_second_solution() {
        // By Simpson's rule and a scan over θ, in another program.
        let mode = |damping| Mode {
            frequency_hz: 40.0,
            damping,
        };
        for (kind, damping, tolerance, periods) in [
            (ShaperKind::SmoothZv, 0.0, 0.05, 0.79614),
            (ShaperKind::SmoothZv, 0.3, 0.05, 0.79614),
            (ShaperKind::SmoothZvd, 0.0, 0.05, 1.2656),
            (ShaperKind::SmoothZvd, 0.2, 0.05, 1.2656),
            (ShaperKind::SmoothEi, 0.0, 0.05, 1.2592),
            (ShaperKind::SmoothEi, 0.2, 0.05, 1.2516),
            (ShaperKind::SmoothEi, 0.05, 0.2, 1.2440),
        ] {
            let found = Kernel::new(kind, &mode(damping), tolerance).unwrap().duration_s;
            let found = found / mode(damping).damped_period_s();
            assert!((found - periods).abs() < 1e-3, "{kind} {damping} {tolerance}: {found}");
        }
    }

    #[test]
    fn unit_samples_keep_what_the_kernel_promises_and_sum_to_one() {
        for damping in [0.0, 0.1, 0.3] {
            let mode = Mode {
                frequency_hz: 31.0,
                damping,
            };
            for (kind, promised) in [
                (ShaperKind::SmoothZv, 0.0),
                (ShaperKind::SmoothZvd, 0.0),
                (ShaperKind::SmoothEi, 0.05),
            ] {
                let (_, impulses) = fine(kind, &mode, 0.05);
                let list = impulses.impulses();
                assert!(list.iter().all(|impulse| impulse.amplitude >= 0.0), "{kind}");
                assert!((list.iter().map(|impulse| impulse.amplitude).sum::<f64>() - 1.0).abs() < 1e-12);
                let residual = residual_vibration(list, &mode);
                assert!((residual - promised).abs() < 2e-3, "{kind} {damping}: {residual}");
                // The first and the last cell are small: the command begins and ends without a jump.
                let largest = list.iter().fold(0.0f64, |most, impulse| most.max(impulse.amplitude));
                assert!(list[0].amplitude < 0.1 * largest, "{kind}");
            }
        }
    }

    #[test]
    fn unit_the_flat_kinds_are_flat_at_the_mode() {
        let mode = Mode {
            frequency_hz: 50.0,
            damping: 0.0,
        };
        let at = |impulses: &ImpulseSequence, ratio: f64| residual_vibration(impulses.impulses(), &mode.scaled(ratio));
        let (_, zv) = fine(ShaperKind::SmoothZv, &mode, 0.05);
        let (_, zvd) = fine(ShaperKind::SmoothZvd, &mode, 0.05);
        let (_, ei) = fine(ShaperKind::SmoothEi, &mode, 0.05);
        for ratio in [0.97, 1.03] {
            assert!(at(&zvd, ratio) < 0.15 * at(&zv, ratio));
            // The mode is the peak between two zeros.
            assert!(at(&ei, ratio) < at(&ei, 1.0));
        }
    }

    #[test]
    fn unit_damping_makes_the_kernel_asymmetric() {
        let mode = |damping| Mode {
            frequency_hz: 50.0,
            damping,
        };
        let mean = |damping: f64| {
            let (kernel, impulses) = fine(ShaperKind::SmoothZv, &mode(damping), 0.05);
            impulses.delay_s() / kernel.duration_s
        };
        assert!((mean(0.0) - 0.5).abs() < 3e-3, "{}", mean(0.0));
        assert!(mean(0.2) < 0.45, "{}", mean(0.2));
    }

    #[test]
    fn unit_smooth_ei_ends_where_its_error_says() {
        let mode = |damping| Mode {
            frequency_hz: 50.0,
            damping,
        };
        let refused = Kernel::new(ShaperKind::SmoothEi, &mode(0.9), 0.05).unwrap_err();
        let DesignError::Damping { most, .. } = refused else {
            panic!("{refused}");
        };
        assert!(Kernel::new(ShaperKind::SmoothEi, &mode(most), 0.05).is_ok());
        assert!(Kernel::new(ShaperKind::SmoothEi, &mode(most + 0.001), 0.05).is_err());
    }

    #[test]
    fn unit_cells_grow_until_a_table_holds_the_kernels() {
        let kernel = Kernel::new(
            ShaperKind::SmoothZv,
            &Mode {
                frequency_hz: 20.0,
                damping: 0.0,
            },
            0.05,
        )
        .unwrap();
        // 0.796 periods of 50 ms are 398 samples at 10 kHz.
        assert_eq!(samples_per_cell(&[kernel], 10_000.0), 2.0);
        assert_eq!(samples_per_cell(&[kernel], 5_000.0), 1.0);
        assert_eq!(samples_per_cell(&[kernel, kernel], 10_000.0), 4.0);
    }
}
