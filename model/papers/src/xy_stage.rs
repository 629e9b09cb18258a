//! "xy-stage": a thesis on an XY stage: its drive chain, its identified plants, their shapers, and the circle that it
//! draws.
//!
//! ```text
//! Gx = 6.787 / (1e-5 s² + 0.0026 s + 6.787)       Gy = 3.4358 / (1e-5 s² + 0.0018 s + 3.4358)
//! ```
//!
//! are taken as exact, though 1e-5 has one digit. The controllers of chapter 4 run on the whole drive ([`super::controllers`]).

use super::controllers::{ControllerCase, LOOP_LAG_S, RATE, SLOPE};
use super::designs::{amplitudes, mode_of_omega, shaper, times_s};
use super::identification::identify;
use super::plants::{Identified, PLANTS};
use super::sheet::{Rule, Sheet};
use super::{contour, drive, sliding_mode_law};
use posicast_machine::plant::Plant;
use posicast_machine::plant::response::step_figures;
use posicast_shaper::design::DesignError;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::impulse::ImpulseSequence;
use std::f64::consts::{PI, TAU};

/// Returns the overshoot of a shaped step in percent if the plant's frequency is `ratio` times the modelled one.
fn overshoot(plant: &Plant, shaper: &ImpulseSequence, ratio: f64) -> f64 {
    100.0 * step_figures(&plant.scaled(ratio), shaper.impulses()).overshoot
}

pub(super) fn rows(sheet: &mut Sheet) -> Result<(), DesignError> {
    drive::rows(sheet);
    for plant in &PLANTS {
        shapers(sheet, plant)?;
    }
    example(sheet)?;
    circle(sheet)?;
    drive::loop_rows(sheet, &PLANTS[0].mode());
    for plant in &PLANTS {
        identified(sheet, plant);
    }
    sliding_mode_law::rows(sheet);
    controller(sheet);
    Ok(())
}

/// Adds the rows of chapter 3: ZV and ZVD for the identified plants.
fn shapers(sheet: &mut Sheet, identified: &Identified) -> Result<(), DesignError> {
    const ROUNDING: &str = "the shaper leaves nothing on the exact plant; the figure is the rounding of its times";
    let (name, mode, plant) = (identified.name, identified.mode(), identified.plant());
    let unshaped = overshoot(&plant, &ImpulseSequence::unity(), 1.0);
    let approximate = "printed as approximate";
    sheet.by_rule(
        format!("chapter 3: overshoot of G{} unshaped, %", name.to_lowercase()),
        "60",
        unshaped,
        Rule::Within(1.5),
        approximate,
    );
    let (zv, zvd) = (shaper(ShaperKind::Zv, &[mode])?, shaper(ShaperKind::Zvd, &[mode])?);
    let k = (-mode.damping * PI / (1.0 - mode.damping * mode.damping).sqrt()).exp();
    let sum = (1.0 + k) * (1.0 + k);
    sheet.formula(
        format!("eqs (3-29) to (3-33): amplitudes of ZVD, {name}"),
        vec![1.0 / sum, 2.0 * k / sum, k * k / sum],
        amplitudes(&zvd),
    );
    let half_s = PI / mode.omega_damped();
    sheet.formula(
        format!("eqs (3-29) to (3-33): times of ZVD in s, {name}"),
        vec![half_s, 2.0 * half_s],
        times_s(&zvd),
    );
    sheet.erratum(
        format!("chapter 3: overshoot with ZV, {name}, %"),
        "0.02",
        overshoot(&plant, &zv, 1.0),
        ROUNDING,
    );
    sheet.erratum(
        format!("chapter 3: overshoot with ZVD, {name}, %"),
        "0.01",
        overshoot(&plant, &zvd, 1.0),
        ROUNDING,
    );
    sheet.by_rule(
        format!("chapter 3: overshoot with ZV, plant −10 %, {name}, %"),
        "10",
        overshoot(&plant, &zv, 0.9),
        Rule::Within(0.5),
        approximate,
    );
    sheet.erratum(
        format!("chapter 3: overshoot with ZVD, plant −10 %, {name}, %"),
        "0.01",
        overshoot(&plant, &zvd, 0.9),
        "the figure of the exact plant stands where that of the slower one belongs: wrong by a factor of 150",
    );
    Ok(())
}

/// Adds the rows of section 3.2.3: 0.05 mm split into 0.03 and 0.02 mm half a period of 1 s apart.
fn example(sheet: &mut Sheet) -> Result<(), DesignError> {
    // This is the damping at which half a period leaves 0.02/0.03 of a swing.
    let logarithm = (0.03f64 / 0.02).ln();
    let damping = logarithm / PI.hypot(logarithm);
    let mode = mode_of_omega(TAU / (1.0 - damping * damping).sqrt(), damping);
    let zv = shaper(ShaperKind::Zv, &[mode])?;
    let steps_mm: Vec<f64> = amplitudes(&zv).iter().map(|a| 0.05 * a).collect();
    sheet.equal("section 3.2.3: steps of the example in mm", ["0.03", "0.02"], steps_mm);
    sheet.equal("section 3.2.3: time between them in s", "0.5", zv.duration_s());
    Ok(())
}

/// Adds the rows of Figure 3-10: a circle of 10 mm at 100 mm/s (assumed, since the thesis gives neither), from a
/// standing start.
fn circle(sheet: &mut Sheet) -> Result<(), DesignError> {
    let kinds = [ShaperKind::None, ShaperKind::Zv, ShaperKind::Zvd];
    let mut outside = Vec::new();
    for kind in kinds {
        let shapers = [shaper(kind, &[PLANTS[0].mode()])?, shaper(kind, &[PLANTS[1].mode()])?];
        outside.push([0.8, 0.9, 1.0, 1.1, 1.2].map(|ratio| 100.0 * contour::excursion(&shapers, ratio)));
    }
    let text = |values: &[f64]| values.iter().map(|v| format!("{v:.2}")).collect::<Vec<_>>().join(", ");
    let [unshaped, zv, zvd] = [outside[0], outside[1], outside[2]];
    sheet.claim(
        "Figure 3-10: unshaped, the circle starts",
        "violently",
        format!("{} % of the radius outside", text(&unshaped[2..3])),
        unshaped[2] > 50.0,
    );
    sheet.claim(
        "Figure 3-10: ZV holds the circle while the plant is off by up to 10 %",
        "it does",
        format!(
            "{} % outside at −10, 0, +10 %; unshaped {}",
            text(&zv[1..4]),
            text(&unshaped[1..4])
        ),
        zv[1..4]
            .iter()
            .zip(&unshaped[1..4])
            .all(|(shaped, unshaped)| shaped < &(unshaped / 6.0)),
    );
    sheet.claim(
        "Figure 3-10: beyond, ZVD is better",
        "it is",
        format!(
            "{} % with ZVD at ±20 %, {} with ZV",
            text(&[zvd[0], zvd[4]]),
            text(&[zv[0], zv[4]])
        ),
        zvd[0] < zv[0] && zvd[4] < zv[4],
    );
    Ok(())
}

/// Adds the rows of equations (2-1) to (2-4): least squares on samples of Gx and Gy, without noise.
fn identified(sheet: &mut Sheet, plant: &Identified) {
    let (printed, found) = (plant.mode(), identify(&plant.plant()));
    sheet.formula(
        format!(
            "eqs (2-1) to (2-4): ω_n in rad/s and ζ of G{}, identified",
            plant.name.to_lowercase()
        ),
        [printed.omega(), printed.damping],
        [found.omega(), found.damping],
    );
}

/// Adds the rows of chapter 4: its parameters and its claims on the whole drive, under friction
/// ([`super::controllers`]).
fn controller(sheet: &mut Sheet) {
    let layer = ControllerCase::LAYER.float();
    let micrometres = |metres: f64| format!("{:.1} µm", 1e6 * metres);
    sheet.claim(
        "chapter 4: surface slope c of the sliding mode",
        "150",
        format!(
            "ε = 4 m/s², φ = 0.02 m/s: |s| at most {:.1} mm/s, |e| {}",
            1e3 * layer.surface_peak,
            micrometres(layer.error_peak)
        ),
        // The state stays within the layer, and e is no larger than s allows.
        layer.surface_peak < 0.02 && layer.error_peak <= layer.surface_peak / SLOPE && layer.limited == 0.0,
    );
    // Section 8.2 of the notes gives this bound: the gain within the layer times the lags of the loop.
    let lags = (SLOPE + RATE + 4.0 / 0.02) * LOOP_LAG_S;
    sheet.claim(
        "chapter 4: reaching rate k of the sliding mode",
        "50",
        format!("slides as above; (c + k + ε/φ) · lag is {lags:.2}, at most 0.5 is good"),
        lags < 0.5 && layer.limited == 0.0 && layer.chatter < 5.0,
    );
    let [si, millimetres, sign] = [
        ControllerCase::SIGN_150_SI,
        ControllerCase::SIGN_150_MM,
        ControllerCase::SIGN,
    ]
    .map(|case| case.float());
    sheet.refuted(
        "chapter 4: reaching gain ε of the sliding mode",
        "150",
        format!(
            "m/s²: at its limit {:.0} % of the time; mm/s²: never slides, |e| {}",
            100.0 * si.limited,
            micrometres(millimetres.error_peak)
        ),
        // With one reading, the command is limited less than half of the time; or with the other, the line is
        // reached.
        si.limited < 0.5 || millimetres.crossings > 10.0,
        "the thesis gives no unit, and either reading is no controller: 15 g, or less than the friction",
    );
    let printed = ControllerCase::EQUATION_PRINTED.float();
    sheet.refuted(
        "eq (4-11), as printed: the voltage that makes the stage follow",
        "it does",
        format!(
            "at its limit {:.0} % of the time, |e| {:.2} m of a radius of 0.01 m",
            100.0 * printed.limited,
            printed.error_peak
        ),
        printed.error_peak < 1e-3,
        "two of its coefficients are wrong (above): it runs away",
    );
    let [corrected, of_screw] = [
        ControllerCase::EQUATION_CORRECTED,
        ControllerCase::EQUATION_SCREW_DAMPING,
    ]
    .map(|case| case.float());
    sheet.claim(
        "eq (4-11), corrected as above: the voltage that makes the stage follow",
        "it does",
        format!(
            "|e| {} with B = 200 N·s/m, the table's friction; {:.1} mm with 13,000, the screw's damper",
            micrometres(corrected.error_peak),
            1e3 * of_screw.error_peak
        ),
        corrected.error_peak < 1e-3 && corrected.limited == 0.0,
    );
    let pid = ControllerCase::PID_FORWARD.float();
    sheet.claim(
        "chapter 4: sliding mode follows better than PID under friction",
        "it does",
        format!(
            "|e| at most {}, with PID {}; rms {}, with PID {}",
            micrometres(layer.error_peak),
            micrometres(pid.error_peak),
            micrometres(layer.error_rms),
            micrometres(pid.error_rms)
        ),
        layer.error_peak < pid.error_peak / 5.0 && layer.error_rms < pid.error_rms / 3.0,
    );
    sheet.refuted(
        "chapter 4: sliding mode removes the error",
        "it does",
        format!(
            "{} with a layer; {} with the sign, and {:.0} A/s of chatter, not {:.0}",
            micrometres(layer.error_peak),
            micrometres(sign.error_peak),
            sign.chatter,
            layer.chatter
        ),
        layer.error_peak < 1e-6 || (sign.error_peak < 1e-6 && sign.chatter < 10.0 * layer.chatter),
        "within a layer d/(c (k + ε/φ)) remains; with the sign the command chatters at the mode of the drive",
    );
}
