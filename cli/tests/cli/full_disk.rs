//! A disk without space: the file is named that could not be written, and nothing half-written stays.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::example;
use std::path::Path;
use std::process::{Command, Output};

/// Runs posicast in `folder`, where no file may get any contents: writing one fails as on a full disk.
fn without_space(folder: &Path, arguments: &[&str]) -> Output {
    let mut shell = Command::new("sh");
    shell.args([
        "-c",
        "trap '' XFSZ; ulimit -f 0; exec \"$0\" \"$@\"",
        env!("CARGO_BIN_EXE_posicast"),
    ]);
    shell.args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn cli_a_file_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let machine = example("xy-stage.toml");
    let machine = machine.to_str().unwrap();
    for (arguments, file) in [
        (&["generate", machine, "-o", "out"][..], "out/"),
        (&["simulate", machine, "-o", "wave.vcd"], "wave.vcd"),
        (&["design", machine, "--plot", "design.svg"], "design.svg"),
        (&["new", "--crane", "crane.toml"], "crane.toml"),
        (&["schema", "-o", "schema.json"], "schema.json"),
        (
            &[
                "campaign",
                "sweep",
                machine,
                "--set",
                "axis.x.shaper.kind=zv",
                "--json",
                "1.json",
            ],
            "1.json",
        ),
    ] {
        let output = without_space(folder.path(), arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(
            said.contains(file) && said.contains("File too large"),
            "{arguments:?}: {said}"
        );
        let left: Vec<_> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .collect();
        assert!(left.is_empty(), "{arguments:?}: {left:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn cli_a_full_standard_output_is_named() {
    let machine = example("xy-stage.toml");
    for arguments in [&["design", "--json"][..], &["design"]] {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_posicast"));
        let output = command.args(arguments).arg(&machine).stdout(full).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(
            said.contains("standard output") && said.contains("No space left"),
            "{arguments:?}: {said}"
        );
    }
}
