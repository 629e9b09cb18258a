//! What `generate` writes for Platform Designer and Quartus, tested without either: its scripts run in `tclsh` with
//! commands that accept what the versions accept (`tests/sopc/`), and their results are compared with the emitted
//! Verilog.

#![cfg(test)] // lets clippy see that this is test code

mod bad_input;
mod components;
mod projects;
mod spi;
mod systems;

use crate::cli::support::{example, generate, scratch};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Name, direction (`Input` or `Output`) and width of each port.
pub(super) type Ports = BTreeMap<String, (String, u32)>;

/// Writes the package of a machine file.
pub(super) fn package(machine: &str) -> (tempfile::TempDir, PathBuf) {
    let (folder, file) = scratch(machine);
    let output = folder.path().join("out");
    generate(&file, &output);
    (folder, output)
}

pub(super) fn xy_stage() -> (tempfile::TempDir, PathBuf) {
    package(&fs::read_to_string(example("xy-stage.toml")).unwrap())
}

/// Returns the records that a checking script prints, split into words, and whether it succeeds.
fn check(script: &str, arguments: &[&str]) -> (Vec<Vec<String>>, bool) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sopc").join(script);
    let output = Command::new("tclsh").arg(script).args(arguments).output().unwrap();
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect();
    (text.lines().map(words).collect(), output.status.success())
}

pub(super) fn check_component(file: &Path) -> (Vec<Vec<String>>, bool) {
    check("platform_designer.tcl", &["component", file.to_str().unwrap()])
}

pub(super) fn check_system(quartus: &str, file: &Path) -> (Vec<Vec<String>>, bool) {
    let components = file.parent().unwrap().to_str().unwrap();
    check(
        "platform_designer.tcl",
        &["system", quartus, file.to_str().unwrap(), components],
    )
}

/// Returns the findings among records, one line each.
pub(super) fn findings(records: &[Vec<String>]) -> Vec<String> {
    let found = records.iter().filter(|record| record[0] == "finding");
    found.map(|record| record[1..].join(" ")).collect()
}

/// Returns the ports of a Verilog module, read from its text.
pub(super) fn verilog_ports(file: &Path) -> Ports {
    let text = fs::read_to_string(file).unwrap();
    let start = text.find("\nmodule ").unwrap();
    let body = &text[start..start + text[start..].find(");").unwrap()];
    let declaration = |line: &str| {
        // The emitter's comments say what a port means.
        let line = line.split("//").next()?.trim().trim_end_matches(',');
        let direction = match line.split_whitespace().next()? {
            "input" => "Input",
            "output" => "Output",
            _ => return None,
        };
        let width = line.split_once('[').map_or(1, |(_, range)| {
            range.split_once(":0]").unwrap().0.parse::<u32>().unwrap() + 1
        });
        let name = line.split_whitespace().next_back()?;
        Some((name.to_owned(), (direction.to_owned(), width)))
    };
    body.lines().filter_map(declaration).collect()
}

/// Returns the ports that a component binds, each to one interface.
pub(super) fn bound_ports(records: &[Vec<String>]) -> Ports {
    let ports = records.iter().filter(|record| record[0] == "port");
    ports
        .map(|record| (record[2].clone(), (record[4].clone(), record[5].parse().unwrap())))
        .collect()
}

/// Returns the files of a file set, as paths.
pub(super) fn file_set(records: &[Vec<String>], kind: &str, folder: &Path) -> Vec<PathBuf> {
    let files = records.iter().filter(|record| record[0] == "file" && record[1] == kind);
    files.map(|record| folder.join(&record[2])).collect()
}

pub(super) fn lint(top: &str, files: &[PathBuf]) {
    let output = Command::new("verilator")
        .args(["--lint-only", "-Wall", "--language", "1364-2001", "--top-module", top])
        .args(files)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{top}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// Replaces text in a file, which must contain it.
pub(super) fn replace(file: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "{from}");
    fs::write(file, text.replacen(from, to, 1)).unwrap();
}

/// The boards with their version of Quartus, clock pin and device.
pub(super) const BOARDS: [(&str, &str, &str, &str); 2] = [
    ("de1", "13.0", "PIN_L1", "EP2C20F484C7"),
    ("de1soc", "25.1", "PIN_AF14", "5CSEMA5F31C6"),
];

/// Returns the records of a project's file, and whether the check succeeds; `ports` are those of the top level.
pub(super) fn check_project(quartus: &str, file: &Path, ports: &Ports) -> (Vec<Vec<String>>, bool) {
    let ports: Vec<String> = ports
        .iter()
        .map(|(name, (direction, _))| format!("{name}={direction}"))
        .collect();
    let arguments = [quartus, file.to_str().unwrap()]
        .into_iter()
        .chain(ports.iter().map(String::as_str));
    check("project.tcl", &arguments.collect::<Vec<_>>())
}
