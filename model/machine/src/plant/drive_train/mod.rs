//! A drive with its screw: winding or current loop, motor and table as two masses on a damped spring, and friction on
//! both.
//!
//! ```text
//! command ─► amplifier ─► i ─► K_t i ─► [ motor J, θ, ω ]──/\/\/\──[ table m, x, v ]
//!                                        friction T(ω)   K, B       friction F(v)
//!
//! J ω′ = K_t i − T(ω) − p F_n      θ′ = ω       F_n = K (p θ − x) + B (p ω − v)       p: lead per radian, m/rad
//! m v′ = F_n − F(v)                x′ = v
//!
//! TunedCurrent         i′ = ω_c (i* − i)                          command i* in A
//! ProportionalCurrent  L i′ = K_c (i* − i) − K_e ω − R i          command i* in A
//! Velocity             the same with i* = K_v (u − ω)             command u in rad/s    eq (2-18)
//! Voltage              L i′ = K u − K_e ω − R i                   command u in V        eq (4-2), its K_t restored
//! ```
//!
//! The equations are those of the thesis on the XY stage (chapters 2 and 4). `B` acts on the *relative* velocity of motor and table: to
//! the ground it would take 3,250 N at 0.25 m/s.
//!
//! **Friction** is Stribeck's, eq (2-20): `F(v) = [F_c + (F_s − F_c) e^{−(v/v_s)²}] sgn v + b v`. [`Contact::Smooth`]
//! replaces `sgn v` by `tanh(v/v_0)`, with which the mass creeps under a force at rest. [`Contact::StickSlip`] is
//! Karnopp's: a mass at rest stays there up to `F_s`.
//!
//! **Time**: [`DriveTrainPlant`] holds a command for a period, in equal steps of at most
//! [`DriveTrain::longest_step_s`]. A step without dry friction and within the limits is exact, by the matrix
//! exponential; any other is a fourth-order Runge–Kutta step.
//!
//! ```
//! use posicast_machine::plant::drive_train::{Amplifier, DriveTrain, DriveTrainPlant, Winding};
//!
//! let winding = Winding { inductance_h: 0.05, resistance_ohm: 1.0, back_emf: 0.18 };
//! let amplifier = Amplifier::Velocity { winding, current_gain: 2.0, velocity_gain: 30.0 };
//! let train = DriveTrain {
//!     torque_constant: 0.378,
//!     motor_inertia: 9.0388e-6,
//!     load_mass: 50.0,
//!     lead_per_radian: 0.005 / std::f64::consts::TAU,
//!     stiffness: 33.9357e6,
//!     damping: 1.3e4,
//!     ..DriveTrain::rigid(amplifier)
//! };
//! let modes = train.modes();
//! assert!((modes[0].frequency_hz - 128.30).abs() < 0.01);
//! let mut plant = DriveTrainPlant::new(train, 1e-3);
//! for _ in 0..500 {
//!     plant.hold(1.0);
//! }
//! // A rad/s that was commanded, less what the back-EMF takes.
//! assert!((plant.state().speed - 1.0).abs() < 0.01);
//! ```
//!
//! The model leaves out cogging, backlash, the ripple of the PWM, iron losses and temperature.

mod friction;
mod linear;
mod plant;

pub use friction::{Contact, Friction, Stribeck};
pub use plant::{DriveTrainPlant, TrainState, quantised};

use posicast_shaper::mode::Mode;

/// Electrical data of a winding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Winding {
    /// Inductance L in H, above 0.
    pub inductance_h: f64,
    /// Resistance R in Ω, at least 0.
    pub resistance_ohm: f64,
    /// Back-EMF constant K_e in V·s/rad, at least 0.
    pub back_emf: f64,
}

/// The amplifier that turns the command into a current.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amplifier {
    /// A current loop that is tuned to a bandwidth; the command is a current in A.
    TunedCurrent {
        /// Bandwidth ω_c in rad/s, above 0.
        bandwidth_rad_s: f64,
    },
    /// A proportional current loop; the command is a current in A.
    ProportionalCurrent {
        /// The winding.
        winding: Winding,
        /// Gain K_c in V/A. The thesis's Table 2-2 exchanges its name with that of the velocity gain.
        current_gain: f64,
    },
    /// A proportional current loop within a proportional velocity loop, eq (2-18); the command is a speed in rad/s.
    Velocity {
        /// The winding.
        winding: Winding,
        /// Gain K_c in V/A.
        current_gain: f64,
        /// Gain K_v in A·s/rad.
        velocity_gain: f64,
    },
    /// No loop: the voltage is the command times a gain, eq (4-2).
    Voltage {
        /// The winding.
        winding: Winding,
        /// Volts per unit of the command.
        gain: f64,
    },
}

/// Drive, motor, screw and table. Lengths are in m, angles in rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveTrain {
    /// The amplifier.
    pub amplifier: Amplifier,
    /// Largest commanded current, A; it clamps commanded currents, but does not act with [`Amplifier::Voltage`].
    /// Infinite: no limit.
    pub current_limit_a: f64,
    /// Largest voltage at the winding, V; it has no effect on [`Amplifier::TunedCurrent`], which has no winding.
    /// Infinite: no limit.
    pub voltage_limit_v: f64,
    /// Torque constant K_t in N·m/A.
    pub torque_constant: f64,
    /// Inertia J of motor and screw in kg·m², above 0.
    pub motor_inertia: f64,
    /// Moved mass m of the table in kg, above 0.
    pub load_mass: f64,
    /// Displacement of the table per radian of the motor p in m/rad: the lead over 2π. Above 0.
    pub lead_per_radian: f64,
    /// Stiffness K between motor and table, at the table, N/m.
    pub stiffness: f64,
    /// Damping B in parallel with that spring, on the relative velocity, N·s/m.
    pub damping: f64,
    /// Friction at the motor: N·m over rad/s.
    pub motor_friction: Friction,
    /// Friction at the table: N over m/s.
    pub load_friction: Friction,
    /// Model of dry friction at rest.
    pub contact: Contact,
}

impl DriveTrain {
    /// This amplifier with unit masses and a radian per metre, without spring, limit or friction; the other fields
    /// are set from there.
    pub fn rigid(amplifier: Amplifier) -> Self {
        Self {
            amplifier,
            current_limit_a: f64::INFINITY,
            voltage_limit_v: f64::INFINITY,
            torque_constant: 1.0,
            motor_inertia: 1.0,
            load_mass: 1.0,
            lead_per_radian: 1.0,
            stiffness: 0.0,
            damping: 0.0,
            motor_friction: Friction::NONE,
            load_friction: Friction::NONE,
            contact: Contact::Smooth,
        }
    }

    /// Mass M in kg that the motor's force accelerates below the mode's frequency: `m + J/p²`.
    pub fn equivalent_mass(&self) -> f64 {
        self.load_mass + self.motor_mass()
    }

    /// Inertia of the motor's side as a mass at the table, kg: `J/p²`.
    pub fn motor_mass(&self) -> f64 {
        self.motor_inertia / (self.lead_per_radian * self.lead_per_radian)
    }

    /// Force per current at the table, N/A: `K_t/p`.
    pub fn force_constant(&self) -> f64 {
        self.torque_constant / self.lead_per_radian
    }

    /// Largest dry friction of both masses as a force at the table, N: `F_s + T_s/p`. A sliding mode must switch more than this.
    pub fn breakaway_force(&self) -> f64 {
        self.load_friction.stribeck.breakaway + self.motor_friction.stribeck.breakaway / self.lead_per_radian
    }

    /// Sliding friction of both masses as a force at the table, N: `F_c + T_c/p`. A controller feeds this forward.
    pub fn coulomb_force(&self) -> f64 {
        self.load_friction.stribeck.coulomb + self.motor_friction.stribeck.coulomb / self.lead_per_radian
    }

    /// Mode of the table on its spring while the motor is held: `ω² = K/m`, `2ζω = B/m`.
    pub fn held_mode(&self) -> Mode {
        Mode::of_spring(self.stiffness, self.damping, self.load_mass)
    }

    /// Mode of motor against table, both free: as for the held motor, with the mass `m J/p² / (m + J/p²)`.
    pub fn free_mode(&self) -> Mode {
        let reduced = self.load_mass * self.motor_mass() / self.equivalent_mass();
        Mode::of_spring(self.stiffness, self.damping, reduced)
    }
}
