//! Extra insensitive: `ei`, exact for damping.
//!
//! Three impulses that leave the tolerated residual at the mode itself and none a little below and above it, which is why
//! the frequency may be off further than for `zvd`, in the same time (Singhose, Seering and Singer 1994). With the pole sum
//! `S(w) = Σ A_i e^{(ζ + j√(1−ζ²)) w t_i}` at frequency ratio `w`:
//!
//! ```text
//! S(w_lo) = 0,  S(w_hi) = 0,  V(1) = tolerance,  dV/dw(1) = 0          A_1 + A_2 + A_3 = 1,  t_1 = 0
//! undamped: A = [(1+V)/4, (1−V)/2, (1+V)/4] at 0, T/2, T
//! ```
//!
//! Six equations for `A_1 A_3 t_2 t_3 w_lo w_hi`, solved by Newton's method along the damping from the closed form at 0.
//! The published fits are not used: theirs is a residual of 4.88 to 5.04 % where 5 % is asked for.
//!
//! As the tolerance goes to 0, `ei` becomes `zvd`, and the two zeros one double zero: the system becomes singular. So the
//! unknowns are the distances from `zvd`, in units that go to 0 with the tolerance.

use std::f64::consts::{PI, TAU};

use nalgebra::{Complex, DVector};

use super::DesignError;
use super::kind::Kind;
use super::newton;
use crate::analysis::INSENSITIVITY_LIMIT;
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// Smallest tolerance that is solved for; below it, the shaper is `zvd` to six digits.
pub const TOLERANCE_MIN: f64 = 1e-6;
/// Largest tolerance that is solved for; at 1 nothing is left to shape.
pub const TOLERANCE_MAX: f64 = 0.9;

/// First step along the damping, and the step at which the end of the family counts as found.
const FIRST_STEP: f64 = 0.1;
const LAST_STEP: f64 = 1e-5;

/// An `ei` shaper.
#[derive(Debug, Clone, PartialEq)]
pub struct Ei {
    /// The three impulses.
    pub impulses: ImpulseSequence,
    /// Frequency ratios at which nothing rings: below and above 1.
    pub zeros: [f64; 2],
}

/// Designs an `ei` shaper that leaves `tolerance` at the mode.
///
/// # Errors
/// [`DesignError::Tolerance`] outside [`TOLERANCE_MIN`]..=[`TOLERANCE_MAX`]; [`DesignError::NoSolution`] above the damping
/// at which the solution ends, an amplitude becomes negative, two impulses meet, or the upper zero leaves for beyond ten
/// times the mode (0.66 at 5 %, 0.43 at 20 %).
pub fn design(mode: &Mode, tolerance: f64) -> Result<Ei, DesignError> {
    DesignError::check_mode(mode)?;
    if !(TOLERANCE_MIN..=TOLERANCE_MAX).contains(&tolerance) {
        return Err(DesignError::Tolerance {
            kind: Kind::Ei,
            mode: *mode,
            tolerance,
            least: TOLERANCE_MIN,
            most: TOLERANCE_MAX,
        });
    }
    let shape = solve(mode.damping, tolerance).map_err(|largest_damping| DesignError::NoSolution {
        kind: Kind::Ei,
        mode: *mode,
        tolerance,
        largest_damping,
        largest_tolerance: None,
    })?;
    let period_s = 1.0 / mode.frequency_hz;
    let impulses = (0..3).map(|i| Impulse {
        time_s: shape.periods[i] * period_s,
        amplitude: shape.amplitudes[i],
    });
    Ok(Ei {
        impulses: ImpulseSequence::new(impulses.collect())
            .map_err(|cause| DesignError::no_sequence(Kind::Ei, mode, cause))?,
        zeros: shape.zeros,
    })
}

/// A shaper of a mode with undamped period 1.
#[derive(Debug, Clone, Copy)]
struct Shape {
    amplitudes: [f64; 3],
    periods: [f64; 3],
    zeros: [f64; 2],
}

/// The family at one damping and tolerance: how unknowns become a shape, and what the shape has to fulfil.
struct Family {
    damping: f64,
    tolerance: f64,
    /// Half distance of the zeros at damping 0: the unit that goes to 0 with the tolerance.
    spread: f64,
}

/// Follows the solution from damping 0; the error is the damping up to which it exists.
fn solve(damping: f64, tolerance: f64) -> Result<Shape, f64> {
    let spread = ((1.0 - tolerance) / (1.0 + tolerance)).acos() / PI;
    let at = |damping| Family {
        damping,
        tolerance,
        spread,
    };
    let excess = tolerance / 4.0 / (spread * spread);
    let mut unknowns = DVector::from_row_slice(&[excess, excess, 0.0, 0.0, 0.0, 1.0]);
    let mut reached = 0.0;
    let mut step: f64 = FIRST_STEP;
    while reached < damping {
        let next = (reached + step).min(damping);
        match at(next).refine(&unknowns) {
            Some(refined) => {
                (unknowns, reached) = (refined, next);
            }
            None if step > LAST_STEP => step /= 2.0,
            None => return Err(reached),
        }
    }
    Ok(at(damping).shape(&unknowns))
}

impl Family {
    /// Unknowns: amplitudes 1 and 3 and times 2 and 3 less those of `zvd`, in units of `spread²`; centre of the zeros less
    /// 1, and their half distance, in units of `spread`.
    fn shape(&self, unknowns: &DVector<f64>) -> Shape {
        let sine = (1.0 - self.damping * self.damping).sqrt();
        let ratio = (-PI * self.damping / sine).exp();
        let sum = (1.0 + ratio) * (1.0 + ratio);
        let unit = self.spread * self.spread;
        let first = 1.0 / sum + unit * unknowns[0];
        let third = ratio * ratio / sum + unit * unknowns[1];
        let centre = 1.0 + self.spread * unknowns[4];
        let half = self.spread * unknowns[5];
        Shape {
            amplitudes: [first, 1.0 - first - third, third],
            periods: [0.0, 0.5 / sine + unit * unknowns[2], 1.0 / sine + unit * unknowns[3]],
            zeros: [centre - half, centre + half],
        }
    }

    /// The solution next to `start`, if it is one with positive amplitudes in order of time.
    fn refine(&self, start: &DVector<f64>) -> Option<DVector<f64>> {
        // The equations are relative to the tolerance, whose last digits rounding takes.
        let accuracy = 1e-13 / self.tolerance + 1e-11;
        let found = newton::solve(|x| self.equations(&self.shape(x)), start.clone(), accuracy)?;
        let Shape {
            amplitudes,
            periods,
            zeros,
        } = self.shape(&found);
        let positive = amplitudes.iter().all(|a| *a > 0.0);
        let ordered = periods.windows(2).all(|p| p[0] < p[1]);
        let either_side = 0.0 < zeros[0] && zeros[0] < 1.0 && (1.0..INSENSITIVITY_LIMIT).contains(&zeros[1]);
        (positive && ordered && either_side).then_some(found)
    }

    /// The six equations, each of order one for a distance of order one from the solution.
    fn equations(&self, shape: &Shape) -> DVector<f64> {
        let pole = TAU * Complex::new(self.damping, (1.0 - self.damping * self.damping).sqrt());
        let [_, _, end] = shape.periods;
        // Referred to the last impulse, as the residual is: nothing grows.
        let terms = |ratio: f64| {
            (0..3).map(move |i| {
                let exponent = pole * (ratio * shape.periods[i]) - pole.re * ratio * end;
                (
                    exponent.exp() * shape.amplitudes[i],
                    pole * shape.periods[i] - pole.re * end,
                )
            })
        };
        let sum = |ratio: f64| terms(ratio).map(|(term, _)| term).sum::<Complex<f64>>();
        let unit = self.spread * self.spread;
        let low = sum(shape.zeros[0]) / unit;
        let high = sum(shape.zeros[1]) / unit;
        let middle = sum(1.0);
        let slope: Complex<f64> = terms(1.0).map(|(term, rate)| term * rate).sum();
        let power_slope = 2.0 * (middle.conj() * slope).re;
        DVector::from_row_slice(&[
            low.re,
            low.im,
            high.re,
            high.im,
            middle.norm() / self.tolerance - 1.0,
            power_slope * self.spread / (self.tolerance * self.tolerance),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::residual_vibration;

    #[test]
    fn unit_undamped_is_the_closed_form() {
        let mode = Mode {
            frequency_hz: 4.0,
            damping: 0.0,
        };
        let ei = design(&mode, 0.05).unwrap();
        let found: Vec<(f64, f64)> = ei.impulses.impulses().iter().map(|i| (i.time_s, i.amplitude)).collect();
        for (found, expected) in found.iter().zip([(0.0, 0.2625), (0.125, 0.475), (0.25, 0.2625)]) {
            assert!((found.0 - expected.0).abs() < 1e-15 && (found.1 - expected.1).abs() < 1e-15);
        }
    }

    #[test]
    fn unit_small_tolerances_approach_zvd() {
        let mode = Mode {
            frequency_hz: 1.0,
            damping: 0.2,
        };
        let zvd = crate::design::zv::design(Kind::Zvd, &mode, 2).unwrap();
        let ei = design(&mode, TOLERANCE_MIN).unwrap();
        for (a, b) in zvd.impulses().iter().zip(ei.impulses.impulses()) {
            assert!((a.amplitude - b.amplitude).abs() < 1e-5 && (a.time_s - b.time_s).abs() < 1e-5);
        }
        assert!((residual_vibration(ei.impulses.impulses(), &mode) - TOLERANCE_MIN).abs() < 1e-12);
    }

    #[test]
    fn unit_beyond_its_damping_the_family_names_where_it_ends() {
        let mode = Mode {
            frequency_hz: 1.0,
            damping: 0.7,
        };
        let Err(DesignError::NoSolution { largest_damping, .. }) = design(&mode, 0.05) else {
            panic!("no ei leaves 5 % at damping 0.7");
        };
        assert!((0.65..0.66).contains(&largest_damping), "{largest_damping}");
        let at = |damping| design(&Mode { damping, ..mode }, 0.05);
        assert!(at(largest_damping).is_ok());
        assert!(at(largest_damping + 1e-4).is_err());
    }

    #[test]
    fn unit_largest_damping_by_tolerance_is_as_documented() {
        let documented = [(0.01, 0.80), (0.05, 0.65), (0.1, 0.56), (0.2, 0.43), (0.3, 0.33)];
        for (tolerance, largest) in documented {
            assert!(solve(largest, tolerance).is_ok(), "{tolerance}");
            assert!(solve(largest + 0.01, tolerance).is_err(), "{tolerance}");
        }
    }

    #[test]
    fn unit_tolerances_outside_the_range_are_errors() {
        let mode = Mode {
            frequency_hz: 1.0,
            damping: 0.1,
        };
        for tolerance in [0.0, -0.05, 1e-7, 0.95, 1.0, 1e300, f64::NAN, f64::INFINITY] {
            assert!(matches!(design(&mode, tolerance), Err(DesignError::Tolerance { .. })));
        }
    }
}
