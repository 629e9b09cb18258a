//! Gains of an axis from its machine file.

use std::f64::consts::TAU;

use super::ControlError;
use super::conditions::{self, ControlWarning, Loop};
use super::culprit::Numbers;
use super::law::Gains;
use crate::rtl::sliding_mode::{Law, MANTISSA_MAX, Row, Settings};
use crate::spec::{Axis, Clock, Controller, Drive, DriveMode, ScaleUse};

/// Command units per unit of the drive: mA per A, mm/s per m/s.
const COMMAND_UNITS: f64 = 1000.0;
/// The feedback's word holds ±2^7.
const FEEDBACK_RANGE: f64 = 128.0;
/// The feedback reaches so many times the limit before its word saturates.
const FEEDBACK_HEADROOM: f64 = 4.0;
/// Of the largest gain × lag that the notes allow (0.5): what a default takes.
const TORQUE_SHARE: f64 = 0.4;
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

/// Feedback gains in m and s: PD and PID.
#[derive(Clone, Copy)]
struct Linear {
    proportional: f64,
    derivative: f64,
    integral: f64,
}

/// Derives gains, settings and warnings of an axis.
///
/// `lag_s` is the whole lag of the loop, see [`loop_lag_s`]. Gains that the file leaves out follow from it:
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
/// [`ControlError`] where a table or the bandwidth is missing, or a gain does not fit.
pub fn gains(axis: &Axis, clock: Clock, lag_s: f64) -> Result<Derived, ControlError> {
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
    let linear = linear(controller, &drive.mode, lag_s);
    let closed = Loop {
        controller,
        linear_poles: match drive.mode {
            DriveMode::Torque { .. } => linear.derivative,
            DriveMode::Velocity { .. } => linear.proportional,
        },
        stable: is_stable(&linear, &drive.mode, lag_s),
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
    let mut gains = Gains::default().with(&[(Row::Fade, 1.0 / fade)]);
    feedback(&mut gains, controller, &linear, &drive.mode, &units);
    command(&mut gains, law, drive, &units);
    gains.set(
        Row::Duty,
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
    let mut warnings = closed.warnings();
    warnings.extend(modes_in_loop(axis, &drive.mode, linear.proportional));
    warnings.extend(conditions::coarse_gains(&gains, &settings));
    Ok(Derived {
        law,
        gains,
        settings,
        warnings,
        steady_error: closed.steady_error(&linear.proportional),
    })
}

/// A velocity drive's loop on a scale at the load: `K·ω²/(s·(s² + 2ζω·s + ω²))` is stable for K below 2ζω.
fn modes_in_loop(axis: &Axis, drive: &DriveMode, proportional: f64) -> Option<ControlWarning> {
    let on_scale = axis.scale.is_some_and(|scale| scale.usage == ScaleUse::Position);
    if !on_scale || !matches!(drive, DriveMode::Velocity { .. }) {
        return None;
    }
    let modes = axis.modes.iter().map(|spec| spec.mode.decay());
    let allowed = modes.fold(f64::INFINITY, f64::min);
    (proportional > allowed).then_some(ControlWarning::ModesInLoop {
        found: proportional,
        allowed,
    })
}

/// The first row that the law reads, that is not 0, and that is 0 in mantissa and shift.
fn lost(gains: &Gains, settings: &Settings, law: Law) -> Option<Row> {
    let actual = Gains::of_settings(settings);
    let is_read = |row: &Row| match row {
        Row::Surface | Row::Boundary | Row::Damping | Row::Reaching | Row::Switching => law == Law::SlidingMode,
        Row::Derivative | Row::Proportional => law != Law::SlidingMode,
        Row::Integral => law == Law::Pid,
        // Nothing fades where there is no friction.
        Row::Fade => gains.get(Row::Coulomb) != 0.0,
        _ => true,
    };
    let is_lost = |row: &Row| gains.get(*row) != 0.0 && actual.get(*row) == 0.0;
    Row::ALL.into_iter().find(|row| is_read(row) && is_lost(row))
}

/// Gains of PD and PID: those of the file, or the defaults.
fn linear(controller: &Controller, mode: &DriveMode, lag_s: f64) -> Linear {
    let (proportional, derivative, integral, with_integral) = match *controller {
        Controller::SlidingMode { .. } => (None, None, None, false),
        Controller::Pd {
            proportional,
            derivative,
        } => (proportional, derivative, None, false),
        Controller::Pid {
            proportional,
            derivative,
            integral,
        } => (proportional, derivative, integral, true),
    };
    let torque = matches!(mode, DriveMode::Torque { .. });
    let derivative = derivative.unwrap_or(if torque { TORQUE_SHARE / lag_s } else { 0.0 });
    let d = derivative;
    let (p, i) = match (torque, with_integral) {
        (true, false) => (d * d / 4.0, 0.0),
        (true, true) => (d * d / 3.0, d * d * d / 27.0),
        (false, false) => (0.25 / lag_s, 0.0),
        (false, true) => (1.0 / (3.0 * lag_s), 1.0 / (27.0 * lag_s * lag_s)),
    };
    Linear {
        proportional: proportional.unwrap_or(p),
        derivative,
        integral: integral.unwrap_or(i),
    }
}

/// Routh's criterion of the loop as it is without the lag (torque), or with it (velocity).
fn is_stable(linear: &Linear, mode: &DriveMode, lag_s: f64) -> bool {
    match mode {
        DriveMode::Torque { .. } => linear.derivative * linear.proportional > linear.integral,
        DriveMode::Velocity { .. } => {
            linear.derivative < 1.0 && (1.0 + linear.derivative) * linear.proportional > linear.integral * lag_s
        }
    }
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
        (Row::Surface, c * tick_s),
        (Row::Boundary, slope),
        (Row::Damping, c * tick_s),
        (Row::Reaching, k * tick_s),
        (Row::Switching, epsilon * tick_s * tick_s / units.count),
        (Row::Derivative, linear.derivative * order),
        (Row::Proportional, linear.proportional * tick_s * order),
        (Row::Integral, linear.integral * tick_s * tick_s * order),
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
                (Row::Feedback, per_acceleration),
                (Row::Acceleration, per_acceleration),
                (Row::Viscous, per_force * drive.viscous * count / tick_s),
                (Row::Coulomb, per_force * drive.coulomb),
                (Row::Limit, COMMAND_UNITS * current_limit_a),
            ]);
        }
        DriveMode::Velocity { full_scale_velocity } => {
            let per_velocity = COMMAND_UNITS * count / tick_s;
            gains.set(Row::Limit, COMMAND_UNITS * full_scale_velocity);
            match (law, drive.bandwidth_hz) {
                (Law::SlidingMode, Some(bandwidth_hz)) => {
                    let per_acceleration = per_velocity / (TAU * bandwidth_hz * tick_s);
                    *gains = gains.with(&[
                        (Row::Feedback, per_acceleration),
                        (Row::Acceleration, per_acceleration),
                        (Row::Viscous, per_velocity),
                    ]);
                }
                _ => *gains = gains.with(&[(Row::Feedback, per_velocity), (Row::Velocity, per_velocity)]),
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
    let reach = FEEDBACK_HEADROOM * gains.get(Row::Limit) / gains.get(Row::Feedback);
    let exponent = (FEEDBACK_RANGE / reach).log2().floor();
    let rows = [
        Row::Damping,
        Row::Reaching,
        Row::Switching,
        Row::Derivative,
        Row::Proportional,
        Row::Integral,
    ];
    // A gain without room for its mantissa would be lost: the finest scale at which all fit.
    let fits =
        |row: &Row, scale: f64| gains.get(*row) * scale <= f64::from(MANTISSA_MAX) * f64::from(row.exponent()).exp2();
    let scale = (0..=64).map(|step| (exponent - f64::from(step)).exp2());
    let scale = scale.into_iter().find(|scale| rows.iter().all(|row| fits(row, *scale)));
    let scale = scale.unwrap_or(1.0);
    for row in rows {
        gains.set(row, gains.get(row) * scale);
    }
    gains.set(Row::Feedback, gains.get(Row::Feedback) / scale);
}
