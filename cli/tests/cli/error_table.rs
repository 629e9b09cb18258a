//! Error tables on the command line: the CSV file beside the machine file, in the output folder, and wrong.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, generate, json, posicast, scratch};
use std::path::{Path, PathBuf};

const RIGHT: &str = "position,error\n-0.1,-0.000004\n0,0\n0.1,0.000004\n";

/// The XY stage with a table of x, and its file.
fn machine(csv: &str) -> (tempfile::TempDir, PathBuf) {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let table = "[axis.error_table]\nfile = \"x.csv\"\n\n[axis.limits]";
    let (folder, file) = scratch(&text.replacen("[axis.limits]", table, 1));
    std::fs::write(folder.path().join("x.csv"), csv).unwrap();
    (folder, file)
}

fn run(command: &str, file: &Path, more: &[&str]) -> std::process::Output {
    posicast().arg(command).arg(file).args(more).output().unwrap()
}

#[test]
fn cli_design_describes_the_error_table_made_from_the_points() {
    let (_folder, file) = machine(RIGHT);
    let document = json(&run("design", &file, &["--json"]).stdout);
    let table = &document["axes"][0]["error_table"];
    for (key, value) in [
        ("points", 3),
        ("entries", 197),
        ("spacing_counts", 1024),
        ("first_counts", -100_000),
    ] {
        assert_eq!(table[key], value, "{key}");
    }
    assert!(table["departure_counts"].as_f64().unwrap() < 0.01);
    assert!(document["axes"][1]["error_table"].is_null());
    let text = String::from_utf8(run("design", &file, &[]).stdout).unwrap();
    assert!(
        text.contains("error table, at the reference: 3 points of up to 4.00 µm in 197 entries, 1.02 mm apart"),
        "{text}"
    );
}

#[test]
fn cli_the_folder_holds_the_file_and_is_verified() {
    let (folder, file) = machine(RIGHT);
    let output = folder.path().join("out");
    generate(&file, &output);
    assert_eq!(std::fs::read_to_string(output.join("x.csv")).unwrap(), RIGHT);
    for path in [
        "rtl/xy_stage_x_error_table.v",
        "docs/error_table.md",
        "driver/src/posicast_error_table.c",
    ] {
        assert!(output.join(path).is_file(), "{path}");
    }
    let rows = [
        "--block",
        "error_table",
        "--cycles",
        "20000",
        "--simulator",
        "icarus",
        "--json",
    ];
    let verified = run("verify", &output, &rows);
    let document = json(&verified.stdout);
    assert_eq!(
        (verified.status.code(), document["result"].as_str()),
        (Some(0), Some("match")),
        "{document}"
    );
    assert!(
        document["blocks"]
            .as_array()
            .unwrap()
            .iter()
            .any(|row| row["name"] == "error_table")
    );
}

#[test]
fn cli_errors_of_the_error_table_file_are_bad_input() {
    for (csv, words) in [
        ("-0.1,0\n0.1,0\n0.05,0\n", "x.csv: row 3"),
        ("-0.1,0\n0.1,inf\n", "x.csv: row 2"),
        ("-0.1,0\n", "x.csv: one row"),
        ("-0.05,0\n0.1,0\n", "cover the travel"),
    ] {
        let (folder, file) = machine(csv);
        let output = run("generate", &file, &["-o", folder.path().join("out").to_str().unwrap()]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(
            (output.status.code(), output.stdout.is_empty()),
            (Some(2), true),
            "{said}"
        );
        assert!(
            said.contains(words) && said.contains("machine.toml:") && said.contains("axis.error_table.file"),
            "{said}"
        );
        assert!(!folder.path().join("out").exists());
    }
    let (folder, file) = machine(RIGHT);
    std::fs::remove_file(folder.path().join("x.csv")).unwrap();
    let output = run("design", &file, &[]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("x.csv: cannot be read"), "{said}");
}
