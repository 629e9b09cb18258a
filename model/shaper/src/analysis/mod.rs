//! The effect of a shaper at a mode: residual vibration, insensitivity, sensitivity curves and maps.
//!
//! Everything here takes plain impulses, so that the same code judges a design ([`crate::impulse`]), its digitised
//! taps and the integer table that the hardware computes with ([`tap_impulses`]). The figure that is guaranteed is
//! that of the integer table; the others explain it.

mod band;
mod insensitivity;
mod residual;
mod ringing;
mod settling;
mod start_control;

pub use band::{SensitivityGrid, sensitivity_grid, worst_residual, worst_residual_of_convolution};
pub use insensitivity::{INSENSITIVITY_LIMIT, Insensitivity, insensitivity};
pub use residual::{pole_sum, residual_vibration, residual_vibration_at, sensitivity_curve, tap_impulses};
pub use ringing::left as ringing_left_by;
pub use ringing::{WeightedMode, ringing_left};
pub use settling::settled_from;
pub use start_control::{StartControl, StartFigures};
