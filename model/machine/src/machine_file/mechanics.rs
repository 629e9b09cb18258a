//! `[axis.mechanics]`: a ball screw between motor and table, described by its data sheets in place of
//! `[[axis.mode]]`.
//!
//! The mode is computed by [`crate::mechanics`]. For a velocity drive, and for an axis without a drive, it is the
//! table on the screw while the motor is held; for a torque drive it is motor against table.

use super::key::{Default, Key, Values};
use super::range::NumberRange;
use super::table::Table;
use super::{ClockSection, mode};
use crate::mechanics::{SHEAR_MODULUS, ScrewDrive, Stiction, torsional_stiffness};
use crate::unit::AxisUnit;
use posicast_shaper::axis::AxisMode;

/// Range of the length of a screw; its upper end catches most lengths in mm.
const LENGTH_M: NumberRange = NumberRange::closed(1e-4, 20.0).unit("m");
/// Range of the lead, of diameters and of a coupling's length: a number above is in mm.
const SMALL_M: NumberRange = NumberRange::closed(1e-4, 1.0).unit("m");
/// Stiffness of nut and bearings.
const STIFFNESS: NumberRange = NumberRange::closed(1e3, 1e12).unit("N/m");
/// Torsional stiffness of a coupling.
const TORSION: NumberRange = NumberRange::closed(1e-3, 1e9).unit("N·m/rad");
/// Inertia of a rotor.
const INERTIA: NumberRange = NumberRange::closed(1e-12, 1e3).unit("kg·m²");
/// Mass of a table.
const MASS: NumberRange = NumberRange::closed(1e-3, 1e6).unit("kg");
/// Friction at rest (breakaway).
const FORCE: NumberRange = NumberRange::closed(0.0, 1e9).unit("N");
/// Stribeck velocity.
const VELOCITY: NumberRange = NumberRange::positive(1e3).unit("m/s");
/// Default Stribeck velocity in m/s: that of the XY stage.
const DEFAULT_STRIBECK: f64 = 0.005;
const BREAKAWAY: &str = "breakaway";
const STRIBECK: &str = "stribeck_velocity";
/// Name of the table.
const TABLE: &str = "mechanics";
/// Diameter and length of a coupling; both are needed to compute its stiffness.
const COUPLING: [&str; 2] = ["coupling_diameter_m", "coupling_length_m"];
/// Key of the damping ratio, which no data sheet states.
const DAMPING: &str = "motor_held_damping";
const COUPLING_STIFFNESS: &str = "coupling_stiffness";

/// The keys of the table.
pub(super) const KEYS: &[Key] = &[
    Key::new("lead_m", Values::Number(SMALL_M), "Lead of the screw per turn.").required(),
    Key::new(
        "screw_diameter_m",
        Values::Number(SMALL_M),
        "Diameter of the steel screw, at the root if known.",
    )
    .required(),
    Key::new("screw_length_m", Values::Number(LENGTH_M), "Length of the screw.").required(),
    Key::new(
        "loaded_length_m",
        Values::Number(LENGTH_M),
        "Length under load, from bearing to nut. Absent: `screw_length_m`.",
    ),
    Key::new(
        COUPLING[0],
        Values::Number(SMALL_M),
        "Diameter of a steel coupling. Absent: rigid.",
    )
    .rule("with `coupling_length_m`"),
    Key::new(COUPLING[1], Values::Number(SMALL_M), "Length of that coupling."),
    Key::new(
        COUPLING_STIFFNESS,
        Values::Number(TORSION),
        "Torsional stiffness of the coupling in N·m/rad, in place of its diameter and length.",
    ),
    Key::new(
        "nut_stiffness",
        Values::Number(STIFFNESS),
        "Axial stiffness of the preloaded nut in N/m, 0.8 of the catalogue's. Absent: rigid.",
    ),
    Key::new(
        "bearing_stiffness",
        Values::Number(STIFFNESS),
        "Axial stiffness of the bearings in N/m. Absent: rigid.",
    ),
    Key::new(
        "motor_inertia",
        Values::Number(INERTIA),
        "Inertia of the rotor and what is fixed to it, in kg·m², without the screw.",
    )
    .required(),
    Key::new("table_mass", Values::Number(MASS), "Moved mass of the table in kg.").required(),
    Key::new(
        DAMPING,
        Values::Number(mode::DAMPING),
        "Damping ratio ζ with the motor held.",
    )
    .required(),
    Key::new(
        BREAKAWAY,
        Values::Number(FORCE),
        "Breakaway friction of the table in N, for a simulation with stick-slip.",
    )
    .rule("at least `coulomb`; needs a torque drive with `bandwidth_hz`"),
    Key::new(
        STRIBECK,
        Values::Number(VELOCITY),
        "Velocity in m/s over which friction falls from `breakaway` to `coulomb`.",
    )
    .rule("needs `breakaway`")
    .default(Default::Number(DEFAULT_STRIBECK)),
];

/// Reads the table and computes the mode. Returns the table, the screw and the mode; `None` where a value is refused.
pub(super) fn read<'r, 't>(
    axis: &Table<'r, 't>,
    clock: Option<ClockSection>,
    unit: AxisUnit,
) -> Option<(Table<'r, 't>, AxisMode, ScrewDrive)> {
    let table = axis.table(TABLE)?;
    table.allow(KEYS);
    if axis.has("mode") {
        let found = "[axis.mechanics] beside [[axis.mode]]";
        let allowed = "one of the two: the mode of [axis.mechanics] follows from its figures";
        axis.contradiction(TABLE, found, allowed, "remove [axis.mechanics], or every [[axis.mode]]");
    }
    if unit.si_name() == "rad" {
        let found = format!("[axis.mechanics] with unit = {}", axis.quote("unit"));
        let remedy = "set `unit = \"m\"` or another length, or give the mode in [[axis.mode]]";
        axis.contradiction(TABLE, found, "a screw on an axis whose unit is a length", remedy);
    }
    let [lead, diameter] = ["lead_m", "screw_diameter_m"].map(|key| table.required_number(key, SMALL_M));
    let length = table.required_number("screw_length_m", LENGTH_M);
    let loaded = table.number("loaded_length_m", LENGTH_M);
    let coupling = read_coupling(&table);
    let [nut, bearing] =
        ["nut_stiffness", "bearing_stiffness"].map(|key| table.number(key, STIFFNESS).unwrap_or(f64::INFINITY));
    let inertia = table.required_number("motor_inertia", INERTIA);
    let mass = table.required_number("table_mass", MASS);
    let damping = table.required_number(DAMPING, mode::DAMPING);
    let stiction = read_stiction(axis, &table);
    let screw = ScrewDrive {
        lead_m: lead?,
        screw_diameter_m: diameter?,
        screw_length_m: length?,
        loaded_length_m: loaded.or(length)?,
        coupling_stiffness: coupling?,
        nut_stiffness: nut,
        bearing_stiffness: bearing,
        motor_inertia: inertia?,
        table_mass: mass?,
        damping: damping?,
        stiction: stiction?,
    };
    let mode = read_mode(axis, &table, &screw, clock?)?;
    Some((table, mode, screw))
}

/// Reads the stick-slip friction; `Some(None)` where the file has none.
fn read_stiction(axis: &Table<'_, '_>, table: &Table<'_, '_>) -> Option<Option<Stiction>> {
    let breakaway = table.number(BREAKAWAY, FORCE);
    let stribeck_velocity = table.number(STRIBECK, VELOCITY).unwrap_or(DEFAULT_STRIBECK);
    if table.lacks(BREAKAWAY) {
        if table.has(STRIBECK) {
            let found = "stribeck_velocity without breakaway";
            let remedy = "add `breakaway`, or remove `stribeck_velocity`";
            table.contradiction(STRIBECK, found, "the two together", remedy);
            return None;
        }
        return Some(None);
    }
    let breakaway = breakaway?;
    // `drive` looks these keys up again and reports what is wrong with them.
    let drive = axis.table("drive");
    let has_bandwidth = drive.as_ref().is_some_and(|drive| drive.has("bandwidth_hz"));
    if !(axis.has_word("drive", "mode", "torque") && has_bandwidth) {
        let found = "breakaway without a torque drive that has a bandwidth";
        let allowed =
            "breakaway with mode = \"torque\" and bandwidth_hz in [axis.drive]; a velocity drive overcomes friction";
        table.contradiction(
            BREAKAWAY,
            found,
            allowed,
            "remove `breakaway`, or complete [axis.drive]",
        );
        return None;
    }
    let coulomb = drive.and_then(|drive| drive.number_if_any("coulomb")).unwrap_or(0.0);
    if coulomb > breakaway {
        let found = format!("a friction of {breakaway} N at rest");
        let allowed = format!("at least drive.coulomb = {coulomb} N");
        table.contradiction(
            BREAKAWAY,
            found,
            allowed,
            "raise `breakaway`: static friction is larger than sliding friction",
        );
        return None;
    }
    Some(Some(Stiction {
        breakaway,
        stribeck_velocity,
    }))
}

/// Torsional stiffness of the coupling; infinite where the file has none.
fn read_coupling(table: &Table<'_, '_>) -> Option<f64> {
    let [diameter, length] = COUPLING.map(|key| table.number(key, SMALL_M));
    let stiffness = table.number(COUPLING_STIFFNESS, TORSION);
    let sized = COUPLING.into_iter().find(|key| table.has(key));
    let missing = COUPLING.into_iter().find(|key| table.lacks(key));
    match (sized, missing) {
        (Some(key), _) if table.has(COUPLING_STIFFNESS) => {
            let found = format!("both {key} and coupling_stiffness");
            let allowed = "coupling_stiffness, or the coupling's diameter and length";
            table.contradiction(key, found, allowed, "remove one of them");
            None
        }
        (Some(key), Some(missing)) => {
            let found = format!("{key} without {missing}");
            let remedy = format!("add `{missing}`, or give `coupling_stiffness` in place of both");
            table.contradiction(key, found, "diameter and length of the coupling together", remedy);
            None
        }
        (Some(_), None) => Some(torsional_stiffness(SHEAR_MODULUS, diameter?, length?)),
        (None, _) if table.has(COUPLING_STIFFNESS) => stiffness,
        (None, _) => Some(f64::INFINITY),
    }
}

/// The mode of the screw: with the motor held or free, whichever the axis's drive leaves to the machine.
fn read_mode(axis: &Table<'_, '_>, table: &Table<'_, '_>, screw: &ScrewDrive, clock: ClockSection) -> Option<AxisMode> {
    // Reading the drive reports what is wrong with it.
    let is_torque = axis.has_word("drive", "mode", "torque");
    let (mode, state) = if is_torque {
        (screw.free_mode(), "free, as behind a torque drive,")
    } else {
        (screw.held_mode(), "held")
    };
    if mode.damping >= 1.0 {
        let found = format!("{}, with the motor {state} {:.3}", table.quote(DAMPING), mode.damping);
        let allowed = "a damping ratio below 1 with the motor free too";
        table.contradiction(
            DAMPING,
            found,
            allowed,
            "lower it: an axis that does not ring needs no shaper",
        );
        return None;
    }
    let half = clock.sample_hz / 2.0;
    if mode.frequency_hz >= half {
        let found = format!("a mode of {:.1} Hz with the motor {state}", mode.frequency_hz);
        let found = found.trim_end_matches(',').to_owned();
        let allowed = format!("below {half} Hz, half of clock.sample_hz");
        let remedy = "raise clock.sample_hz, or check the units: lengths are in m, stiffness in N/m, inertia in kg·m²";
        axis.contradiction(TABLE, found, allowed, remedy);
        return None;
    }
    Some(AxisMode {
        mode,
        free: None,
        shaper: None,
        tolerance: None,
        order: None,
        frequency_band: None,
        damping_band: None,
        participation: 1.0,
        points: Vec::new(),
    })
}
