//! The cascade of half sums for an axis whose shaper is `vibrationless`: the same shaper without a multiplier.

use super::{HardwareError, SHAPER_KEY};
use crate::machine_file::Machine;
use posicast_blocks::cascade::{CascadeConfig, CascadeConfigError};
use posicast_shaper::analysis::{residual_vibration, tap_impulses};
use posicast_shaper::design::vibrationless::axis_half_sums_s;
use posicast_shaper::digitise::half_sums_samples;

/// Fraction of the tap table in which the residual is measured; it holds every cascade of up to 16 half sums exactly.
const TABLE_FRACTION: u32 = 16;

/// A cascade, and the residual vibration that its whole delays leave.
#[derive(Debug, Clone, PartialEq)]
pub struct CascadeHardware {
    /// The half sums of all modes, one after the other, each delay rounded to a sample.
    pub config: CascadeConfig,
    /// Residual vibration of each mode, as a fraction of that of an unshaped step.
    pub residuals: Vec<f64>,
}

/// The cascade of the axis with this index; `None` where the axis has a shaper of another kind, or several kinds.
///
/// # Errors
/// [`HardwareError`] for more half sums or longer delays than the hardware has.
pub fn cascade(machine: &Machine, index: usize) -> Result<Option<CascadeHardware>, HardwareError> {
    let Some(axis) = machine.axes.get(index).filter(|axis| axis.shaped().is_vibrationless()) else {
        return Ok(None);
    };
    let refused = |error: &dyn std::fmt::Display| HardwareError::new(index, SHAPER_KEY, error);
    let delays_s = axis_half_sums_s(axis.shaped()).map_err(|error| refused(&error))?;
    let config = config(machine, &delays_s).map_err(|error| refused(&error))?;
    let table = config.tap_table(TABLE_FRACTION).map_err(|error| refused(&error))?;
    let impulses = tap_impulses(&table, machine.clock.sample_hz);
    let residuals = axis.modes.iter().map(|mode| residual_vibration(&impulses, &mode.mode));
    Ok(Some(CascadeHardware {
        residuals: residuals.collect(),
        config,
    }))
}

/// The cascade of half sums with these delays, each rounded to a sample.
pub(super) fn config(machine: &Machine, delays_s: &[f64]) -> Result<CascadeConfig, CascadeConfigError> {
    let delays_samples = half_sums_samples(delays_s, machine.clock.sample_hz);
    CascadeConfig::new(machine.fixed_point.command_bits, delays_samples)
}
