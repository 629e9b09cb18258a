//! `custom`: the impulses of the machine file as they are.
//!
//! First time 0, times increasing, amplitudes that sum to 1 within 1e-9. Nothing is promised at any mode; the residual that
//! is reported says what the impulses do.

use super::DesignError;
use crate::impulse::{Impulse, ImpulseSequence};

/// Takes `(time_s, amplitude)` pairs of the axis `axis`.
///
/// # Errors
/// [`DesignError::NoSequence`] names the rule that the list breaks, and where.
pub fn design(axis: &str, pairs: &[(f64, f64)]) -> Result<ImpulseSequence, DesignError> {
    let impulses = pairs.iter().map(|&(time_s, amplitude)| Impulse { time_s, amplitude });
    ImpulseSequence::new(impulses.collect()).map_err(|cause| DesignError::NoSequence {
        what: format!("axis {axis}: `impulses` of shaper \"custom\""),
        cause,
    })
}
