//! A stepper motor: a rotor in the magnetic field that the steps turn.
//!
//! The field pulls the rotor like a spring whose force is a sine of their distance: it is zero every four full steps. So the rotor
//! swings about its step, lags behind it under load, and falls back by four full steps if it is pulled over. The swing is damped
//! against the mean motion of the field: at a constant velocity the damping takes no force.

use std::f64::consts::TAU;

use super::pins::Command;
use crate::machine_file::StepperSection;

/// Full steps from one place of the rotor to the next one that is the same to the field.
const FULL_STEPS_PER_PITCH: f64 = 4.0;
/// Deceleration of a rotor without current, as a fraction of the largest acceleration of the field: friction and detent.
const COASTING: f64 = 0.05;

/// The motor of an axis, or a drive that is always at its steps.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stepper {
    /// Length of a step in m or rad.
    step: f64,
    /// The field at the end of the last cell.
    field: f64,
    origin: f64,
    cell_s: f64,
    rotor: Option<Rotor>,
}

#[derive(Debug, Clone, PartialEq)]
struct Rotor {
    /// Length of four full steps in m or rad.
    pitch: f64,
    /// Largest acceleration at rest, per s².
    largest: f64,
    /// Twice the damping ratio times the angular frequency, 1/s.
    damping: f64,
    /// Velocity at which the largest force has fallen to 0.71.
    corner: f64,
    /// Mean velocity of the field, over about a sixth of a swing.
    field_velocity: f64,
    /// Part of the way to the velocity of the cell's own steps that the mean goes in a cell.
    follows: f64,
}

impl Stepper {
    /// A motor at rest at `origin`, whose steps are 1/`counts_per_unit` long. Without `stepper` the drive is always at its steps.
    pub(super) fn new(stepper: Option<&StepperSection>, counts_per_unit: f64, cell_s: f64, origin: f64) -> Self {
        let step = 1.0 / counts_per_unit;
        let rotor = stepper.map(|of| {
            let omega = TAU * of.resonance_hz;
            let pitch = FULL_STEPS_PER_PITCH * f64::from(of.microsteps) * step;
            Rotor {
                pitch,
                largest: omega * omega * pitch / TAU,
                damping: 2.0 * of.damping * omega,
                corner: of.corner_velocity.unwrap_or(f64::INFINITY),
                field_velocity: 0.0,
                follows: -(-omega * cell_s).exp_m1(),
            }
        });
        Self {
            step,
            field: origin,
            origin,
            cell_s,
            rotor,
        }
    }

    /// Tells a drive that is always at its steps that it is disabled at this position: it holds the place at which it is enabled.
    pub(super) fn disabled(&mut self, steps: i64, position: f64) {
        if self.rotor.is_none() {
            self.origin = position - steps as f64 * self.step;
        }
    }

    /// Turns the field by the steps of a cell; the rotor may be held.
    pub(super) fn turn(&mut self, command: &Command) {
        let field = self.origin + command.steps as f64 * self.step;
        let moved = field - std::mem::replace(&mut self.field, field);
        if let Some(rotor) = &mut self.rotor {
            rotor.field_velocity += (moved / self.cell_s - rotor.field_velocity) * rotor.follows;
        }
    }

    /// Simulates a cell from a position and velocity, and returns those at its end.
    pub(super) fn cell(&mut self, command: &Command, (position, velocity): (f64, f64)) -> (f64, f64) {
        self.turn(command);
        let field = self.field;
        let Some(rotor) = &self.rotor else {
            if !command.enabled {
                return (position, 0.0);
            }
            return (field, (field - position) / self.cell_s);
        };
        let acceleration = if command.enabled {
            let force = rotor.largest / (1.0 + (velocity / rotor.corner).powi(2)).sqrt();
            force * (TAU * (field - position) / rotor.pitch).sin() + rotor.damping * (rotor.field_velocity - velocity)
        } else {
            let most = COASTING * rotor.largest;
            (-velocity / self.cell_s).clamp(-most, most)
        };
        // The velocity first: the swing then keeps its energy.
        let velocity = velocity + acceleration * self.cell_s;
        (position + velocity * self.cell_s, velocity)
    }

    /// Steps by which the rotor has fallen behind, or run ahead, for ever: multiples of four full steps.
    pub(super) fn lost_steps(&self, steps: i64, position: f64) -> i64 {
        let field = self.origin + steps as f64 * self.step;
        self.rotor.as_ref().map_or(0, |rotor| {
            let pitches = ((field - position) / rotor.pitch).round();
            (pitches * rotor.pitch / self.step).round() as i64
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotor_that_was_held_stays_within_half_a_pitch() {
        let mut stepper = Stepper::new(Some(&NEMA17), 80_000.0, CELL_S, 0.0);
        // A thousand steps, one per 100 µs, while the rotor is held.
        for cell in 0..50_000 {
            stepper.turn(&command(cell / 50));
        }
        let (mut position, mut velocity) = (0.0, 0.0);
        for _ in 0..200_000 {
            (position, velocity) = stepper.cell(&command(1000), (position, velocity));
        }
        // It swings to the nearest place that is the same to the field: 1000 steps less whole pitches of 64.
        let pitch = 64.0 / 80_000.0;
        let at = (1000.0 / 80_000.0_f64).rem_euclid(pitch);
        let nearest = if at > pitch / 2.0 { at - pitch } else { at };
        assert!((position - nearest).abs() < 1e-6, "{position} {nearest}");
        assert_eq!(stepper.lost_steps(1000, position), 1024);
    }

    const CELL_S: f64 = 2e-6;
    const NEMA17: StepperSection = StepperSection {
        microsteps: 16,
        resonance_hz: 150.0,
        damping: 0.05,
        corner_velocity: None,
    };

    fn command(steps: i64) -> Command {
        Command {
            share: 0.0,
            steps,
            enabled: true,
            released: true,
        }
    }

    #[test]
    fn the_rotor_swings_about_its_step_at_its_resonance() {
        let mut stepper = Stepper::new(Some(&NEMA17), 80_000.0, CELL_S, 0.0);
        let (mut state, mut crossings) = ((0.0, 0.0), 0);
        let target = 1.0 / 80_000.0;
        let cells = 25_000;
        let mut highest = 0.0f64;
        for _ in 0..cells {
            let before = state.0;
            state = stepper.cell(&command(1), state);
            crossings += u32::from(before < target && state.0 >= target);
            highest = highest.max(state.0);
        }
        // 0.05 s at 150 Hz are 7.5 periods. The first overshoot is exp(-π·0.05) of the step, and what the field's own motion pushes:
        // 2ζ of a step within a sixth of a swing.
        assert!((7..=8).contains(&crossings), "{crossings}");
        let overshoot = highest / target - 1.0 - (-std::f64::consts::PI * 0.05f64).exp();
        assert!((0.0..0.1).contains(&overshoot), "{overshoot}");
    }

    #[test]
    fn an_overrun_loses_four_full_steps() {
        let mut stepper = Stepper::new(Some(&NEMA17), 80_000.0, CELL_S, 0.0);
        let mut state = (0.0, 0.0);
        // The field jumps by three full steps: the rotor goes back by one.
        for _ in 0..200_000 {
            state = stepper.cell(&command(3 * 16), state);
        }
        assert!((state.0 + 16.0 / 80_000.0).abs() < 1e-6, "{}", state.0);
        assert_eq!(stepper.lost_steps(3 * 16, state.0), 4 * 16);
    }
}
