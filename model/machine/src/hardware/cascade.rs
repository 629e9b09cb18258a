//! The cascade of half sums for an axis whose shaper is `vibrationless`: the same shaper without a multiplier.

use super::{HardwareError, SHAPER_KEY};
use crate::machine_file::{AxisSection, Machine};
use posicast_blocks::cascade::CascadeConfig;
use posicast_shaper::analysis::{residual_vibration, tap_impulses};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::vibrationless::half_sums_s;
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
    let Some(axis) = machine.axes.get(index).filter(|axis| is_vibrationless(axis)) else {
        return Ok(None);
    };
    let refused = |error: &dyn std::fmt::Display| HardwareError::new(index, SHAPER_KEY, error);
    let sample_hz = machine.clock.sample_hz;
    let shaped = axis.shaped();
    let mut delays_samples = Vec::new();
    for mode in &axis.modes {
        let half_sums = half_sums_s(&mode.mode, shaped.order_of(mode), shaped.epsilon());
        let half_sums = half_sums.map_err(|error| refused(&error))?;
        delays_samples.extend(half_sums_samples(&half_sums, sample_hz));
    }
    let config = CascadeConfig::new(machine.fixed_point.command_bits, delays_samples);
    let config = config.map_err(|error| refused(&error))?;
    let table = config.tap_table(TABLE_FRACTION).map_err(|error| refused(&error))?;
    let impulses = tap_impulses(&table, sample_hz);
    let residuals = axis.modes.iter().map(|mode| residual_vibration(&impulses, &mode.mode));
    Ok(Some(CascadeHardware {
        residuals: residuals.collect(),
        config,
    }))
}

fn is_vibrationless(axis: &AxisSection) -> bool {
    let shaped = axis.shaped();
    let mut modes = axis.modes.iter();
    !axis.modes.is_empty() && modes.all(|mode| shaped.kind_of(mode) == ShaperKind::Vibrationless)
}
