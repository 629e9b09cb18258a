//! `[axis.drive]`: what the PWM's duty means to the power stage behind it.

use super::range::NumberRange;
use super::table::Table;
use crate::unit::AxisUnit;

/// What must be there to divide by.
const POSITIVE: NumberRange = NumberRange::positive(1e12);
/// What may be absent in the machine.
const NOT_NEGATIVE: NumberRange = NumberRange::closed(0.0, 1e12);

/// What the duty is a command for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveMode {
    /// A current, and by it a force or torque.
    Torque {
        /// Moved mass in kg, or inertia in kg·m², as the motor feels it.
        equivalent_mass: f64,
        /// Force per current in N/A, or torque in N·m/A.
        force_constant: f64,
        /// Largest current that is asked for, in A; at most `full_scale_a`.
        current_limit_a: f64,
        /// Current at full duty, in A.
        full_scale_a: f64,
    },
    /// A velocity, which a stiff drive keeps.
    Velocity {
        /// Velocity at full duty, in m/s.
        full_scale_velocity: f64,
    },
}

/// `[axis.drive]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// What the duty is a command for.
    pub mode: DriveMode,
    /// Bandwidth with which the drive follows its command, in Hz, where the file gives it.
    pub bandwidth_hz: Option<f64>,
    /// Viscous friction in N·s/m. Default 0.
    pub viscous: f64,
    /// Coulomb friction in N. Default 0.
    pub coulomb: f64,
}

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>, unit: AxisUnit) -> Option<Drive> {
    let (current, velocity) = ("full_scale_a", "full_scale_velocity");
    table.allow(&[
        "mode",
        "equivalent_mass",
        "force_constant",
        "current_limit_a",
        current,
        velocity,
        "bandwidth_hz",
        "viscous",
        "coulomb",
    ]);
    let mode = table.required_choice("mode", &["torque", "velocity"]);
    let positive = [
        "equivalent_mass",
        "force_constant",
        "current_limit_a",
        current,
        "bandwidth_hz",
    ];
    let [
        equivalent_mass,
        force_constant,
        current_limit_a,
        full_scale_a,
        bandwidth_hz,
    ] = positive.map(|key| table.number(key, POSITIVE));
    let full_scale_velocity = table.quantity(velocity, POSITIVE, unit);
    let viscous = table.number("viscous", NOT_NEGATIVE).unwrap_or(0.0);
    let coulomb = table.number("coulomb", NOT_NEGATIVE).unwrap_or(0.0);
    let torque = mode? == "torque";
    let (needed, refused): (&[&str], &str) = if torque {
        (
            &["equivalent_mass", "force_constant", "current_limit_a", current],
            velocity,
        )
    } else {
        (&[velocity], current)
    };
    for key in needed {
        table.require(key, POSITIVE);
    }
    if table.has(refused) {
        let found = format!("{refused} with mode = {}", table.quote("mode"));
        let allowed = format!("{current} with mode torque, {velocity} with mode velocity");
        table.contradiction(refused, found, allowed, format!("remove `{refused}`"));
    }
    if let Some((limit_a, full_scale_a)) = current_limit_a.zip(full_scale_a).filter(|(limit, full)| limit > full) {
        let found = format!("a current limit of {limit_a} A");
        let allowed = format!("at most full_scale_a = {full_scale_a} A");
        table.contradiction(
            "current_limit_a",
            found,
            allowed,
            "lower current_limit_a: no command reaches it",
        );
    }
    let mode = if torque {
        DriveMode::Torque {
            equivalent_mass: equivalent_mass?,
            force_constant: force_constant?,
            current_limit_a: current_limit_a?,
            full_scale_a: full_scale_a?,
        }
    } else {
        DriveMode::Velocity {
            full_scale_velocity: full_scale_velocity?,
        }
    };
    Some(Drive {
        mode,
        bandwidth_hz,
        viscous,
        coulomb,
    })
}
