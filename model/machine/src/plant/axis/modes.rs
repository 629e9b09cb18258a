//! Vibration of the load on its modes, relative to the driven coordinate.
//!
//! With `x` the driven coordinate, `y` the load, `w = x'`, each mode `k` has `d_k`, its distance from `x`, and `v_k = x' + d_k'`:
//!
//! ```text
//! velocity drive   d″ + 2σd′ + ω²d = −x″ − 2σx′     y/x = ω²/(s² + 2σs + ω²): what a shaper is designed for
//! torque drive     d″ + 2σd′ + ω²d = −x″            inside the moved mass, damped by its own motion only
//! y = x + Σ share_k · d_k
//! ```
//!
//! Within a cell of the time grid `x` is a ramp, for which both have one closed form: a free oscillation about
//! `−lag·w`. The frequency of a mode that moves with the position is updated when `x` has moved by 1/4096 of the
//! range of its points.

use nalgebra::{Matrix2, Vector2};

use super::super::{Plant, PlantMode, free_amplitude, free_motion};
use crate::machine_file::AxisSection;

/// Steps of the position, over the range of a moving mode's points, in which its frequency is updated.
const STEPS: f64 = 4096.0;

#[derive(Debug, Clone, PartialEq)]
struct LoadMode {
    of: PlantMode,
    cell: Matrix2<f64>,
    /// Time by which the mode lags a ramp, 2ζ/ω, in s; 0 where it does not.
    lag_s: f64,
    distance: f64,
    velocity: f64,
}

/// All modes of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LoadModes {
    modes: Vec<LoadMode>,
    cell_s: f64,
    trails: bool,
    path: Option<Path>,
}

/// Modes of an axis that move with its position.
#[derive(Debug, Clone, PartialEq)]
struct Path {
    axis: AxisSection,
    /// Factor on all frequencies.
    factor: f64,
    /// Position for which the modes are valid now.
    at: f64,
    step: f64,
}

impl LoadModes {
    /// Makes modes at rest. With `trails` they lag a ramp, as those of a velocity drive do.
    pub(super) fn new(plant: &Plant, cell_s: f64, trails: bool) -> Self {
        let modes = plant.modes().iter().map(|of| LoadMode {
            of: *of,
            cell: free_motion(&of.mode, cell_s),
            lag_s: lag_s(of, trails),
            distance: 0.0,
            velocity: 0.0,
        });
        Self {
            modes: modes.collect(),
            cell_s,
            trails,
            path: None,
        }
    }

    /// Makes the modes move with the position, if those of the axis do.
    pub(super) fn along(mut self, axis: &AxisSection, factor: f64, position: f64) -> Self {
        if let Some(family) = axis.family.as_ref().filter(|family| family.is_position()) {
            self.path = Some(Path {
                axis: axis.clone(),
                factor,
                at: f64::INFINITY,
                step: (family.range[1] - family.range[0]) / STEPS,
            });
            self.follow(position);
        }
        self
    }

    /// Updates the modes for a position that is a step away from the last one.
    fn follow(&mut self, position: f64) {
        let Some(path) = &mut self.path else {
            return;
        };
        if (position - path.at).abs() < path.step {
            return;
        }
        path.at = position;
        for (mode, of_axis) in self.modes.iter_mut().zip(&path.axis.modes) {
            mode.of.mode = of_axis.at(position).scaled(path.factor);
            mode.cell = free_motion(&mode.of.mode, self.cell_s);
            mode.lag_s = lag_s(&mode.of, self.trails);
        }
    }

    /// Simulates a cell at whose end the driven coordinate has reached `position` at this velocity.
    pub(super) fn cell(&mut self, velocity: f64, position: f64) {
        self.follow(position);
        for mode in &mut self.modes {
            let rest = -mode.lag_s * velocity;
            let moved = mode.cell * Vector2::new(mode.distance - rest, mode.velocity - velocity);
            (mode.distance, mode.velocity) = (moved.x + rest, moved.y + velocity);
        }
    }

    /// Distance of the load from the driven coordinate.
    pub(super) fn deflection(&self) -> f64 {
        self.modes
            .iter()
            .fold(0.0, |sum, mode| sum + mode.of.share * mode.distance)
    }

    /// Sum of the amplitudes with which the modes ring, if the driven coordinate keeps its velocity from now on.
    pub(super) fn vibration(&self, velocity: f64) -> f64 {
        self.modes.iter().fold(0.0, |sum, mode| {
            let state = Vector2::new(mode.distance + mode.lag_s * velocity, mode.velocity - velocity);
            sum + mode.of.share.abs() * free_amplitude(&mode.of.mode, &state)
        })
    }
}

/// Time by which a mode lags a ramp, s.
fn lag_s(of: &PlantMode, trails: bool) -> f64 {
    if trails {
        2.0 * of.mode.damping / of.mode.omega()
    } else {
        0.0
    }
}
