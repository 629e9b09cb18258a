//! `periodic`: one undamped shaper for many modes, by the periodicity of its residual.
//!
//! The residual of impulses at `kπ/ω_sys` repeats with `2ω_sys`. The bound that a base shaper keeps round `ω_sys`
//! therefore holds round its odd multiples too, with the same absolute width (Zhang and Li 2010, section 3.2). A base
//! with the one-sided relative width `λ` serves the mode `ω_i` if, for some `n ≥ 0`,
//!
//! ```text
//! ω_i / (2n + 1 + λ) ≤ ω_sys ≤ ω_i / (2n + 1 − λ)
//! ```
//!
//! For each mode these are disjoint intervals; the intersection over all modes, down to the lowest frequency, is the
//! complete list of solutions. The largest frequency of the list is chosen: it gives the shortest shaper. `ω_i` is
//! the damped frequency. The amplitudes are those for undamped modes, so each mode's residual is checked.
//!
//! Limits: at most [`MULTIPLES_MAX`] odd multiples per mode are searched; no ring buffer holds a longer shaper.

use super::bias_point::{self, BiasPoint};
use super::joint_error::{JointError, check_distinct};
use super::kind::{Design, KindRow, Promise, ShaperKind};
use super::{DesignError, Findings};
use crate::analysis::residual_vibration;
use crate::axis::{DEFAULT_CHEBYSHEV_ORDER, DEFAULT_TOLERANCE, ShapedAxis};
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// `periodic`.
pub(super) const PERIODIC: KindRow = KindRow::new(
    "periodic",
    Promise::Unsaid,
    Design::Axis(|axis, _| design_axis(axis)),
    "`base` at a common frequency; each mode's frequency is nearly an odd multiple of it",
)
.source("Zhang and Li 2010")
.keys(&["base", "lowest_frequency_hz"]);

/// The kinds that can be the base.
pub const BASES: [ShaperKind; 3] = [ShaperKind::ZvEi, ShaperKind::MultiEi, ShaperKind::ChebyshevEi];

/// Largest number of odd multiples per mode that are searched.
pub const MULTIPLES_MAX: u32 = 16_384;

/// The base that `periodic` repeats: kind, order of `chebyshev-ei`, tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Base {
    /// Kind of the base: `zv-ei`, `multi-ei` or `chebyshev-ei`.
    pub kind: ShaperKind,
    /// Zero pairs of `chebyshev-ei`.
    pub order: u32,
    /// Residual at the edges of the base's width.
    pub tolerance: f64,
}

/// An interval of frequencies that serve all modes.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Lower end in Hz.
    pub low_hz: f64,
    /// Upper end in Hz.
    pub high_hz: f64,
    /// For each mode, in the order of the file, the `n` of its odd multiple `2n + 1`.
    pub n: Vec<u32>,
}

/// A periodic shaper.
#[derive(Debug, Clone, PartialEq)]
pub struct Periodic {
    /// Impulses at multiples of `1/(2 · system_hz)`.
    pub impulses: ImpulseSequence,
    /// The frequency that was chosen: the upper end of the first solution.
    pub system_hz: f64,
    /// One-sided relative width of the base.
    pub lambda: f64,
    /// All solutions, the largest frequency first.
    pub solutions: Vec<Solution>,
}

/// Designs the shaper of an axis by the keys of the machine file.
fn design_axis(axis: ShapedAxis<'_>) -> Result<(ImpulseSequence, Findings), DesignError> {
    let given = axis.shaper;
    let base = Base {
        kind: given.and_then(|s| s.base).unwrap_or(ShaperKind::MultiEi),
        order: given.and_then(|s| s.order).unwrap_or(DEFAULT_CHEBYSHEV_ORDER),
        tolerance: given.and_then(|s| s.tolerance).unwrap_or(DEFAULT_TOLERANCE),
    };
    let modes: Vec<(Mode, f64)> = axis.modes.iter().map(|m| (m.mode, axis.tolerance_of(m))).collect();
    let found = design(&modes, base, axis.lowest_frequency_hz())?;
    Ok((found.impulses.clone(), Findings::Periodic(found)))
}

/// Designs the shortest periodic shaper whose frequency is at least `lowest_hz`; each mode comes with its tolerance.
///
/// # Errors
/// [`JointError::Base`] for another base; [`JointError::NoPeriodicSolution`] and [`JointError::SearchRange`] from the
/// search; [`JointError::AboveTolerance`] for a mode whose damping raises its residual above its tolerance;
/// [`DesignError`] for an invalid mode or an invalid base.
pub fn design(modes: &[(Mode, f64)], base: Base, lowest_hz: f64) -> Result<Periodic, DesignError> {
    let plain: Vec<Mode> = modes.iter().map(|(mode, _)| *mode).collect();
    plain.iter().try_for_each(DesignError::check_mode)?;
    check_distinct(&plain)?;
    if !BASES.contains(&base.kind) {
        return Err(JointError::Base(base.kind).into());
    }
    let BiasPoint { amplitudes, lambda, .. } = bias_point::undamped(base.kind, base.order, base.tolerance)?;
    let damped_hz: Vec<f64> = plain.iter().map(Mode::damped_frequency_hz).collect();
    let solutions = search(&damped_hz, lambda, lowest_hz)?;
    let Some(system_hz) = solutions.first().map(|s| s.high_hz) else {
        return Err(JointError::NoPeriodicSolution { lowest_hz, lambda }.into());
    };
    let impulses = amplitudes.iter().enumerate().map(|(index, &amplitude)| Impulse {
        time_s: index as f64 / (2.0 * system_hz),
        amplitude,
    });
    let impulses = ImpulseSequence::new(impulses.collect()).map_err(|cause| DesignError::NoSequence {
        what: format!("shaper \"{}\" at {system_hz} Hz", ShaperKind::Periodic),
        cause,
    })?;
    for &(mode, tolerance) in modes {
        let found = residual_vibration(impulses.impulses(), &mode);
        // The residual at the edge of the width equals the tolerance, so rounding there is no excess; insensitivity
        // does the same.
        if found.is_nan() || found > tolerance * (1.0 + 1e-6) {
            return Err(JointError::AboveTolerance { mode, found, tolerance }.into());
        }
    }
    Ok(Periodic {
        impulses,
        system_hz,
        lambda,
        solutions,
    })
}

/// Returns all frequencies `f` from `lowest_hz` up for which every mode's frequency is at most `lambda · f` away from an
/// odd multiple of `f`.
///
/// `lambda` lies in (0, 1). The list is complete and has the largest first; an interval that reaches below
/// `lowest_hz` ends there. Time and memory grow with the sum of `frequency / lowest_hz`.
///
/// # Errors
/// [`JointError::SearchRange`] where that is more than [`MULTIPLES_MAX`] multiples for a mode.
pub fn search(frequencies_hz: &[f64], lambda: f64, lowest_hz: f64) -> Result<Vec<Solution>, JointError> {
    let highest_hz = frequencies_hz.iter().fold(0.0, |most: f64, f| most.max(*f));
    let least_hz = highest_hz / f64::from(2 * MULTIPLES_MAX);
    if lowest_hz.is_nan() || lowest_hz < least_hz {
        return Err(JointError::SearchRange {
            lowest_hz,
            most: MULTIPLES_MAX,
            least_hz,
        });
    }
    let mut left = vec![Solution {
        low_hz: lowest_hz,
        high_hz: f64::INFINITY,
        n: Vec::new(),
    }];
    for &frequency_hz in frequencies_hz {
        left = intersect(&left, frequency_hz, lambda);
    }
    // Without a mode nothing limits the frequency, so there is no solution either.
    Ok(left.into_iter().filter(|s| s.high_hz.is_finite()).collect())
}

/// Intersects intervals, the largest first, with those of one more mode. Both lists are walked once.
fn intersect(left: &[Solution], frequency_hz: f64, lambda: f64) -> Vec<Solution> {
    let mut cut = Vec::new();
    let mut first_n = 0;
    for solution in left {
        let bounds = |n: u32| {
            let multiple = f64::from(2 * n + 1);
            (frequency_hz / (multiple + lambda), frequency_hz / (multiple - lambda))
        };
        // An interval of the mode may serve the next solution too, so the walk continues from the first one that
        // reached so far down.
        while first_n <= MULTIPLES_MAX && bounds(first_n).0 > solution.high_hz {
            first_n += 1;
        }
        let reaching = (first_n..=MULTIPLES_MAX).take_while(|n| bounds(*n).1 >= solution.low_hz);
        cut.extend(reaching.map(|n| {
            let (low_hz, high_hz) = bounds(n);
            Solution {
                low_hz: low_hz.max(solution.low_hz),
                high_hz: high_hz.min(solution.high_hz),
                n: solution.n.iter().copied().chain([n]).collect(),
            }
        }));
    }
    cut
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absurd_limits_end_in_errors_and_not_in_time() {
        for lowest_hz in [0.0, -1.0, 1e-300, f64::NAN, f64::MIN_POSITIVE] {
            assert!(matches!(
                search(&[10.0, 35.0], 0.48, lowest_hz),
                Err(JointError::SearchRange { .. })
            ));
        }
        assert_eq!(search(&[10.0, 35.0], 0.48, f64::INFINITY), Ok(Vec::new()));
        assert_eq!(search(&[], 0.48, 1.0), Ok(Vec::new()));
        assert!(search(&[10.0, 35.0], 0.48, 35.0 / 32768.0).is_ok());
    }

    #[test]
    fn intervals_that_reach_below_the_limit_end_there() {
        let found = search(&[10.0], 0.5, 3.0).unwrap();
        let expected = [(10.0 / 1.5, 20.0, 0), (3.0, 4.0, 1)];
        assert_eq!(found.len(), 2);
        for (solution, (low_hz, high_hz, n)) in found.iter().zip(expected) {
            assert_eq!(
                (solution.low_hz, solution.high_hz, &solution.n[..]),
                (low_hz, high_hz, &[n][..])
            );
        }
    }
}
