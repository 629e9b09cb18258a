//! The load on its modes, seen from what the drive moves.
//!
//! With `x` the driven coordinate, `y` the load, `w = x'`, each mode `k` has `d_k`, its distance from `x`, and `v_k = x' + d_k'`:
//!
//! ```text
//! velocity drive   d″ + 2σd′ + ω²d = −x″ − 2σx′     y/x = ω²/(s² + 2σs + ω²): what a shaper is designed for
//! torque drive     d″ + 2σd′ + ω²d = −x″            inside the moved mass, damped by its own motion only
//! y = x + Σ share_k · d_k
//! ```
//!
//! Within a cell of the grid `x` is a ramp, under which both have one closed form: a free oscillation about `−lag·w`.

use nalgebra::{Matrix2, Vector2};

use super::super::{Plant, PlantMode, free_amplitude, free_motion};

#[derive(Debug, Clone, PartialEq)]
struct LoadMode {
    of: PlantMode,
    cell: Matrix2<f64>,
    /// How long the mode trails a ramp: 2ζ/ω in s, or 0.
    lag_s: f64,
    distance: f64,
    velocity: f64,
}

/// All modes of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LoadModes(Vec<LoadMode>);

impl LoadModes {
    /// At rest. `trails`: the modes of a velocity drive, which trail a ramp.
    pub(super) fn new(plant: &Plant, cell_s: f64, trails: bool) -> Self {
        let modes = plant.modes().iter().map(|of| LoadMode {
            of: *of,
            cell: free_motion(&of.mode, cell_s),
            lag_s: if trails {
                2.0 * of.mode.damping / of.mode.omega()
            } else {
                0.0
            },
            distance: 0.0,
            velocity: 0.0,
        });
        Self(modes.collect())
    }

    /// A cell in which the driven coordinate moves at this velocity.
    pub(super) fn cell(&mut self, velocity: f64) {
        for mode in &mut self.0 {
            let rest = -mode.lag_s * velocity;
            let moved = mode.cell * Vector2::new(mode.distance - rest, mode.velocity - velocity);
            (mode.distance, mode.velocity) = (moved.x + rest, moved.y + velocity);
        }
    }

    /// Distance of the load from the driven coordinate.
    pub(super) fn deflection(&self) -> f64 {
        self.0.iter().fold(0.0, |sum, mode| sum + mode.of.share * mode.distance)
    }

    /// Sum of the amplitudes with which the modes ring, if the driven coordinate keeps its velocity from now on.
    pub(super) fn vibration(&self, velocity: f64) -> f64 {
        self.0.iter().fold(0.0, |sum, mode| {
            let state = Vector2::new(mode.distance + mode.lag_s * velocity, mode.velocity - velocity);
            sum + mode.of.share.abs() * free_amplitude(&mode.of.mode, &state)
        })
    }
}
