//! Least squares in which some unknowns are linear, so that they follow from the values of the others (Golub and
//! Pereyra 1973, in the form of Kaufman 1975). The others are found by the Levenberg–Marquardt method.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A problem `measured ≈ basis(unknowns) · coefficients`, with each row divided by its standard deviation.
pub(crate) trait Separable {
    /// The measured values.
    fn measured(&self) -> &DVector<f64>;

    /// The basis, with a column for each coefficient.
    fn basis(&self, unknowns: &[f64]) -> DMatrix<f64>;

    /// Derivatives of `basis · coefficients` with respect to each unknown, with the coefficients fixed.
    fn slopes(&self, unknowns: &[f64], basis: &DMatrix<f64>, coefficients: &DVector<f64>) -> DMatrix<f64>;

    /// The unknowns after a step, limited to their ranges.
    fn stepped(&self, unknowns: &[f64], step: &DVector<f64>) -> Vec<f64>;
}

/// The unknowns with the best fit, and the quality of the fit.
#[derive(Debug, Clone)]
pub(crate) struct Solution {
    pub(crate) unknowns: Vec<f64>,
    pub(crate) coefficients: DVector<f64>,
    /// The fitted values.
    pub(crate) fitted: DVector<f64>,
    /// Sum of squares of the residuals.
    pub(crate) square: f64,
    /// Degrees of freedom: number of values minus unknowns and coefficients.
    pub(crate) freedoms: f64,
    /// Covariance of the unknowns, and of the coefficients at fixed unknowns, for rows of variance 1; `None` if the rows do not determine
    /// them.
    covariance: Option<DMatrix<f64>>,
    linear_covariance: DMatrix<f64>,
    /// Slopes with respect to the unknowns, without the part that the coefficients absorb, and residuals, row by row.
    slopes: DMatrix<f64>,
    residual: DVector<f64>,
}

impl Solution {
    /// Sum of squares per degree of freedom.
    pub(crate) fn reduced_square(&self) -> f64 {
        self.square / self.freedoms
    }

    /// Standard deviation of an unknown where each row has the standard deviation `row`.
    pub(crate) fn deviation(&self, unknown: usize, row: f64) -> f64 {
        let variance = self.covariance.as_ref().map(|c| c[(unknown, unknown)].max(0.0));
        variance.map_or(f64::INFINITY, |variance| row * variance.sqrt())
    }

    /// Standard deviation of an unknown where residuals of neighbouring rows are correlated: from the sums of slopes
    /// times residuals over `blocks` intervals of rows, which are independent if an interval is longer than the
    /// memory of the noise.
    pub(crate) fn deviation_with_memory(&self, unknown: usize, blocks: usize) -> f64 {
        let Some(covariance) = &self.covariance else {
            return f64::INFINITY;
        };
        deviation_over_stretches(
            &self.slopes,
            &self.residual,
            &covariance.column(unknown).into_owned(),
            blocks,
        )
    }

    /// Standard deviation of a coefficient at fixed unknowns, where each row has the standard deviation `row`.
    pub(crate) fn linear_deviation(&self, coefficient: usize, row: f64) -> f64 {
        row * self.linear_covariance[(coefficient, coefficient)].max(0.0).sqrt()
    }
}

/// Standard deviation of a combination of parameters. `direction` is the covariance of the parameters times the gradient of the
/// combination; each of `stretches` intervals of rows contributes its slopes times its residual.
pub(crate) fn deviation_over_stretches(
    slopes: &DMatrix<f64>,
    residual: &DVector<f64>,
    direction: &DVector<f64>,
    stretches: usize,
) -> f64 {
    let rows = residual.len();
    let length = rows.div_ceil(stretches.max(2));
    let variance: f64 = (0..rows)
        .step_by(length)
        .map(|begin| {
            let length = length.min(rows - begin);
            let pull = slopes.rows(begin, length).tr_mul(&residual.rows(begin, length));
            direction.dot(&pull).powi(2)
        })
        .sum();
    // Few intervals show too small a variance, as few values do.
    let count = rows.div_ceil(length) as f64;
    (variance * count / (count - 2.0).max(1.0)).sqrt()
}

/// Accuracy to which a fit is continued.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Effort {
    /// The fit stops when it is clear how much it explains.
    Rough,
    /// The fit stops when it converges.
    Full,
}

impl Effort {
    /// Largest number of steps, and the relative gain below which a step is the last.
    fn limits(self) -> (usize, f64) {
        match self {
            Self::Rough => (25, 1e-3),
            Self::Full => (60, 1e-6),
        }
    }
}

/// Returns the products of all pairs of columns.
fn products(columns: &DMatrix<f64>) -> DMatrix<f64> {
    let width = columns.ncols();
    let mut products = DMatrix::zeros(width, width);
    for a in 0..width {
        for b in 0..=a {
            let product = columns.column(a).dot(&columns.column(b));
            products[(a, b)] = product;
            products[(b, a)] = product;
        }
    }
    products
}

/// A symmetric matrix of products, whose columns are scaled to one before it is factored.
pub(crate) struct Gram {
    factor: Cholesky<f64, Dyn>,
    scale: DVector<f64>,
}

impl Gram {
    /// Returns the scaled matrix of columns; `None` if they are dependent or contain NaN.
    pub(crate) fn of(columns: &DMatrix<f64>) -> Option<Self> {
        Self::new(&products(columns))
    }

    pub(crate) fn new(products: &DMatrix<f64>) -> Option<Self> {
        let scale = products
            .diagonal()
            .map(|square| 1.0 / square.sqrt().max(f64::MIN_POSITIVE));
        let mut scaled = DMatrix::from_fn(products.nrows(), products.ncols(), |r, c| {
            products[(r, c)] * scale[r] * scale[c]
        });
        for n in 0..scaled.nrows() {
            scaled[(n, n)] += 1e-14;
        }
        scaled.cholesky().map(|factor| Self { factor, scale })
    }

    pub(crate) fn solve(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let scaled = DMatrix::from_fn(right.nrows(), right.ncols(), |r, c| right[(r, c)] * self.scale[r]);
        let solved = self.factor.solve(&scaled);
        DMatrix::from_fn(right.nrows(), right.ncols(), |r, c| solved[(r, c)] * self.scale[r])
    }

    pub(crate) fn solve_one(&self, right: &DVector<f64>) -> DVector<f64> {
        let solved = self.factor.solve(&right.component_mul(&self.scale));
        solved.component_mul(&self.scale)
    }

    pub(crate) fn inverse(&self) -> DMatrix<f64> {
        let size = self.scale.len();
        self.solve(&DMatrix::identity(size, size))
    }
}

/// The linear part of the problem at given unknowns.
struct Linear {
    basis: DMatrix<f64>,
    gram: Gram,
    coefficients: DVector<f64>,
    residual: DVector<f64>,
}

fn linear(problem: &impl Separable, unknowns: &[f64]) -> Option<Linear> {
    let basis = problem.basis(unknowns);
    let gram = Gram::of(&basis)?;
    let coefficients = gram.solve_one(&basis.tr_mul(problem.measured()));
    let residual = problem.measured() - &basis * &coefficients;
    residual.norm_squared().is_finite().then_some(Linear {
        basis,
        gram,
        coefficients,
        residual,
    })
}

/// Slopes without the part that the coefficients absorb.
fn slopes(problem: &impl Separable, unknowns: &[f64], now: &Linear) -> DMatrix<f64> {
    let slopes = problem.slopes(unknowns, &now.basis, &now.coefficients);
    let shared = now.gram.solve(&now.basis.tr_mul(&slopes));
    slopes - &now.basis * shared
}

/// Returns the best fit near the given unknowns; `None` if the rows do not determine the coefficients.
pub(crate) fn refine(problem: &impl Separable, start: &[f64], effort: Effort) -> Option<Solution> {
    let (steps, settled) = effort.limits();
    let mut unknowns = start.to_vec();
    let mut now = linear(problem, &unknowns)?;
    let mut here = slopes(problem, &unknowns, &now);
    let (mut products, mut pull) = (self::products(&here), here.tr_mul(&now.residual));
    let (mut damping, mut growth) = (1e-3, 4.0);
    for _ in 0..steps {
        if products.is_empty() {
            break;
        }
        let mut stiff = products.clone();
        for n in 0..products.nrows() {
            stiff[(n, n)] *= 1.0 + damping;
        }
        let Some(gram) = Gram::new(&stiff) else { break };
        let step = gram.solve_one(&pull);
        let square = now.residual.norm_squared();
        // A step that promises so little is the last, taken or not.
        let promised = 2.0 * step.dot(&pull) - step.dot(&(&products * &step));
        let is_last = promised < settled * square;
        let tried = problem.stepped(&unknowns, &step);
        match linear(problem, &tried) {
            Some(better) if better.residual.norm_squared() < square => {
                let gain = square - better.residual.norm_squared();
                (unknowns, now) = (tried, better);
                here = slopes(problem, &unknowns, &now);
                (products, pull) = (self::products(&here), here.tr_mul(&now.residual));
                // Nielsen's rule: what the step gained of its promise says how far the problem is linear.
                let kept = (2.0 * gain / promised - 1.0).clamp(-1.0, 1.0);
                damping = (damping * (1.0 - kept.powi(3)).max(0.1)).max(1e-9);
                growth = 4.0;
                if is_last || gain < settled * square {
                    break;
                }
            }
            _ => {
                damping *= growth;
                growth *= 2.0;
                if is_last || damping > 1e6 {
                    break;
                }
            }
        }
    }
    let freedoms = now.residual.len() as f64 - (now.coefficients.len() + unknowns.len()) as f64;
    Some(Solution {
        fitted: &now.basis * &now.coefficients,
        square: now.residual.norm_squared(),
        freedoms: freedoms.max(1.0),
        covariance: Gram::new(&products).map(|gram| gram.inverse()),
        linear_covariance: now.gram.inverse(),
        unknowns,
        coefficients: now.coefficients,
        slopes: here,
        residual: now.residual,
    })
}
