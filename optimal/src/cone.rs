//! A cone program as rows, and the solver behind it.
//!
//! ```text
//! minimise ½ Σ q_j x_j² + Σ c_j x_j     so that     A x + s = b,  s in a product of cones
//! ```

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// Tolerances of gap and feasibility, tried one after the other: if rounding ends the first attempt, the second mostly
/// succeeds.
const TOLERANCES: [f64; 2] = [1e-9, 1e-7];

/// A cone program under construction. The rows of one cone are consecutive; the cones are given in the order of
/// [`Rows`].
#[derive(Debug, Default)]
pub(crate) struct ConeProgram {
    linear: Vec<f64>,
    squares: Vec<f64>,
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
    right: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

/// Solution of a solver.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    pub(crate) x: Vec<f64>,
    /// Multipliers of the rows.
    pub(crate) z: Vec<f64>,
}

/// Why there is no solution.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Unsolved {
    /// The constraints cannot be met.
    Infeasible,
    /// The solver ended early, with this message.
    Stopped(String),
}

impl ConeProgram {
    /// Adds a variable with these coefficients in the objective, and returns its index.
    pub(crate) fn variable(&mut self, linear: f64, square: f64) -> usize {
        self.linear.push(linear);
        self.squares.push(square);
        self.linear.len() - 1
    }

    /// Adds a row `Σ coefficient · x ≤ right`, `= right`, or one of a second-order cone.
    fn row(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, right: f64) {
        let row = self.right.len();
        for (column, value) in terms {
            self.rows.push(row);
            self.columns.push(column);
            self.values.push(value);
        }
        self.right.push(right);
    }

    /// Adds `Σ coefficient · x = right`.
    pub(crate) fn equal(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, right: f64) {
        self.row(terms, right);
        self.cones.push(SupportedConeT::ZeroConeT(1));
    }

    /// Adds `Σ coefficient · x ≤ right`.
    pub(crate) fn at_most(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, right: f64) {
        self.row(terms, right);
        match self.cones.last_mut() {
            Some(SupportedConeT::NonnegativeConeT(rows)) => *rows += 1,
            _ => self.cones.push(SupportedConeT::NonnegativeConeT(1)),
        }
    }

    /// Adds `|(b_1 − row_1, b_2 − row_2)| ≤ b_0 − row_0`, and returns the index of the first of the three rows.
    pub(crate) fn cone(&mut self, three: [(Vec<(usize, f64)>, f64); 3]) -> usize {
        let first = self.right.len();
        for (terms, right) in three {
            self.row(terms, right);
        }
        self.cones.push(SupportedConeT::SecondOrderConeT(3));
        first
    }

    pub(crate) fn solve(self) -> Result<Solution, Unsolved> {
        let (columns, rows) = (self.linear.len(), self.right.len());
        let on_diagonal: Vec<usize> = (0..columns).filter(|j| self.squares[*j] != 0.0).collect();
        let squares: Vec<f64> = on_diagonal.iter().map(|j| self.squares[*j]).collect();
        let quadratic = CscMatrix::new_from_triplets(columns, columns, on_diagonal.clone(), on_diagonal, squares);
        let matrix = CscMatrix::new_from_triplets(rows, columns, self.rows, self.columns, self.values);
        let mut stopped = String::new();
        for tolerance in TOLERANCES {
            let settings = DefaultSettingsBuilder::default()
                .verbose(false)
                .max_threads(1)
                .presolve_enable(false)
                .tol_gap_abs(tolerance)
                .tol_gap_rel(tolerance)
                .tol_feas(tolerance)
                .build()
                .map_err(|error| Unsolved::Stopped(error.to_string()))?;
            let mut solver = DefaultSolver::new(&quadratic, &self.linear, &matrix, &self.right, &self.cones, settings)
                .map_err(|error| Unsolved::Stopped(error.to_string()))?;
            solver.solve();
            match solver.solution.status {
                // If progress stalls near the end, the caller checks the point by its own arithmetic.
                SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress => {
                    return Ok(Solution {
                        x: solver.solution.x,
                        z: solver.solution.z,
                    });
                }
                SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                    return Err(Unsolved::Infeasible);
                }
                other => stopped = format!("{other:?}"),
            }
        }
        Err(Unsolved::Stopped(stopped))
    }
}
