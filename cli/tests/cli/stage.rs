//! Machines whose loops are complete: the stage that `generate` and `verify` make of them, and the closed loop of `run`.

#![cfg(test)] // lets clippy see that this is test code

use crate::support::{example, json, posicast, scratch};

/// The XY stage with some text replaced, once.
fn changed(from: &str, to: &str) -> String {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn cli_generate_writes_the_stage_and_verify_of_the_folder_compares_it() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let mut generate = posicast();
    generate.arg("generate").arg(example("xy-stage.toml"));
    generate.arg("-o").arg(&output).assert().success();
    for module in ["stage", "stage_registers", "stage_x", "stage_y_shaper", "stage_axis"] {
        assert!(output.join(format!("rtl/xy_stage_{module}.v")).is_file(), "{module}");
    }
    let mut verify = posicast();
    verify.arg("verify").arg(&output);
    verify.args([
        "--block",
        "stage",
        "--cycles",
        "3000",
        "--simulator",
        "icarus",
        "--json",
    ]);
    let document = json(&verify.assert().success().get_output().stdout);
    assert_eq!(document["blocks"].as_array().unwrap().len(), 1);
    assert_eq!(document["blocks"][0]["instance"], "x, y, Avalon");
}

#[test]
fn cli_generate_of_a_stage_that_cannot_be_names_line_and_key_and_writes_nothing() {
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
        // A PWM for the fast sample too; it changes nothing for the others.
        let text = changed(from, to).replace("frequency_hz = 20_000", "frequency_hz = 500_000");
        let text = text.replace("500e-9", "40e-9").replace("1e-6", "40e-9");
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
    let cases = [
        (changed(controller, "# "), ""),
        (
            changed("[[axis]]", "[fixed_point]\ncommand_bits = 16\n[[axis]]"),
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

/// The XY stage, quick to simulate: a slower clock, and limits at which the move is short.
fn quick() -> String {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    text.replace("frequency_hz = 50_000_000", "frequency_hz = 10_000_000")
        .replace("velocity = 0.25", "following_error = 0.0005\nvelocity = 0.4")
        .replace("acceleration = 8.0", "acceleration = 40.0")
        .replace("jerk = 400.0", "jerk = 8000.0")
}

/// `run --json` of a machine: exit status, document and what was said.
fn run(text: &str, arguments: &[&str]) -> (Option<i32>, serde_json::Value, String, tempfile::TempDir) {
    let (folder, file) = scratch(text);
    let output = folder.path().join("out");
    let mut run = posicast();
    run.arg("run").arg(&file).arg("-o").arg(&output);
    let out = run
        .args(["--json", "--cycles", "2000"])
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
        ["the stage", "the shapers take", "the axes follow"]
            .iter()
            .any(|begin| name.starts_with(begin))
    });
    assert_eq!(of_stage.count(), 4);
    for picture in ["move", "vibration", "circle"] {
        assert!(folder.path().join(format!("out/plots/stage-{picture}.svg")).is_file());
    }
}

#[test]
fn cli_run_without_verilator_runs_the_loop_in_the_model_and_a_fault_is_exit_status_1() {
    // Nothing follows so closely: the first move is a fault.
    let text = quick().replace("following_error = 0.0005", "following_error = 1e-6");
    let (status, document, said, _folder) = run(&text, &["--simulator", "rusthdl"]);
    assert_eq!((status, &document["result"]), (Some(1), &"fail".into()), "{said}");
    assert!(said.contains("the closed loop runs in the bit-exact model"), "{said}");
    assert!(document["stage"]["side_by_side"].is_null());
    let checks = document["checks"].as_array().unwrap();
    let failed = checks.iter().filter(|check| check["passed"] == false);
    let details: Vec<&str> = failed.map(|check| check["detail"].as_str().unwrap()).collect();
    assert!(
        details[0].contains("FAULT") && details[0].contains("following-error"),
        "{details:?}"
    );
}
