//! Tests the PWM's fault path in an event simulator, with pulses shorter than a clock, which a cycle simulation cannot
//! see.

use crate::support::broken;
use posicast_blocks::pwm::{ActiveLow, PwmConfig};
use posicast_hdl::pwm::{emit, name};
use std::process::Command;

/// Compiles and runs `pwm_fault.v` with the emitted Verilog, in which the first `from` is replaced by `to`.
fn said(from: &str, to: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let config = PwmConfig::new(ActiveLow::default(), 1, 1).unwrap();
    let modules = broken(&emit(&config, "").unwrap(), from, to);
    let mut files = vec![folder.path().join("pwm_fault.v")];
    let bench = include_str!("pwm_fault.v").replace("pwm dut", &format!("{} dut", name(&config, "")));
    std::fs::write(&files[0], bench).unwrap();
    for module in &modules {
        files.push(folder.path().join(format!("{}.v", module.name)));
        std::fs::write(&files[files.len() - 1], &module.text).unwrap();
    }
    let tool = |variable: &str, name: &str| Command::new(std::env::var(variable).unwrap_or_else(|_| name.to_owned()));
    let program = folder.path().join("pwm_fault.vvp");
    let mut compile = tool("IVERILOG", "iverilog");
    compile
        .args(["-g2005", "-s", "pwm_fault", "-o"])
        .arg(&program)
        .args(&files);
    let compiled = compile.output().unwrap();
    assert!(
        compiled.status.success(),
        "{}",
        String::from_utf8_lossy(&compiled.stderr)
    );
    let ran = tool("VVP", "vvp").arg("-n").arg(&program).output().unwrap();
    String::from_utf8_lossy(&ran.stdout).trim().to_owned()
}

#[test]
fn crosssim_pulses_shorter_than_a_clock_switch_the_pins_off_and_are_kept() {
    assert_eq!(said("", ""), "passed");
}

#[test]
fn crosssim_catches_a_latch_that_needs_the_clock() {
    let said = said("always @(posedge clk or negedge trip_n)", "always @(posedge clk)");
    assert!(said.contains("not off after the pulse"), "{said}");
}

#[test]
fn crosssim_catches_pins_that_wait_for_the_synchroniser() {
    let said = said("armed = fault_latch_armed & trip_n", "armed = !latched");
    assert!(said.contains("not off without a clock"), "{said}");
}
