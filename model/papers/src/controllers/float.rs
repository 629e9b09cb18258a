//! The laws in floating point, in m and s.

use super::run::{Law, Seen};
use super::{CURRENT_LIMIT_A, CURRENT_LOOP, ControllerCase, ControllerLaw, RATE, SLOPE, VISCOUS, nominal};
use crate::drive::WINDING;
use crate::sliding_mode_law;
use posicast_machine::plant::drive_train::{Amplifier, DriveTrain};

/// A law with its integral.
pub(super) struct FloatLaw {
    law: ControllerLaw,
    /// The machine parameters that the law uses.
    known: DriveTrain,
    tick_s: f64,
    in_volts: bool,
    /// Sum of the errors of the previous ticks, ∫e, m·s.
    integral: f64,
}

impl FloatLaw {
    pub(super) fn new(case: &ControllerCase) -> Self {
        let amplifier = Amplifier::TunedCurrent {
            bandwidth_rad_s: CURRENT_LOOP,
        };
        Self {
            law: case.law,
            known: nominal(amplifier),
            tick_s: case.tick_s,
            in_volts: case.voltage_mode_h.is_some(),
            integral: 0.0,
        }
    }
}

/// Returns a value that is linear between −1 and 1 over ±φ, or the sign if φ is 0.
fn switched(sliding: f64, boundary: f64) -> f64 {
    if boundary > 0.0 {
        (sliding / boundary).clamp(-1.0, 1.0)
    } else if sliding == 0.0 {
        0.0
    } else {
        sliding.signum()
    }
}

impl Law for FloatLaw {
    fn surface(&self, error: f64, rate: f64) -> f64 {
        let integral = match self.law {
            ControllerLaw::Sliding { integral, .. } => integral,
            ControllerLaw::Linear { .. } | ControllerLaw::Equation { .. } => 0.0,
        };
        SLOPE * error + rate + integral * self.integral
    }

    fn command(&mut self, seen: &Seen) -> f64 {
        let (error, rate) = (seen.reference[0] - seen.position, seen.reference[1] - seen.velocity);
        let sliding = self.surface(error, rate);
        let (acceleration, friction) = match self.law {
            ControllerLaw::Linear { integral, acceleration } => {
                self.integral += error * self.tick_s;
                let forward = if acceleration { seen.reference[2] } else { 0.0 };
                let feedback = SLOPE * RATE * error + (SLOPE + RATE) * rate + integral * self.integral;
                (feedback + forward, 0.0)
            }
            ControllerLaw::Sliding {
                epsilon,
                boundary,
                integral,
                coulomb,
            } => {
                self.integral += error * self.tick_s;
                let reaching = epsilon * switched(sliding, boundary) + RATE * sliding;
                let forward = if coulomb {
                    self.known.coulomb_force() * switched(seen.reference[1], 0.0)
                } else {
                    0.0
                };
                (
                    seen.reference[2] + SLOPE * rate + integral * error + reaching,
                    VISCOUS * seen.velocity + forward,
                )
            }
            ControllerLaw::Equation {
                coefficients,
                epsilon,
                boundary,
            } => {
                let wanted = seen.reference[2] + SLOPE * rate + epsilon * switched(sliding, boundary) + RATE * sliding;
                return sliding_mode_law::voltage(coefficients, wanted, seen.motor_speed, seen.position, seen.velocity);
            }
        };
        let force = self.known.equivalent_mass() * acceleration + friction;
        let current = force / self.known.force_constant();
        if self.in_volts {
            let back_emf = WINDING.back_emf * seen.velocity / self.known.lead_per_radian;
            return WINDING.resistance_ohm * current + back_emf;
        }
        current.clamp(-CURRENT_LIMIT_A, CURRENT_LIMIT_A)
    }
}
