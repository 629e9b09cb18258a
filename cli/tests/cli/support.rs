//! Shared parts of the tests of the command line.

#![cfg(test)] // lets clippy see that this is test code

use assert_cmd::Command;
use assert_cmd::assert::Assert;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Returns the program, in a folder of its own.
pub(crate) fn posicast() -> Command {
    Command::new(env!("CARGO_BIN_EXE_posicast"))
}

/// Runs `identify` with these words in a folder; returns its exit status, what it prints, and its problems.
pub(crate) fn identify(folder: &Path, words: &[&str]) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = posicast()
        .current_dir(folder)
        .arg("identify")
        .args(words)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code(), text(stdout), text(stderr))
}

/// Returns the path of a machine file of the examples.
pub(crate) fn example(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name)
}

/// Returns a scratch folder with `machine.toml` in it.
pub(crate) fn scratch(machine: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("machine.toml");
    std::fs::write(&file, machine).unwrap();
    (folder, file)
}

/// Runs `generate` on a machine file, which must succeed.
pub(crate) fn generate(machine: &Path, output: &Path) -> Assert {
    let mut generate = posicast();
    generate
        .arg("generate")
        .arg(machine)
        .arg("-o")
        .arg(output)
        .assert()
        .success()
}

/// Returns a one-axis machine with this shaper and this mode.
pub(crate) fn one_axis(shaper: &str, mode: &str) -> String {
    format!(
        "name = \"one\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 10_000\n\
         [[axis]]\nname = \"x\"\ncounts_per_unit = 1_000_000\n[axis.shaper]\n{shaper}\n[[axis.mode]]\n{mode}\n"
    )
}

/// Parses the JSON document on standard output.
pub(crate) fn json(output: &[u8]) -> Value {
    serde_json::from_slice(output).unwrap()
}

/// Checks a document against the schema of this name, which must name every key of it.
pub(crate) fn assert_fits_schema(name: &str, document: &Value) {
    let mut schema = json(&posicast().args(["schema", name]).output().unwrap().stdout);
    close(&mut schema);
    let schema = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> = schema
        .iter_errors(document)
        .map(|error| format!("{}: {error}", error.instance_path()))
        .collect();
    assert!(errors.is_empty(), "{name}: {errors:#?}");
}

/// Lets a schema refuse the keys that it does not name.
fn close(schema: &mut Value) {
    match schema {
        Value::Object(of) => {
            if of.contains_key("properties") {
                of.entry("additionalProperties").or_insert(Value::Bool(false));
            }
            of.values_mut().for_each(close);
        }
        Value::Array(of) => of.iter_mut().for_each(close),
        _ => {}
    }
}

/// The crates of the model.
pub(crate) const MODEL: [&str; 5] = [
    "model/taps",
    "model/shaper",
    "model/blocks",
    "model/machine",
    "model/papers",
];

/// Returns the Rust files of these packages of the workspace, without their tests.
pub(crate) fn rust_sources(packages: &[&str]) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let files = packages
        .iter()
        .flat_map(|package| files_below(&root.join(package).join("src")));
    let rust = files.filter(|file| file.extension().is_some_and(|extension| extension == "rs"));
    rust.collect()
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.map(|path| if path.is_dir() { files_below(&path) } else { vec![path] });
    files.flatten().collect()
}
