//! The circle that the XY stage draws: X follows `R cos Ωt` and Y follows `R sin Ωt`, from rest at the centre.
//!
//! The command of X starts with a step of `R`. A sine is not a cubic, so the response is written as the sum of the
//! steady oscillation `Re(H(jΩ)·e^{jΩt})` and the free motion that makes the sum start at rest.

use super::plants::PLANTS;
use nalgebra::{Complex, Vector2};
use posicast_machine::plant::free_motion;
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;

/// Radius in mm (assumed).
const RADIUS_MM: f64 = 10.0;
/// Contour speed in mm/s (assumed).
const SPEED_MM_S: f64 = 100.0;
/// Interval between two samples, in seconds: a few hundred per period of either axis.
const LOOK_S: f64 = 2e-5;
/// Time after the end of the shapers that is sampled, in seconds: once round the circle.
const LOOKED_AT_S: f64 = 0.65;

/// A mode that follows the real part of `e^{j(Ωt − phase)}` from rest at time 0.
struct Follower {
    mode: Mode,
    speed: f64,
    /// Steady response at time 0.
    steady: Complex<f64>,
    /// Position and velocity that the free motion must add at time 0 for a start from rest.
    missing: Vector2<f64>,
}

impl Follower {
    fn new(mode: Mode, speed: f64, phase: f64) -> Self {
        let square = mode.omega() * mode.omega();
        let gain = Complex::from(square) / Complex::new(square - speed * speed, 2.0 * mode.decay() * speed);
        let steady = gain * Complex::from_polar(1.0, -phase);
        Self {
            mode,
            speed,
            steady,
            missing: -Vector2::new(steady.re, (steady * Complex::new(0.0, speed)).re),
        }
    }

    fn at(&self, time_s: f64) -> f64 {
        if time_s < 0.0 {
            return 0.0;
        }
        let steady = self.steady * Complex::from_polar(1.0, self.speed * time_s);
        steady.re + (free_motion(&self.mode, time_s) * self.missing).x
    }
}

/// Returns the positions `(x, y)` over time on a circle of radius 1, for plants whose frequencies are `ratio` times
/// those of their models.
fn path(shapers: &[ImpulseSequence; 2], ratio: f64, duration_s: f64) -> Vec<(f64, f64)> {
    let speed = SPEED_MM_S / RADIUS_MM;
    let phases = [0.0, std::f64::consts::FRAC_PI_2];
    let followers = [0, 1].map(|axis| Follower::new(PLANTS[axis].mode().scaled(ratio), speed, phases[axis]));
    let looks = (duration_s / LOOK_S).ceil() as u32;
    (0..=looks)
        .map(|look| {
            let time_s = f64::from(look) * LOOK_S;
            let [x, y] = [0, 1].map(|axis| {
                let impulses = shapers[axis].impulses().iter();
                impulses
                    .map(|i| i.amplitude * followers[axis].at(time_s - i.time_s))
                    .sum::<f64>()
            });
            (x, y)
        })
        .collect()
}

/// Returns the largest excursion of the stage outside the circle, as a fraction of the radius.
pub(super) fn excursion(shapers: &[ImpulseSequence; 2], ratio: f64) -> f64 {
    let longest_s = shapers.iter().map(ImpulseSequence::duration_s).fold(0.0, f64::max);
    let radii = path(shapers, ratio, longest_s + LOOKED_AT_S).into_iter();
    radii.map(|(x, y)| x.hypot(y) - 1.0).fold(0.0, f64::max)
}

/// Returns the distance outside the circle over time, `(seconds, mm)`, from the time at which the stage reaches 90 %
/// of the radius.
pub(super) fn radius_errors_mm(shapers: &[ImpulseSequence; 2], ratio: f64, duration_s: f64) -> Vec<(f64, f64)> {
    let radii = path(shapers, ratio, duration_s).into_iter().enumerate();
    let errors = radii.map(|(look, (x, y))| (look as f64 * LOOK_S, RADIUS_MM * (x.hypot(y) - 1.0)));
    errors
        .skip_while(|(_, error_mm)| *error_mm < -0.1 * RADIUS_MM)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_follower_starts_at_rest_and_solves_its_differential_equation() {
        let mode = Mode {
            frequency_hz: 20.0,
            damping: 0.1,
        };
        let follower = Follower::new(mode, 10.0, 0.3);
        let step_s = 1e-6;
        assert!(follower.at(0.0).abs() < 1e-14 && (follower.at(step_s) / step_s).abs() < 0.1);
        for time_s in [0.01f64, 0.1, 0.7] {
            let [before, here, after] = [-step_s, 0.0, step_s].map(|d| follower.at(time_s + d));
            let acceleration = (after - 2.0 * here + before) / (step_s * step_s);
            let velocity = (after - before) / (2.0 * step_s);
            let command = (10.0 * time_s - 0.3).cos();
            let force = mode.omega().powi(2) * (command - here) - 2.0 * mode.decay() * velocity;
            assert!(
                (acceleration - force).abs() < 1e-2 * mode.omega().powi(2),
                "{acceleration} {force}"
            );
        }
    }
}
