//! The drive, which follows its command with a bandwidth, as a current or as a velocity.
//!
//! The result is exact for a command that is constant over a cell of the time grid.

use std::f64::consts::TAU;

use super::friction::{Slide, Sliding};
use super::pins::Command;
use super::stepper::Stepper;
use super::two_mass::TwoMass;
use crate::machine_file::{Drive, DriveMode};
use crate::mechanics::{ScrewDrive, Stiction};

/// A first-order lag `y' = ω (u − y)`, or `y = u` for a drive without a stated bandwidth.
#[derive(Debug, Clone, PartialEq)]
struct FirstOrder {
    state: f64,
    /// Fraction of a distance from the command that remains after a cell, and its mean over the cell.
    left: f64,
    mean: f64,
}

impl FirstOrder {
    fn new(bandwidth_hz: Option<f64>, cell_s: f64) -> Self {
        let cells = bandwidth_hz.map_or(f64::INFINITY, |bandwidth_hz| TAU * bandwidth_hz * cell_s);
        Self {
            state: 0.0,
            left: (-cells).exp(),
            // With such a low bandwidth the output does not change within a cell.
            mean: if cells > 0.0 { -(-cells).exp_m1() / cells } else { 1.0 },
        }
    }

    /// Follows `command` for a cell, and returns the mean of the output in it.
    fn follow(&mut self, command: f64) -> f64 {
        let away = self.state - command;
        self.state = command + self.left * away;
        command + self.mean * away
    }
}

/// The drive with the mass that it moves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Driven {
    kind: Kind,
    cell_s: f64,
    /// Position in m or rad.
    pub(super) position: f64,
    /// Velocity in m/s or rad/s, at the end of the cell.
    pub(super) velocity: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Velocity {
        full_scale: f64,
        velocity: FirstOrder,
    },
    Torque {
        full_scale_a: f64,
        limit_a: f64,
        current: FirstOrder,
        /// Acceleration per current, m/s² per A.
        acceleration_per_a: f64,
        sliding: Sliding,
    },
    Screw(Box<TwoMass>),
    Stepper(Stepper),
}

impl Driven {
    pub(super) fn new(drive: &Drive, cell_s: f64, position: f64) -> Self {
        let follows = FirstOrder::new(drive.bandwidth_hz, cell_s);
        let kind = match drive.mode {
            DriveMode::Velocity { full_scale_velocity } => Kind::Velocity {
                full_scale: full_scale_velocity,
                velocity: follows,
            },
            DriveMode::Torque {
                equivalent_mass,
                force_constant,
                current_limit_a,
                full_scale_a,
            } => Kind::Torque {
                full_scale_a,
                limit_a: current_limit_a,
                current: follows,
                acceleration_per_a: force_constant / equivalent_mass,
                sliding: Sliding::new(drive.viscous / equivalent_mass, drive.coulomb / equivalent_mass, cell_s),
            },
        };
        Self {
            kind,
            cell_s,
            position,
            velocity: 0.0,
        }
    }

    /// A drive with step inputs and its motor.
    pub(super) fn of_stepper(stepper: Stepper, cell_s: f64, position: f64) -> Self {
        Self {
            kind: Kind::Stepper(stepper),
            cell_s,
            position,
            velocity: 0.0,
        }
    }

    /// Steps that the motor has lost out of these, in multiples of four full steps.
    pub(super) fn lost_steps(&self, steps: i64) -> i64 {
        match &self.kind {
            Kind::Stepper(stepper) => stepper.lost_steps(steps, self.position),
            _ => 0,
        }
    }

    /// Replaces the single mass by motor and table on their screw, with stick-slip friction.
    pub(super) fn with_stiction(self, drive: &Drive, screw: &ScrewDrive, stiction: &Stiction) -> Self {
        match TwoMass::new(drive, screw, stiction, self.cell_s, self.position) {
            Some(two_mass) => Self {
                kind: Kind::Screw(Box::new(two_mass)),
                ..self
            },
            None => self,
        }
    }

    /// Position of the load and amplitude of its ringing, if these are not computed from modes.
    pub(super) fn load(&self) -> Option<(f64, f64)> {
        match &self.kind {
            Kind::Screw(two_mass) => Some(two_mass.load()),
            _ => None,
        }
    }

    /// Moves the whole by this distance.
    pub(super) fn displace(&mut self, distance: f64) {
        self.position += distance;
        if let Kind::Screw(two_mass) = &mut self.kind {
            two_mass.displace(distance);
        }
    }

    /// Output of the drive: current in A, or velocity in m/s.
    pub(super) fn output(&self) -> f64 {
        match &self.kind {
            Kind::Velocity { velocity, .. } => velocity.state,
            Kind::Torque { current, .. } => current.state,
            Kind::Screw(two_mass) => two_mass.current_a(),
            Kind::Stepper(_) => self.velocity,
        }
    }

    /// Simulates one cell.
    pub(super) fn cell(&mut self, command: &Command) {
        let travel = match &mut self.kind {
            Kind::Screw(two_mass) => {
                (self.position, self.velocity) = two_mass.cell(command);
                return;
            }
            Kind::Stepper(stepper) => {
                if command.released {
                    (self.position, self.velocity) = stepper.cell(command, (self.position, self.velocity));
                } else {
                    stepper.turn(command);
                    self.velocity = 0.0;
                }
                if !command.enabled {
                    stepper.disabled(command.steps, self.position);
                }
                return;
            }
            Kind::Velocity { full_scale, velocity } => {
                let wanted = if command.enabled {
                    command.share * *full_scale
                } else {
                    0.0
                };
                let mean = velocity.follow(wanted);
                Slide {
                    velocity: velocity.state,
                    distance: mean * self.cell_s,
                }
            }
            Kind::Torque {
                full_scale_a,
                limit_a,
                current,
                acceleration_per_a,
                sliding,
            } => {
                let mean_a = if command.enabled {
                    current.follow((command.share * *full_scale_a).clamp(-*limit_a, *limit_a))
                } else {
                    current.state = 0.0;
                    0.0
                };
                sliding.slide(self.velocity, mean_a * *acceleration_per_a)
            }
        };
        if command.released {
            self.position += travel.distance;
            self.velocity = travel.velocity;
            return;
        }
        self.velocity = 0.0;
        if let Kind::Velocity { velocity, .. } = &mut self.kind {
            velocity.state = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ON: Command = Command {
        share: 0.5,
        steps: 0,
        enabled: true,
        released: true,
    };
    const CELL_S: f64 = 2e-6;

    fn velocity_drive(bandwidth_hz: Option<f64>) -> Driven {
        let drive = Drive {
            mode: DriveMode::Velocity {
                full_scale_velocity: 0.4,
            },
            bandwidth_hz,
            viscous: 0.0,
            coulomb: 0.0,
        };
        Driven::new(&drive, CELL_S, 0.0)
    }

    fn torque_drive(viscous: f64, coulomb: f64) -> Driven {
        let drive = Drive {
            mode: DriveMode::Torque {
                equivalent_mass: 50.0,
                force_constant: 400.0,
                current_limit_a: 2.0,
                full_scale_a: 8.0,
            },
            bandwidth_hz: Some(1000.0),
            viscous,
            coulomb,
        };
        Driven::new(&drive, CELL_S, 0.0)
    }

    fn run(driven: &mut Driven, command: Command, cells: u32) {
        (0..cells).for_each(|_| driven.cell(&command));
    }

    #[test]
    fn a_velocity_drive_follows_by_its_bandwidth() {
        let mut stiff = velocity_drive(None);
        run(&mut stiff, ON, 500);
        assert!((stiff.position - 0.2 * 1e-3).abs() < 1e-15);
        let mut soft = velocity_drive(Some(200.0));
        run(&mut soft, ON, 5000);
        let (pole, time_s): (f64, f64) = (TAU * 200.0, 0.01);
        let left = (-pole * time_s).exp();
        assert!((soft.velocity - 0.2 * (1.0 - left)).abs() < 1e-12);
        assert!((soft.position - 0.2 * (time_s - (1.0 - left) / pole)).abs() < 1e-12);
        // Switched off, the drive brakes with its bandwidth. With the brake applied, the axis stands.
        run(&mut soft, Command { enabled: false, ..ON }, 5000);
        assert!(soft.velocity.abs() < 1e-6);
        run(&mut soft, ON, 1000);
        let position = soft.position;
        run(&mut soft, Command { released: false, ..ON }, 1000);
        assert_eq!((soft.position, soft.velocity, soft.output()), (position, 0.0, 0.0));
    }

    #[test]
    fn a_torque_drive_accelerates_its_mass_within_the_limit() {
        let mut driven = torque_drive(0.0, 0.0);
        run(&mut driven, ON, 50_000);
        // Half of 8 A is commanded, but 2 A is the limit: 16 m/s², late by the time constant of the current.
        let late_s = 1.0 / (TAU * 1000.0);
        assert!((driven.velocity - 16.0 * (0.1 - late_s)).abs() < 1e-9);
        let coasting = driven.velocity;
        run(&mut driven, Command { enabled: false, ..ON }, 10);
        assert_eq!((driven.velocity, driven.output()), (coasting, 0.0));
    }

    #[test]
    fn friction_of_both_kinds_ends_a_coast() {
        let mut driven = torque_drive(100.0, 100.0);
        run(&mut driven, ON, 25_000);
        assert!(driven.velocity > 0.6);
        run(&mut driven, Command { enabled: false, ..ON }, 200_000);
        assert_eq!(driven.velocity, 0.0);
    }
}
