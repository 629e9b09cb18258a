//! `verify`: the blocks that it compares, and the choice of some of them.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, generate, json, one_axis, posicast, scratch};
use posicast_testbench::blocks::library;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Runs `verify --json` on a machine file; returns the document, and the rows as name and instance.
fn rows(machine: &Path, arguments: &[&str]) -> (serde_json::Value, Vec<(String, String)>) {
    let mut verify = posicast();
    verify.arg("verify").arg(machine).arg("--json").args(arguments);
    let document = json(&verify.output().unwrap().stdout);
    let text = |row: &serde_json::Value, key: &str| row[key].as_str().unwrap().to_owned();
    let blocks = document["blocks"].as_array().unwrap();
    let rows = blocks.iter().map(|row| (text(row, "name"), text(row, "instance")));
    let rows = rows.collect();
    (document, rows)
}

fn compares_every_block(simulator: &str) {
    let arguments = ["--cycles", "1000", "--simulator", simulator];
    let (document, rows) = rows(&example("xy-stage.toml"), &arguments);
    // 1,000 clocks do not fill a delay line: every value is equal, but that is not a verdict.
    assert_eq!(document["result"], "no_verdict");
    assert!(!document["not_exercised"].as_array().unwrap().is_empty());
    let component = |block: &str| rows.contains(&(block.to_owned(), "x, Avalon".to_owned()));
    for block in ["shaper", "pulse_counter", "pwm", "sliding_mode"] {
        // RustHDL's simulator does not have the registers.
        assert_eq!(component(block), simulator == "icarus", "{block}: {rows:?}");
    }
    for (name, instance) in [
        ("shaper", "x"),
        ("shaper", "y"),
        ("shaper", "motion"),
        ("pulse_counter", "x, y"),
        ("sliding_mode", "x, y"),
        ("divider", "5000 clocks per tick"),
        ("pwm", "x, y"),
        ("sliding_mode", "x, y"),
        ("cascade", "4 stages, 32 bits"),
        ("axis", "alone"),
        ("error_table", "9 entries"),
        ("encoder_generator", "alone"),
        ("excitation", "alone"),
        ("uart_bridge", "alone"),
        ("spi_bridge", "alone"),
        ("drive_command", "alone"),
        ("linear_scale", "alone"),
    ] {
        let row = rows
            .iter()
            .position(|row| row == &(name.to_owned(), instance.to_owned()));
        let row = &document["blocks"][row.unwrap_or_else(|| panic!("{name} {instance} in {rows:?}"))];
        assert_eq!(
            (row["cycles"].as_u64(), row["mismatches"].as_u64()),
            (Some(1000), Some(0))
        );
        assert!(row["first"].is_null());
    }
}

#[test]
fn cli_verify_compares_every_block_of_the_library_for_a_machine_with_a_loop() {
    compares_every_block("icarus");
}

#[test]
fn long_cli_verify_compares_every_block_of_the_library_in_rusthdl() {
    compares_every_block("rusthdl");
}

#[test]
fn cli_verify_of_shapers_alone_keeps_to_them() {
    let (_folder, machine) = scratch(&one_axis("kind = \"zvd\"", "frequency_hz = 40.0\ndamping = 0.1"));
    let (document, rows) = rows(&machine, &["--simulator", "rusthdl"]);
    assert_eq!(document["result"], "match");
    assert_eq!(rows, [("shaper".to_owned(), "x".to_owned())]);
}

#[test]
fn cli_verify_selects_blocks_by_name_and_lists_them() {
    let chosen = ["--simulator", "icarus", "--block", "divider", "--block", "cascade"];
    let (document, rows) = rows(&example("xy-stage.toml"), &chosen);
    assert_eq!(document["result"], "match");
    let names: Vec<&str> = rows.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["divider", "cascade"]);
    let unknown = posicast()
        .arg("verify")
        .arg(example("xy-stage.toml"))
        .args(["--block", "divdier", "--json"])
        .output()
        .unwrap();
    assert_eq!((unknown.status.code(), unknown.stdout.is_empty()), (Some(2), true));
    let said = String::from_utf8_lossy(&unknown.stderr).into_owned();
    assert!(
        said.contains("divdier") && said.contains("cascade, compare, divider, divider_share, drive_command"),
        "{said}"
    );
}

#[test]
fn cli_verify_knows_no_block_that_the_ladder_leaves_out() {
    let mut unknown = posicast();
    unknown
        .arg("verify")
        .arg(example("xy-stage.toml"))
        .args(["--block", "none"]);
    let said = String::from_utf8_lossy(&unknown.output().unwrap().stderr).into_owned();
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, names) = said.split_once("choose from: ").unwrap_or_else(|| panic!("{said}"));
    let library = library().unwrap();
    let in_ladder: BTreeSet<&str> = library.iter().map(|block| block.name()).collect();
    for name in names.trim().split(", ") {
        assert!(
            in_ladder.contains(name),
            "{name} is no row of the ladder: {in_ladder:?}"
        );
    }
}

#[test]
fn long_cli_verify_of_a_folder_finds_a_broken_component_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    generate(&example("xy-stage.toml"), &output);
    let top = output.join("rtl/xy_stage_y_pulse_counter_avalon.v");
    let text = std::fs::read_to_string(&top).unwrap();
    let (from, to) = (".start       (divide)", ".start       (tick)");
    assert!(text.contains(from), "{text}");
    std::fs::write(&top, text.replace(from, to)).unwrap();
    let verify = posicast()
        .arg("verify")
        .arg(&output)
        .args([
            "--json",
            "--cycles",
            "20000",
            "--simulator",
            "icarus",
            "--block",
            "pulse_counter",
        ])
        .output()
        .unwrap();
    assert_eq!(
        verify.status.code(),
        Some(1),
        "{}",
        String::from_utf8_lossy(&verify.stderr)
    );
    let document = json(&verify.stdout);
    let blocks = document["blocks"].as_array().unwrap();
    let mismatches: Vec<(&str, bool)> = blocks
        .iter()
        .map(|row| (row["instance"].as_str().unwrap(), row["mismatches"] != 0))
        .collect();
    assert_eq!(
        mismatches,
        [
            ("x, Avalon", false),
            ("x, in the pulse_counter component", false),
            ("y, Avalon", true),
            ("y, in the pulse_counter component", false),
            ("in the stage", false),
        ]
    );
}

/// Returns a folder as `generate` writes it for the XY stage.
fn generated(folder: &Path) -> PathBuf {
    let output = folder.join("out");
    generate(&example("xy-stage.toml"), &output);
    output
}

/// Runs `verify` on a folder with Icarus, which needs no build.
fn verify(output: &Path, arguments: &[&str]) -> Output {
    let mut verify = posicast();
    verify.arg("verify").arg(output).args(["--simulator", "icarus"]);
    verify.args(arguments).output().unwrap()
}

#[test]
fn long_cli_verify_of_a_folder_compares_the_blocks_in_its_components_and_names_the_broken_row() {
    let folder = tempfile::tempdir().unwrap();
    let output = generated(folder.path());
    for (block, component, file, from, to) in [
        (
            "pwm",
            "pwm",
            "posicast_pwm_gates_",
            "a_high_gate_next = high_side;",
            "a_high_gate_next = !high_side;",
        ),
        // Each axis has registers of its own.
        ("registers", "pwm", "xy_stage_x_pwm_registers", "!running && ", ""),
    ] {
        let files = std::fs::read_dir(output.join("rtl")).unwrap();
        let named = |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().starts_with(file);
        let file = files.map(|found| found.unwrap().path()).find(named).unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{text}");
        std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
        let broken = verify(&output, &["--cycles", "6000", "--block", block]);
        std::fs::write(&file, text).unwrap();
        let said = String::from_utf8_lossy(&broken.stdout).into_owned();
        assert_eq!(broken.status.code(), Some(1), "{said}");
        let axes: &[&str] = if block == "registers" { &["x"] } else { &["x", "y"] };
        for axis in axes {
            let row = format!("{block} {axis}, in the {component} component: first mismatch in clock ");
            assert!(said.contains(&row), "{said}");
        }
    }
}

#[test]
fn long_cli_verify_gives_each_row_stimuli_of_its_own_that_repeat() {
    let folder = tempfile::tempdir().unwrap();
    let output = generated(folder.path());
    let file = output.join("rtl/posicast_pwm_leg.v");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replacen("lasts = dead_time;", "lasts = minimum_pulse;", 1)).unwrap();
    let first = |arguments: &[&str]| {
        let out = verify(&output, &[&["--json", "--cycles", "6000"], arguments].concat());
        let document = json(&out.stdout);
        assert_eq!(document["seed"], 1);
        let rows = document["blocks"].as_array().unwrap().iter();
        let inner = rows.filter(|row| row["name"] == "pwm" && row["instance"].as_str().unwrap().ends_with("component"));
        inner.map(|row| row["first"]["time"].as_u64()).collect::<Vec<_>>()
    };
    let alone = first(&["--block", "pwm"]);
    assert_eq!(alone, first(&["--block", "registers", "--block", "pwm"]));
    assert_ne!(alone[0], alone[1], "x and y have the same stimuli");
}

#[test]
fn cli_verify_of_a_folder_misses_a_file_that_is_gone() {
    let folder = tempfile::tempdir().unwrap();
    let output = generated(folder.path());
    std::fs::remove_file(output.join("rtl/xy_stage_y_pwm_avalon.v")).unwrap();
    let gone = verify(&output, &["--cycles", "100"]);
    assert_eq!((gone.status.code(), gone.stdout.is_empty()), (Some(2), true));
    let said = String::from_utf8_lossy(&gone.stderr).replace(['\n', ' '], "");
    assert!(
        said.contains("xy_stage_y_pwm_avalon.v") && said.contains("`generate`"),
        "{said}"
    );
}

#[test]
fn cli_verify_warns_of_no_sample_only_where_a_block_has_samples() {
    for (block, warns) in [("divider", false), ("shaper", true)] {
        let mut verify = posicast();
        verify.arg("verify").arg(example("xy-stage.toml"));
        verify.args(["--simulator", "rusthdl", "--cycles", "3", "--block", block]);
        let said = String::from_utf8_lossy(&verify.output().unwrap().stderr).into_owned();
        assert_eq!(said.contains("no output sample"), warns, "{block}: {said}");
    }
}
