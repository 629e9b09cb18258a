//! The inline shaper on the command line: from the example to Verilog that equals its model, and files that are refused.

use super::support::{example, generate, posicast, scratch};
use predicates::prelude::*;

fn text() -> String {
    std::fs::read_to_string(example("inline.toml")).unwrap()
}

/// Generates the example with one text in place of another, and checks that it is refused at this line and with these words.
fn refused(from: &str, to: &str, words: &[&str]) {
    let text = text();
    assert!(text.contains(from), "the example has no `{from}`");
    let (folder, file) = scratch(&text.replacen(from, to, 1));
    let output = folder.path().join("out");
    let mut run = posicast();
    run.arg("generate").arg(&file).arg("-o").arg(&output);
    let mut assert = run.assert().code(2).stdout("");
    for word in words {
        assert = assert.stderr(predicate::str::contains(*word));
    }
    assert!(!output.exists());
}

#[test]
fn cli_inline_is_generated_with_its_modules_and_pages() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("router");
    generate(&example("inline.toml"), &output).success();
    let top = std::fs::read_to_string(output.join("rtl/router_inline.v")).unwrap();
    for pin in [
        "x_step_in",
        "z_direction",
        "drive_enable",
        "emergency_stop_n",
        "settled",
        "bypassed",
        "y_input_too_fast",
    ] {
        assert!(top.contains(pin), "{pin}");
    }
    for page in ["inline", "inline_axis", "step_generator", "pulse_counter", "shaper"] {
        assert!(output.join(format!("docs/{page}.md")).is_file(), "{page}");
    }
}

#[test]
fn cli_inline_verilog_equals_its_model() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("router");
    generate(&example("inline.toml"), &output).success();
    posicast()
        .arg("verify")
        .arg(&output)
        .args(["--block", "inline_shaper", "--block", "inline_group"])
        .assert()
        .success()
        .stdout(predicate::str::contains("inline_shaper"));
}

#[test]
fn cli_inline_pulses_that_the_filter_swallows_are_refused() {
    let words = [
        "machine.toml:30",
        "axis.input.pulse_s",
        "240.0 ns",
        "lower filter_clocks",
    ];
    refused("pulse_s = 5e-6  ", "pulse_s = 0.2e-6", &words);
}

#[test]
fn cli_inline_rates_beyond_the_lines_are_refused() {
    let words = ["axis.input.pulse_s of axis x", "at most", "lower the velocity"];
    refused("velocity = 500.0", "velocity = 1500.0", &words);
    let words = ["axis.steps.pulse_s of axis x", "limits.velocity"];
    refused("pulse_s = 2.5e-6", "pulse_s = 25e-6", &words);
    let words = ["axis.limits.velocity", "a step per tick more", "positive impulses"];
    refused("pulse_s = 2.5e-6", "pulse_s = 12.3e-6", &words);
    refused(
        "counts_per_unit = 80 ",
        "counts_per_unit = 8000 ",
        &["axis x", "2000000 steps/s"],
    );
}

#[test]
fn cli_inline_needs_steps_and_limits_on_every_axis() {
    refused("velocity = 500.0", "jerk = 500.0", &["axis.steps", "limits.velocity"]);
    let of_x = "[axis.input]\nkind = \"step_direction\"\nfilter_clocks = 10                    # 200 ns: what a cable picks up is shorter\n\
                pulse_s = 5e-6                        # as set in the controller\n";
    refused(
        of_x,
        "",
        &[
            "axis y with [axis.input] and axis x without",
            "add [axis.input] to axis x",
        ],
    );
    refused(
        "[clock]",
        "[link]\nbaud = 115200\n[clock]",
        &["[link] beside [axis.input]", "remove [link]"],
    );
}

#[test]
fn cli_inline_words_and_lines_of_another_kind_are_refused() {
    refused(
        "kind = \"step_direction\"",
        "kind = \"step-direction\"",
        &["axis.input.kind", "step_direction, up_down, quadrature"],
    );
    refused(
        "pulse_s = 5e-6  ",
        "active_low = [\"step_up\"]\npulse_s = 5e-6",
        &["step_up", "`step` and `direction`"],
    );
    refused(
        "velocity = 500.0",
        "velocity = 500.0\nwatchdog_s = 0.5",
        &["watchdog_s with [axis.input]", "remove"],
    );
    refused(
        "filter_clocks = 10  ",
        "filter_clocks = 64",
        &["axis.input.filter_clocks", "0 to 63"],
    );
}
