//! Gains of an axis from its machine file.

use std::f64::consts::TAU;

use super::ControlError;
use super::conditions::{self, ControlWarning, Loop};
use super::culprit::Numbers;
use super::law::Gains;
use super::linear::{Linear, default_linear, linear_law};
use super::sampled::{LinearLaw, Margins, SampledLoop};
use crate::machine_file::{AxisSection, ClockSection, Controller, Drive, DriveMode};
use crate::rtl::sliding_mode::{Law, MANTISSA_MAX, SettingRow, Settings};

/// Command units per unit of the drive: mA per A, mm/s per m/s.
const COMMAND_UNITS: f64 = 1000.0;
/// The feedback's word holds ±2^7.
const FEEDBACK_RANGE: f64 = 128.0;
/// The feedback reaches so many times the limit before its word saturates.
const FEEDBACK_HEADROOM: f64 = 4.0;
/// A modulus margin below this is worth a word: a gain margin of 6 dB and a phase margin of 29° may not be there.
const THIN: f64 = 0.5;
/// What the rounding of a default may take from it.
const ROUNDED: f64 = 1e-6;
/// The steepest fade: over this part of a count per tick.
const LEAST_FADE: f64 = 1.0 / 128.0;

/// What follows for an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// The law of the machine file: the reset value of the register.
    pub law: Law,
    /// Gains as wanted, in counts, ticks and command units.
    pub gains: Gains,
    /// Gains and limit as the hardware has them.
    pub settings: Settings,
    /// Conditions that do not hold.
    pub warnings: Vec<ControlWarning>,
    /// Error in m (rad) that a constant Coulomb friction leaves, without what is fed forward against it.
    pub steady_error: f64,
    /// The law as the loop has it near its reference, in m and s; of the sliding mode within the boundary layer.
    pub linear: LinearLaw,
    /// Stability of the sampled loop on the machine of the file, with its modes.
    pub margins: Margins,
    /// The loop that they are of.
    pub sampled: SampledLoop,
}

/// Lag of a loop: the schedule's delay from the capture of the position to the new duty, and the drive's own.
/// A velocity that is measured over a tick adds half a tick to the delay.
pub fn loop_lag_s(drive: &Drive, schedule_delay_s: f64) -> f64 {
    schedule_delay_s
        + drive
            .bandwidth_hz
            .map_or(0.0, |bandwidth_hz| 1.0 / (TAU * bandwidth_hz))
}

/// The numbers that turn m and s into counts and ticks.
struct Units {
    /// T in s.
    tick_s: f64,
    /// q: m per count of the loop.
    count: f64,
}

/// Derives gains, settings and warnings of an axis.
///
/// `lag_s` is the whole lag of the loop, see [`loop_lag_s`]. Gains that the file leaves out follow from it and from the modes
/// that are in the loop, with `lag` the smallest time, not below `lag_s`, that leaves the margin of [`crate::control::DEFAULT_MARGIN`]:
///
/// | drive | law | rule | reason |
/// |---|---|---|---|
/// | torque | PD | D = 0.4/lag, P = D²/4 | `s² + D·s + P` has a double real pole |
/// | torque | PID | D = 0.4/lag, P = D²/3, I = D³/27 | `s³ + D·s² + P·s + I` has a triple real pole |
/// | velocity | PD | P = 1/(4·lag), D = 0 | `lag·s² + s + P` has a double real pole |
/// | velocity | PID | P = 1/(3·lag), I = 1/(27·lag²), D = 0 | `lag·s³ + s² + P·s + I` has a triple real pole |
///
/// The laws that the file does not choose get their gains by the same rules, for a change of law at run time; the sliding
/// mode of a torque drive then is one without switching, c = k = D/2, which equals the default PD.
///
/// # Errors
/// [`ControlError`] where a table or the bandwidth is missing, a gain does not fit, or the loop is unstable on the machine.
pub fn gains(axis: &AxisSection, clock: ClockSection, lag_s: f64) -> Result<Derived, ControlError> {
    let missing = |table| ControlError::Missing {
        axis: axis.name.clone(),
        table,
    };
    if !(lag_s > 0.0 && lag_s.is_finite()) {
        return Err(ControlError::Lag(lag_s));
    }
    let drive = axis.drive.as_ref().ok_or_else(|| missing("drive"))?;
    let controller = axis.controller.as_ref().ok_or_else(|| missing("controller"))?;
    let pwm = axis.pwm.as_ref().ok_or_else(|| missing("pwm"))?;
    let units = Units {
        tick_s: clock.sample_period_s(),
        count: 1.0 / axis.loop_counts_per_unit(),
    };
    let law = match controller {
        Controller::SlidingMode { .. } => Law::SlidingMode,
        Controller::Pd { .. } => Law::Pd,
        Controller::Pid { .. } => Law::Pid,
    };
    let linear = default_linear(axis, clock, controller, drive, lag_s);
    let closed = Loop {
        unit: axis.unit,
        controller,
        linear_poles: match drive.mode {
            DriveMode::Torque { .. } => linear.derivative,
            DriveMode::Velocity { .. } => linear.proportional,
        },
        drive,
        lag_s,
        tick_s: units.tick_s,
        count: units.count,
        limits: axis.limits.as_ref(),
    };
    if law == Law::SlidingMode && matches!(drive.mode, DriveMode::Velocity { .. }) && drive.bandwidth_hz.is_none() {
        return Err(ControlError::Bandwidth {
            axis: axis.name.clone(),
        });
    }
    let fade = closed.fade_counts_per_tick().max(LEAST_FADE);
    let mut gains = Gains::default().with(&[(SettingRow::Fade, 1.0 / fade)]);
    feedback(&mut gains, controller, &linear, &drive.mode, &units);
    command(&mut gains, law, drive, &units);
    gains.set(
        SettingRow::Duty,
        f64::from(pwm.period_clocks(&clock)) / full_scale(&drive.mode),
    );
    scale_feedback(&mut gains);
    let numbers = Numbers { axis, clock };
    let settings = gains.quantise().map_err(|source| ControlError::Gain {
        axis: axis.name.clone(),
        culprit: numbers.culprit(source.row()),
        source,
    })?;
    if let Some(row) = lost(&gains, &settings, law) {
        return Err(ControlError::Lost {
            axis: axis.name.clone(),
            row,
            found: gains.get(row),
            smallest: row.smallest(),
            culprit: numbers.culprit(row),
        });
    }
    let sampled = SampledLoop::new(axis, clock, lag_s, 1.0).ok_or_else(|| missing("drive"))?;
    let of_loop = linear_law(controller, &linear, drive);
    let margins = sampled.margins(&of_loop);
    if !margins.stable {
        return Err(ControlError::Unstable {
            axis: axis.name.clone(),
            key: conditions::gain_key(controller),
            gain_margin_db: margins.gain_margin_db(),
            largest_factor: margins.gain_margin,
            gains: conditions::gain_names(controller),
        });
    }
    let mut warnings = closed.warnings();
    warnings.extend(
        (margins.modulus_margin < THIN - ROUNDED).then(|| ControlWarning::ThinMargin {
            modulus_margin: margins.modulus_margin,
            gain_margin_db: margins.gain_margin_db().unwrap_or(f64::INFINITY),
            phase_margin_deg: margins.phase_margin_deg.unwrap_or(180.0),
            gains: conditions::gain_names(controller),
        }),
    );
    warnings.extend(conditions::unstable_nearby(axis, clock, lag_s, &of_loop));
    warnings.extend(conditions::coarse_gains(&gains, &settings));
    Ok(Derived {
        law,
        gains,
        settings,
        warnings,
        steady_error: closed.steady_error(&linear.proportional),
        linear: of_loop,
        margins,
        sampled,
    })
}

/// The first row that the law reads, that is not 0, and that is 0 in mantissa and shift.
fn lost(gains: &Gains, settings: &Settings, law: Law) -> Option<SettingRow> {
    let actual = Gains::of_settings(settings);
    let is_read = |row: &SettingRow| match row {
        SettingRow::Surface
        | SettingRow::Boundary
        | SettingRow::Damping
        | SettingRow::Reaching
        | SettingRow::Switching => law == Law::SlidingMode,
        SettingRow::Derivative | SettingRow::Proportional => law != Law::SlidingMode,
        SettingRow::Integral => law == Law::Pid,
        // Nothing fades where there is no friction.
        SettingRow::Fade => gains.get(SettingRow::Coulomb) != 0.0,
        _ => true,
    };
    let is_lost = |row: &SettingRow| gains.get(*row) != 0.0 && actual.get(*row) == 0.0;
    SettingRow::ALL.into_iter().find(|row| is_read(row) && is_lost(row))
}

/// The rows of the laws: acceleration in counts/T² of a torque drive and of the sliding mode, velocity in counts/T else.
fn feedback(gains: &mut Gains, controller: &Controller, linear: &Linear, mode: &DriveMode, units: &Units) {
    let tick_s = units.tick_s;
    // Of a velocity drive the command is one order lower.
    let order = match mode {
        DriveMode::Torque { .. } => tick_s,
        DriveMode::Velocity { .. } => 1.0,
    };
    let half = linear.derivative / 2.0;
    let (c, k, epsilon, slope) = match *controller {
        Controller::SlidingMode {
            c,
            k,
            epsilon,
            boundary,
        } => (c, k, epsilon, units.count / (boundary * tick_s)),
        _ => (half, half, 0.0, 0.0),
    };
    *gains = gains.with(&[
        (SettingRow::Surface, c * tick_s),
        (SettingRow::Boundary, slope),
        (SettingRow::Damping, c * tick_s),
        (SettingRow::Reaching, k * tick_s),
        (SettingRow::Switching, epsilon * tick_s * tick_s / units.count),
        (SettingRow::Derivative, linear.derivative * order),
        (SettingRow::Proportional, linear.proportional * tick_s * order),
        (SettingRow::Integral, linear.integral * tick_s * tick_s * order),
    ]);
}

/// The rows from motion to command.
fn command(gains: &mut Gains, law: Law, drive: &Drive, units: &Units) {
    let Units { tick_s, count } = *units;
    match drive.mode {
        DriveMode::Torque {
            equivalent_mass,
            force_constant,
            current_limit_a,
            ..
        } => {
            let per_force = COMMAND_UNITS / force_constant;
            let per_acceleration = per_force * equivalent_mass * count / (tick_s * tick_s);
            *gains = gains.with(&[
                (SettingRow::Feedback, per_acceleration),
                (SettingRow::Acceleration, per_acceleration),
                (SettingRow::Viscous, per_force * drive.viscous * count / tick_s),
                (SettingRow::Coulomb, per_force * drive.coulomb),
                (SettingRow::Limit, COMMAND_UNITS * current_limit_a),
            ]);
        }
        DriveMode::Velocity { full_scale_velocity } => {
            let per_velocity = COMMAND_UNITS * count / tick_s;
            gains.set(SettingRow::Limit, COMMAND_UNITS * full_scale_velocity);
            match (law, drive.bandwidth_hz) {
                (Law::SlidingMode, Some(bandwidth_hz)) => {
                    let per_acceleration = per_velocity / (TAU * bandwidth_hz * tick_s);
                    *gains = gains.with(&[
                        (SettingRow::Feedback, per_acceleration),
                        (SettingRow::Acceleration, per_acceleration),
                        (SettingRow::Viscous, per_velocity),
                    ]);
                }
                _ => {
                    *gains = gains.with(&[
                        (SettingRow::Feedback, per_velocity),
                        (SettingRow::Velocity, per_velocity),
                    ])
                }
            }
        }
    }
}

/// Full scale of the drive, in command units.
pub(super) fn full_scale(mode: &DriveMode) -> f64 {
    COMMAND_UNITS
        * match mode {
            DriveMode::Torque { full_scale_a, .. } => full_scale_a,
            DriveMode::Velocity { full_scale_velocity } => full_scale_velocity,
        }
}

/// Scales the feedback by a power of two: its word then holds just so much as the drive can follow, as finely as it can.
fn scale_feedback(gains: &mut Gains) {
    let reach = FEEDBACK_HEADROOM * gains.get(SettingRow::Limit) / gains.get(SettingRow::Feedback);
    let exponent = (FEEDBACK_RANGE / reach).log2().floor();
    let rows = [
        SettingRow::Damping,
        SettingRow::Reaching,
        SettingRow::Switching,
        SettingRow::Derivative,
        SettingRow::Proportional,
        SettingRow::Integral,
    ];
    // A gain without room for its mantissa would be lost: the finest scale at which all fit.
    let fits = |row: &SettingRow, scale: f64| {
        gains.get(*row) * scale <= f64::from(MANTISSA_MAX) * f64::from(row.exponent()).exp2()
    };
    let scale = (0..=64).map(|step| (exponent - f64::from(step)).exp2());
    let scale = scale.into_iter().find(|scale| rows.iter().all(|row| fits(row, *scale)));
    let scale = scale.unwrap_or(1.0);
    for row in rows {
        gains.set(row, gains.get(row) * scale);
    }
    gains.set(SettingRow::Feedback, gains.get(SettingRow::Feedback) / scale);
}
