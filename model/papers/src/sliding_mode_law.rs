//! Equation (4-11) of the XY stage: the control law that follows from the thesis's own model of the drive.
//!
//! ```text
//! m v′ = K (P′θ − x) − B v              table; P′: lead per radian
//! 0    = K_t i − P′ K (P′θ − x)         motor, its inertia left out as in eq. (4-7)
//! L i′ = K_cp u − K_e ω − R i           winding, eq. (4-2)
//! ```
//!
//! Given an acceleration `v′`, the model determines the required `u`:
//! `u = (m R P′/(K_cp K_t)) · [v′ + c_3 x + c_4 v + …]`. Its coefficients are found by eliminating `θ`, `i` and `i′`
//! numerically, without relying on derived formulas.

use super::sheet::Sheet;
use std::f64::consts::TAU;

/// Lead per radian in m.
const LEAD: f64 = 0.005 / TAU;
/// Inductance in H and resistance in Ω of the winding.
const WINDING: (f64, f64) = (0.05, 1.0);
const MASS: f64 = 50.0;
const STIFFNESS: f64 = 33.9357e6;
/// Damping of the screw in N·s/m.
pub(super) const DAMPING: f64 = 1.3e4;
const BACK_EMF: f64 = 0.18;
const TORQUE: f64 = 0.378;

/// Required acceleration and state of the model.
#[derive(Default)]
struct State {
    acceleration: f64,
    motor_speed: f64,
    position: f64,
    velocity: f64,
}

/// Returns `K_cp u · K_t/(m R P′)`, the bracket of the law, for a table with this damper to the ground in N·s/m.
fn bracket(state: &State, damping: f64) -> f64 {
    let stretch = (MASS * state.acceleration + damping * state.velocity) / STIFFNESS;
    let angle = (stretch + state.position) / LEAD;
    let current = LEAD * STIFFNESS * (LEAD * angle - state.position) / TORQUE;
    let current_rate = LEAD * STIFFNESS * (LEAD * state.motor_speed - state.velocity) / TORQUE;
    let (inductance, resistance) = WINDING;
    let voltage = inductance * current_rate + resistance * current + BACK_EMF * state.motor_speed;
    voltage * TORQUE / (MASS * resistance * LEAD)
}

/// The coefficients of x3 and x4 in eq. (4-11).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coefficients {
    /// As they are printed.
    Printed,
    /// As derived from the model, for a table with a damper to the ground.
    Corrected {
        /// Damping B of the table in N·s/m.
        damping: f64,
    },
}

/// Voltage in V that eq. (4-11) asks for an acceleration in m/s², in this state of rad/s, m and m/s. Friction, which the law leaves to
/// `ε`, is not in it.
pub(super) fn voltage(
    coefficients: Coefficients,
    acceleration: f64,
    motor_speed: f64,
    position: f64,
    velocity: f64,
) -> f64 {
    let (inductance, resistance) = WINDING;
    let state = State {
        acceleration,
        motor_speed,
        ..State::default()
    };
    let of_law = match coefficients {
        Coefficients::Printed => {
            let printed_velocity = inductance * STIFFNESS / (MASS * resistance) + 1.0;
            bracket(&state, DAMPING) + PRINTED_POSITION * position + printed_velocity * velocity
        }
        Coefficients::Corrected { damping } => {
            let whole = State {
                position,
                velocity,
                ..state
            };
            bracket(&whole, damping)
        }
    };
    of_law * MASS * resistance * LEAD / TORQUE
}

/// Coefficient of x3 in eq. (4-11) as printed, 1/s²: 2K/m.
const PRINTED_POSITION: f64 = 2.0 * STIFFNESS / MASS;

/// The coefficients of eq. (4-11) that are wrong.
pub(super) fn rows(sheet: &mut Sheet) {
    let one = |state: State| bracket(&state, DAMPING);
    let position = one(State {
        position: 1.0,
        ..State::default()
    });
    let velocity = one(State {
        velocity: 1.0,
        ..State::default()
    });
    sheet.erratum(
        "eq (4-11): coefficient of x3 in 1/s², printed as 2K/m",
        "1357428",
        position,
        "a slip of sign: the two terms cancel",
    );
    sheet.erratum(
        "eq (4-11): coefficient of x4 in 1/s, printed as (LK + mR)/(mR)",
        "33936.7",
        velocity,
        "it must be (BR − LK)/(mR)",
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_elimination_is_the_algebra() {
        let (inductance, resistance) = WINDING;
        let one = |state: State| bracket(&state, DAMPING);
        let of_acceleration = one(State {
            acceleration: 1.0,
            ..State::default()
        });
        let of_velocity = one(State {
            velocity: 1.0,
            ..State::default()
        });
        let of_speed = one(State {
            motor_speed: 1.0,
            ..State::default()
        });
        assert!((of_acceleration - 1.0).abs() < 1e-12);
        let expected = (DAMPING * resistance - inductance * STIFFNESS) / (MASS * resistance);
        assert!((of_velocity / expected - 1.0).abs() < 1e-12);
        let expected = (TORQUE * BACK_EMF + LEAD * inductance * STIFFNESS * LEAD) / (MASS * resistance * LEAD);
        assert!((of_speed / expected - 1.0).abs() < 1e-12);
    }
}
