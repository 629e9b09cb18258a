//! Negative shapers: `um-zv um-zvd um-ei` and `ps-zv ps-zvd ps-ei`.
//!
//! The impulses alternate in sign. Their amplitudes are given and their times are solved for (Singhose, Singer and
//! Seering 1994; the `ps` kinds are the NZV, NZVD and NEI of the negative-impulse paper). They are a third to a fifth
//! shorter than their positive counterparts; the price is some insensitivity, and a command that swings back:
//!
//! ```text
//! um (unity magnitude):   1, −1, 1, …     partial sums 0 … 1
//! ps (partial sum):       1, −2, 2, …     partial sums −1 … 1
//!
//! -zv    3 impulses   R(1) = 0                                                    t_2 t_3
//! -zvd   5 impulses   R(1) = 0, R′(1) = 0                                         t_2 … t_5
//! -ei    5 impulses   R(w_lo) = R(w_hi) = 0, |R(1)| = V, d|R|/dw(1) = 0           t_2 … t_5, w_lo, w_hi
//! ```
//!
//! (`R`: `equations.rs`.) There are many solutions. These are the shortest known, followed from the undamped one
//! along damping and tolerance (`path.rs`). The published cubic fits in the damping are off by 1e-4 to 4e-4 of a
//! period and not used: with amplitudes whose magnitudes sum to 5 to 9, a shaper needs its times to the last digit.

use nalgebra::DVector;

use super::DesignError;
use super::equations::{Equations, Linearised, Point, Ratio};
use super::hump_ei::TOLERANCE_MIN;
use super::kind::{Design, KindRow, Promise, ShaperKind};
use super::path::{Branch, PRECISE, follow};
use crate::analysis::residual_vibration;
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// `um-zv`.
pub(super) const UM_ZV: KindRow = row(
    "um-zv",
    Promise::Zero,
    "`zv` with impulses 1, −1, 1: shorter, a command that swings back",
);

/// `um-zvd`.
pub(super) const UM_ZVD: KindRow = row("um-zvd", Promise::Zero, "`zvd` with impulses 1, −1, 1, −1, 1");

/// `um-ei`.
pub(super) const UM_EI: KindRow = row("um-ei", Promise::Tolerance, "`ei` with impulses 1, −1, 1, −1, 1");

/// `ps-zv`.
pub(super) const PS_ZV: KindRow = row("ps-zv", Promise::Zero, "`zv` with impulses 1, −2, 2: shorter still");

/// `ps-zvd`.
pub(super) const PS_ZVD: KindRow = row("ps-zvd", Promise::Zero, "`zvd` with impulses 1, −2, 2, −2, 2");

/// `ps-ei`.
pub(super) const PS_EI: KindRow = row("ps-ei", Promise::Tolerance, "`ei` with impulses 1, −2, 2, −2, 2");

const fn row(name: &'static str, promise: Promise, about: &'static str) -> KindRow {
    let design = Design::Mode(|kind, mode, settings| design(kind, mode, settings.tolerance));
    KindRow::new(name, promise, design, about).source("Singhose, Singer and Seering 1994")
}

/// Largest damping ratio of the family.
pub const DAMPING_MAX: f64 = 0.4;
/// The tolerances of `um-ei` and `ps-ei` lie below this value.
pub const TOLERANCE_BELOW: f64 = 0.5;

/// Tolerance of the undamped solutions from which the others are followed.
const START_TOLERANCE: f64 = 0.05;
/// Longest step in the damping ratio and in the root of the tolerance.
const LONGEST_STEP: f64 = 0.1;
/// Largest deviation of the finished shaper from its zeros and its hump.
const VERIFIED: f64 = 1e-9;

/// Designs a negative shaper; only `um-ei` and `ps-ei` use `tolerance`.
///
/// # Errors
/// [`DesignError::Damping`] above [`DAMPING_MAX`]; [`DesignError::Tolerance`] below 1e-6 or from [`TOLERANCE_BELOW`] on;
/// [`DesignError::OtherFamily`] for a kind of another family.
pub fn design(kind: ShaperKind, mode: &Mode, tolerance: f64) -> Result<ImpulseSequence, DesignError> {
    DesignError::check_mode(mode)?;
    let Some(family) = Family::of(kind) else {
        return Err(DesignError::OtherFamily { kind });
    };
    if mode.damping > DAMPING_MAX {
        return Err(DesignError::Damping {
            kind,
            mode: *mode,
            most: DAMPING_MAX,
            instead: family.positive,
        });
    }
    let tolerance = if family.condition == Condition::Hump {
        if !(TOLERANCE_MIN..TOLERANCE_BELOW).contains(&tolerance) {
            return Err(DesignError::Tolerance {
                kind,
                mode: *mode,
                tolerance,
                least: TOLERANCE_MIN,
                most: TOLERANCE_BELOW,
            });
        }
        tolerance
    } else {
        START_TOLERANCE
    };
    let path = Path {
        family: &family,
        damping: mode.damping,
        root_change: tolerance.sqrt() - START_TOLERANCE.sqrt(),
    };
    let longest = LONGEST_STEP / mode.damping.max(path.root_change.abs()).max(LONGEST_STEP);
    let start = DVector::from_column_slice(family.undamped);
    let unknowns = follow(&path, start, longest, PRECISE).map_err(|reached| DesignError::NotSolved {
        kind,
        mode: *mode,
        reached,
    })?;
    let times = family.times(unknowns.as_slice());
    let impulses = times.iter().zip(family.amplitudes).map(|(time, &amplitude)| Impulse {
        time_s: time / mode.frequency_hz,
        amplitude,
    });
    let impulses =
        ImpulseSequence::new(impulses.collect()).map_err(|cause| DesignError::no_sequence(kind, mode, cause))?;
    for &zero in &unknowns.as_slice()[times.len() - 1..] {
        let found = residual_vibration(impulses.impulses(), &mode.scaled(zero));
        DesignError::verify(kind, mode, found, 0.0, VERIFIED)?;
    }
    Ok(impulses)
}

/// Condition on the residual at the mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Condition {
    Zero,
    StationaryZero,
    Hump,
}

/// Data of a kind: its given amplitudes, and its undamped solution.
#[derive(Debug, Clone, Copy)]
struct Family {
    condition: Condition,
    amplitudes: &'static [f64],
    /// Times in periods after the first, then the zeros of an EI at 5 %: accurate enough for Newton's method to find
    /// all digits.
    undamped: &'static [f64],
    /// The kind with positive amplitudes that meets the same conditions.
    positive: ShaperKind,
}

const UM_3: &[f64] = &[1.0, -1.0, 1.0];
const UM_5: &[f64] = &[1.0, -1.0, 1.0, -1.0, 1.0];
const PS_3: &[f64] = &[1.0, -2.0, 2.0];
const PS_5: &[f64] = &[1.0, -2.0, 2.0, -2.0, 2.0];

impl Family {
    fn of(kind: ShaperKind) -> Option<Self> {
        let (condition, amplitudes, undamped, positive): (_, _, &[f64], _) = match kind {
            ShaperKind::UmZv => (Condition::Zero, UM_3, &[0.1667, 0.3333], ShaperKind::Zv),
            ShaperKind::PsZv => (Condition::Zero, PS_3, &[0.2098, 0.2902], ShaperKind::Zv),
            ShaperKind::UmZvd => (
                Condition::StationaryZero,
                UM_5,
                &[0.08951, 0.36623, 0.64296, 0.73247],
                ShaperKind::Zvd,
            ),
            ShaperKind::PsZvd => (
                Condition::StationaryZero,
                PS_5,
                &[0.15241, 0.27740, 0.63131, 0.67895],
                ShaperKind::Zvd,
            ),
            ShaperKind::UmEi => (
                Condition::Hump,
                UM_5,
                &[0.09408, 0.36837, 0.64266, 0.73673, 0.87037, 1.12276],
                ShaperKind::Ei,
            ),
            ShaperKind::PsEi => (
                Condition::Hump,
                PS_5,
                &[0.15668, 0.28118, 0.63434, 0.68416, 0.87241, 1.11969],
                ShaperKind::Ei,
            ),
            _ => return None,
        };
        Some(Self {
            condition,
            amplitudes,
            undamped,
            positive,
        })
    }

    /// All times in periods, the first included.
    fn times(&self, unknowns: &[f64]) -> Vec<f64> {
        let times = unknowns.iter().take(self.amplitudes.len() - 1);
        [0.0].into_iter().chain(times.copied()).collect()
    }
}

/// The path from the undamped solution at [`START_TOLERANCE`] to the wanted one. It is straight in the damping and in
/// the root of the tolerance, in which the zeros move evenly.
struct Path<'a> {
    family: &'a Family,
    damping: f64,
    root_change: f64,
}

impl Branch for Path<'_> {
    fn linearised(&self, unknowns: &DVector<f64>, s: f64) -> Linearised {
        let root = START_TOLERANCE.sqrt() + s * self.root_change;
        let point = Point {
            damping: s * self.damping,
            tolerance: root * root,
            damping_rate: self.damping,
            tolerance_rate: 2.0 * root * self.root_change,
        };
        let times = self.family.times(unknowns.as_slice());
        let mode = Ratio::Fixed(1.0);
        let equations = Equations::new(self.family.amplitudes, &times, false, point, unknowns.len());
        let equations = match self.family.condition {
            Condition::Zero => equations.zero(mode),
            Condition::StationaryZero => equations.stationary_zero(),
            Condition::Hump => {
                let [low, high] = [4, 5].map(|index| unknowns[index]);
                equations
                    .zero(Ratio::Free(low, 0))
                    .zero(Ratio::Free(high, 1))
                    .hump(mode)
            }
        };
        equations.finish()
    }

    /// As the tolerance goes to 0, the differences from `-zvd` do too; those of the zeros with its root.
    fn units(&self, s: f64) -> DVector<f64> {
        let root = START_TOLERANCE.sqrt() + s * self.root_change;
        let times = self.family.amplitudes.len() - 1;
        DVector::from_fn(self.family.undamped.len(), |row, _| match self.family.condition {
            Condition::Hump if row < times => root * root,
            Condition::Hump => root,
            Condition::Zero | Condition::StationaryZero => 1.0,
        })
    }

    fn is_valid(&self, unknowns: &DVector<f64>) -> bool {
        let times = self.family.times(unknowns.as_slice());
        let ordered = times.windows(2).all(|pair| pair[0] < pair[1]);
        let zeros = &unknowns.as_slice()[times.len() - 1..];
        let either_side = zeros.is_empty() || (0.0 < zeros[0] && zeros[0] < 1.0 && zeros[1] > 1.0);
        ordered && either_side
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [ShaperKind; 6] = [
        ShaperKind::UmZv,
        ShaperKind::UmZvd,
        ShaperKind::UmEi,
        ShaperKind::PsZv,
        ShaperKind::PsZvd,
        ShaperKind::PsEi,
    ];

    fn mode(damping: f64) -> Mode {
        Mode {
            frequency_hz: 1.0,
            damping,
        }
    }

    #[test]
    fn undamped_closed_forms() {
        let times = |kind| -> Vec<f64> {
            let impulses = design(kind, &mode(0.0), 0.05).unwrap();
            impulses.impulses().iter().skip(1).map(|i| i.time_s).collect()
        };
        let acos = |cosine: f64| cosine.acos() / std::f64::consts::TAU;
        for (kind, expected) in [
            (ShaperKind::UmZv, [1.0 / 6.0, 1.0 / 3.0]),
            (ShaperKind::PsZv, [acos(0.25), acos(-0.25)]),
        ] {
            for (found, expected) in times(kind).iter().zip(expected) {
                assert!((found - expected).abs() < 1e-15, "{kind}");
            }
        }
        // Unit amplitudes without damping are symmetric.
        let [a, b, c, d] = times(ShaperKind::UmZvd)[..] else {
            panic!("five impulses");
        };
        assert!((2.0 * b - d).abs() < 1e-14 && (a + c - d).abs() < 1e-14);
    }

    #[test]
    fn designs_exist_for_all_dampings_and_tolerances() {
        for kind in KINDS {
            for damping in [0.0, 1e-12, 0.1, 0.25, 0.4] {
                for tolerance in [TOLERANCE_MIN, 1e-4, 0.05, 0.3, 0.4999999] {
                    let found = design(kind, &mode(damping), tolerance);
                    assert!(found.is_ok(), "{kind} {damping} {tolerance}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn short_steps_lead_to_the_same_solution() {
        for kind in KINDS {
            let family = Family::of(kind).unwrap();
            for tolerance in [1e-3f64, 0.49] {
                let path = Path {
                    family: &family,
                    damping: 0.4,
                    root_change: tolerance.sqrt() - START_TOLERANCE.sqrt(),
                };
                let along =
                    |longest| follow(&path, DVector::from_column_slice(family.undamped), longest, PRECISE).unwrap();
                assert!((along(0.25) - along(0.002)).amax() < 1e-11, "{kind} {tolerance}");
            }
        }
    }

    #[test]
    fn outside_the_range_the_error_names_it_and_an_alternative() {
        for kind in KINDS {
            let error = design(kind, &mode(0.41), 0.05).unwrap_err().to_string();
            assert!(
                error.contains("0.4") && error.contains("use \"z") || error.contains("use \"ei\""),
                "{error}"
            );
        }
        for tolerance in [0.0, -0.1, 1e-7, 0.5, 0.9, f64::NAN, f64::INFINITY] {
            for kind in [ShaperKind::UmEi, ShaperKind::PsEi] {
                assert!(matches!(
                    design(kind, &mode(0.1), tolerance),
                    Err(DesignError::Tolerance { .. })
                ));
            }
            // The other kinds ignore the tolerance.
            assert!(design(ShaperKind::PsZv, &mode(0.1), tolerance).is_ok());
        }
    }
}
