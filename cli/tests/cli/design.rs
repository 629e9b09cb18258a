//! `posicast design`: the published figures of the XY stage, in the contract's document.

use crate::cli::support::{example, json, one_axis, posicast, scratch};
use predicates::prelude::PredicateBooleanExt;

const MODE: &str = "frequency_hz = 40.0\ndamping = 0.01";

#[test]
fn cli_design_gives_the_published_shaper_of_the_xy_stage() {
    let output = posicast()
        .arg("design")
        .arg(example("xy-stage.toml"))
        .arg("--json")
        .assert()
        .success();
    let document = json(&output.get_output().stdout);
    assert_eq!(document["name"], "xy_stage");
    let x = &document["axes"][0];
    assert_eq!((x["name"].as_str(), x["kind"].as_str()), (Some("x"), Some("zvd")));
    // From the source paper's Gx, sections 4 and 5: amplitudes to six digits, times to a nanosecond.
    let published = [(0.0, 0.388050), (3.861771e-3, 0.469773), (7.723542e-3, 0.142177)];
    for (impulse, (time_s, amplitude)) in x["impulses"].as_array().unwrap().iter().zip(published) {
        assert!((impulse["time_s"].as_f64().unwrap() - time_s).abs() < 0.5e-9);
        assert!((impulse["amplitude"].as_f64().unwrap() - amplitude).abs() < 0.5e-6);
    }
    let range = x["modes"][0]["insensitivity"].as_array().unwrap();
    assert!((range[0].as_f64().unwrap() - 0.8195).abs() < 5e-5 && (range[1].as_f64().unwrap() - 1.1991).abs() < 5e-5);
    let taps = x["quantised"]["taps"].as_array().unwrap();
    let sum: i64 = taps.iter().map(|t| t["coefficient"].as_i64().unwrap()).sum();
    assert_eq!(sum, 1 << x["quantised"]["coefficient_fraction"].as_u64().unwrap());
    assert!(x["quantised"]["modes"][0]["residual"].as_f64().unwrap() < 1e-5);
}

#[test]
fn cli_design_says_null_where_the_residual_exceeds_the_tolerance() {
    let (_folder, file) = scratch(&one_axis("kind = \"none\"", "frequency_hz = 20.0\ndamping = 0.0"));
    let output = posicast().arg("design").arg(&file).arg("--json").assert().success();
    let mode = &json(&output.get_output().stdout)["axes"][0]["modes"][0];
    assert_eq!(
        (mode["residual"].as_f64(), mode["insensitivity"].is_null()),
        (Some(1.0), true)
    );
}

#[test]
fn cli_design_draws_the_sensitivity_of_every_axis() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("sensitivity.svg");
    posicast()
        .arg("design")
        .arg(example("xy-stage.toml"))
        .arg("--plot")
        .arg(&plot)
        .assert()
        .success();
    let svg = std::fs::read_to_string(&plot).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("axis x") && svg.contains("axis y"));
}

#[test]
fn cli_design_writes_no_svg_into_a_file_of_another_kind() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("sensitivity.png");
    let mut design = posicast();
    design
        .arg("design")
        .arg(example("xy-stage.toml"))
        .arg("--plot")
        .arg(&plot);
    let said = String::from_utf8(design.assert().code(2).get_output().stderr.clone()).unwrap();
    assert!(
        said.contains("pictures are written as SVG, not as png") && said.contains("sensitivity.svg"),
        "{said}"
    );
    assert!(!plot.exists());
}

#[test]
fn cli_design_and_generate_warn_of_a_controller_that_is_too_fast() {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let gains = "kind = \"pd\"\nproportional = 4000.0\n";
    let (folder, file) = scratch(&text.replacen("kind = \"pd\"", gains, 1).replacen(
        "locked-antiphase",
        "half-bridge",
        2,
    ));
    let design = posicast().arg("design").arg(&file).arg("--json").output().unwrap();
    assert!(design.status.success());
    let said = String::from_utf8_lossy(&design.stderr).into_owned();
    assert!(
        said.contains(": axis.controller: controller of axis `x`: proportional·lag = 0.6"),
        "{said}"
    );
    let axis = &json(&design.stdout)["axes"][0];
    assert_eq!(axis["control"]["law"], "pd");
    assert_eq!(axis["control"]["settings"].as_array().unwrap().len(), 16);
    assert!(
        axis["control"]["warnings"][1].as_str().unwrap().contains("half bridge"),
        "{axis}"
    );
    let output = folder.path().join("out");
    let generate = posicast()
        .arg("generate")
        .arg(&file)
        .arg("-o")
        .arg(&output)
        .output()
        .unwrap();
    assert!(generate.status.success());
    assert!(String::from_utf8_lossy(&generate.stderr).contains("proportional·lag"));
    let report = json(&std::fs::read(output.join("report.json")).unwrap());
    assert_eq!(report["axes"][0]["control"], axis["control"]);
    for block in ["shaper", "pulse_counter", "pwm", "sliding_mode"] {
        for axis in ["x", "y"] {
            let file = output.join(format!("rtl/xy_stage_{axis}_{block}_avalon.v"));
            let text = std::fs::read_to_string(&file).unwrap();
            assert_eq!(text.matches("endmodule").count(), 1, "{}", file.display());
        }
    }
}

#[test]
fn cli_design_gives_the_axes_of_a_stage_equal_delays_and_reports_the_rest() {
    let file = example("contouring-stage.toml");
    let output = posicast().arg("design").arg(&file).arg("--json").assert().success();
    let document = json(&output.get_output().stdout);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let stage = &document["stage"];
    // This is the slowest axis alone: its shaper's mean delay plus 2ζ/ω.
    assert!((number(&stage["total_delay_s"]) - 4.65e-3).abs() < 1e-6, "{stage}");
    assert_eq!(number(&stage["contour_speed"]), 0.1);
    assert!(
        number(&stage["mismatch_s"]) < 200e-9 && number(&stage["mismatch_um"]) < 0.02,
        "{stage}"
    );
    let [x, y] = [0, 1].map(|axis: usize| &document["axes"][axis]);
    assert!(
        (number(&x["delay"]["added_samples"]) - 13.54).abs() < 0.01,
        "{}",
        x["delay"]
    );
    assert_eq!(number(&y["delay"]["added_samples"]), 0.0);
    // The figures of the shaper itself are unchanged.
    assert!((number(&x["delay_s"]) - 2.9122670e-3).abs() < 1e-9);
    let taps = x["quantised"]["taps"].as_array().unwrap();
    assert_eq!((taps.len(), taps[0]["delay_samples"].as_u64()), (8, Some(13)));
    let words = &x["control"]["supervision"];
    assert_eq!(
        (words["soft_limit_minus"].as_i64(), words["settle_ticks"].as_i64()),
        (Some(-25_600_000), Some(92))
    );
    let text = posicast().arg("design").arg(&file).assert().success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(
        text.contains("stage: every axis 4.65") && text.contains(" nm at 100 mm/s"),
        "{text}"
    );
    let plain = posicast()
        .arg("design")
        .arg(example("xy-stage.toml"))
        .arg("--json")
        .output()
        .unwrap();
    assert!(json(&plain.stdout).get("stage").is_none() && json(&plain.stdout)["axes"][0].get("delay").is_none());
}

#[test]
fn cli_design_names_key_and_line_of_a_limit_that_its_word_does_not_hold() {
    let text = std::fs::read_to_string(example("contouring-stage.toml")).unwrap();
    let (_folder, file) = scratch(&text.replace("watchdog_s = 0.5 ", "watchdog_s = 6.6 "));
    let line = 1 + text.lines().position(|line| line.starts_with("watchdog_s")).unwrap();
    let design = posicast().arg("design").arg(&file).output().unwrap();
    assert_eq!((design.status.code(), design.stdout.len()), (Some(2), 0));
    let said = String::from_utf8_lossy(&design.stderr).into_owned();
    let expected = format!(
        "machine.toml:{line}: axis.limits.watchdog_s of axis x: found 6.6; allowed: at least 0, at most 6.5535 s, the 65,535 ticks"
    );
    assert!(said.contains(&expected), "{said}");
}

#[test]
fn cli_design_says_that_a_free_mode_was_converted() {
    let mode = "frequency_hz = 60.0\ndamping = 0.03\nmeasured = \"free\"\nmotor_mass = 2.0\nload_mass = 2.0";
    let (_folder, file) = scratch(&one_axis("kind = \"zvd\"", mode));
    let text = posicast().arg("design").arg(&file).assert().success();
    text.stdout(predicates::str::contains(
        "mode 1: measured with the motor free at 60.000 Hz, damping 0.0300; designed for the motor held, 42.426 Hz and 0.0212",
    ));
    let output = posicast().arg("design").arg(&file).arg("--json").assert().success();
    let mode = &json(&output.get_output().stdout)["axes"][0]["modes"][0];
    assert_eq!(
        (mode["free"]["frequency_hz"].as_f64(), mode["free"]["damping"].as_f64()),
        (Some(60.0), Some(0.03))
    );
    assert!((mode["frequency_hz"].as_f64().unwrap() - 42.426_406_871).abs() < 1e-6);
}

#[test]
fn cli_design_names_the_source_of_a_mode_from_data_sheets() {
    // 1/(1/(207e9 A/0.5) + 1/144e6 + 1/110e6 + ..) by hand, and √(K/38)/2π.
    let says = "mode 1: from [axis.mechanics], 28.37 N/µm between motor and table, table 38 kg,";
    let text = posicast()
        .arg("design")
        .arg(example("ball-screw.toml"))
        .assert()
        .success();
    text.stdout(predicates::str::contains(says).and(predicates::str::contains("; the motor held; free it would be ")));
    let output = posicast()
        .arg("design")
        .arg(example("ball-screw.toml"))
        .arg("--json")
        .assert()
        .success();
    let mode = json(&output.get_output().stdout)["axes"][0]["modes"][0].clone();
    assert_eq!(mode["mechanics"]["motor"].as_str(), Some("held"));
    let stiffness = mode["mechanics"]["stiffness_n_per_m"].as_f64().unwrap();
    let frequency_hz = (stiffness / 38.0).sqrt() / std::f64::consts::TAU;
    assert!((mode["frequency_hz"].as_f64().unwrap() / frequency_hz - 1.0).abs() < 1e-12);
}

#[test]
fn cli_design_sets_a_known_move_beside_one_whose_jerk_time_is_a_period() {
    // d/v 250 ms, v/a 50 ms, a/j 13.3 ms; a period of 40 ms in place of a/j.
    let limits = "[axis.limits]\nvelocity = 0.2\nacceleration = 4\njerk = 300\n";
    let said = |kind: &str, more: &[&str]| {
        let text = one_axis(&format!("kind = \"{kind}\""), "frequency_hz = 25.0\ndamping = 0.0\n") + limits;
        let (_folder, file) = scratch(&text);
        let output = posicast()
            .arg("design")
            .arg(&file)
            .args(["--move", "0.05"])
            .args(more)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    for (kind, shaper_s, better) in [("zvd", 0.04, "period"), ("zv", 0.02, "shaper")] {
        let found = &json(&said(kind, &["--json"]))["moves"][0];
        let number = |way: &serde_json::Value, key: &str| way[key].as_f64().unwrap();
        let (shaped, period) = (&found["shaped"], &found["by_period"][0]);
        assert!((number(shaped, "command_s") - (0.25 + 0.05 + 4.0 / 300.0)).abs() < 1e-12);
        assert!((number(shaped, "shaper_s") - shaper_s).abs() < 1e-9);
        assert!((number(period, "total_s") - 0.34).abs() < 1e-12);
        assert!((number(period, "jerk") - 100.0).abs() < 1e-9);
        assert!(number(period, "residual") < 1e-12);
        assert_eq!(found["better"], better);
    }
    let text = String::from_utf8(said("zvd", &[])).unwrap();
    assert!(text.contains("jerk time of 40.000 ms, mode 1"), "{text}");
    assert!(
        text.lines()
            .any(|line| line.contains("jerk time") && line.ends_with("better")),
        "{text}"
    );
    let (_folder, file) = scratch(&one_axis("kind = \"zv\"", MODE));
    let refused = posicast()
        .arg("design")
        .arg(&file)
        .args(["--move", "0"])
        .assert()
        .code(2);
    refused.stderr(predicates::str::contains(
        "--move, axis `x`: a move of 0 causes no motion",
    ));
}

#[test]
fn cli_design_compares_smooth_kinds_with_the_best_at_their_duration() {
    let (_folder, file) = scratch(&one_axis("kind = \"zv\"", MODE));
    let compare = posicast()
        .arg("design")
        .arg(&file)
        .args(["--compare", "--json"])
        .assert()
        .success();
    let document = json(&compare.get_output().stdout);
    let kinds = document["axes"][0]["kinds"].as_array().unwrap();
    let smooth: Vec<_> = kinds
        .iter()
        .filter(|kind| kind["kind"].as_str().unwrap().starts_with("smooth_"))
        .collect();
    assert_eq!(smooth.len(), 7);
    for kind in smooth {
        let [least, worst] = ["least_residual", "worst_residual"].map(|key| kind[key].as_f64().unwrap());
        assert!(least < worst, "{kind}");
    }
    let text = posicast().arg("design").arg(&file).arg("--compare").assert().success();
    text.stdout(predicates::str::contains("least there: residual of the best shaper"));
}

#[test]
fn cli_design_compares_optimal_for_the_band_and_marks_the_shortest_that_keeps_the_tolerance() {
    let (_folder, file) = scratch(&one_axis("kind = \"zv\"", MODE));
    for (band, tolerance) in [("10", 0.05), ("20", 0.05)] {
        let compare = posicast()
            .arg("design")
            .arg(&file)
            .args(["--compare", "--json", "--band", band])
            .assert()
            .success();
        let document = json(&compare.get_output().stdout);
        let axis = &document["axes"][0];
        assert_eq!(axis["tolerances"], serde_json::json!([tolerance]));
        let kinds = axis["kinds"].as_array().unwrap();
        for name in ["optimal", "optimal ±1"] {
            let row = kinds.iter().find(|kind| kind["kind"] == name).unwrap();
            assert!(row["worst_residual"].as_f64().unwrap() <= tolerance, "{row}");
            assert_eq!(row["keeps_tolerance"], true);
        }
        let shortest: Vec<_> = kinds.iter().filter(|kind| kind["shortest"] == true).collect();
        let duration = |kind: &serde_json::Value| kind["duration_s"].as_f64().unwrap();
        let keeping = kinds
            .iter()
            .filter(|kind| kind["worst_residual"].as_f64().unwrap() <= tolerance);
        let least = keeping.map(duration).fold(f64::INFINITY, f64::min);
        assert_eq!(shortest.iter().map(|kind| duration(kind)).collect::<Vec<_>>(), [least]);
    }
    let text = posicast().arg("design").arg(&file).arg("--compare").assert().success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(text.contains("axis x, tolerance 5.000 %"), "{text}");
    let marked: Vec<&str> = text
        .lines()
        .filter(|line| line.contains("the shortest that keeps the tolerance"))
        .collect();
    assert!(marked.len() == 1 && marked[0].contains("optimal"), "{text}");
}
