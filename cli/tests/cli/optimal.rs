//! `optimal` and its certificates from the command line, and all the way to RTL.

use crate::cli::support::{assert_fits_schema, example, json, one_axis, posicast, scratch};
use predicates::prelude::*;

#[test]
fn cli_design_certifies_an_optimal_shaper() {
    let mut design = posicast();
    design.arg("design").arg(example("optimal-arm.toml")).arg("--json");
    let document = json(&design.assert().success().get_output().stdout);
    let axis = &document["axes"][0];
    let certificate = &axis["certificate"];
    for (mode, quantised) in [0, 1].map(|i| (&certificate["modes"][i], &axis["quantised"]["modes"][i])) {
        assert_eq!(mode["holds"], true);
        let [certified, found] = ["certified_residual", "found_residual"].map(|key| mode[key].as_f64().unwrap());
        assert!(found <= certified && certified <= 0.05 * (1.0 + 1e-6), "{mode}");
        assert_eq!(quantised["certified_residual"].as_f64(), Some(certified));
    }
    let shorter = &certificate["shorter"];
    assert_eq!(shorter["proven"], true);
    assert_eq!(shorter["least_duration_s"], axis["duration_s"]);
    assert_eq!(
        shorter["excluded_samples"].as_u64().unwrap() + 1,
        shorter["least_samples"].as_u64().unwrap()
    );
    // Anyone can check it: with the weights of the document, h_i of every sample is above the tolerated sum.
    let (sample_hz, end) = (5000.0, shorter["excluded_samples"].as_u64().unwrap());
    let points = shorter["points"].as_array().unwrap();
    let number = |point: &serde_json::Value, key: &str| point[key].as_f64().unwrap();
    let tolerated: f64 = points
        .iter()
        .map(|point| {
            0.05 * point["weight"][0]
                .as_f64()
                .unwrap()
                .hypot(point["weight"][1].as_f64().unwrap())
        })
        .sum();
    for sample in 0..=end {
        let left_s = (end - sample) as f64 / sample_hz;
        let gain: f64 = points
            .iter()
            .map(|point| {
                let (omega, damping) = (
                    std::f64::consts::TAU * number(point, "frequency_hz"),
                    number(point, "damping"),
                );
                let turn = omega * (1.0 - damping * damping).sqrt() * left_s;
                let [re, im] = [0, 1].map(|part| point["weight"][part].as_f64().unwrap());
                (-damping * omega * left_s).exp() * (re * turn.cos() - im * turn.sin())
            })
            .sum();
        assert!(gain > tolerated, "sample {sample}: {gain} {tolerated}");
    }
}

#[test]
fn cli_every_kind_is_certified_on_request() {
    let said = |more: &[&str]| {
        let mut design = posicast();
        design.arg("design").arg(example("xy-stage.toml")).args(more);
        String::from_utf8(design.assert().success().get_output().stdout.clone()).unwrap()
    };
    assert!(!said(&[]).contains("certified"));
    let text = said(&["--certify"]);
    assert_eq!(text.matches("certified: nowhere in these bands").count(), 2, "{text}");
    let (_folder, file) = scratch(&one_axis(
        "kind = \"zvd\"",
        "frequency_hz = 40\ndamping = 0.01\nfrequency_band = 0.3",
    ));
    let mut design = posicast();
    design.arg("design").arg(file).arg("--certify");
    design
        .assert()
        .success()
        .stdout(predicate::str::contains("above the tolerance"));
}

#[test]
fn cli_run_takes_an_optimal_shaper_to_rtl_and_measures_the_corners() {
    let folder = tempfile::tempdir().unwrap();
    let text = one_axis(
        "kind = \"optimal\"\ncommand = [-1, 1]",
        "frequency_hz = 240\ndamping = 0.02\nfrequency_band = 0.1\ndamping_band = [0.01, 0.05]",
    );
    let (_scratch, file) = scratch(&text);
    let mut run = posicast();
    run.arg("run").arg(&file).arg("-o").arg(folder.path().join("out"));
    run.args(["--json", "--simulator", "icarus", "--cycles", "60000"]);
    let document = json(&run.assert().success().get_output().stdout);
    assert_eq!(
        (&document["result"], &document["verify"]["result"]),
        (&"pass".into(), &"match".into())
    );
    let checks = document["checks"].as_array().unwrap();
    let corners = checks
        .iter()
        .find(|check| check["name"].as_str().unwrap().contains("corners"));
    let corners = corners.unwrap();
    assert_eq!(corners["passed"], true);
    assert!(
        corners["detail"].as_str().unwrap().starts_with("4 corners, "),
        "{corners}"
    );
}

#[test]
fn cli_the_front_shows_the_benefit_of_longer_durations() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("front.svg");
    let mut design = posicast();
    design.arg("design").arg(example("optimal-arm.toml"));
    design.args(["--front", "--json", "--plot"]).arg(&plot);
    let document = json(&design.assert().success().get_output().stdout);
    let durations = document["fronts"][0]["durations"].as_array().unwrap();
    assert!(durations.len() >= 5);
    let of = |index: usize, key: &str| durations[index][key].as_f64().unwrap();
    assert_eq!(of(0, "duration_s"), document["axes"][0]["duration_s"].as_f64().unwrap());
    let last = durations.len() - 1;
    assert!(of(last, "least_residual") < 0.5 * of(0, "least_residual"));
    assert!(of(0, "least_residual") <= 0.05 * (1.0 + 1e-6));
    assert!(
        std::fs::read_to_string(&plot)
            .unwrap()
            .contains("fewest taps found against duration")
    );
    let mut other = posicast();
    other.arg("design").arg(example("xy-stage.toml")).arg("--front");
    other
        .assert()
        .code(2)
        .stderr(predicate::str::contains("no axis of the machine has an optimal shaper"));
}

#[test]
fn cli_reproduce_beyond_sets_the_shortest_beside_the_papers() {
    let mut reproduce = posicast();
    reproduce.args(["reproduce", "--beyond", "--json"]);
    let document = json(&reproduce.assert().success().get_output().stdout);
    assert_fits_schema("beyond", &document);
    let rows = document["beyond"].as_array().unwrap();
    // Computed independently: one mode by insensitivity, four modes by uncertainty, the robot's two.
    let expected = [
        0.890, 1.005, 1.520, 2.000, 0.3975, 0.5325, 0.6575, 0.7575, 7.80e-3, 4.90e-3, 4.85e-3,
    ];
    assert_eq!(rows.len(), expected.len());
    for (row, expected) in rows.iter().zip(expected) {
        let (optimal_s, sample_s) = (row["optimal_s"].as_f64().unwrap(), row["sample_s"].as_f64().unwrap());
        assert!((optimal_s - expected).abs() < 1.5 * sample_s, "{row}");
        assert_eq!(row["proven"], true, "{row}");
        for other in ["paper", "closed_form"] {
            // One step of the grid is what a closed form in continuous time may be ahead.
            let shorter = row[other]["duration_s"]
                .as_f64()
                .is_some_and(|duration_s| duration_s < optimal_s - sample_s);
            assert!(!shorter, "{row}");
        }
    }
}

#[test]
fn cli_axes_that_arrive_together_are_designed_as_one() {
    let axis = |name: &str, mode: &str| {
        format!(
            "[[axis]]\nname = \"{name}\"\ncounts_per_unit = 1_000_000\n[axis.shaper]\nkind = \"optimal\"\n[[axis.mode]]\n{mode}\n"
        )
    };
    let text = format!(
        "name = \"two\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 2_000\n[stage]\narrive_together = true\n{}{}",
        axis("x", "frequency_hz = 62\ndamping = 0.02\nfrequency_band = 0.1"),
        axis("y", "frequency_hz = 36\ndamping = 0.05\nfrequency_band = 0.1"),
    );
    let (_folder, file) = scratch(&text);
    let document = json(
        &posicast()
            .arg("design")
            .arg(&file)
            .arg("--json")
            .assert()
            .success()
            .get_output()
            .stdout,
    );
    let together = &document["stage"]["together"];
    assert_eq!(
        (&together["proven"], &together["decisive_axis"]),
        (&true.into(), &"y".into())
    );
    let number = |key: &str| together[key].as_f64().unwrap();
    assert_eq!(number("excluded_samples") + 1.0, number("samples"));
    assert!(number("least_delay_s") <= number("delay_s") + 1e-9 && number("least_delay_s") > 0.99 * number("delay_s"));
    for axis in document["axes"].as_array().unwrap() {
        let delay = &axis["delay"];
        assert!(delay["added_samples"].as_f64().unwrap().abs() < 1e-9, "{delay}");
        let designed = delay["total_s"].as_f64().unwrap() - delay["rounding_s"].as_f64().unwrap();
        assert!((designed - number("delay_s")).abs() < 1e-9, "{delay}");
    }
    let said = posicast().arg("design").arg(&file).assert().success();
    said.stdout(
        predicate::str::contains("designed together: least common duration")
            .and(predicate::str::contains(
                "proof, checked: axis y has no shaper of at most",
            ))
            .and(predicate::str::contains(
                "proof, checked: every shaper of axis y of this duration is at least",
            )),
    );
    let (_folder, file) = scratch(&text.replacen("\"optimal\"", "\"zvd\"", 1));
    posicast()
        .arg("design")
        .arg(&file)
        .assert()
        .code(2)
        .stderr(predicate::str::contains("stage.arrive_together").and(predicate::str::contains("axis x of kind zvd")));
}
