//! Runs a controller on its machine, tick by tick, and computes the figures of the steady part.

use super::ControllerCase;
use posicast_machine::plant::drive_train::{DriveTrainPlant, quantised};
use std::f64::consts::TAU;

/// Radius in m and frequency in Hz of the sine that the axis follows.
const SINE: (f64, f64) = (0.01, 2.0);
/// Start and end of the steady part in s: two periods.
const STEADY_S: (f64, f64) = (0.5, 1.5);
/// Cutoff frequency in Hz of the filter of a velocity that is differenced from a scale.
const VELOCITY_FILTER_HZ: f64 = 300.0;

/// Inputs of a law in a tick, in m and s.
pub(super) struct Seen {
    /// r, r′, r″.
    pub(super) reference: [f64; 3],
    pub(super) position: f64,
    pub(super) velocity: f64,
    /// Speed of the motor, rad/s.
    pub(super) motor_speed: f64,
}

/// A law that computes a command each tick.
pub(super) trait Law {
    /// Returns s of this error and its rate, in m/s.
    fn surface(&self, error: f64, rate: f64) -> f64;
    /// Returns the command in A or V.
    fn command(&mut self, seen: &Seen) -> f64;
}

/// Tracking figures of a controller over two periods of the sine.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ControllerFigures {
    /// Largest error in m.
    pub error_peak: f64,
    /// Root mean square of the error in m.
    pub error_rms: f64,
    /// Largest error of the velocity in m/s.
    pub rate_peak: f64,
    /// Root mean square of the command in A; in V without a current loop.
    pub command_rms: f64,
    /// Total variation of the command per second, in A/s or V/s, which measures chatter.
    pub chatter: f64,
    /// Largest s as the controller sees it, in m/s.
    pub surface_peak: f64,
    /// Share of the ticks in which a limit clips the command, 0 to 1.
    pub limited: f64,
    /// Number of sign changes of s per second.
    pub crossings: f64,
}

/// The feedback of a tick.
struct Feedback {
    resolution: Option<f64>,
    kept: f64,
    position: f64,
    velocity: f64,
}

impl Feedback {
    fn new(case: &ControllerCase) -> Self {
        Self {
            resolution: case.scale_m,
            kept: 1.0 - (-TAU * VELOCITY_FILTER_HZ * case.tick_s).exp(),
            position: 0.0,
            velocity: 0.0,
        }
    }

    fn see(&mut self, position: f64, velocity: f64, tick_s: f64) {
        let Some(resolution) = self.resolution else {
            (self.position, self.velocity) = (position, velocity);
            return;
        };
        let shown = quantised(position, resolution);
        let difference = (shown - self.position) / tick_s;
        self.velocity += self.kept * (difference - self.velocity);
        self.position = shown;
    }
}

/// Lets a law follow the sine from rest.
pub(super) fn run(case: &ControllerCase, law: &mut impl Law) -> ControllerFigures {
    let (radius, frequency_hz) = SINE;
    let (omega, tick_s) = (TAU * frequency_hz, case.tick_s);
    let train = case.train();
    let limit = match case.voltage_mode_h {
        None => train.current_limit_a,
        Some(_) => train.voltage_limit_v,
    };
    let mut plant = DriveTrainPlant::new(train, tick_s);
    let mut feedback = Feedback::new(case);
    let [first, end] = [STEADY_S.0, STEADY_S.1].map(|time_s| (time_s / tick_s).round() as u32);
    let (mut found, mut before) = (ControllerFigures::default(), None);
    for tick in 0..end {
        let time_s = f64::from(tick) * tick_s;
        let (sin, cos) = (omega * time_s).sin_cos();
        let reference = [radius * sin, radius * omega * cos, -radius * omega * omega * sin];
        let state = plant.state();
        feedback.see(state.position, state.velocity, tick_s);
        let seen = Seen {
            reference,
            position: feedback.position,
            velocity: feedback.velocity,
            motor_speed: state.speed,
        };
        let surface = law.surface(reference[0] - seen.position, reference[1] - seen.velocity);
        let command = law.command(&seen);
        if tick >= first {
            let (error, rate) = (reference[0] - state.position, reference[1] - state.velocity);
            found.error_peak = found.error_peak.max(error.abs());
            found.error_rms += error * error;
            found.rate_peak = found.rate_peak.max(rate.abs());
            found.command_rms += command * command;
            found.surface_peak = found.surface_peak.max(surface.abs());
            found.limited += f64::from(u8::from(command.abs() >= limit));
            if let Some((command_before, surface_before)) = before {
                let (way, was): (f64, f64) = (command - command_before, surface_before);
                found.chatter += way.abs();
                found.crossings += f64::from(u8::from((surface > 0.0) != (was > 0.0)));
            }
            before = Some((command, surface));
        }
        plant.hold(command);
    }
    let (ticks, time_s) = (f64::from(end - first), STEADY_S.1 - STEADY_S.0);
    ControllerFigures {
        error_rms: (found.error_rms / ticks).sqrt(),
        command_rms: (found.command_rms / ticks).sqrt(),
        chatter: found.chatter / time_s,
        limited: found.limited / ticks,
        crossings: found.crossings / time_s,
        ..found
    }
}
