//! The identified plants of "xy-stage".

use super::designs::mode_of_omega;
use posicast_machine::plant::{Plant, PlantMode};
use posicast_shaper::mode::Mode;

/// A plant of the thesis: `b / (a_2 s² + a_1 s + b)`.
pub(super) struct Identified {
    /// Name of the axis.
    pub(super) name: &'static str,
    pub(super) second: f64,
    pub(super) first: f64,
    pub(super) zeroth: f64,
}

/// Gx and Gy.
pub(super) const PLANTS: [Identified; 2] = [
    Identified {
        name: "X",
        second: 1e-5,
        first: 0.0026,
        zeroth: 6.787,
    },
    Identified {
        name: "Y",
        second: 1e-5,
        first: 0.0018,
        zeroth: 3.4358,
    },
];

impl Identified {
    /// Returns the mode of the plant.
    pub(super) fn mode(&self) -> Mode {
        let omega = (self.zeroth / self.second).sqrt();
        mode_of_omega(omega, self.first / (2.0 * self.second * omega))
    }

    /// Returns the plant of the simulated machine.
    pub(super) fn plant(&self) -> Plant {
        let mode = self.mode();
        Plant::of_shares(vec![PlantMode { mode, share: 1.0 }])
    }
}
