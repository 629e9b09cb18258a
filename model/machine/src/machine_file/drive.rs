//! `[axis.drive]`: what the PWM's duty commands of the power stage behind it.

use super::key::{Key, Values};
use super::range::NumberRange;
use super::table::Table;
use crate::unit::AxisUnit;

/// Range of the figures that are divided by.
const POSITIVE: NumberRange = NumberRange::positive(1e12);
/// Range of frictions, which may be 0.
const NOT_NEGATIVE: NumberRange = NumberRange::closed(0.0, 1e12);

/// Quantity that the duty commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveMode {
    /// The duty commands a current, and through it a force or torque.
    Torque {
        /// Moved mass in kg, or inertia in kg·m², as the motor feels it.
        equivalent_mass: f64,
        /// Force per current in N/A, or torque in N·m/A.
        force_constant: f64,
        /// Largest current that is commanded, in A; at most `full_scale_a`.
        current_limit_a: f64,
        /// Current at full duty, in A.
        full_scale_a: f64,
    },
    /// The duty commands a velocity, which a stiff drive keeps.
    Velocity {
        /// Velocity at full duty, in the axis's unit/s.
        full_scale_velocity: f64,
    },
}

/// `[axis.drive]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    /// Quantity that the duty commands.
    pub mode: DriveMode,
    /// Bandwidth of the drive's response to its command, in Hz; `None` if the file gives none.
    pub bandwidth_hz: Option<f64>,
    /// Viscous friction in N·s/m. Default 0.
    pub viscous: f64,
    /// Coulomb friction in N. Default 0.
    pub coulomb: f64,
}

/// Names of the quantities that full duty can command.
const MODES: [&str; 2] = ["torque", "velocity"];

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "mode",
        Values::Word(|| MODES.to_vec()),
        "What the duty commands: a torque, by a current, or a velocity.",
    )
    .required(),
    Key::new(
        "equivalent_mass",
        Values::Number(POSITIVE),
        "Moved mass in kg, or inertia in kg·m², as the motor feels it. `torque` needs it.",
    ),
    Key::new(
        "force_constant",
        Values::Number(POSITIVE),
        "Force per current in N/A, or torque in N·m/A. `torque` needs it.",
    ),
    Key::new(
        "current_limit_a",
        Values::Number(POSITIVE),
        "Largest commanded current, at most `full_scale_a`. `torque` needs it.",
    ),
    Key::new(
        "full_scale_a",
        Values::Number(POSITIVE),
        "Current at full duty. `torque` needs it.",
    )
    .rule("not with `velocity`"),
    Key::new(
        "full_scale_velocity",
        Values::Quantity(POSITIVE),
        "Velocity at full duty, in unit/s. `velocity` needs it.",
    )
    .rule("not with `torque`"),
    Key::new(
        "bandwidth_hz",
        Values::Number(POSITIVE),
        "Bandwidth of the drive. Absent: infinite.",
    ),
    Key::or_zero("viscous", NOT_NEGATIVE, "Viscous friction in N·s/m."),
    Key::or_zero("coulomb", NOT_NEGATIVE, "Coulomb friction in N."),
];

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>, unit: AxisUnit) -> Option<Drive> {
    let (current, velocity) = ("full_scale_a", "full_scale_velocity");
    table.allow(KEYS);
    let mode = table.required_choice("mode", &MODES);
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
