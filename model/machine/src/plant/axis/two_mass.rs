//! Motor and table on a screw, with stick-slip friction, for a torque drive whose machine file asks for it.
//!
//! The machine is that of [`super::super::drive_train`], with Karnopp's contact at the table. Its driven coordinate
//! is the motor's displacement, and its load is the table. Below the breakaway force both stand still.

use nalgebra::Vector2;
use std::f64::consts::TAU;

use super::super::drive_train::{Amplifier, Contact, DriveTrain, DriveTrainPlant, Friction, Stribeck, TrainState};
use super::super::free_amplitude;
use super::pins::Command;
use crate::machine_file::{Drive, DriveMode};
use crate::mechanics::{ScrewDrive, Stiction};
use posicast_shaper::mode::Mode;

/// Karnopp's velocity band, m/s: far below a count per tick.
const REST_VELOCITY: f64 = 1e-6;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct TwoMass {
    plant: DriveTrainPlant,
    full_scale_a: f64,
    lead_per_radian: f64,
    mode: Mode,
}

impl TwoMass {
    /// Starts at rest; `None` for a velocity drive, and for one without a bandwidth, which the machine file refuses.
    pub(super) fn new(
        drive: &Drive,
        screw: &ScrewDrive,
        stiction: &Stiction,
        cell_s: f64,
        position: f64,
    ) -> Option<Self> {
        let DriveMode::Torque {
            force_constant,
            current_limit_a,
            full_scale_a,
            ..
        } = drive.mode
        else {
            return None;
        };
        let lead_per_radian = screw.lead_m / TAU;
        let amplifier = Amplifier::TunedCurrent {
            bandwidth_rad_s: TAU * drive.bandwidth_hz?,
        };
        let train = DriveTrain {
            current_limit_a,
            torque_constant: force_constant * lead_per_radian,
            motor_inertia: screw.turning_inertia(),
            load_mass: screw.table_mass,
            lead_per_radian,
            stiffness: screw.stiffness(),
            damping: screw.relative_damping(),
            load_friction: Friction {
                stribeck: Stribeck {
                    coulomb: drive.coulomb,
                    breakaway: stiction.breakaway,
                    velocity: stiction.stribeck_velocity,
                    viscous: drive.viscous,
                },
                rest_velocity: REST_VELOCITY,
            },
            contact: Contact::StickSlip,
            ..DriveTrain::rigid(amplifier)
        };
        let start = TrainState {
            angle: position / lead_per_radian,
            position,
            ..TrainState::default()
        };
        Some(Self {
            plant: DriveTrainPlant::new(train, cell_s).starting(start),
            full_scale_a,
            lead_per_radian,
            mode: train.free_mode(),
        })
    }

    pub(super) fn current_a(&self) -> f64 {
        self.plant.state().current_a
    }

    /// Position of the table, and the amplitude of the free vibration of table against motor that starts from the
    /// present state.
    pub(super) fn load(&self) -> (f64, f64) {
        let state = self.plant.state();
        let apart = Vector2::new(
            state.position - self.lead_per_radian * state.angle,
            state.velocity - self.lead_per_radian * state.speed,
        );
        (state.position, free_amplitude(&self.mode, &apart))
    }

    pub(super) fn displace(&mut self, distance: f64) {
        let state = self.plant.state();
        self.put(TrainState {
            angle: state.angle + distance / self.lead_per_radian,
            position: state.position + distance,
            ..state
        });
    }

    fn put(&mut self, state: TrainState) {
        self.plant = self.plant.clone().starting(state);
    }

    /// Simulates one cell; returns position and velocity of the motor, referred to the table.
    pub(super) fn cell(&mut self, command: &Command) -> (f64, f64) {
        let state = self.plant.state();
        if !command.enabled && state.current_a != 0.0 {
            // The current is switched off at once.
            self.put(TrainState {
                current_a: 0.0,
                ..state
            });
        }
        let asked = if command.enabled {
            command.share * self.full_scale_a
        } else {
            0.0
        };
        self.plant.hold(asked);
        if !command.released {
            // Both masses stand at once.
            self.put(TrainState {
                speed: 0.0,
                velocity: 0.0,
                current_a: self.plant.state().current_a,
                ..state
            });
        }
        let state = self.plant.state();
        (self.lead_per_radian * state.angle, self.lead_per_radian * state.speed)
    }
}
