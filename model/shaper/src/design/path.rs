//! Follows a solution of equations from where it is known to where it is wanted.
//!
//! The equations depend on a position `s` on a path, 0 to 1, along which damping and tolerance go from those of a
//! known solution to those asked for. From the solution at `s`, the start for the next one lies on its tangent, with
//! the curvature of the last step; Newton's method takes it to the solution there. A step counts only if Newton's
//! corrections shrink from the first on, and if the tangents at both its ends lead from one to the other. Then the
//! solution found is the continuation of the last one, and not another that happens to be near: next to a fold, where
//! another sheet of solutions begins, the tangents are steep and do not lead there. Otherwise half the step is tried,
//! until steps are so short that the branch itself ends.

use nalgebra::DVector;

use super::equations::Linearised;

/// Each correction must be smaller than the one before by at least this factor.
const CONTRACTION: f64 = 0.25;
/// Largest difference, as a fraction of a step, between its end and where the tangents at its two ends lead. On the
/// way into a fold the difference is 0.03 when the step is half of what is left; beyond the fold it is 0.3 and more.
const SAME_SHEET: f64 = 0.1;
/// Correction, in units of the unknowns, at which an intermediate solution is accurate enough: the error is its
/// square. At the end of the path one more correction follows; it leaves rounding errors only, and need therefore not
/// be smaller.
const SETTLED: f64 = 1e-5;
/// Largest number of rounds; Newton's method doubles the digits each time, so more would mean that it does not
/// converge.
const ROUNDS: usize = 12;
/// The end of a branch counts as found once the step is this short: six digits.
pub(super) const PRECISE: f64 = 1e-6;

/// A system of equations along a path.
pub(super) trait Branch {
    /// Values and derivatives of the equations at position `s` for these unknowns.
    fn linearised(&self, unknowns: &DVector<f64>, s: f64) -> Linearised;

    /// Scale of each unknown at position `s`: its distance from the next solution, or from where the equations
    /// degenerate. A correction is small if it is small in these units.
    fn units(&self, s: f64) -> DVector<f64>;

    /// Whether a solution is valid for the kind: its times are in order, and its amplitudes positive where they must
    /// be.
    fn is_valid(&self, unknowns: &DVector<f64>) -> bool;
}

/// Follows `branch` from a start near its solution at 0 up to 1, in steps of at most `longest`. It gives up when a
/// step of `shortest` fails.
///
/// # Errors
/// The position up to which the branch was followed, where it does not reach 1; 0 if there is no solution at 0.
pub(super) fn follow(
    branch: &impl Branch,
    start: DVector<f64>,
    longest: f64,
    shortest: f64,
) -> Result<DVector<f64>, f64> {
    let mut here = solve(branch, start, 0.0).ok_or(0.0)?;
    let (mut s, mut step) = (0.0, longest.min(1.0));
    // Change of the tangent, from the last step.
    let mut bend = DVector::zeros(here.unknowns.len());
    // After a failure the next step does not grow: towards the end of a branch every longer step would fail again.
    let mut may_grow = false;
    while s < 1.0 {
        let next = if s + step >= 1.0 { 1.0 } else { s + step };
        let ahead = next - s;
        let predicted = &here.unknowns + (&here.tangent + &bend * (ahead / 2.0)) * ahead;
        match solve(branch, predicted, next).filter(|found| same_sheet(&here, found, ahead, &branch.units(next))) {
            Some(solution) => {
                bend = (&solution.tangent - &here.tangent) / ahead;
                (here, s) = (solution, next);
                step = if may_grow { (2.0 * step).min(longest) } else { step };
                may_grow = true;
            }
            None if step > shortest => {
                step /= 2.0;
                may_grow = false;
            }
            None => return Err(s),
        }
    }
    Ok(here.unknowns)
}

/// A solution with its derivative along the path.
struct Solution {
    unknowns: DVector<f64>,
    tangent: DVector<f64>,
}

/// Whether two solutions, `step` apart, lie on one sheet: whether the mean of their tangents leads from one to the
/// other.
fn same_sheet(here: &Solution, there: &Solution, step: f64, units: &DVector<f64>) -> bool {
    let size = |vector: DVector<f64>| vector.component_div(units).norm();
    let way = &there.unknowns - &here.unknowns;
    let deviation = size(&way - (&here.tangent + &there.tangent) * (step / 2.0));
    // A deviation as small as Newton's remaining error does not count.
    deviation <= SAME_SHEET * size(way) || deviation <= SETTLED
}

/// Newton's method at one position: returns the valid solution to which it converges from `start`, with shrinking
/// corrections.
fn solve(branch: &impl Branch, start: DVector<f64>, s: f64) -> Option<Solution> {
    let units = branch.units(s);
    let mut unknowns = start;
    let mut before = f64::INFINITY;
    for _ in 0..ROUNDS {
        let Linearised { values, jacobian, path } = branch.linearised(&unknowns, s);
        let factors = jacobian.lu();
        let correction = factors.solve(&values)?;
        let size = correction.component_div(&units).amax();
        let was_settled = before <= SETTLED;
        if !(size <= CONTRACTION * before || was_settled) {
            return None;
        }
        if size <= before {
            unknowns -= correction;
        }
        if was_settled || (size <= SETTLED && s < 1.0) {
            let tangent = -factors.solve(&path)?;
            return branch.is_valid(&unknowns).then_some(Solution { unknowns, tangent });
        }
        before = size;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// The branch `x² = 1 − s/limit`, which ends in a fold at `limit`.
    struct Fold(f64);

    impl Branch for Fold {
        fn linearised(&self, x: &DVector<f64>, s: f64) -> Linearised {
            Linearised {
                values: DVector::from_element(1, x[0] * x[0] - 1.0 + s / self.0),
                jacobian: DMatrix::from_element(1, 1, 2.0 * x[0]),
                path: DVector::from_element(1, 1.0 / self.0),
            }
        }

        fn units(&self, _: f64) -> DVector<f64> {
            DVector::from_element(1, 1.0)
        }

        fn is_valid(&self, x: &DVector<f64>) -> bool {
            x[0].is_finite()
        }
    }

    #[test]
    fn follows_the_branch_that_it_starts_on() {
        for sign in [1.0, -1.0] {
            let start = DVector::from_element(1, 1.1 * sign);
            let found = follow(&Fold(1.25), start, 1.0, PRECISE).unwrap();
            assert!((found[0] - sign * 0.2f64.sqrt()).abs() < 1e-15);
        }
    }

    /// The branch `x³ − x/4 = s − 1/2`, a horizontal S: the sheet from `s = 0` ends below 0.55, where another has
    /// long begun.
    struct Cubic;

    impl Branch for Cubic {
        fn linearised(&self, x: &DVector<f64>, s: f64) -> Linearised {
            Linearised {
                values: DVector::from_element(1, x[0].powi(3) - x[0] / 4.0 - s + 0.5),
                jacobian: DMatrix::from_element(1, 1, 3.0 * x[0] * x[0] - 0.25),
                path: DVector::from_element(1, -1.0),
            }
        }

        fn units(&self, _: f64) -> DVector<f64> {
            DVector::from_element(1, 1.0)
        }

        fn is_valid(&self, x: &DVector<f64>) -> bool {
            x[0].is_finite()
        }
    }

    #[test]
    fn does_not_leap_over_a_fold() {
        let fold = 0.5 + 1.0 / (6.0 * 12f64.sqrt());
        for longest in [1.0, 0.7, 0.5, 0.3, 0.1, 0.03] {
            let ended = follow(&Cubic, DVector::from_element(1, -0.9), longest, PRECISE).unwrap_err();
            assert!((ended - fold).abs() < 1e-5, "{longest}: {ended}");
        }
    }

    #[test]
    fn reports_where_a_branch_ends() {
        let ended = follow(&Fold(0.4), DVector::from_element(1, 1.0), 1.0, PRECISE).unwrap_err();
        assert!((ended - 0.4).abs() < 1e-5, "{ended}");
    }
}
