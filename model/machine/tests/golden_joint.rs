//! Shapers for several modes at once, compared with numbers that were computed elsewhere (`golden/joint.json` says
//! where).

use crate::support;

use posicast_shaper::analysis::{StartControl, residual_vibration};
use posicast_shaper::design::antisymmetric::{Swing, exact, three_impulse, two_impulse};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::vibrationless::{gain, half_sum_cascade, optimum, robustness_index};
use posicast_shaper::design::{AxisDesign, Findings, JointError, bias_point, design_axis, periodic, ratios};
use posicast_shaper::impulse::{Impulse, ImpulseSequence};
use posicast_shaper::mode::Mode;
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use support::{machine, shaper};

fn golden(key: &str) -> Value {
    let document: Value = serde_json::from_str(include_str!("golden/joint.json")).unwrap();
    document[key].clone()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    let distance = (found - expected).abs();
    assert!(distance <= tolerance, "{what}: {found} instead of {expected}");
}

#[track_caller]
fn all_close(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (found, expected) in found.iter().zip(expected) {
        close(*found, *expected, tolerance, what);
    }
}

fn is_time_optimal(design: &AxisDesign) -> bool {
    matches!(&design.findings, Findings::Simultaneous(found) if found.is_time_optimal)
}

fn times(impulses: &[Impulse]) -> Vec<f64> {
    impulses.iter().map(|i| i.time_s).collect()
}

fn amplitudes(impulses: &[Impulse]) -> Vec<f64> {
    impulses.iter().map(|i| i.amplitude).collect()
}

#[test]
fn golden_periodic_search_is_complete() {
    let cases = golden("periodic");
    for case in cases.as_array().unwrap() {
        let found = periodic::search(
            &numbers(&case["modes"]),
            number(&case["lambda"]),
            number(&case["omega_min"]),
        );
        let found = found.unwrap();
        let expected = case["intervals_lo_hi_n"].as_array().unwrap();
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            close(found.low_hz, number(&expected[0]), 1e-9, "low");
            close(found.high_hz, number(&expected[1]), 1e-9, "high");
            let n: Vec<f64> = found.n.iter().map(|n| f64::from(*n)).collect();
            assert_eq!(n, numbers(&expected[2]));
        }
    }
    let base = bias_point::undamped(ShaperKind::MultiEi, 0, 0.05).unwrap();
    close(base.lambda, number(&cases[1]["lambda"]), 1e-12, "lambda");
}

#[test]
fn golden_periodic_machine_repeats_multi_ei_at_the_upper_end() {
    let modes = [10.0, 35.0, 68.0, 124.0];
    let rows: Vec<_> = modes.iter().map(|omega| (omega / TAU, 0.0, "")).collect();
    let shaper = "kind = \"periodic\"\nlowest_frequency_hz = 0.16";
    let design = design_axis(machine(1000, "modal", shaper, &rows).axes[0].shaped(), 1e3).unwrap();
    let high = number(&golden("periodic")[1]["intervals_lo_hi_n"][0][1]);
    let expected: Vec<f64> = (0..5).map(|k| f64::from(k) * PI / high).collect();
    all_close(&times(design.impulses.impulses()), &expected, 1e-9, "times");
    let multi_ei = [
        0.11237962936504912,
        0.2375,
        0.30024074126990175,
        0.2375,
        0.11237962936504912,
    ];
    all_close(&amplitudes(design.impulses.impulses()), &multi_ei, 1e-12, "amplitudes");
}

#[test]
fn golden_simultaneous_solutions_of_the_robot_are_reached_and_optimal() {
    let rows = golden("simultaneous");
    assert_eq!(rows.as_array().unwrap().len(), 4);
    for row in rows.as_array().unwrap() {
        let name = row["name"].as_str().unwrap().to_lowercase();
        let parts: Vec<&str> = name.split('-').collect();
        let own = |kind: &str| format!("shaper = \"{kind}\"");
        let (first, second) = (own(parts[1]), own(parts[2]));
        let shaper = format!("kind = \"simultaneous\"\namplitude = \"{}\"", parts[0]);
        let rows = [(76.6, 0.057, &first[..]), (231.2, 0.017, &second[..])];
        let design = design_axis(machine(10_000, "modal", &shaper, &rows).axes[0].shaped(), 1e4).unwrap();
        let impulses = design.impulses.impulses();
        assert_eq!(amplitudes(impulses), numbers(&row["A"]), "{name}");
        assert!(is_time_optimal(&design), "{name}");
        for (found, expected) in times(impulses).iter().zip(numbers(&row["t"])) {
            close(*found, expected, 1e-9 * expected, &name);
        }
    }
}

#[test]
fn golden_simultaneous_unit_magnitude_lasts_as_long_as_published() {
    let cases = [
        ("zv", "zv", 5.212e-3),
        ("zv", "zvd", 6.768e-3),
        ("zvd", "zv", 9.814e-3),
        ("zvd", "zvd", 10.998e-3),
    ];
    for (first, second, expected_s) in cases {
        let own = [first, second].map(|kind| format!("shaper = \"{kind}\""));
        let rows = [(76.6, 0.057, &own[0][..]), (231.2, 0.017, &own[1][..])];
        let shaper = "kind = \"simultaneous\"\namplitude = \"um\"";
        let design = design_axis(machine(10_000, "modal", shaper, &rows).axes[0].shaped(), 1e4).unwrap();
        close(design.impulses.duration_s(), expected_s, 0.5e-6, first);
        assert!(is_time_optimal(&design), "{first}, {second}");
        let sums = design.impulses.partial_sums();
        assert_eq!((sums.min, sums.max), (0.0, 1.0));
    }
}

#[test]
fn golden_vibrationless_optimum() {
    for (key, row) in golden("vibrationless_optimum").as_object().unwrap() {
        let order = key.rsplit('=').next().unwrap().parse().unwrap();
        let found = optimum(order, 0.05).unwrap();
        close(found.index, number(&row["Delta"]), 1e-9, key);
        all_close(&found.ratios, &numbers(&row["omega"]), 1e-9, key);
    }
    // These are known to the printed digits.
    let orders: [(u32, f64, &[f64]); 2] = [
        (4, 0.4537311, &[0.5799420, 0.7972949, 1.0983381, 1.3862888]),
        (5, 0.6420906, &[0.3804580, 0.5325671, 0.7169933, 0.9746735, 1.3941908]),
    ];
    for (order, index, ratios) in orders {
        let found = optimum(order, 0.05).unwrap();
        close(found.index, index, 5.1e-8, "index");
        all_close(&found.ratios, ratios, 5.1e-8, "ratios");
    }
}

#[test]
fn golden_half_sums_gain_residual_and_dynamic_coefficient() {
    for (order, row) in golden("vibrationless").as_object().unwrap() {
        let ratios = numbers(&row["omega"]);
        let delays: Vec<f64> = ratios.iter().map(|ratio| PI / ratio).collect();
        let cascade = half_sum_cascade(&delays).unwrap();
        all_close(&times(cascade.impulses()), &numbers(&row["times"]), 1e-9, order);
        assert!(
            cascade
                .impulses()
                .iter()
                .all(|i| i.amplitude == number(&row["weight_each"]))
        );
        for (omega, expected) in row["absP_at"].as_object().unwrap() {
            close(gain(&ratios, omega.parse().unwrap()), number(expected), 1e-12, omega);
        }
        close(
            robustness_index(&ratios, 0.05),
            number(&row["Delta_R_bound2_eps.05"]),
            1e-9,
            order,
        );
        close(
            robustness_index(&ratios, 0.1),
            number(&row["Delta_K_only_eps.05"]),
            1e-9,
            order,
        );
        for (key, expected) in row["K_R_maxF"].as_object().unwrap() {
            let (omega, length) = key.split_once(',').unwrap();
            let omega: f64 = omega.trim_start_matches("omega=").parse().unwrap();
            let length: f64 = length.trim_start_matches("T=").trim_end_matches("pi").parse().unwrap();
            let figures = StartControl::new(length * PI, &delays).unwrap().figures(omega);
            let found = [figures.dynamic_coefficient, figures.residual, figures.force];
            all_close(&found, &numbers(expected), 1e-9, key);
        }
    }
}

#[test]
fn a_start_shorter_than_its_filter_is_named_and_swings_most_after_its_end() {
    let short = StartControl::new(0.1, &[]).unwrap().figures(1.0);
    close(short.dynamic_coefficient, 2.0 * 0.05f64.sin(), 1e-15, "a push");
    let start = |length: f64| StartControl::new(length, &[1.0, 2.0]).unwrap().check_length();
    assert!(start(3.1).is_ok());
    assert_eq!(
        start(3.0),
        Err(JointError::ShortStart {
            start_s: 3.0,
            filter_s: 3.0
        })
    );
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(StartControl::new(length, &[1.0]).is_err());
    }
    assert!(StartControl::new(1.0, &[0.0]).is_err() && StartControl::new(1.0, &[f64::NAN]).is_err());
}

#[test]
fn golden_antisymmetry_test_and_partition() {
    for (key, row) in golden("antisymmetry").as_object().unwrap() {
        let omega: Vec<f64> = serde_json::from_str(key).unwrap();
        let all = ratios::common_divisor(&omega).unwrap();
        let m: Vec<f64> = all.multiples.iter().map(|m| *m as f64).collect();
        assert_eq!(m, numbers(&row["m"]), "{key}");
        assert!(all.error < 1e-15);
        assert_eq!(all.is_antisymmetric(), row["antisymmetric"].as_bool().unwrap(), "{key}");
        let classes = ratios::partition(&omega).unwrap();
        let mut found: Vec<Vec<f64>> = classes
            .iter()
            .map(|class| class.members.iter().map(|&index| omega[index]).collect())
            .collect();
        let mut expected: Vec<Vec<f64>> = row["groups"].as_array().unwrap().iter().map(numbers).collect();
        found.sort_by(|a, b| a[0].total_cmp(&b[0]));
        expected.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert_eq!(found, expected, "{key}");
        assert!(classes.iter().all(|class| class.multiples.is_antisymmetric()));
    }
    let all = ratios::common_divisor(&[2.0, 14.0]).unwrap();
    // In angular frequencies the antiperiod is π/ω_c.
    close(TAU * all.antiperiod().unwrap(), PI / 2.0, 1e-15, "antiperiod");
}

#[test]
fn golden_antisymmetric_damped_impulses() {
    for (key, row) in golden("damped").as_object().unwrap() {
        let antiperiod = number(&row["T_a"]);
        let (decays, multiples) = (numbers(&row["sigma"]), numbers(&row["m"]));
        let swings: Vec<Swing> = decays
            .iter()
            .zip(&multiples)
            .zip(numbers(&row["A"]))
            .map(|((decay, multiple), amplitude)| Swing {
                amplitude,
                multiple: *multiple,
                decay: decay * antiperiod,
            })
            .collect();
        let two = two_impulse(antiperiod, &swings);
        all_close(&amplitudes(&two), &numbers(&row["two_impulse"]), 1e-12, key);
        let product = exact(antiperiod, &decays);
        let expected = &row["common_spacing_exact"];
        all_close(&amplitudes(&product), &numbers(&expected["amplitudes"]), 1e-12, key);
        all_close(&times(&product), &numbers(&expected["times"]), 1e-12, key);
        let three = three_impulse(antiperiod, &swings).unwrap();
        let expected = &row["three_system"];
        all_close(&amplitudes(&three), &numbers(&expected["amplitudes"]), 1e-9, key);
        let expected = [0.0, number(&expected["t2"]), number(&expected["t3"])];
        all_close(&times(&three), &expected, 1e-9, key);
    }
}

#[test]
fn golden_antisymmetric_machine_takes_two_impulses_per_class() {
    let design = |shaper: &str, modes: &[(f64, f64, &str)]| {
        design_axis(machine(1000, "modal", shaper, modes).axes[0].shaped(), 1e3)
            .unwrap()
            .impulses
    };
    // The paper's modes 30, 105, 385: {105, 385} have the divisor 35, {30} is alone; four impulses replace eight.
    let modes = [(30.0, 0.0, ""), (105.0, 0.0, ""), (385.0, 0.0, "")];
    let found = design(&shaper("antisymmetric", 0.05), &modes);
    let (a, b) = (0.5 / 35.0, 0.5 / 30.0);
    all_close(&times(found.impulses()), &[0.0, a, b, a + b], 1e-15, "times");
    assert_eq!(amplitudes(found.impulses()), [0.25; 4]);
    // The modes 2 and 14 are damped as in the paper's example, with the undamped frequencies of the file.
    let scale = (1.0f64 - 1e-4).sqrt();
    let modes = [(2.0 / scale, 0.01, ""), (14.0 / scale, 0.01, "")];
    let expected = golden("damped")["paper"]["common_spacing_exact"]["amplitudes"].clone();
    let found = design(&shaper("antisymmetric", 0.05), &modes);
    all_close(&amplitudes(found.impulses()), &numbers(&expected), 1e-12, "amplitudes");
    all_close(&times(found.impulses()), &[0.0, 0.25, 0.5], 1e-12, "times");
    for (frequency_hz, damping, _) in modes {
        assert!(residual_vibration(found.impulses(), &Mode { frequency_hz, damping }) < 1e-14);
    }
    let undamped = [(2.0, 0.0, ""), (14.0, 0.0, "")];
    for (method, expected) in [
        ("exact", &[0.5, 0.5][..]),
        ("two-impulse", &[0.5, 0.5]),
        ("three-impulse", &[0.25, 0.5, 0.25]),
    ] {
        let found: ImpulseSequence = design(&format!("kind = \"antisymmetric\"\nmethod = \"{method}\""), &undamped);
        all_close(&amplitudes(found.impulses()), expected, 1e-12, method);
        let spacing = times(found.impulses());
        all_close(&spacing, &[0.0, 0.25, 0.5][..expected.len()], 1e-12, method);
    }
}
