//! Recursive least squares with forgetting, for a mode that changes, sample by sample.
//!
//! ```text
//! K = Pφ/(λ + φᵀPφ)     θ ← θ + K(y − φᵀθ)     P ← (P − KφᵀP)/λ
//! ```

use super::arx::ArxModel;
use nalgebra::{DMatrix, DVector};
use posicast_shaper::mode::Mode;

/// A model that is updated with every sample. Its memory is about `1/(1 − forgetting)` samples.
#[derive(Debug, Clone)]
pub struct RecursiveArx {
    order: usize,
    sample_s: f64,
    forgetting: f64,
    parameters: DVector<f64>,
    covariance: DMatrix<f64>,
    /// The last commands and responses; the newest come first.
    commands: Vec<f64>,
    responses: Vec<f64>,
}

/// Initial variance of unknown parameters.
const UNKNOWN: f64 = 1e5;

impl RecursiveArx {
    /// A model of `order` with the forgetting factor `forgetting`, above 0 and at most 1.
    pub fn new(order: usize, sample_s: f64, forgetting: f64) -> Self {
        Self {
            order,
            sample_s,
            forgetting: forgetting.clamp(0.5, 1.0),
            parameters: DVector::zeros(2 * order),
            covariance: DMatrix::identity(2 * order, 2 * order) * UNKNOWN,
            commands: Vec::new(),
            responses: Vec::new(),
        }
    }

    /// Takes the next sample: the response before the command of the same sample acts.
    pub fn take(&mut self, command: f64, response: f64) {
        if self.responses.len() == self.order {
            let past = self.responses.iter().map(|y| -y).chain(self.commands.iter().copied());
            let regressor = DVector::from_iterator(2 * self.order, past);
            let spread = &self.covariance * &regressor;
            let gain = &spread / (self.forgetting + regressor.dot(&spread));
            self.parameters += &gain * (response - regressor.dot(&self.parameters));
            let next = (&self.covariance - gain * spread.transpose()) / self.forgetting;
            // Rounding must not make the covariance asymmetric, because the asymmetry would grow until the covariance
            // is invalid.
            self.covariance = (&next + next.transpose()) * 0.5;
        }
        self.responses.insert(0, response);
        self.commands.insert(0, command);
        self.responses.truncate(self.order);
        self.commands.truncate(self.order);
    }

    /// The model after the last sample.
    pub fn model(&self) -> ArxModel {
        ArxModel {
            a: self.parameters.rows(0, self.order).iter().copied().collect(),
            b: self.parameters.rows(self.order, self.order).iter().copied().collect(),
            sample_s: self.sample_s,
        }
    }

    /// Its modes after the last sample.
    pub fn modes(&self) -> Vec<Mode> {
        self.model().modes()
    }
}
