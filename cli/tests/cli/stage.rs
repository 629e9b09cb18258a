//! Machines whose loops are complete: the stage that `generate` and `verify` make of them, and the closed loop of
//! `run`.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, generate, json, posicast, scratch};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Returns the XY stage with some text replaced, once.
fn changed(from: &str, to: &str) -> String {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn cli_generate_writes_the_stage() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    generate(&example("xy-stage.toml"), &output);
    for module in [
        "xy_stage_stage",
        "xy_stage_stage_x",
        "xy_stage_y_tap_banks",
        "posicast_axis",
    ] {
        assert!(output.join(format!("rtl/{module}.v")).is_file(), "{module}");
    }
}

#[test]
fn long_cli_verify_of_a_folder_compares_the_stage() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    generate(&example("xy-stage.toml"), &output);
    let mut verify = posicast();
    verify.arg("verify").arg(&output);
    verify.args(["--block", "stage", "--simulator", "icarus", "--json"]);
    let document = json(&verify.assert().success().get_output().stdout);
    let rows = document["blocks"].as_array().unwrap();
    let instances: Vec<&str> = rows.iter().map(|row| row["instance"].as_str().unwrap()).collect();
    assert_eq!(instances, ["x, y, Avalon", "x, y, Avalon, 730 clocks per tick"]);
}

/// Returns the XY stage with the figures of its axes in mm.
fn in_millimetres() -> String {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let figures = [
        ("unit = \"m\"", "unit = \"mm\""),
        ("counts_per_unit = 1_000_000", "counts_per_unit = 1_000"),
        ("full_scale_velocity = 0.5", "full_scale_velocity = 500"),
        ("\nvelocity = 0.25", "\nvelocity = 250"),
        ("\nacceleration = 8.0", "\nacceleration = 8_000"),
        ("\njerk = 400.0", "\njerk = 400_000"),
        ("travel = [-0.1, 0.1]", "travel = [-100, 100]"),
        ("following_error = 0.001", "following_error = 1"),
    ];
    figures.iter().fold(text, |text, (metres, millimetres)| {
        assert_eq!(text.matches(metres).count(), 2, "{metres}");
        text.replace(metres, millimetres)
    })
}

#[test]
fn cli_a_file_in_millimetres_gives_the_hardware_of_the_file_in_metres() {
    let folder = tempfile::tempdir().unwrap();
    let (_scratch, millimetres) = scratch(&in_millimetres());
    let files = [("m", example("xy-stage.toml")), ("mm", millimetres)];
    let mut packages = files.into_iter().map(|(unit, file)| {
        let output = folder.path().join(unit);
        generate(&file, &output);
        let mut texts = BTreeMap::new();
        for part in ["rtl", "sopc", "sim", "docs"] {
            texts_below(&output.join(part), &output, &mut texts);
        }
        let document = json(&std::fs::read(output.join("report.json")).unwrap());
        let driver = std::fs::read_to_string(output.join("driver/src/machine_xy_stage.c")).unwrap();
        (texts, document, driver)
    });
    let ((texts, metres, _), (texts_of_millimetres, millimetres, driver)) =
        (packages.next().unwrap(), packages.next().unwrap());
    assert!(texts.len() > 90);
    assert_eq!(texts, texts_of_millimetres);
    assert!(driver.contains("1000.0, /* counts per mm */"));
    for (of_metres, of_millimetres) in axes(&metres).iter().zip(axes(&millimetres)) {
        assert_eq!((&of_metres["unit"], &of_metres["si_unit"]), (&"m".into(), &"m".into()));
        assert_eq!(
            (&of_millimetres["unit"], &of_millimetres["si_unit"]),
            (&"mm".into(), &"m".into())
        );
        for part in ["impulses", "quantised", "control"] {
            assert!(!of_metres[part].is_null());
            assert_eq!(of_metres[part], of_millimetres[part], "{part}");
        }
    }
}

/// Collects every file below a folder, by its path relative to another.
fn texts_below(folder: &Path, root: &Path, texts: &mut BTreeMap<PathBuf, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            texts_below(&path, root, texts)
        } else {
            let place = path.strip_prefix(root).unwrap().to_owned();
            texts.insert(place, std::fs::read(&path).unwrap());
        }
    }
}

fn axes(document: &serde_json::Value) -> &Vec<serde_json::Value> {
    let design = document.get("design").unwrap_or(document);
    design["axes"].as_array().unwrap()
}

#[test]
fn cli_generate_of_an_impossible_stage_names_line_and_key_and_writes_nothing() {
    let cases = [
        ("name = \"x\"", "name = \"divider\"", "machine.toml:20: axis.name: "),
        ("name = \"y\"", "name = \"avs\"", ": axis.name: "),
        (
            "sample_hz = 10_000",
            "sample_hz = 500_000",
            "machine.toml:13: clock.sample_hz: ",
        ),
    ];
    for (from, to, place) in cases {
        // This PWM also suits the fast sample rate; it changes nothing for the others.
        let text = changed(from, to).replace("frequency_hz = 20_000", "frequency_hz = 500_000");
        let text = text.replace("500e-9", "40e-9").replace("1e-6", "40e-9");
        let text = text.replace("watchdog_s = 0.5", "watchdog_s = 0.05");
        let (folder, file) = scratch(&text);
        let output = folder.path().join("out");
        let mut generate = posicast();
        let refused = generate
            .arg("generate")
            .arg(&file)
            .arg("-o")
            .arg(&output)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(
            (refused.status.code(), refused.stdout.is_empty()),
            (Some(2), true),
            "{said}"
        );
        assert!(said.contains(place), "{said}");
        assert!(!output.exists());
    }
}

#[test]
fn cli_a_loop_that_is_not_complete_or_has_short_words_gives_no_stage() {
    let controller = "[axis.controller]                     # turns the position's error into the velocity that is asked for\n\
                      kind = \"pd\"";
    // Guards need an axis with a controller; those of Y stay.
    let guards = ["following_error", "encoder_lost_s", "watchdog_s"];
    let open = changed(controller, "# ");
    let open = guards.iter().fold(open, |text, guard| text.replacen(guard, "# ", 1));
    let cases = [
        (open, ""),
        (
            changed("[[axis]]", "[fixed_point]\ncommand_bits = 16\n[[axis]]").replace("travel =", "# "),
            "no stage is built",
        ),
    ];
    for (text, warning) in cases {
        let (folder, file) = scratch(&text);
        let output = folder.path().join("out");
        let mut generate = posicast();
        let run = generate
            .arg("generate")
            .arg(&file)
            .arg("-o")
            .arg(&output)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        assert!(run.status.success() && said.contains(warning), "{said}");
        assert!(!output.join("rtl/xy_stage_stage.v").exists());
    }
}

#[test]
fn cli_an_axis_with_a_loop_takes_words_of_any_width() {
    for bits in [18, 26, 31] {
        let text = changed("[[axis]]", &format!("[fixed_point]\ncommand_bits = {bits}\n[[axis]]"));
        let (folder, file) = scratch(&text.replace("travel =", "# "));
        let output = folder.path().join("out");
        generate(&file, &output);
        let select = format!("rtl/posicast_sample_select_{bits}x3.v");
        assert!(output.join(&select).is_file(), "{select}");
    }
}

#[test]
fn cli_a_warning_names_a_torque_drive_whose_wrong_sign_is_not_detected() {
    let text = std::fs::read_to_string(example("xy-stage-torque.toml")).unwrap();
    let unseen = "does not detect a wrong feedback sign";
    let said = |text: &str| {
        let (_folder, file) = scratch(text);
        let run = posicast().arg("design").arg(&file).output().unwrap();
        assert!(run.status.success());
        String::from_utf8(run.stderr).unwrap()
    };
    let without = text.replace("following_error", "# ");
    // 0.25 m/s are reached by half of 22.2 m/s² of X, and of 12.2 m/s² of Y.
    assert!(!said(&text).contains(unseen) && !said(&without).contains(unseen));
    let short = without.replace("encoder_lost_s = 0.05", "encoder_lost_s = 0.04");
    let short = said(&short);
    assert_eq!(short.matches(unseen).count(), 1, "{short}");
    assert!(
        short.contains("axis `y`") && short.contains("encoder_lost_s to 0.050 or more"),
        "{short}"
    );
    let unknown = said(&without.replace("velocity = 0.25", "# "));
    assert_eq!(unknown.matches(unseen).count(), 2, "{unknown}");
    // The following error alone detects it.
    assert!(!said(&text.replace("encoder_lost_s", "# ")).contains(unseen));
}

/// Returns the XY stage, quick to simulate: a slower clock, and limits for which the move is short.
pub(super) fn quick() -> String {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    text.replace("frequency_hz = 50_000_000", "frequency_hz = 10_000_000")
        .replace("following_error = 0.001", "following_error = 0.0005")
        .replace("velocity = 0.25", "velocity = 0.4")
        .replace("acceleration = 8.0", "acceleration = 40.0")
        .replace("jerk = 400.0", "jerk = 8000.0")
}

/// Runs `run --json` on a machine; returns exit status, document and standard error.
pub(super) fn run(text: &str, arguments: &[&str]) -> (Option<i32>, serde_json::Value, String, tempfile::TempDir) {
    let (folder, file) = scratch(text);
    let output = folder.path().join("out");
    let mut run = posicast();
    run.arg("run").arg(&file).arg("-o").arg(&output);
    let out = run
        .args(["--json", "--cycles", "20000"])
        .args(arguments)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    (out.status.code(), json(&out.stdout), said, folder)
}

#[test]
fn cli_run_closes_the_loop_in_verilog_and_model() {
    let (status, document, said, folder) = run(&quick(), &[]);
    assert_eq!(status, Some(0), "{said} {document}");
    let stage = &document["stage"];
    let side_by_side = &stage["side_by_side"];
    assert_eq!(
        (&side_by_side["mismatches"], &side_by_side["whole"]),
        (&0.into(), &true.into())
    );
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or_else(|| panic!("{value} in {stage}"));
    for axis in stage["axes"].as_array().unwrap() {
        assert!(number(&axis["tracking"]["peak"]) < 10e-6);
        assert!(number(&axis["offset"]).abs() < 2e-6);
        let unshaped = number(&axis["residual_unshaped"]);
        assert!(number(&axis["residual"]) < 0.1 * unshaped);
        for off in ["residual_minus_10_percent", "residual_plus_10_percent"] {
            assert!(number(&axis[off]) < 0.2 * unshaped);
        }
    }
    let circle = &stage["circle"];
    assert!(number(&circle["equal_delays"]["peak"]) < 0.5 * number(&circle["own_delays"]["peak"]));
    assert_eq!(stage["schedule"]["tick_clocks"], 1000);
    let checks = document["checks"].as_array().unwrap();
    let of_stage = checks.iter().filter(|check| {
        let name = check["name"].as_str().unwrap();
        ["the stage", "the shapers suppress", "the axes follow"]
            .iter()
            .any(|begin| name.starts_with(begin))
    });
    assert_eq!(of_stage.count(), 5);
    for picture in ["move", "vibration", "circle"] {
        assert!(folder.path().join(format!("out/plots/stage-{picture}.svg")).is_file());
    }
}

#[test]
fn cli_run_without_verilator_runs_the_loop_in_the_model_and_a_fault_is_exit_status_1() {
    // No axis follows so closely: the first move is a fault.
    let text = quick().replace("following_error = 0.0005", "following_error = 1e-6");
    let (status, document, said, folder) = run(&text, &["--simulator", "rusthdl"]);
    assert_eq!((status, &document["result"]), (Some(1), &"fail".into()), "{said}");
    assert!(said.contains("the closed loop runs in the bit-exact model"), "{said}");
    assert!(
        said.contains("axis `x` has a following_error of 0.000001 m, which is only 1 of its encoder's counts"),
        "{said}"
    );
    assert!(document["stage"]["side_by_side"].is_null());
    let checks = document["checks"].as_array().unwrap();
    let failed = checks.iter().filter(|check| check["passed"] == false);
    let details: Vec<&str> = failed.map(|check| check["detail"].as_str().unwrap()).collect();
    assert!(
        details[0].contains("FAULT") && details[0].contains("following-error"),
        "{details:?}"
    );
    // What is left of a vibration is not measured on a move without an end.
    let vibration = checks
        .iter()
        .find(|check| check["name"].as_str().unwrap().starts_with("the shapers suppress"));
    assert_eq!(vibration.unwrap()["verdict"], "open");
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("/axes/0/residual_displacement\"") && !page.contains("/stage/axes/0/residual"));
    for (name, title) in [
        ("move", "axis y: position"),
        ("vibration", "until the run was given up"),
    ] {
        let svg = std::fs::read_to_string(folder.path().join(format!("out/plots/stage-{name}.svg"))).unwrap();
        assert!(
            svg.contains(title) && svg.contains("axis x in FAULT: following-error"),
            "{name}"
        );
        assert!(svg.matches("<polyline").count() > 4, "{name}: no curves");
    }
}

/// Returns name and detail of each check that failed.
fn failed(document: &serde_json::Value) -> Vec<(String, String)> {
    let text = |value: &serde_json::Value| value.as_str().unwrap().to_owned();
    let checks = document["checks"].as_array().unwrap();
    let failed = checks.iter().filter(|check| check["passed"] == false);
    failed
        .map(|check| (text(&check["name"]), text(&check["detail"])))
        .collect()
}

#[test]
fn long_cli_run_that_moves_nothing_or_misses_its_tolerance_fails() {
    let coarse = quick().replace("counts_per_unit = 1_000_000", "counts_per_unit = 80");
    // Half a metre per second is less than one count per tick.
    let text = coarse.replacen("[target]", "[fixed_point]\ncoefficient_fraction = 1\n[target]", 1);
    let (status, document, said, _folder) = run(&text, &["--simulator", "rusthdl"]);
    assert_eq!(status, Some(1), "{said}");
    let failed = failed(&document);
    let has = |name: &str, detail: &str| failed.iter().any(|(n, d)| n.starts_with(name) && d.contains(detail));
    assert!(
        has("the integer taps keep the tolerance", "and the tolerance is"),
        "{failed:?}"
    );
    assert!(has("the command moves every axis", "not exercised"), "{failed:?}");
    assert!(has("the axes follow as closely", "not exercised"), "{failed:?}");
    assert!(
        said.contains(": axis.shaper: axis x, mode of 131.117 Hz: the integer taps leave"),
        "{said}"
    );
}

#[test]
fn long_cli_run_of_ei_shapers_passes_and_reports_the_expected_residual() {
    let text = include_str!("../../../closed_loop/tests/fixtures/machines/ei-gantry.toml");
    let (status, document, said, _folder) = run(text, &["--simulator", "rusthdl", "--move", "0.005"]);
    assert_eq!((status, failed(&document).len()), (Some(0), 0), "{said} {document}");
    let checks = document["checks"].as_array().unwrap();
    let shapers = checks
        .iter()
        .find(|check| check["name"].as_str().unwrap().starts_with("the shapers suppress"));
    let detail = shapers.unwrap()["detail"].as_str().unwrap();
    assert!(
        detail.contains("axis x: 47.") && detail.contains("expected from its design"),
        "{detail}"
    );
    assert!(
        said.contains("has no following_error") && said.contains("has no watchdog_s"),
        "{said}"
    );
}

#[test]
fn cli_gains_that_the_machine_does_not_bear_are_refused_with_the_margin() {
    let torque = std::fs::read_to_string(example("xy-stage-torque.toml")).unwrap();
    let unstable = torque.replacen("k = 50.0 ", "k = 5000.0 ", 1);
    let (_folder, file) = scratch(&unstable);
    let mut design = posicast();
    let refused = design.arg("design").arg(&file).output().unwrap();
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(
        (refused.status.code(), refused.stdout.is_empty()),
        (Some(2), true),
        "{said}"
    );
    assert!(
        said.contains("axis.controller.c") && said.contains("unstable on the machine"),
        "{said}"
    );

    let mut design = posicast();
    design.arg("design").arg(example("xy-stage-torque.toml")).arg("--json");
    let sound = design.output().unwrap();
    let margins = json(&sound.stdout)["axes"][0]["control"]["margins"].clone();
    assert!(margins["gain_margin_db"].as_f64().unwrap() > 6.0, "{margins}");
    assert!(margins["modulus_margin"].as_f64().unwrap() > 0.5, "{margins}");
    assert!(sound.stderr.is_empty(), "{}", String::from_utf8_lossy(&sound.stderr));
}
