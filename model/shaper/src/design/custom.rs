//! `custom`: the impulses of the machine file, unchanged; `none`: the command, unchanged. Neither depends on a mode.
//!
//! The first time of `custom` is 0, times increase, and the amplitudes sum to 1 within 1e-9. It does not promise a residual at any mode;
//! the report states the residual of the impulses.

use super::DesignError;
use super::kind::{Design, KindRow, Promise};
use crate::impulse::{Impulse, ImpulseSequence};

/// `custom`.
pub(super) const CUSTOM: KindRow = KindRow::new(
    "custom",
    Promise::Unsaid,
    Design::Fixed(|axis| design(axis.name, axis.shaper.map_or(&[], |shaper| &shaper.impulses))),
    "the impulses in the file",
)
.keys(&["impulses"]);

/// `none`.
pub(super) const NONE: KindRow = KindRow::new(
    "none",
    Promise::Unsaid,
    Design::Fixed(|_| Ok(ImpulseSequence::unity())),
    "the command unchanged",
);

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
