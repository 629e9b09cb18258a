//! `structure = "cascade"`: half sums in the top module of a machine that has shapers alone.

use super::support::{example, generate, posicast};
use predicates::prelude::*;
use serde_json::Value;
use std::path::Path;

/// An undamped mode of 9 Hz and two half sums: delays of 0.5/(0.8993 · 9 Hz) and 0.5/(1.1004 · 9 Hz), 61.8 and 50.5 samples.
const UNDAMPED: &str = r#"
name = "boom"
clock = { frequency_hz = 50_000_000, sample_hz = 1000 }
[[axis]]
name = "lift"
counts_per_unit = 1000
shaper = { kind = "vibrationless", structure = "cascade" }
mode = [{ frequency_hz = 9.0, damping = 0 }]
"#;

fn designed(text: &str) -> Value {
    let scratch = tempfile::tempdir().unwrap();
    let file = scratch.path().join("boom.toml");
    std::fs::write(&file, text).unwrap();
    let output = posicast().arg("design").arg(&file).arg("--json").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A half sum has the gain |cos(pi f d)|.
#[test]
fn cli_cascade_states_the_residual_of_its_whole_delays() {
    let document = designed(UNDAMPED);
    let quantised = &document["axes"][0]["quantised"];
    assert_eq!(quantised["half_sums_samples"], serde_json::json!([62, 50]));
    assert_eq!(quantised["taps"].as_array().unwrap().len(), 4);
    let gain = |delay_s: f64| (std::f64::consts::PI * 9.0 * delay_s).cos().abs();
    let residual = quantised["modes"][0]["residual"].as_f64().unwrap();
    assert!((residual - gain(0.062) * gain(0.050)).abs() < 1e-12, "{residual}");
    let as_taps = designed(&UNDAMPED.replace("cascade", "taps"));
    assert!(as_taps["axes"][0]["quantised"].get("half_sums_samples").is_none());
}

/// Verilator and RustHDL's simulator compare it with the model; the axis has no multiplier.
#[test]
fn cli_cascade_is_verified_beside_a_table() {
    for simulator in [
        &["--cycles", "30000"][..],
        &["--cycles", "13000", "--simulator", "rusthdl"],
    ] {
        let mut verify = posicast();
        verify.arg("verify").arg(example("varying-load.toml")).args(simulator);
        verify.assert().success().stdout(predicate::str::contains(
            "every tap and bank of the shapers and every flag",
        ));
    }
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("boom");
    generate(&example("varying-load.toml"), &folder);
    let cascade = std::fs::read_to_string(folder.join("rtl/boom_lift_cascade.v")).unwrap();
    assert!(!cascade.contains("smul"), "{cascade}");
    assert!(folder.join("docs/cascade.md").is_file());
}

#[test]
fn cli_cascade_with_another_delay_or_too_few_clocks_is_no_match() {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("boom");
    generate(&example("varying-load.toml"), &folder);
    let verify = |folder: &Path, more: &[&str]| {
        let mut verify = posicast();
        verify.arg("verify").arg(folder).args(["--block", "shaper"]).args(more);
        let output = verify.output().unwrap();
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stdout).into_owned(),
        )
    };
    let (code, said) = verify(&folder, &["--cycles", "400"]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("half sum 0 (after 146 samples)"), "{said}");

    let rom = folder.join("rtl/boom_lift_stage_delays.v");
    let text = std::fs::read_to_string(&rom).unwrap();
    let line = text.lines().find(|line| line.contains("// 104 samples")).unwrap();
    let later = line.replace("h68", "h69");
    assert_ne!(line, later, "{text}");
    std::fs::write(&rom, text.replace(line, &later)).unwrap();
    let (code, said) = verify(&folder, &["--edited", "--cycles", "30000"]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("lift_y"), "{said}");
}

/// 2^10 impulses fit no table, but a cascade.
#[test]
fn cli_cascade_is_offered_where_a_table_is_too_small() {
    let scratch = tempfile::tempdir().unwrap();
    let file = scratch.path().join("boom.toml");
    let two_modes = UNDAMPED
        .replace("damping = 0 }]", "damping = 0 }, { frequency_hz = 23.0, damping = 0 }]")
        .replace("\"cascade\"", "\"taps\", order = 5");
    std::fs::write(&file, &two_modes).unwrap();
    let remedy = "structure = \"cascade\" in [axis.shaper] computes it without a table";
    let mut design = posicast();
    design.arg("design").arg(&file);
    design.assert().code(2).stderr(predicate::str::contains(remedy));

    std::fs::write(&file, two_modes.replace("\"taps\"", "\"cascade\"")).unwrap();
    let mut run = posicast();
    run.arg("run").arg(&file).arg("-o").arg(scratch.path().join("out"));
    run.assert().success().stdout(predicate::str::contains("PASS"));
}

#[test]
fn cli_cascade_has_no_bitstream_by_tables() {
    let mut bitstream = posicast();
    bitstream
        .arg("bitstream")
        .arg(example("varying-load.toml"))
        .args(["--board", "colorlight-i5"]);
    bitstream
        .assert()
        .code(2)
        .stderr(predicate::str::contains("axis lift is a cascade of half sums"));
}
