//! `generate --block`: a block alone whose bench passes in Icarus, fails where it should, and whose proofs are proven by Yosys.

use super::support::{example, posicast};
use predicates::prelude::*;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn kit(arguments: &[&str]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("kit");
    posicast()
        .arg("generate")
        .args(arguments)
        .arg("-o")
        .arg(&output)
        .assert()
        .success();
    (folder, output)
}

fn make(folder: &Path, goal: &str) -> Output {
    Command::new("make").arg(goal).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// The one file of the bench folder with this ending.
fn bench_file(folder: &Path, ending: &str) -> PathBuf {
    let files = std::fs::read_dir(folder.join("bench"))
        .unwrap()
        .map(|file| file.unwrap().path());
    let mut files = files.filter(|file| file.to_string_lossy().ends_with(ending));
    files.next().unwrap()
}

fn pass_and_have_no_warning(blocks: &[&str]) {
    for block in blocks {
        let (_scratch, folder) = kit(&["--block", block]);
        let ran = make(&folder, "bench");
        assert!(
            ran.status.success() && said(&ran).contains("PASS: "),
            "{block}: {}",
            said(&ran)
        );
        let linted = make(&folder, "lint");
        assert!(linted.status.success(), "{block}: {}", said(&linted));
        let readme = std::fs::read_to_string(folder.join("README.md")).unwrap();
        assert!(readme.contains("make prove"), "{block}: {readme}");
    }
}

#[test]
fn cli_block_kits_pass_their_benches_and_have_no_warning() {
    pass_and_have_no_warning(&["pulse_counter", "wishbone_bridge"]);
}

#[test]
fn long_cli_block_kits_pass_their_benches_and_have_no_warning() {
    pass_and_have_no_warning(&[
        "cascade",
        "step_generator",
        "absolute_encoder",
        "capture",
        "compare",
        "axis",
        "group",
    ]);
}

#[test]
fn cli_block_kit_of_a_machine_has_its_settings_and_buses() {
    let machine = example("xy-stage.toml");
    let (_scratch, folder) = kit(&[machine.to_str().unwrap(), "--block", "pwm"]);
    let tops = std::fs::read_to_string(folder.join("filelist.f")).unwrap();
    // 500 ns and 1 µs at 50 MHz.
    assert!(tops.contains("rtl/posicast_pwm_25x50_0000.v"), "{tops}");
    let ran = make(&folder, "bench");
    assert!(ran.status.success(), "{}", said(&ran));
    for (list, top) in [
        ("avalon", "xy_stage_x_pwm_avalon"),
        ("axi", "xy_stage_x_pwm_axi"),
        ("wishbone", "xy_stage_x_pwm_wishbone"),
    ] {
        let files = std::fs::read_to_string(folder.join(format!("bus/{list}.f"))).unwrap();
        let last = files.lines().last().unwrap().to_owned();
        assert!(last.ends_with(&format!("{top}.v")), "{last}");
        let module = Path::new(&last).file_stem().unwrap().to_string_lossy().into_owned();
        let linted = Command::new("verilator")
            .args([
                "--lint-only",
                "-Wall",
                "--top-module",
                &module,
                "-f",
                &format!("bus/{list}.f"),
            ])
            .current_dir(&folder)
            .output()
            .unwrap();
        assert!(linted.status.success(), "{}", said(&linted));
    }
    assert!(folder.join("docs/registers.md").is_file() && folder.join("docs/pwm.md").is_file());
}

/// Half sums of order 1 have half a period of the damped mode as delay: 62.5 samples at 8 Hz and 1 kHz, 31.25 at 16 Hz.
#[test]
fn cli_block_kit_of_a_vibrationless_axis_has_its_half_sums() {
    let scratch = tempfile::tempdir().unwrap();
    let file = scratch.path().join("slow.toml");
    let mode = |hz: &str| format!("[[axis.mode]]\nfrequency_hz = {hz}\ndamping = 0\n");
    let text = format!(
        "name = \"slow\"\n[clock]\nfrequency_hz = 50_000_000\nsample_hz = 1000\n[[axis]]\nname = \"x\"\ncounts_per_unit = 1000\n\
         [axis.shaper]\nkind = \"vibrationless\"\norder = 1\n{}{}",
        mode("8.0"),
        mode("16.0")
    );
    std::fs::write(&file, &text).unwrap();
    let (_scratch, folder) = kit(&[file.to_str().unwrap(), "--block", "cascade"]);
    let rom = std::fs::read_to_string(folder.join("rtl/slow_x_stage_delays.v")).unwrap();
    assert!(rom.contains("// 63 samples") && rom.contains("// 31 samples"), "{rom}");
    let ran = make(&folder, "bench");
    assert!(ran.status.success(), "{}", said(&ran));
    let readme = std::fs::read_to_string(folder.join("README.md")).unwrap();
    // |cos(pi f 0.063) cos(pi f 0.031)|.
    assert!(readme.contains("0.894 % at 8 Hz, 1.256 % at 16 Hz"), "{readme}");

    std::fs::write(&file, text.replace("\"vibrationless\"\norder = 1", "\"zv\"")).unwrap();
    posicast()
        .args(["generate", file.to_str().unwrap(), "--block", "cascade"])
        .assert()
        .code(2)
        .stderr(predicate::str::contains("has no such block"));
}

#[test]
fn cli_block_kit_fails_for_wrong_verilog_and_for_missing_clocks() {
    let (_scratch, folder) = kit(&["--block", "divider"]);
    let verilog = folder.join("rtl/divider_5000.v");
    let right = std::fs::read_to_string(&verilog).unwrap();
    let wrong = right.replacen("+ ", "- ", 1);
    assert_ne!(right, wrong);
    std::fs::write(&verilog, wrong).unwrap();
    let ran = make(&folder, "bench");
    assert!(!ran.status.success() && said(&ran).contains("FAIL: "), "{}", said(&ran));

    std::fs::write(&verilog, right).unwrap();
    let vectors = bench_file(&folder, ".hex");
    let all = std::fs::read_to_string(&vectors).unwrap();
    let half: String = all.lines().take(10_000).map(|line| format!("{line}\n")).collect();
    std::fs::write(&vectors, half).unwrap();
    let ran = make(&folder, "bench");
    assert!(
        !ran.status.success() && said(&ran).contains("has not 20000 lines"),
        "{}",
        said(&ran)
    );
}

#[test]
fn cli_block_kit_proves_its_properties() {
    let (_scratch, folder) = kit(&["--block", "probe_line"]);
    let proven = make(&folder, "prove");
    assert!(
        proven.status.success() && said(&proven).contains("proven: probe_line"),
        "{}",
        said(&proven)
    );
    let properties = folder.join("formal/probe_line_1/properties.sv");
    let text = std::fs::read_to_string(&properties).unwrap();
    let (before, after) = text
        .rsplit_once("assert (")
        .or_else(|| text.rsplit_once("assert("))
        .unwrap();
    std::fs::write(&properties, format!("{before}assert (!{after}")).unwrap();
    let refused = make(&folder, "prove");
    assert!(
        !refused.status.success() && said(&refused).contains("not proven"),
        "{}",
        said(&refused)
    );
}

#[test]
fn cli_block_that_is_not_there_is_bad_input() {
    let refused = |arguments: &[&str], words: &str| {
        posicast()
            .arg("generate")
            .args(arguments)
            .assert()
            .code(2)
            .stderr(predicate::str::contains(words));
    };
    refused(&["--block", "flux_capacitor"], "posicast has no such block");
    refused(&["--block", "step_genrator"], "did you mean `step_generator`?");
    refused(
        &["--block", "stage"],
        "choose from: absolute_encoder, absolute_feedback, axi_lite_bridge",
    );
    let inline = example("inline.toml");
    refused(&[inline.to_str().unwrap(), "--block", "pwm"], "has no such block");
    refused(&["--block", "pwm", "--hal"], "cannot be used with");
}

#[test]
fn cli_block_kit_is_no_machine() {
    let (_scratch, folder) = kit(&["--block", "divider"]);
    posicast()
        .arg("verify")
        .arg(&folder)
        .assert()
        .code(2)
        .stderr(predicate::str::contains("this is the kit of the block divider alone"))
        .stderr(predicate::str::contains("posicast verify MACHINE --block divider"));
}
