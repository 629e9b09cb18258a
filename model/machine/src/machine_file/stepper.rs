//! `[axis.stepper]`: the stepper motor behind the lines, for the simulation.

use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use crate::unit::AxisUnit;

/// Default of the damping ratio of the rotor in its magnetic spring.
const DEFAULT_DAMPING: f64 = 0.1;
/// Largest number of microsteps per full step.
const MOST_MICROSTEPS: u32 = 256;
const RESONANCE_HZ: NumberRange = NumberRange::positive(10_000.0).unit("Hz");
const DAMPING: NumberRange = NumberRange::closed(0.0, 1.0).open_above();
const VELOCITY: NumberRange = NumberRange::positive(1e9);

/// `[axis.stepper]`. Lengths are in m or rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepperSection {
    /// Steps of the drive per full step of the motor.
    pub microsteps: u32,
    /// Frequency with which rotor and moved mass swing in the magnetic field of a standing motor, in Hz.
    pub resonance_hz: f64,
    /// Damping ratio of that swing. Default 0.1.
    pub damping: f64,
    /// Velocity at which the largest force has fallen to 0.71 of that at rest, per s; `None`: it does not fall.
    pub corner_velocity: Option<f64>,
}

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new(
        "microsteps",
        Values::Integer(1, MOST_MICROSTEPS),
        "Steps of the drive per full step of the motor.",
    )
    .required(),
    Key::new(
        "resonance_hz",
        Values::Number(RESONANCE_HZ),
        "Frequency with which rotor and load swing about a step at rest. With the full step it gives the largest force.",
    )
    .required(),
    Key::new("resonance_damping", Values::Number(DAMPING), "Damping ratio of that swing.")
        .default(Default::Number(DEFAULT_DAMPING)),
    Key::new(
        "corner_velocity",
        Values::Quantity(VELOCITY),
        "Velocity at which the largest force has fallen to 0.71 of that at rest, in unit/s. Absent: it does not fall.",
    ),
];

/// Reads the table; `None` where a value is refused.
pub(super) fn read(table: &Table<'_, '_>, unit: AxisUnit) -> Option<StepperSection> {
    table.allow(KEYS);
    table.require("microsteps", format!("a whole number, 1 to {MOST_MICROSTEPS}"));
    let microsteps = table.integer("microsteps", 1, MOST_MICROSTEPS);
    let resonance_hz = table.required_number("resonance_hz", RESONANCE_HZ);
    let damping = table.number("resonance_damping", DAMPING).unwrap_or(DEFAULT_DAMPING);
    let corner_velocity = table.quantity("corner_velocity", VELOCITY, unit);
    Some(StepperSection {
        microsteps: microsteps?,
        resonance_hz: resonance_hz?,
        damping,
        corner_velocity,
    })
}
