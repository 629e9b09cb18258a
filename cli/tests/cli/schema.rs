//! `posicast schema`: on standard output, and as a file that posicast recognises.

use crate::cli::support::{assert_fits_schema, example, json, one_axis, posicast, scratch};
use std::path::Path;

#[test]
fn standard_output_has_the_committed_schema() {
    let output = posicast().arg("schema").output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    let committed = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/machine-file.schema.json");
    assert_eq!(
        String::from_utf8(output.stdout).unwrap(),
        std::fs::read_to_string(committed).unwrap()
    );
}

#[test]
fn golden_the_committed_schema_of_the_report_matches_its_types() {
    let output = posicast().args(["schema", "--report"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    let written = String::from_utf8(output.stdout).unwrap();
    let committed = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/report.schema.json");
    if std::env::var_os("POSICAST_REGENERATE").is_some() {
        std::fs::write(committed, &written).unwrap();
    }
    assert!(
        written == std::fs::read_to_string(committed).unwrap(),
        "docs/report.schema.json is not what the types of the report say; if the change is meant: scripts/regenerate"
    );
}

#[test]
fn the_option_report_is_the_name_report() {
    let of = |words: &[&str]| posicast().arg("schema").args(words).output().unwrap();
    assert_eq!(of(&["report"]).stdout, of(&["--report"]).stdout);
    assert_eq!(of(&["machine-file"]).stdout, of(&[]).stdout);
    assert_eq!(of(&["design", "--report"]).status.code(), Some(2));
}

#[test]
fn a_file_is_replaced_only_if_it_is_ours() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("posicast-machine.schema.json");
    let schema = |words: &[&str]| {
        let output = posicast()
            .args(["schema", "-o"])
            .arg(&path)
            .args(words)
            .output()
            .unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(schema(&[]).0, Some(0));
    let written = std::fs::read(&path).unwrap();
    assert!(
        json(&written)["$comment"]
            .as_str()
            .unwrap()
            .starts_with("written by posicast ")
    );
    assert_eq!(json(&written)["properties"]["name"]["type"], "string");
    assert_eq!(schema(&[]).0, Some(0), "it is ours");
    std::fs::write(&path, "{}").unwrap();
    let (code, said) = schema(&[]);
    assert_eq!(code, Some(2));
    assert!(said.contains("--output") && said.contains("--force"), "{said}");
    assert_eq!(schema(&["--force"]).0, Some(0));
    assert_eq!(std::fs::read(&path).unwrap(), written);
}

/// Runs a command in a folder, and checks its document against the schema of this name.
fn fits(name: &str, folder: &Path, words: &[&str]) {
    let output = posicast().current_dir(folder).args(words).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(matches!(output.status.code(), Some(0 | 1)), "{words:?}: {said}");
    assert_fits_schema(name, &json(&output.stdout));
}

#[test]
fn documents_fit_their_schemas() {
    let (folder, _) = scratch(&one_axis("kind = \"zvd\"", "frequency_hz = 50.0\ndamping = 0.1"));
    let (stage, contoured) = (example("xy-stage.toml"), example("contouring-stage.toml"));
    let (arm, moving) = (example("optimal-arm.toml"), example("telescope-arm.toml"));
    let [stage, contoured, arm, moving] = [&stage, &contoured, &arm, &moving].map(|path| path.to_str().unwrap());
    let log = example("printer-x.csv");
    let log = log.to_str().unwrap();
    let short = ["--simulator", "icarus", "--cycles", "2000", "--json"];
    let rows: [(&str, &[&str]); 15] = [
        ("design", &["design", "machine.toml", "--json"]),
        ("design", &["design", stage, "--json", "--certify", "--move", "0.01"]),
        ("design", &["design", arm, "--json", "--front"]),
        ("design", &["design", moving, "--json"]),
        ("compare", &["design", stage, "--compare", "--json"]),
        ("generate", &["generate", "machine.toml", "-o", "out", "--json"]),
        ("simulate", &["simulate", "machine.toml", "-o", "a.vcd", "--json"]),
        ("simulate", &["simulate", contoured, "--contour", "circle", "--json"]),
        (
            "verify",
            &[
                "verify",
                "machine.toml",
                short[0],
                short[1],
                short[2],
                short[3],
                short[4],
            ],
        ),
        (
            "verify",
            &["verify", "out", short[0], short[1], short[2], short[3], short[4]],
        ),
        ("diff", &["diff", "a.vcd", "a.vcd", "--json"]),
        ("synth", &["synth", "machine.toml", "--json"]),
        ("identify", &["identify", log, "--json"]),
        ("reproduce", &["reproduce", "antisymmetry", "--json"]),
        ("doctor", &["doctor", "--json"]),
    ];
    for (name, words) in rows {
        fits(name, folder.path(), words);
    }
}

#[test]
fn every_name_has_a_schema_that_names_its_keys() {
    let help = posicast().args(["schema", "--help"]).output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    // Other options list values, too.
    let (arguments, _) = help.split_once("Options:").unwrap();
    let names: Vec<&str> = arguments
        .lines()
        .filter_map(|line| line.trim().strip_prefix("- ")?.split(':').next())
        .collect();
    assert!(
        names.contains(&"machine-file") && names.contains(&"host-status"),
        "{help}"
    );
    for name in names {
        let schema = posicast().args(["schema", name]).output().unwrap();
        let schema = json(&schema.stdout);
        assert!(schema["$schema"].is_string(), "{name}");
        assert!(schema.get("properties").or(schema.get("anyOf")).is_some(), "{name}");
    }
}
