//! The drive chain of the XY stage: stiffnesses from its data sheets, and the modes of its control loops.
//!
//! The thesis mixes N/m, N/µm and N·mm/rad under one heading. Here lengths are in mm, forces in N and stiffnesses in
//! N/µm (= kN/mm) or N·mm/rad, which each item states.

use super::sheet::{Rule, Sheet};
use posicast_machine::mechanics::{
    DENSITY, SHEAR_MODULUS, YOUNGS_MODULUS, axial_stiffness, in_series, preloaded_nut, shaft_inertia, torsion_at_table,
    torsional_stiffness,
};
use posicast_machine::plant::drive_train::{Amplifier, DriveTrain, Winding};
use posicast_shaper::mode::Mode;
use std::f64::consts::TAU;

/// Lead of the screws, mm per turn.
const LEAD_MM: f64 = 5.0;
/// Diameter of the screws, mm.
const SCREW_MM: f64 = 12.0;
/// Lengths of the screws, mm: X, Y.
const SCREWS_MM: [f64; 2] = [340.0, 440.0];
/// Lengths that the thesis loads in tension, mm: X, Y.
const LOADED_MM: [f64; 2] = [350.0, 340.0];
/// Dynamic load ratings of the bearings, N: X, Y.
const LOAD_RATINGS: [f64; 2] = [3744.0, 4537.0];
/// Stiffness of the bearings as printed, N/µm: X, Y.
const BEARINGS: [f64; 2] = [133.4873, 140.3455];
/// Rated torque of the motors, mN·m, at 3,000 turns a minute and 0.91 A.
const RATED_TORQUE: f64 = 318.0;

/// Returns the torsional stiffness of a round shaft in N·mm/rad.
fn torsion(diameter_mm: f64, length_mm: f64) -> f64 {
    torsional_stiffness(SHEAR_MODULUS, diameter_mm / 1e3, length_mm / 1e3) * 1e3
}

/// Returns the tensile stiffness of a screw in N/µm.
fn tension(length_mm: f64) -> f64 {
    axial_stiffness(YOUNGS_MODULUS, SCREW_MM / 1e3, length_mm / 1e3) / 1e6
}

/// Converts a torsional stiffness in N·mm/rad to the stiffness at the table in N/µm.
fn at_table(torsion: f64) -> f64 {
    torsion_at_table(torsion / 1e3, LEAD_MM / 1e3) / 1e6
}

/// Adds the rows of Tables 2-1 to 2-3.
pub(super) fn rows(sheet: &mut Sheet) {
    let coupling = torsion(8.0, 25.0);
    let screws = SCREWS_MM.map(|length_mm| torsion(SCREW_MM, length_mm));
    sheet.equal("Table 2-1: K1 in N·mm/rad (printed as N/m)", "1.3029e6", coupling);
    sheet.equal("Table 2-1: K2 of X in N·mm/rad (printed as N/m)", ".4850e6", screws[0]);
    sheet.equal("Table 2-1: K2 of Y in N·mm/rad (printed as N/m)", ".3748e6", screws[1]);

    let tensions = LOADED_MM.map(tension);
    const TEN: &str = "the digits agree, the power of ten does not: 1 N/µm is 1e6 N/m";
    sheet.erratum("Table 2-1: K_S of X in N/m", "6.69e6", tensions[0] * 1e6, TEN);
    sheet.erratum("Table 2-1: K_S of Y in N/m", "6.8856e6", tensions[1] * 1e6, TEN);
    sheet.equal("Table 2-1: K_S of X in N/µm, digits as printed", "66.9", tensions[0]);
    sheet.equal("Table 2-1: K_S of Y in N/µm, digits as printed", "68.856", tensions[1]);
    let own = tension(SCREWS_MM[1]);
    sheet.erratum(
        "Table 2-1: K_S of Y in N/µm, with its own 440 mm",
        "68.856",
        own,
        "computed with 340 mm, the length of X",
    );

    let nut = preloaded_nut(250.0);
    sheet.equal("eq (2-28): K_N in N/µm", "200", nut);
    let preloads = LOAD_RATINGS.map(|rating| 0.1 * rating);
    sheet.equal(
        "eq (2-30): preload of the bearings in N, X and Y",
        ["374.4", "453.7"],
        preloads,
    );
    const NO_DATA: &str = "the number and size of the balls and the contact angle are not printed";
    sheet.not_comparable("Table 2-1: K_B of X in N/µm", "133.4873", NO_DATA);
    sheet.not_comparable("Table 2-1: K_B of Y in N/µm", "140.3455", NO_DATA);
    sheet.erratum(
        "Table 2-1: K_B of Y over K_B of X",
        "1.0514",
        (preloads[1] / preloads[0]).cbrt(),
        "of equal bearings the stiffness goes with the cube root of the preload",
    );

    let axial = [0, 1].map(|axis| in_series(&[tensions[axis], nut, BEARINGS[axis]]));
    sheet.equal("Table 2-3: K_ax of X in N/µm, with the printed K_B", "36.44", axial[0]);
    sheet.by_rule(
        "Table 2-3: K_ax of Y in N/µm, with the printed K_B",
        "37.5258",
        axial[1],
        Rule::Within(1.1e-4),
        "the last digit is off by one",
    );
    let drives = [0, 1].map(|axis| in_series(&[axial[axis], at_table(screws[axis])]));
    sheet.erratum(
        "eq (2-35): K of the drive of X in N/µm",
        "34.8432",
        drives[0],
        "it would need a K2 of 5.035e5",
    );
    sheet.by_rule(
        "eq (2-35): K of the drive of Y in N/µm",
        "35.2884",
        drives[1],
        Rule::Within(2.5e-4),
        "agrees to 6e-6",
    );
    totals(sheet, coupling, drives);
    motor(sheet);
}

/// Adds the stiffness of the whole chain, as printed and with correct units, and what follows from it.
fn totals(sheet: &mut Sheet, coupling: f64, drives: [f64; 2]) {
    const PRINTED: [(&str, &str, f64); 2] = [("X", "33.9357", 34.8432), ("Y", "34.3578", 35.2884)];
    // The thesis divided K1 in N·mm/rad by 1,000 and added it as if it were in N/µm.
    let as_printed = PRINTED.map(|(_, _, drive)| in_series(&[drive, coupling / 1e3]));
    for (axis, (name, printed, _)) in PRINTED.into_iter().enumerate() {
        sheet.by_rule(
            format!("Table 2-3: K of {name} in N/µm, by the thesis's arithmetic"),
            printed,
            as_printed[axis],
            Rule::Rounded,
            "from the printed K of the drive, with K1 in N·mm/rad added as 1302.9 N/µm",
        );
        sheet.erratum(
            format!("Table 2-3: K of {name} in N/µm"),
            printed,
            in_series(&[drives[axis], at_table(coupling)]),
            "K1 is a torsional stiffness: it must be divided by (P/2π)² before it is added",
        );
    }
    sheet.equal("chapter 2: numerator of Gx", "6.787", as_printed[0] / 5.0);
    sheet.equal("chapter 2: numerator of Gy", "3.4358", as_printed[1] / 10.0);
    const UNKNOWN: &str = "the mass of the table is not given";
    sheet.not_comparable("Table 2-3: J of X in kg·m²", "0.3455e-4", UNKNOWN);
    sheet.not_comparable("Table 2-3: J of Y in kg·m²", "0.6603e-4", UNKNOWN);
    let lead_per_radian = LEAD_MM / TAU / 1e3;
    for (axis, (printed, inertia)) in [("131.1", 0.3455e-4), ("93.3", 0.6603e-4)].into_iter().enumerate() {
        let mass = inertia / (lead_per_radian * lead_per_radian);
        let hz = (as_printed[axis] * 1e6 / mass).sqrt() / TAU;
        sheet.erratum(
            format!(
                "eq (2-15): frequency of {} in Hz, from the printed K and J",
                PRINTED[axis].0
            ),
            printed,
            hz,
            "the thesis's K and J give another frequency than its transfer function",
        );
    }
}

fn motor(sheet: &mut Sheet) {
    sheet.equal(
        "Table 2-2: rated power in W",
        "100",
        RATED_TORQUE / 1e3 * 3000.0 * TAU / 60.0,
    );
    sheet.erratum(
        "Table 2-2: K_t in N·m/A",
        "0.378",
        RATED_TORQUE / 1e3 / 0.91,
        "rated torque over rated current is 8 % less",
    );
}

/// The winding of the motor, from Table 2-2.
pub(super) const WINDING: Winding = Winding {
    inductance_h: 0.05,
    resistance_ohm: 1.0,
    back_emf: 0.18,
};

/// Returns the X axis without friction and limits, as the thesis computes with it: its own stiffness, and its mass
/// and damping of 1e-5 s² and 0.0026 s.
pub(super) fn x_axis(amplifier: Amplifier) -> DriveTrain {
    DriveTrain {
        torque_constant: 0.378,
        motor_inertia: 0.0364e-4 + shaft_inertia(DENSITY, SCREW_MM / 1e3, SCREWS_MM[0] / 1e3),
        load_mass: 50.0,
        lead_per_radian: LEAD_MM / TAU / 1e3,
        stiffness: 33.9357e6,
        damping: 5.0 * 0.0026 * 1e6,
        ..DriveTrain::rigid(amplifier)
    }
}

/// Returns the modes of the X axis in its velocity loop (eq. 2-18), lowest frequency first.
fn velocity_loop_modes() -> Vec<Mode> {
    let amplifier = Amplifier::Velocity {
        winding: WINDING,
        current_gain: 2.0,
        velocity_gain: 30.0,
    };
    x_axis(amplifier).modes()
}

/// Adds a row that checks that the identified plant is the mode of the table in the velocity loop.
pub(super) fn loop_rows(sheet: &mut Sheet, identified: &Mode) {
    let modes = velocity_loop_modes();
    let table = modes.first();
    let off = table.map_or(f64::NAN, |m| 100.0 * (identified.frequency_hz / m.frequency_hz - 1.0));
    sheet.claim(
        "eq (2-18): the lowest mode of the velocity loop is that of Gx",
        "131.1 Hz, ζ 0.158",
        table.map_or_else(String::new, |m| {
            format!("{:.2} Hz, ζ {:.4}: {off:.1} % off", m.frequency_hz, m.damping)
        }),
        off.abs() < 2.5,
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_modes_of_the_velocity_loop() {
        let found = velocity_loop_modes();
        let expected = [
            (128.296_227_754_013_05, 0.148_969_992_410_437_3),
            (1_153.987_314_459_922_3, 0.068_310_846_543_019_58),
        ];
        assert_eq!(found.len(), expected.len());
        for (found, (hz, damping)) in found.iter().zip(expected) {
            assert!((found.frequency_hz / hz - 1.0).abs() < 1e-10, "{found:?}");
            assert!((found.damping - damping).abs() < 1e-10, "{found:?}");
        }
    }
}
