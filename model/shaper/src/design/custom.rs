//! `custom`: the impulses of the machine file, unchanged.
//!
//! The first time is 0, times increase, and the amplitudes sum to 1 within 1e-9. No residual is promised at any mode;
//! the reported residual says what the impulses do.

use super::DesignError;
use crate::impulse::{Impulse, ImpulseSequence};

/// Takes `(time_s, amplitude)` pairs of the axis `axis`.
///
/// # Errors
/// [`DesignError::NoSequence`] names the rule that the list breaks, and the impulse.
pub fn design(axis: &str, pairs: &[(f64, f64)]) -> Result<ImpulseSequence, DesignError> {
    let impulses = pairs.iter().map(|&(time_s, amplitude)| Impulse { time_s, amplitude });
    ImpulseSequence::new(impulses.collect()).map_err(|cause| DesignError::NoSequence {
        what: format!("axis {axis}: `impulses` of shaper \"custom\""),
        cause,
    })
}
