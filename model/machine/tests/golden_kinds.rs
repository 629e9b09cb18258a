//! The kinds with several humps, the bias-point kinds and the hybrids of two modes, compared with numbers computed
//! elsewhere (`golden/*.json` say where).

use crate::support;
use crate::support::golden;

use std::collections::BTreeMap;

use golden::{close, number, numbers, rows};
use posicast_machine::plant::Plant;
use posicast_machine::plant::response::{step_figures, step_response};
use posicast_shaper::analysis::residual_vibration;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{AxisDesign, bias_point, design_axis, hump_ei};
use posicast_shaper::mode::Mode;
use support::{machine, shaper};

#[test]
fn golden_one_two_and_three_humps() {
    let rows = rows(include_str!("golden/multi_hump_ei.json"), "shapers");
    assert_eq!(rows.len(), 3);
    let mode = Mode {
        frequency_hz: 50.0,
        damping: 0.1,
    };
    for row in rows {
        let kind = ShaperKind::from_name(row["kind"].as_str().unwrap()).unwrap();
        let found = hump_ei::design(kind, &mode, 0.05).unwrap();
        let what = kind.name();
        let impulses = found.impulses.impulses();
        let expected = numbers(&row["A"]).into_iter().zip(numbers(&row["t_over_T"]));
        assert_eq!(impulses.len(), numbers(&row["A"]).len());
        for (impulse, (amplitude, time)) in impulses.iter().zip(expected) {
            close(impulse.amplitude, amplitude, 1e-9, what);
            close(impulse.time_s * 50.0, time, 1e-9 * time, what);
        }
        for (found, key) in [(&found.zeros, "zeros"), (&found.humps, "humps")] {
            assert_eq!(found.len(), numbers(&row[key]).len());
            for (found, expected) in found.iter().zip(numbers(&row[key])) {
                close(*found, expected, 1e-9, what);
            }
        }
    }
}

#[test]
fn golden_bias_point_shapers() {
    let rows = rows(include_str!("golden/hybrid_ei.json"), "shapers");
    assert_eq!(rows.len(), 14);
    for row in rows {
        let name = row["kind"].as_str().unwrap();
        let kind = ShaperKind::from_name(name).unwrap();
        let order = row["order"].as_u64().unwrap() as u32;
        let tolerance = number(&row["tolerance"]);
        let what = format!("{name} {order} {tolerance}");
        let base = bias_point::undamped(kind, order, tolerance).unwrap();
        close(base.lambda, number(&row["lambda"]), 1e-9, &what);
        if let Some(offsets) = row.get("zero_offsets_alpha") {
            for theta in &base.zeros_theta {
                let alpha = 1.0 - theta / std::f64::consts::PI;
                assert!(
                    numbers(offsets).iter().any(|known| (known - alpha).abs() < 1e-9),
                    "{what}"
                );
            }
        }
        let order = if kind == ShaperKind::ChebyshevEi {
            format!("order = {order}\n")
        } else {
            String::new()
        };
        let lines = format!("kind = \"{name}\"\n{order}tolerance = {tolerance}");
        let machine = machine(10_000, "modal", &lines, &[(25.0, 0.0, "")]);
        let design = design_axis(machine.axes[0].shaped(), machine.clock.sample_hz).unwrap();
        let impulses = design.impulses.impulses();
        let amplitudes = numbers(&row["amplitudes"]);
        assert_eq!(impulses.len(), amplitudes.len(), "{what}");
        for (index, (impulse, amplitude)) in impulses.iter().zip(&amplitudes).enumerate() {
            close(impulse.amplitude, *amplitude, 1e-9, &what);
            close(base.amplitudes[index], *amplitude, 1e-9, &what);
            close(impulse.time_s, 0.02 * index as f64, 1e-9 * impulse.time_s, &what);
        }
        let mode = machine.axes[0].modes[0].mode;
        for (ratio, expected) in row["residual_at_ratio"].as_object().unwrap() {
            let off = mode.scaled(ratio.parse().unwrap());
            close(residual_vibration(impulses, &off), number(expected), 1e-9, &what);
        }
    }
}

/// Returns the robot with a kind per mode: `ZV-EI`, or, with the negative kinds, `NZV-NEI`.
fn robot(name: &str) -> (AxisDesign, Plant) {
    let kinds = name.split('-').map(|part| match part.strip_prefix('N') {
        Some(rest) => format!("shaper = \"ps-{}\"", rest.to_lowercase()),
        None => format!("shaper = \"{}\"", part.to_lowercase()),
    });
    let kinds: Vec<String> = kinds.collect();
    let modes = [(76.6, 0.057, kinds[0].as_str()), (231.2, 0.017, kinds[1].as_str())];
    let machine = machine(10_000, "modal", &shaper("zv", 0.05), &modes);
    let axis = &machine.axes[0];
    (
        design_axis(axis.shaped(), machine.clock.sample_hz).unwrap(),
        Plant::of_axis(axis).unwrap(),
    )
}

#[test]
fn golden_all_twelve_hybrids_of_the_robot_have_their_durations() {
    let rows = rows(include_str!("golden/two_mode_robot.json"), "durations");
    assert_eq!(rows.len(), 6);
    for row in rows {
        let name = row["name"].as_str().unwrap();
        let negative = format!("N{}", name.replace('-', "-N"));
        for (name, key) in [(name, "positive_s"), (&negative, "negative_s")] {
            let expected = number(&row[key]);
            close(robot(name).0.impulses.duration_s(), expected, 1e-9 * expected, name);
        }
    }
}

#[test]
fn golden_responses_of_the_robot() {
    let rows = rows(include_str!("golden/two_mode_robot.json"), "responses");
    assert_eq!(rows.len(), 5);
    for row in rows {
        let name = row["name"].as_str().unwrap();
        let (design, plant) = robot(name);
        let impulses = design.impulses.impulses();
        let expected = numbers(&row["A"]).into_iter().zip(numbers(&row["t"]));
        assert_eq!(impulses.len(), numbers(&row["A"]).len());
        for (impulse, (amplitude, time)) in impulses.iter().zip(expected) {
            close(impulse.amplitude, amplitude, 1e-9, name);
            close(impulse.time_s, time, 1e-9 * time, name);
        }
        let figures = step_figures(&plant, impulses);
        close(figures.residual[0], number(&row["V1"]), 1e-9, name);
        close(figures.residual[1], number(&row["V2"]), 1e-9, name);
        close(figures.overshoot, number(&row["over"]), 1e-6, name);
        let sums = design.impulses.partial_sums();
        let partial = numbers(&row["partial"]);
        close(sums.min, partial[0], 1e-9, name);
        close(sums.max, partial[1], 1e-9, name);
        // The response is sampled every microsecond of 40 ms, and at the impulses, where it has its kinks.
        let curve = step_response(&plant, impulses, 0.04, 40_001);
        let lowest = curve.iter().map(|(_, y)| *y).fold(0.0, f64::min);
        close(lowest, number(&row["under"]), 1e-6, name);
        close(left_after(&plant, &design), number(&row["resid"]), 1e-6, name);
        close(
            left_after(&plant.scaled(1.1), &design),
            number(&row["resid_f+10%"]),
            1e-6,
            name,
        );
        for (mode, key) in ["y_mode1_at_1to20ms", "y_mode2_at_1to20ms"].into_iter().enumerate() {
            let mut shares = [(plant.modes()[0].mode, 0.0), (plant.modes()[1].mode, 0.0)];
            shares[mode].1 = 1.0;
            let one = Plant::new(&shares).unwrap();
            let curve = step_response(&one, impulses, 0.02, 21);
            for ((_, found), expected) in curve.iter().skip(1).zip(numbers(&row[key])) {
                close(*found, expected, 1e-9, &format!("{name} {key}"));
            }
        }
    }
}

/// Returns the largest distance from the step after the last impulse.
fn left_after(plant: &Plant, design: &AxisDesign) -> f64 {
    let last_s = design.impulses.duration_s();
    let curve = step_response(plant, design.impulses.impulses(), last_s + 0.1, 200_001);
    let after = curve.iter().filter(|(time_s, _)| *time_s >= last_s);
    after.map(|(_, y)| (y - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn golden_negative_hybrids_lift_the_tolerance_and_reach_five_times_the_step() {
    // These are V in percent at both modes, from the notes on the negative-impulse paper.
    let known = BTreeMap::from([
        ("ZV-EI", [0.0, 0.17]),
        ("ZVD-EI", [0.0, 0.006]),
        ("EI-ZV", [4.21, 0.0]),
        ("EI-ZVD", [3.55, 0.0]),
        ("NEI-NEI", [3.66, 16.91]),
        ("NZV-NEI", [0.0, 17.12]),
        ("NZVD-NEI", [0.0, 16.86]),
        ("NEI-NZV", [4.35, 0.0]),
        ("NEI-NZVD", [3.71, 0.0]),
        ("NZVD-NZVD", [0.0, 0.0]),
    ]);
    for (name, percent) in known {
        let (design, plant) = robot(name);
        for (mode, percent) in plant.modes().iter().zip(percent) {
            let found = residual_vibration(design.impulses.impulses(), &mode.mode);
            close(100.0 * found, percent, if percent < 0.1 { 5e-4 } else { 6e-3 }, name);
        }
        let sums = design.impulses.partial_sums();
        if name.starts_with('N') {
            close(sums.min, -3.0, 1e-12, name);
            close(sums.max, 5.0, 1e-12, name);
        } else {
            assert!(sums.min > 0.0 && sums.max < 1.0 + 1e-12);
        }
    }
}
