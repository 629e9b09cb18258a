//! Simulates how a loop follows a command, tick by tick, without the quantisation of the encoder and without friction
//! at standstill.

use nalgebra::Complex;

use super::{LinearLaw, SampledLoop};

/// Limits of the plant's input, which is an acceleration for a torque drive and a velocity for a velocity drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FollowLimits {
    /// Largest magnitude of the input, in m/s² or m/s.
    pub input: f64,
    /// Disturbance by friction or load, which is added to every input, in its unit.
    pub disturbance: f64,
}

/// Positions of an axis at a tick, in m or rad.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Followed {
    /// Reference position.
    pub reference: f64,
    /// Reference minus position of the loop.
    pub error: f64,
    /// Position of the load.
    pub load: f64,
}

impl SampledLoop {
    /// Follows references of position, velocity and acceleration in m and s, from rest at 0.
    pub fn follow(&self, law: &LinearLaw, limits: &FollowLimits, references: &[[f64; 3]]) -> Vec<Followed> {
        let zero = Complex::from(0.0);
        let mut states = vec![zero; self.poles.len()];
        // The newest input comes first.
        let mut inputs = vec![0.0; self.delay_ticks + 2];
        let (mut motor_before, mut integral) = (0.0, 0.0);
        let output = |states: &[Complex<f64>], of: fn(&super::PlantPole) -> Complex<f64>| {
            let parts = self.poles.iter().zip(states);
            parts.map(|(pole, state)| (of(pole) * state).re).sum::<f64>()
        };
        let ticks = references.iter().map(|[position, velocity, acceleration]| {
            let measured = output(&states, |pole| pole.position);
            let motor = output(&states, |pole| pole.motor);
            let rate = (motor - motor_before) / self.tick_s;
            motor_before = motor;
            let error = position - measured;
            let wanted = law.proportional * error
                + law.derivative * (velocity - rate)
                + law.integral * integral
                + law.velocity * rate
                + law.velocity_reference * velocity
                + law.acceleration_reference * acceleration;
            // The integral is frozen while the command is clamped in its direction.
            let clamped = wanted.abs() > limits.input && (wanted < 0.0) == (error < 0.0);
            if !clamped {
                integral += self.tick_s * error;
            }
            inputs.rotate_right(1);
            inputs[0] = wanted.clamp(-limits.input, limits.input) + limits.disturbance;
            let (now, before) = (inputs[self.delay_ticks], inputs[self.delay_ticks + 1]);
            let followed = Followed {
                reference: *position,
                error,
                load: output(&states, |pole| pole.load),
            };
            for (pole, state) in self.poles.iter().zip(&mut states) {
                *state = pole.per_tick * *state + pole.gamma[0] * now + pole.gamma[1] * before;
            }
            followed
        });
        ticks.collect()
    }
}
