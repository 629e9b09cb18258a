//! The feedback in m and s: the gains of the file, defaults for those that it leaves out, and the linear law of the
//! loop.

use std::f64::consts::TAU;

use super::sampled::{LinearLaw, SampledLoop};
use crate::machine_file::{AxisSection, ClockSection, Controller, Drive, DriveMode, ScaleUse};

/// Modulus margin that default gains keep on the machine of the file, and with its frequencies 10 % and 20 % off: a
/// gain margin of at least 6 dB, and a phase margin of at least 29°.
pub const DEFAULT_MARGIN: f64 = 0.5;
/// Frequency factors at which the default gains keep that margin. The last two are the ends.
pub(super) const FACTORS: [f64; 5] = [1.0, 0.9, 1.1, 0.8, 1.2];
/// Product of gain and lag of the default gains; the notes allow 0.5.
const TORQUE_SHARE: f64 = 0.4;
/// Number of steps of the search for slower gains, their ratio, and the number of bisections of the last one.
const STEPS: i32 = 60;
const STEP: f64 = 1.25;
const BISECTIONS: u32 = 6;

/// Gains of PD and PID in m and s.
#[derive(Clone, Copy)]
pub(super) struct Linear {
    pub(super) proportional: f64,
    pub(super) derivative: f64,
    pub(super) integral: f64,
}

/// Gains of PD and PID: those of the file, and the rest computed from this lag.
fn gains_for_lag(controller: &Controller, mode: &DriveMode, lag_s: f64) -> Linear {
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

/// Whether the modes are inside the loop, as with a torque drive or with a scale at the load.
pub(super) fn has_modes(axis: &AxisSection, drive: &Drive) -> bool {
    let on_scale = axis.scale.is_some_and(|scale| scale.usage == ScaleUse::Position);
    !axis.modes.is_empty() && (on_scale || matches!(drive.mode, DriveMode::Torque { .. }))
}

/// Gains of PD and PID: those of the file, or defaults that are as fast as the lag and the modes allow. Where no
/// speed keeps the margin, which may be because of the gains in the file, the defaults are computed from the lag
/// alone.
pub(super) fn default_linear(
    axis: &AxisSection,
    clock: ClockSection,
    controller: &Controller,
    drive: &Drive,
    lag_s: f64,
) -> Linear {
    let fastest = gains_for_lag(controller, &drive.mode, lag_s);
    let given = match controller {
        Controller::SlidingMode { .. } => matches!(drive.mode, DriveMode::Velocity { .. }),
        Controller::Pd {
            proportional,
            derivative,
        } => proportional.is_some() && derivative.is_some(),
        Controller::Pid {
            proportional,
            derivative,
            integral,
        } => proportional.is_some() && derivative.is_some() && integral.is_some(),
    };
    if given {
        return fastest;
    }
    let factors = if has_modes(axis, drive) {
        &FACTORS[..]
    } else {
        &FACTORS[..1]
    };
    let loops = factors
        .iter()
        .map(|factor| SampledLoop::new(axis, clock, lag_s, *factor));
    let Some(loops) = loops.collect::<Option<Vec<_>>>() else {
        return fastest;
    };
    let at = |slower: f64| gains_for_lag(controller, &drive.mode, slower * lag_s);
    let holds = |slower: f64| {
        let law = pd_pid(&at(slower), drive);
        loops.iter().all(|sampled| sampled.holds(&law, DEFAULT_MARGIN))
    };
    let Some(step) = (0..STEPS).find(|step| holds(STEP.powi(*step))) else {
        return fastest;
    };
    let (mut fails, mut found) = (STEP.powi(step - 1), STEP.powi(step));
    for _ in 0..if step > 0 { BISECTIONS } else { 0 } {
        let middle = (fails * found).sqrt();
        if holds(middle) {
            found = middle;
        } else {
            fails = middle;
        }
    }
    at(found)
}

/// The linear laws of PD and PID, with their feed-forward.
fn pd_pid(linear: &Linear, drive: &Drive) -> LinearLaw {
    let feedback = LinearLaw {
        proportional: linear.proportional,
        derivative: linear.derivative,
        integral: linear.integral,
        ..LinearLaw::default()
    };
    match drive.mode {
        DriveMode::Torque { equivalent_mass, .. } => LinearLaw {
            velocity: drive.viscous / equivalent_mass,
            acceleration_reference: 1.0,
            ..feedback
        },
        DriveMode::Velocity { .. } => LinearLaw {
            velocity_reference: 1.0,
            ..feedback
        },
    }
}

/// The linear law near the reference; the sliding mode is linear within its boundary layer.
pub(super) fn linear_law(controller: &Controller, linear: &Linear, drive: &Drive) -> LinearLaw {
    let Controller::SlidingMode {
        c,
        k,
        epsilon,
        boundary,
    } = *controller
    else {
        return pd_pid(linear, drive);
    };
    let reaching = k + epsilon / boundary;
    let (proportional, derivative) = (c * reaching, c + reaching);
    match (drive.mode, drive.bandwidth_hz) {
        (DriveMode::Velocity { .. }, Some(bandwidth_hz)) => LinearLaw {
            proportional: proportional / (TAU * bandwidth_hz),
            derivative: derivative / (TAU * bandwidth_hz),
            integral: 0.0,
            velocity: 1.0,
            velocity_reference: 0.0,
            acceleration_reference: 1.0 / (TAU * bandwidth_hz),
        },
        _ => pd_pid(
            &Linear {
                proportional,
                derivative,
                integral: 0.0,
            },
            drive,
        ),
    }
}
