//! A tool or a simulation that does not answer is stopped, and named.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, generate, one_axis, posicast, scratch};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Time limit in which Icarus compiles a small block.
const LIMIT: &str = "3";

fn verify(source: &Path, arguments: &[&str], variables: &[(&str, &Path)], limit: &str) -> (Option<i32>, String) {
    let cache = tempfile::tempdir().unwrap();
    let start = Instant::now();
    let mut verify = posicast();
    verify.arg("verify").arg(source).args(arguments);
    verify
        .envs(variables.iter().copied())
        .env("POSICAST_TOOL_LIMIT_S", limit)
        .env("POSICAST_CACHE", cache.path());
    let output = verify.output().unwrap();
    assert!(start.elapsed() < Duration::from_secs(200), "it was not stopped");
    assert!(output.stdout.is_empty());
    (
        output.status.code(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

/// Returns a program that only sleeps.
fn sleeper(folder: &Path) -> PathBuf {
    let path = folder.join("sleeper");
    std::fs::write(&path, "#!/bin/sh\nsleep 600\n").unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[test]
fn cli_a_tool_that_never_answers_is_stopped_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let sleeper = sleeper(folder.path());
    let machine = example("xy-stage.toml");
    for (simulator, variable) in [("verilator", "VERILATOR"), ("icarus", "IVERILOG")] {
        let words = ["--simulator", simulator, "--block", "divider"];
        let (status, said) = verify(&machine, &words, &[(variable, &sleeper)], "1");
        assert_eq!(status, Some(2), "{variable}: {said}");
        assert!(said.contains("sleeper did not answer for 1 s"), "{variable}: {said}");
        assert!(said.contains("POSICAST_TOOL_LIMIT_S"), "{variable}: {said}");
    }
}

#[test]
fn cli_a_simulator_that_never_answers_is_stopped_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let sleeper = sleeper(folder.path());
    let words = ["--simulator", "icarus", "--block", "divider"];
    let (status, said) = verify(&example("xy-stage.toml"), &words, &[("VVP", &sleeper)], LIMIT);
    assert_eq!(status, Some(2), "{said}");
    assert!(
        said.contains("did not answer for 3 s") && said.contains("POSICAST_TOOL_LIMIT_S"),
        "{said}"
    );
}

/// Generates a machine with one axis, in whose Verilog a strobe begins a loop without end.
fn endless(folder: &Path) -> PathBuf {
    let (_scratch, machine) = scratch(&one_axis("kind = \"zv\"", "frequency_hz = 50.0\ndamping = 0.1"));
    let output = folder.join("out");
    generate(&machine, &output);
    let top = output.join("rtl/one.v");
    let text = std::fs::read_to_string(&top).unwrap();
    // Verilator leaves out a loop whose result nothing uses.
    let looping = "    reg [31:0] mine = 0;\n    always @(posedge clk) begin\n        while (strobe) mine = mine + 1;\n        \
                   if (mine == 7) $display(\"seven\");\n    end\nendmodule";
    std::fs::write(&top, text.replacen("endmodule", looping, 1)).unwrap();
    output
}

#[test]
fn cli_a_simulation_in_icarus_that_loops_without_end_is_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let output = endless(folder.path());
    let (status, said) = verify(&output, &["--simulator", "icarus"], &[], LIMIT);
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("Icarus did not answer for 3 s"), "{said}");
}

/// The limit also holds for the build, which takes some seconds.
#[test]
fn long_cli_a_simulation_in_verilator_that_loops_without_end_ends_the_command() {
    let folder = tempfile::tempdir().unwrap();
    let output = endless(folder.path());
    let mut verify = posicast();
    verify.arg("verify").arg(&output).args(["--simulator", "verilator"]);
    let ended = verify
        .env("POSICAST_CACHE", folder.path().join("cache"))
        .env("POSICAST_TOOL_LIMIT_S", "60")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(
        (ended.status.code(), ended.stdout.is_empty()),
        (Some(2), true),
        "{said}"
    );
    assert!(said.contains("did not come back from a clock for 60 s"), "{said}");
}
