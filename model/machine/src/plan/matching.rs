//! Equal total delays of the axes of a stage, made by delaying their tap tables.
//!
//! ```text
//! own   = Σ a_i d_i / f_s          the shaper's mean, of its real taps
//!       + Σ 2ζ/ω                   what the modes of the loop add to it
//! total = the largest own + extra_delay_s
//! added = total − own              whole samples in every delay, the fraction f as (1 − f, f), then rounding
//! ```
//!
//! A ramp comes out of every axis `total` late, so that a straight line at any angle stays straight, and a circle
//! keeps its shape except for what the shapers' different lengths smooth away. `2ζ/ω` is the delay of a mode at low
//! frequencies; the delays of modes in series add up. They count where the loop is closed before the modes. Where the
//! loop's own position is the load's (a torque drive with its encoder on the load, or a scale that closes the loop),
//! the controller compensates them, and they count as 0.
//!
//! Rounding the coefficients leaves the mismatch that is reported: with `e_i = c_i/2^F − a_i`, whose sum is 0, it is
//! at most `½·(d_n − d_1)·Σ|e_i|` samples per axis.

use crate::machine_file::{AxisSection, DriveMode, Machine, ScaleUse};
use posicast_shaper::digitise::{DigitiseError, Digitised};
use posicast_taps::TapTable;

/// The parts of an axis's delay in seconds, from the command to the load, for a ramp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisDelay {
    /// Mean delay of the shaper's real taps, before anything is added.
    pub shaper_s: f64,
    /// Lag of the axis's modes, `Σ 2ζ/ω`.
    pub mode_lag_s: f64,
    /// Delay that was added to the table, in samples; 0 without `[stage]`.
    pub added_samples: f64,
    /// Delay that was added to the table, in seconds.
    pub added_s: f64,
    /// Change of the delay by rounding the coefficients.
    pub rounding_s: f64,
}

impl AxisDelay {
    /// Total delay before the coefficients are rounded.
    pub fn designed_s(&self) -> f64 {
        self.shaper_s + self.mode_lag_s + self.added_s
    }

    /// Total delay of the integer table.
    pub fn total_s(&self) -> f64 {
        self.designed_s() + self.rounding_s
    }

    /// Returns the delay with what rounding to `table` changes.
    pub(super) fn of_table(self, digitised: &Digitised, table: &TapTable, sample_hz: f64) -> Self {
        Self {
            rounding_s: (table.mean_delay_samples() - digitised.mean_delay_samples()) / sample_hz,
            ..self
        }
    }
}

/// The remaining difference between the delays of a stage's axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageDelay {
    /// Total delay of every axis before the coefficients are rounded, in seconds.
    pub total_s: f64,
    /// Largest difference between two axes' totals after rounding, in seconds.
    pub mismatch_s: f64,
    /// Speed at which the mismatch is reported, in m/s: the file's, else the smallest velocity limit of the axes.
    pub contour_speed: Option<f64>,
}

impl StageDelay {
    /// Delay figures of a machine with `[stage]`; `None` without.
    pub(super) fn of_machine(machine: &Machine, delays: &[AxisDelay]) -> Option<Self> {
        let stage = machine.stage.as_ref()?;
        let totals = || delays.iter().map(AxisDelay::total_s);
        let limits = machine.axes.iter().filter_map(|axis| axis.limits?.velocity);
        Some(Self {
            total_s: delays
                .iter()
                .map(AxisDelay::designed_s)
                .fold(f64::NEG_INFINITY, f64::max),
            mismatch_s: totals().fold(f64::NEG_INFINITY, f64::max) - totals().fold(f64::INFINITY, f64::min),
            contour_speed: stage.contour_speed.or_else(|| limits.reduce(f64::min)),
        })
    }

    /// Distance between two axes at the contour speed, in µm; `None` where there is no speed.
    pub fn mismatch_um(&self) -> Option<f64> {
        self.contour_speed.map(|speed| self.mismatch_s * speed * 1e6)
    }
}

/// Lag of an axis's modes at low frequencies, `Σ 2ζ/ω`, in seconds; 0 where the loop controls the load itself.
pub fn mode_lag_s(axis: &AxisSection) -> f64 {
    let torque = axis
        .drive
        .is_some_and(|drive| matches!(drive.mode, DriveMode::Torque { .. }));
    let scale = axis.scale.is_some_and(|scale| scale.usage == ScaleUse::Position);
    if torque && axis.controller.is_some() || scale {
        return 0.0;
    }
    let modes = axis.modes.iter().map(|axis_mode| axis_mode.mode);
    // `sum` would be -0 without a mode.
    modes.fold(0.0, |lag_s, mode| lag_s + 2.0 * mode.damping / mode.omega())
}

/// Delays the taps of all axes, and the further tables of an axis, to one total where the machine has `[stage]`;
/// returns them unchanged where it has none.
///
/// # Errors
/// [`DigitiseError::MatchedDelay`] where a ring buffer cannot hold the delay that an axis needs.
pub(super) fn matched(
    machine: &Machine,
    tables: &[(&AxisSection, &Digitised)],
) -> Result<Vec<(Digitised, AxisDelay)>, DigitiseError> {
    let sample_hz = machine.clock.sample_hz;
    let own: Vec<AxisDelay> = tables
        .iter()
        .map(|(axis, taps)| AxisDelay {
            shaper_s: taps.mean_delay_samples() / sample_hz,
            mode_lag_s: mode_lag_s(axis),
            added_samples: 0.0,
            added_s: 0.0,
            rounding_s: 0.0,
        })
        .collect();
    let Some(stage) = machine.stage else {
        let digitised = tables.iter().map(|(_, digitised)| (*digitised).clone());
        return Ok(digitised.zip(own).collect());
    };
    let slowest = own
        .iter()
        .zip(tables)
        .max_by(|(a, _), (b, _)| a.designed_s().total_cmp(&b.designed_s()));
    let Some((slowest, (slowest_axis, _))) = slowest else {
        return Ok(Vec::new());
    };
    let total_s = slowest.designed_s() + stage.extra_delay_s;
    let tables = tables.iter().zip(&own);
    tables
        .map(|((axis, taps), own)| {
            let added_s = total_s - own.designed_s();
            let added_samples = added_s * sample_hz;
            let later = taps.delayed(added_samples).ok_or_else(|| DigitiseError::MatchedDelay {
                axis: axis.name.clone(),
                slowest: slowest_axis.name.clone(),
                added_samples,
                found: taps.taps.last().map_or(0.0, |tap| f64::from(tap.delay_samples)) + added_samples.ceil(),
                sample_hz,
            })?;
            let delay = AxisDelay {
                added_samples,
                added_s,
                ..*own
            };
            Ok((later, delay))
        })
        .collect()
}
