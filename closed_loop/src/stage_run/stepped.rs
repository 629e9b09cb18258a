//! Expected figures of a move of an axis with steps, from the machine file alone: the shaped reference, the motor as a linear spring,
//! and the modes behind it. Neither the stage nor its pins are used.

use posicast_machine::machine_file::AxisSection;
use posicast_machine::plant::axis::AxisPlantError;
use posicast_machine::plant::{Plant, SampledPlant};
use std::f64::consts::TAU;

use super::StageRunError;
use super::expected::Expected;
use super::figures;
use crate::stage_bench::AxisSample;

/// Parts of a tick in which motor and modes are integrated.
const PARTS: u32 = 64;
/// Steps that the ringing of a motor about its rest may add: the last step comes at once, and the motor overshoots it by up to its
/// size.
const LAST_STEP: f64 = 1.0;

/// Expected figures for references (position, velocity, acceleration, in units and s) in every tick.
pub(super) fn expected(
    axis: &AxisSection,
    sample_hz: f64,
    references: &[[f64; 3]],
    frequency_factor: f64,
) -> Result<Expected, StageRunError> {
    let unit = axis.loop_counts_per_unit();
    let plant = Plant::of_axis(axis).map_err(|source| AxisPlantError::Modes {
        axis: axis.name.clone(),
        source,
    })?;
    let part_s = 1.0 / (sample_hz * f64::from(PARTS));
    let mut modes = SampledPlant::new(&plant.scaled(frequency_factor), part_s, 0.0);
    let mut motor = Motor::new(axis, part_s);
    let (mut samples, mut before) = (Vec::with_capacity(references.len()), 0.0);
    for [reference, ..] in references {
        let mut load = 0.0;
        for part in 1..=PARTS {
            let along = f64::from(part) / f64::from(PARTS);
            let field = before + (reference - before) * along;
            load = modes.step(motor.follow(field, (reference - before) * sample_hz));
        }
        samples.push(AxisSample {
            command: reference * unit,
            shaped: reference * unit,
            count: before * unit,
            // The lines are less than a tick behind.
            error: (reference - before) * unit,
            motor: motor.position,
            load,
        });
        before = *reference;
    }
    let distance = references.last().map_or(0.0, |last| last[0]);
    Ok(Expected {
        distance,
        counts: distance * unit,
        figures: figures::of_move(&samples, unit),
        friction: LAST_STEP / unit,
        handover: 0.0,
        count: 1.0 / unit,
    })
}

/// The motor's rotor in a linear spring.
struct Motor {
    omega: f64,
    damping: f64,
    part_s: f64,
    position: f64,
    velocity: f64,
}

impl Motor {
    fn new(axis: &AxisSection, part_s: f64) -> Self {
        let (omega, damping) = axis
            .stepper
            .map_or((f64::INFINITY, 0.0), |of| (TAU * of.resonance_hz, of.damping));
        Self {
            omega,
            damping,
            part_s,
            position: 0.0,
            velocity: 0.0,
        }
    }

    /// Follows the field, which has this velocity, for a part of a tick. Without a stated resonance the drive is always at its steps.
    fn follow(&mut self, field: f64, field_velocity: f64) -> f64 {
        if self.omega.is_infinite() {
            self.position = field;
            return field;
        }
        let damping = 2.0 * self.damping * self.omega;
        let pull = self.omega.powi(2) * (field - self.position) + damping * (field_velocity - self.velocity);
        self.velocity += pull * self.part_s;
        self.position += self.velocity * self.part_s;
        self.position
    }
}
