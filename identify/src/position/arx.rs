//! ARX models: equations (2-1) to (2-4) of the XY stage, of any order.
//!
//! ```text
//! y(k) = −a_1·y(k−1) − … − a_n·y(k−n) + b_1·u(k−1) + … + b_n·u(k−n)
//! p = root of z^n + a_1·z^(n−1) + … + a_n,    s = ln(p)/T,    ω = |s|,    ζ = −Re s/|s|
//! ```
//!
//! Without noise, least squares are exact. Noise of the sensor biases them, the more so the more samples there are in a
//! period. Instrumental variables remove the bias: commands and responses that the model itself predicts,
//! filtered by `1/A` (Young's refined method).

use crate::separable::Gram;
use crate::signal::PositionLog;
use nalgebra::{Complex, DMatrix, DVector};
use posicast_shaper::mode::Mode;
use std::f64::consts::TAU;
use thiserror::Error;

/// A model with the coefficients of its denominator `a` and numerator `b`.
#[derive(Debug, Clone, PartialEq)]
pub struct ArxModel {
    /// Coefficients `a_1 … a_n`.
    pub a: Vec<f64>,
    /// Coefficients `b_1 … b_n`.
    pub b: Vec<f64>,
    /// Time between samples in seconds.
    pub sample_s: f64,
}

/// Why a model cannot be determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum ArxError {
    /// There are too few samples for the order.
    #[error("{samples} samples are too few for a model of order {order}")]
    Short {
        /// Number of samples.
        samples: usize,
        /// Order of the model.
        order: usize,
    },
    /// The command does not excite enough coefficients.
    #[error("the command does not move enough to determine a model of order {order}")]
    Excitation {
        /// Order of the model.
        order: usize,
    },
}

/// Largest number of rounds of the refined method.
const ROUNDS: usize = 12;

/// The model that explains a log best, by least squares on its equation.
///
/// # Errors
/// [`ArxError`] where the log does not determine the model.
pub fn least_squares(log: &PositionLog, order: usize) -> Result<ArxModel, ArxError> {
    let rows = rows(&log.command, &log.response, order);
    solve(log, order, &rows, &rows, &log.response)
}

/// The model by instrumental variables, starting from least squares.
///
/// # Errors
/// [`ArxError`] where the log does not determine the model.
pub fn with_instruments(log: &PositionLog, order: usize) -> Result<ArxModel, ArxError> {
    let mut model = least_squares(log, order)?;
    for _ in 0..ROUNDS {
        if !model.is_stable() {
            break;
        }
        let predicted = model.simulated(&log.command);
        let [command, response, predicted] =
            [&log.command, &log.response, &predicted].map(|signal| model.autoregressed(signal));
        let instruments = rows(&command, &predicted, order);
        let regressors = rows(&command, &response, order);
        let next = solve(log, order, &instruments, &regressors, &response)?;
        let change: f64 = next.a.iter().zip(&model.a).map(|(a, b)| (a - b).abs()).sum();
        model = next;
        if change < 1e-12 {
            break;
        }
    }
    Ok(model)
}

/// Returns the log reduced to 4 to 15 samples per period of `frequency_hz`, if it has more: means of equally many
/// samples of the command and of the response.
pub fn decimated(log: &PositionLog, frequency_hz: f64) -> PositionLog {
    const SAMPLES_PER_PERIOD: f64 = 10.0;
    let joined = ((1.0 / (frequency_hz * log.sample_s * SAMPLES_PER_PERIOD)) as usize).max(1);
    let means = |signal: &[f64]| -> Vec<f64> {
        let mean = |group: &[f64]| group.iter().sum::<f64>() / joined as f64;
        signal.chunks_exact(joined).map(mean).collect()
    };
    PositionLog {
        sample_s: log.sample_s * joined as f64,
        between: log.between,
        command: means(&log.command),
        response: means(&log.response),
        missing: Vec::new(),
    }
}

/// Regressors `[−y(k−1) … −y(k−n), u(k−1) … u(k−n)]` for each k from n on.
fn rows(command: &[f64], response: &[f64], order: usize) -> DMatrix<f64> {
    let count = response.len().min(command.len()).saturating_sub(order);
    DMatrix::from_fn(count, 2 * order, |row, column| {
        let k = row + order;
        if column < order {
            -response[k - 1 - column]
        } else {
            command[k - 1 - (column - order)]
        }
    })
}

fn solve(
    log: &PositionLog,
    order: usize,
    instruments: &DMatrix<f64>,
    regressors: &DMatrix<f64>,
    response: &[f64],
) -> Result<ArxModel, ArxError> {
    if order == 0 || instruments.nrows() < 4 * order {
        return Err(ArxError::Short {
            samples: log.response.len(),
            order,
        });
    }
    let right = DVector::from_column_slice(&response[order..order + instruments.nrows()]);
    // With the model's own instruments the products are nearly symmetric, but not exactly, so Cholesky's method
    // cannot be used.
    Gram::of(instruments).ok_or(ArxError::Excitation { order })?;
    let found = instruments.tr_mul(regressors).lu().solve(&instruments.tr_mul(&right));
    let found = found.ok_or(ArxError::Excitation { order })?;
    if !found.iter().all(|value| value.is_finite()) {
        return Err(ArxError::Excitation { order });
    }
    Ok(ArxModel {
        a: found.rows(0, order).iter().copied().collect(),
        b: found.rows(order, order).iter().copied().collect(),
        sample_s: log.sample_s,
    })
}

impl ArxModel {
    /// Response of the model to a command, from rest.
    pub fn simulated(&self, command: &[f64]) -> Vec<f64> {
        let order = self.a.len();
        let mut response: Vec<f64> = Vec::with_capacity(command.len());
        for k in 0..command.len() {
            let terms = (1..=order.min(k)).map(|n| self.b[n - 1] * command[k - n] - self.a[n - 1] * response[k - n]);
            response.push(terms.sum());
        }
        response
    }

    /// Filters a signal by `1/A`.
    fn autoregressed(&self, signal: &[f64]) -> Vec<f64> {
        let order = self.a.len();
        let mut out: Vec<f64> = Vec::with_capacity(signal.len());
        for (k, value) in signal.iter().enumerate() {
            let back: f64 = (1..=order.min(k)).map(|n| self.a[n - 1] * out[k - n]).sum();
            out.push(value - back);
        }
        out
    }

    fn poles(&self) -> Vec<Complex<f64>> {
        let order = self.a.len();
        let companion = DMatrix::from_fn(order, order, |row, column| match (row, column) {
            (0, column) => -self.a[column],
            (row, column) if row == column + 1 => 1.0,
            _ => 0.0,
        });
        companion.complex_eigenvalues().iter().copied().collect()
    }

    fn is_stable(&self) -> bool {
        self.poles().iter().all(|pole| pole.norm() < 1.0)
    }

    /// Its modes in continuous time, sorted by frequency: the complex poles that decay.
    pub fn modes(&self) -> Vec<Mode> {
        let oscillating = self
            .poles()
            .into_iter()
            .filter(|pole| pole.im > 0.0 && pole.norm() < 1.0);
        let mut modes: Vec<Mode> = oscillating
            .map(|pole| {
                let continuous = pole.ln() / self.sample_s;
                Mode {
                    frequency_hz: continuous.norm() / TAU,
                    damping: -continuous.re / continuous.norm(),
                }
            })
            .collect();
        modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        modes
    }
}
