//! Newton's method for a small square system, with the Jacobian of the caller or from central differences.
//!
//! The unknowns are scaled to order one and number ten or so at most, so the Jacobian is cheap and differences are
//! accurate enough: the steps still end at rounding level, because the equations themselves are exact.

use nalgebra::{DMatrix, DVector};

/// Half width of the central differences, at which truncation and rounding are about equal.
const DIFFERENCE: f64 = 6e-6;
/// Largest number of rounds. Newton's method doubles the digits each time; from a neighbouring solution it needs four
/// or five rounds.
const ROUNDS: usize = 30;

/// Solves `equations(x) = 0` from a start near the solution, with the Jacobian from central differences. `None` if it
/// does not get every equation below `accuracy`.
pub(super) fn solve(
    equations: impl Fn(&DVector<f64>) -> DVector<f64>,
    start: DVector<f64>,
    accuracy: f64,
) -> Option<DVector<f64>> {
    solve_with(&equations, |x| differences(&equations, x), start, accuracy)
}

/// As [`solve`], with the derivatives of the equations: a row per equation, a column per unknown.
pub(super) fn solve_with(
    equations: impl Fn(&DVector<f64>) -> DVector<f64>,
    jacobian: impl Fn(&DVector<f64>) -> DMatrix<f64>,
    start: DVector<f64>,
    accuracy: f64,
) -> Option<DVector<f64>> {
    let mut best = start;
    let mut values = equations(&best);
    for _ in 0..ROUNDS {
        let next = &best - jacobian(&best).lu().solve(&values)?;
        let next_values = equations(&next);
        let (error, next_error) = (largest(&values), largest(&next_values));
        // At rounding level the error no longer falls: the better of the last two is the solution.
        if next_error.is_nan() || (error < accuracy && next_error >= error) {
            break;
        }
        (best, values) = (next, next_values);
    }
    (largest(&values) < accuracy).then_some(best)
}

/// The Jacobian from central differences.
pub(super) fn differences(equations: impl Fn(&DVector<f64>) -> DVector<f64>, x: &DVector<f64>) -> DMatrix<f64> {
    let slopes = (0..x.len()).map(|column| {
        let (mut ahead, mut behind) = (x.clone(), x.clone());
        ahead[column] += DIFFERENCE;
        behind[column] -= DIFFERENCE;
        (equations(&ahead) - equations(&behind)) / (2.0 * DIFFERENCE)
    });
    DMatrix::from_columns(&slopes.collect::<Vec<_>>())
}

/// Largest magnitude of the values; NaN if one of them is NaN.
fn largest(values: &DVector<f64>) -> f64 {
    values
        .iter()
        .fold(0.0, |most: f64, v| if v.is_nan() { *v } else { most.max(v.abs()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vector(values: [f64; 2]) -> DVector<f64> {
        DVector::from_row_slice(&values)
    }

    #[test]
    fn solves_to_rounding_or_reports_failure() {
        let circle_and_line = |x: &DVector<f64>| vector([x.norm_squared() - 2.0, x[0] - x[1]]);
        let found = solve(circle_and_line, vector([2.0, 0.5]), 1e-12).unwrap();
        assert!((found - vector([1.0, 1.0])).amax() < 1e-14);
        let nowhere = |x: &DVector<f64>| vector([x[0] * x[0] + 1.0, x[1]]);
        assert_eq!(solve(nowhere, vector([0.3, 0.3]), 1e-12), None);
    }
}
