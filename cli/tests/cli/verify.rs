//! `verify`: which blocks it compares, and which of them on request.

#![cfg(test)] // lets clippy see that this is test code

use crate::support::{example, json, one_axis, posicast, scratch};
use std::path::Path;

/// `verify --json` of a machine file, and the rows as name and instance.
fn rows(machine: &Path, arguments: &[&str]) -> (serde_json::Value, Vec<(String, String)>) {
    let mut verify = posicast();
    verify.arg("verify").arg(machine).arg("--json").args(arguments);
    let document = json(&verify.assert().success().get_output().stdout);
    let text = |row: &serde_json::Value, key: &str| row[key].as_str().unwrap().to_owned();
    let blocks = document["blocks"].as_array().unwrap();
    let rows = blocks.iter().map(|row| (text(row, "name"), text(row, "instance")));
    let rows = rows.collect();
    (document, rows)
}

#[test]
fn cli_verify_compares_every_block_of_the_library_for_a_machine_with_a_loop() {
    for simulator in ["icarus", "rusthdl"] {
        let arguments = ["--cycles", "3000", "--simulator", simulator];
        let (document, rows) = rows(&example("xy-stage.toml"), &arguments);
        assert_eq!(document["result"], "match");
        let component = |block: &str| rows.contains(&(block.to_owned(), "x, Avalon".to_owned()));
        for block in ["shaper", "pulse_counter", "pwm", "sliding_mode"] {
            // RustHDL's simulator has no registers.
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
        ] {
            let row = rows
                .iter()
                .position(|row| row == &(name.to_owned(), instance.to_owned()));
            let row = &document["blocks"][row.unwrap_or_else(|| panic!("{name} {instance} in {rows:?}"))];
            assert_eq!(
                (row["cycles"].as_u64(), row["mismatches"].as_u64()),
                (Some(3000), Some(0))
            );
            assert!(row["first"].is_null());
        }
    }
}

#[test]
fn cli_verify_of_shapers_alone_keeps_to_them() {
    let (_folder, machine) = scratch(&one_axis("kind = \"zvd\"", "frequency_hz = 40.0\ndamping = 0.1"));
    let (_, rows) = rows(&machine, &["--cycles", "2000", "--simulator", "rusthdl"]);
    assert_eq!(rows, [("shaper".to_owned(), "x".to_owned())]);
}

#[test]
fn cli_verify_takes_blocks_by_name_and_says_which_there_are() {
    let chosen = [
        "--cycles",
        "2000",
        "--simulator",
        "icarus",
        "--block",
        "divider",
        "--block",
        "cascade",
    ];
    let (_, rows) = rows(&example("xy-stage.toml"), &chosen);
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
        said.contains("divdier") && said.contains("cascade, divider, pulse_counter"),
        "{said}"
    );
}

#[test]
fn cli_verify_of_a_folder_finds_a_broken_component_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let mut generate = posicast();
    generate
        .arg("generate")
        .arg(example("xy-stage.toml"))
        .arg("-o")
        .arg(&output);
    generate.assert().success();
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
    assert_eq!(mismatches, [("x, Avalon", false), ("y, Avalon", true)]);
}
