//! Derives the gains of an axis from its machine file.

use std::f64::consts::TAU;

use super::ControlError;
use super::conditions::{self, ControlWarning, Loop};
use super::culprit::Numbers;
use super::law::Gains;
use super::linear::{Linear, default_linear, linear_law};
use super::sampled::{LinearLaw, Margins, SampledLoop};
use crate::machine_file::{AxisSection, ClockSection, Controller, Drive, DriveMode};
use posicast_blocks::sliding_mode::{Law, MANTISSA_MAX, SettingRow, Settings};

/// Command units per unit of the drive: mA per A, or mm/s per m/s.
const COMMAND_UNITS: f64 = 1000.0;
/// Range of the feedback's word: ±2^7.
const FEEDBACK_RANGE: f64 = 128.0;
/// Ratio of the feedback's range to the command limit.
const FEEDBACK_HEADROOM: f64 = 4.0;
/// Modulus margin below which a warning is given: 0.5 guarantees a gain margin of 6 dB and a phase margin of 29°.
const THIN: f64 = 0.5;
/// Tolerance by which rounding may lower the margin of default gains.
const ROUNDED: f64 = 1e-6;
/// Smallest fade velocity in counts per tick: a fade can be no steeper.
const LEAST_FADE: f64 = 1.0 / 128.0;

/// The controller of an axis with its figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// Control law of the machine file, which is the reset value of the register.
    pub law: Law,
    /// Gains before quantising, in counts, ticks and command units.
    pub gains: Gains,
    /// Gains and command limit as the hardware holds them.
    pub settings: Settings,
    /// The conditions that do not hold.
    pub warnings: Vec<ControlWarning>,
    /// Position error in m (rad) that a constant Coulomb friction leaves, without the feed-forward against it.
    pub steady_error: f64,
    /// The linear law near the reference, in m and s; for the sliding mode that within the boundary layer.
    pub linear: LinearLaw,
    /// Stability of the sampled loop on the machine of the file, modes included.
    pub margins: Margins,
    /// The sampled loop to which the margins belong.
    pub sampled: SampledLoop,
}

/// Lag of a loop in s: the delay from the capture of the position to the new duty, plus the drive's own lag. A
/// velocity that is measured over a tick adds half a tick to the delay.
pub fn loop_lag_s(drive: &Drive, schedule_delay_s: f64) -> f64 {
    schedule_delay_s
        + drive
            .bandwidth_hz
            .map_or(0.0, |bandwidth_hz| 1.0 / (TAU * bandwidth_hz))
}

/// Factors that convert m and s to counts and ticks.
struct Units {
    /// Tick T in s.
    tick_s: f64,
    /// Length q of a count of the loop, in m.
    count: f64,
}

/// Derives gains, settings and warnings of an axis.
///
/// `lag_s` is the whole lag of the loop, see [`loop_lag_s`]. Gains that the file leaves out are computed from it and
/// from the modes in the loop. In the table `lag` is the smallest time, at least `lag_s`, that leaves the margin
/// [`crate::control::DEFAULT_MARGIN`]:
///
/// | drive | law | rule | reason |
/// |---|---|---|---|
/// | torque | PD | D = 0.4/lag, P = D²/4 | `s² + D·s + P` has a double real pole |
/// | torque | PID | D = 0.4/lag, P = D²/3, I = D³/27 | `s³ + D·s² + P·s + I` has a triple real pole |
/// | velocity | PD | P = 1/(4·lag), D = 0 | `lag·s² + s + P` has a double real pole |
/// | velocity | PID | P = 1/(3·lag), I = 1/(27·lag²), D = 0 | `lag·s³ + s² + P·s + I` has a triple real pole |
///
/// The laws that the file does not choose get their gains by the same rules, so that the law can be changed at run
/// time. The sliding mode of a torque drive then has no switching term and c = k = D/2, which equals the default PD.
///
/// # Errors
/// [`ControlError`] where a table or the bandwidth is missing, a gain does not fit, or the loop is unstable on the
/// machine of the file.
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

/// The first row that the law uses whose gain is not 0 but is quantised to 0.
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
        // The fade is not used where there is no friction.
        SettingRow::Fade => gains.get(SettingRow::Coulomb) != 0.0,
        _ => true,
    };
    let is_lost = |row: &SettingRow| gains.get(*row) != 0.0 && actual.get(*row) == 0.0;
    SettingRow::ALL.into_iter().find(|row| is_read(row) && is_lost(row))
}

/// Sets the rows of the feedback: an acceleration in counts/T² for a torque drive and for the sliding mode, else a
/// velocity in counts/T.
fn feedback(gains: &mut Gains, controller: &Controller, linear: &Linear, mode: &DriveMode, units: &Units) {
    let tick_s = units.tick_s;
    // The command of a velocity drive is one order of time lower.
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

/// Sets the rows that turn motion into a command.
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

/// Scales the feedback by a power of two, so that its word just covers what the drive can follow, with the finest
/// resolution.
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
    // A gain whose mantissa has no room would be lost, so this is the finest scale at which all gains fit.
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
