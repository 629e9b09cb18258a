//! Chapter 4 of the thesis on the XY stage: sliding mode, PD and PID on the drive with its screw, under Stribeck friction.
//!
//! ```text
//! r = 10 mm · sin(2π 2 Hz t), 10 kHz, from rest; figures of 0.5 to 1.5 s
//! e = r − x      s = c e + e′ (+ c_i ∫e)      i* = (M a + b v + F̂_c sgn r′)/k_f
//! sliding mode   a = r″ + c e′ (+ c_i e) + ε sat(s/φ) + k s           sgn where φ is 0
//! PD, PID        a = k_p e + k_d e′ (+ k_i ∫e) (+ r″),  k_p = c k, k_d = c + k,  b = 0
//! ```
//!
//! The law is that of section 8.2 of the notes, for a fast current loop, since eq (4-11) has no relative degree. The
//! plant is the X axis of [`posicast_machine::plant::drive_train`] with assumed friction and limits. [`ControllerCase::float`]
//! runs the law in floating point, [`ControllerCase::bit_exact`] runs the hardware's
//! [`TickController`](posicast_blocks::sliding_mode::TickController) instead.

mod exact;
mod float;
mod run;

pub use super::sliding_mode_law::Coefficients;
pub use run::ControllerFigures;

use super::drive::x_axis;
use super::sliding_mode_law;
use posicast_machine::plant::drive_train::{Amplifier, Contact, DriveTrain, Friction, Stribeck, Winding};
use std::f64::consts::TAU;

/// Slope c of the sliding line in 1/s, from the thesis.
pub(super) const SLOPE: f64 = 150.0;
/// Reaching rate k in 1/s, from the thesis.
pub(super) const RATE: f64 = 50.0;
/// Integral gain of PID, 1/s³.
const PID_INTEGRAL: f64 = 2e5;
/// Integral slope of the sliding mode, 1/s².
const SLIDING_INTEGRAL: f64 = 7500.0;
/// Bandwidth of the tuned current loop, rad/s.
const CURRENT_LOOP: f64 = TAU * 1000.0;
/// Lag of the loop at 10 kHz in s: that of the current loop plus half a tick, for which the command is held.
pub(super) const LOOP_LAG_S: f64 = 1.0 / CURRENT_LOOP + 50e-6;
/// Largest current in A: three times the rated one.
const CURRENT_LIMIT_A: f64 = 2.73;
/// Largest voltage in V.
const VOLTAGE_LIMIT_V: f64 = 282.0;
/// Viscous friction of the table in N·s/m, which the sliding-mode laws know.
const VISCOUS: f64 = 200.0;

/// A law with its gains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ControllerLaw {
    /// PD; PID if the integral gain is not 0.
    Linear {
        /// Integral gain k_i in 1/s³; 0 for PD.
        integral: f64,
        /// Whether r″ is fed forward.
        acceleration: bool,
    },
    /// Sliding mode.
    Sliding {
        /// Reaching gain ε, m/s².
        epsilon: f64,
        /// Width φ of the boundary layer in m/s; 0 for the sign function.
        boundary: f64,
        /// Integral slope c_i in 1/s²; 0 for no integral.
        integral: f64,
        /// Whether Coulomb friction is fed forward by the sign of r′.
        coulomb: bool,
    },
    /// Equation (4-11), for a drive without a current loop: a sliding mode that the thesis derives with the motor's inertia left out.
    Equation {
        /// Its coefficients of position and velocity.
        coefficients: Coefficients,
        /// Reaching gain ε, m/s².
        epsilon: f64,
        /// Boundary layer φ, m/s.
        boundary: f64,
    },
}

/// A row of the comparison: a law and its conditions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControllerCase {
    /// Name of the row.
    pub name: &'static str,
    /// The law.
    pub law: ControllerLaw,
    /// Mass of the table divided by the mass that the law assumes.
    pub mass_factor: f64,
    /// Period of the controller in s.
    pub tick_s: f64,
    /// Resolution of the scale in m; the velocity is then its difference through a 300 Hz filter. `None` means ideal
    /// feedback.
    pub scale_m: Option<f64>,
    /// Inductance of the winding in H for a drive without a current loop; `None` for a drive with one.
    pub voltage_mode_h: Option<f64>,
}

const fn case(name: &'static str, law: ControllerLaw) -> ControllerCase {
    ControllerCase {
        name,
        law,
        mass_factor: 1.0,
        tick_s: 1e-4,
        scale_m: None,
        voltage_mode_h: None,
    }
}

const fn linear(integral: f64, acceleration: bool) -> ControllerLaw {
    ControllerLaw::Linear { integral, acceleration }
}

const fn sliding(epsilon: f64, boundary: f64) -> ControllerLaw {
    ControllerLaw::Sliding {
        epsilon,
        boundary,
        integral: 0.0,
        coulomb: false,
    }
}

const fn equation(coefficients: Coefficients) -> ControllerLaw {
    ControllerLaw::Equation {
        coefficients,
        epsilon: 4.0,
        boundary: 0.02,
    }
}

const fn without_current_loop(name: &'static str, law: ControllerLaw, inductance_h: f64) -> ControllerCase {
    ControllerCase {
        voltage_mode_h: Some(inductance_h),
        ..case(name, law)
    }
}

impl ControllerCase {
    /// PD as fast as the sliding mode.
    pub const PD: Self = case("PD", linear(0.0, false));
    /// The same with r″ fed forward.
    pub const PD_FORWARD: Self = case("PD + r″", linear(0.0, true));
    /// PID with r″ fed forward.
    pub const PID_FORWARD: Self = case("PID + r″", linear(PID_INTEGRAL, true));
    /// Sliding mode with the thesis's ε of 150, read in m/s².
    pub const SIGN_150_SI: Self = case("sliding mode, sgn, ε = 150 m/s²", sliding(150.0, 0.0));
    /// Sliding mode with the thesis's ε of 150, read in mm/s².
    pub const SIGN_150_MM: Self = case("sliding mode, sgn, ε = 150 mm/s²", sliding(0.15, 0.0));
    /// Sliding mode with an ε above the friction and the sign function.
    pub const SIGN: Self = case("sliding mode, sgn, ε = 4 m/s²", sliding(4.0, 0.0));
    /// The same with a boundary layer.
    pub const LAYER: Self = case("sliding mode, ε = 4 m/s², φ = 0.02 m/s", sliding(4.0, 0.02));

    /// Equation (4-11) as it is printed.
    pub const EQUATION_PRINTED: Self = without_current_loop(
        "equation (4-11) as printed, 50 mH",
        equation(Coefficients::Printed),
        0.05,
    );
    /// Equation (4-11) with its coefficients corrected. B is the damper of the table to the ground: its viscous
    /// friction.
    pub const EQUATION_CORRECTED: Self = without_current_loop(
        "equation (4-11) corrected, 50 mH",
        equation(Coefficients::Corrected { damping: VISCOUS }),
        0.05,
    );
    /// The same with the thesis's B, which is the damper of the screw and acts on the relative velocity.
    pub(super) const EQUATION_SCREW_DAMPING: Self = without_current_loop(
        "equation (4-11) corrected, B of the screw, 50 mH",
        equation(Coefficients::Corrected {
            damping: sliding_mode_law::DAMPING,
        }),
        0.05,
    );

    /// All rows, in the order of the notes.
    pub const ALL: [Self; 28] = [
        Self::PD,
        Self::PD_FORWARD,
        case("PID", linear(PID_INTEGRAL, false)),
        Self::PID_FORWARD,
        Self::SIGN_150_SI,
        Self::SIGN_150_MM,
        Self::SIGN,
        case("sliding mode, ε = 4 m/s², φ = 0.005 m/s", sliding(4.0, 0.005)),
        Self::LAYER,
        case("sliding mode, ε = 4 m/s², φ = 0.05 m/s", sliding(4.0, 0.05)),
        case("sliding mode, ε = 4 m/s², φ = 0.1 m/s", sliding(4.0, 0.1)),
        case("sliding mode, ε = 150 m/s², φ = 0.5 m/s", sliding(150.0, 0.5)),
        case("sliding mode, ε = 150 m/s², φ = 1 m/s", sliding(150.0, 1.0)),
        case(
            "sliding mode, φ = 0.02 m/s, Coulomb fed forward",
            ControllerLaw::Sliding {
                epsilon: 4.0,
                boundary: 0.02,
                integral: 0.0,
                coulomb: true,
            },
        ),
        case(
            "integral sliding mode, φ = 0.02 m/s",
            ControllerLaw::Sliding {
                epsilon: 4.0,
                boundary: 0.02,
                integral: SLIDING_INTEGRAL,
                coulomb: false,
            },
        ),
        Self {
            mass_factor: 1.5,
            ..case("sliding mode, φ = 0.02 m/s, table 50 % heavier", sliding(4.0, 0.02))
        },
        Self {
            mass_factor: 1.5,
            ..case("PD + r″, table 50 % heavier", linear(0.0, true))
        },
        Self {
            tick_s: 1e-3,
            ..case("sliding mode, φ = 0.02 m/s, 1 kHz", sliding(4.0, 0.02))
        },
        Self {
            tick_s: 1e-3,
            ..case("sliding mode, sgn, ε = 4 m/s², 1 kHz", sliding(4.0, 0.0))
        },
        Self {
            scale_m: Some(1e-6),
            ..case("sliding mode, φ = 0.05 m/s, scale of 1 µm", sliding(4.0, 0.05))
        },
        Self {
            scale_m: Some(1e-7),
            ..case("sliding mode, φ = 0.05 m/s, scale of 0.1 µm", sliding(4.0, 0.05))
        },
        Self {
            scale_m: Some(1e-6),
            ..case("sliding mode, sgn, ε = 4 m/s², scale of 1 µm", sliding(4.0, 0.0))
        },
        without_current_loop(
            "sliding mode, φ = 0.02 m/s, no current loop, 50 mH",
            sliding(4.0, 0.02),
            0.05,
        ),
        without_current_loop(
            "sliding mode, φ = 0.02 m/s, no current loop, 5 mH",
            sliding(4.0, 0.02),
            0.005,
        ),
        without_current_loop(
            "sliding mode, φ = 0.02 m/s, no current loop, 1 mH",
            sliding(4.0, 0.02),
            0.001,
        ),
        without_current_loop(
            "sliding mode, φ = 0.02 m/s, no current loop, 0.2 mH",
            sliding(4.0, 0.02),
            0.0002,
        ),
        Self::EQUATION_PRINTED,
        Self::EQUATION_CORRECTED,
    ];

    /// Returns the plant.
    fn train(&self) -> DriveTrain {
        let amplifier = match self.voltage_mode_h {
            None => Amplifier::TunedCurrent {
                bandwidth_rad_s: CURRENT_LOOP,
            },
            Some(inductance_h) => Amplifier::Voltage {
                winding: Winding {
                    inductance_h,
                    ..super::drive::WINDING
                },
                gain: 1.0,
            },
        };
        let nominal = nominal(amplifier);
        DriveTrain {
            load_mass: self.mass_factor * nominal.load_mass,
            ..nominal
        }
    }

    /// Runs the law in floating point and returns the figures of its steady part.
    pub fn float(&self) -> ControllerFigures {
        run::run(self, &mut float::FloatLaw::new(self))
    }

    /// Runs the hardware's controller instead, bit for bit; `None` for a law that the hardware does not have, and for
    /// a drive without a current loop.
    ///
    /// Its counts are those of the scale. With ideal feedback it has counts of 10 nm, or 100 nm at 1 kHz, and the
    /// true velocity.
    pub fn bit_exact(&self) -> Option<ControllerFigures> {
        let mut law = exact::ExactLaw::new(self)?;
        Some(run::run(self, &mut law))
    }
}

/// Returns the X axis with friction and limits. The thesis does not give them; section 7 of the notes assumes them.
fn nominal(amplifier: Amplifier) -> DriveTrain {
    DriveTrain {
        current_limit_a: CURRENT_LIMIT_A,
        voltage_limit_v: VOLTAGE_LIMIT_V,
        motor_friction: Friction {
            stribeck: Stribeck {
                coulomb: 0.010,
                breakaway: 0.015,
                velocity: 2.0,
                viscous: 2e-5,
            },
            rest_velocity: 0.05,
        },
        load_friction: Friction {
            stribeck: Stribeck {
                coulomb: 40.0,
                breakaway: 60.0,
                velocity: 0.005,
                viscous: VISCOUS,
            },
            rest_velocity: 1e-4,
        },
        contact: Contact::Smooth,
        ..x_axis(amplifier)
    }
}
