//! `posicast schema`: on standard output, and as a file that posicast recognises.

use crate::cli::support::{json, posicast};

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
