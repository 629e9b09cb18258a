//! `run`, `generate` and `verify`: the Verilog, its simulation, and errors put into it.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, generate, json, posicast};
use std::path::{Path, PathBuf};

/// Number of clocks that reach every directed case of the example and some random ones.
const CYCLES: &str = "60000";

/// Returns the XY stage with open loops; `stage.rs` tests the closed loop.
fn without_controllers() -> String {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    // The guards of [axis.limits] are for axes with a controller.
    let closed = [
        "[axis.controller]",
        "kind = \"pd\"",
        "following_error",
        "encoder_lost_s",
        "watchdog_s",
    ];
    closed.iter().fold(text, |text, part| text.replace(part, "#"))
}

#[test]
fn cli_run_goes_the_whole_way_on_the_xy_stage() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("xy_stage");
    let (_scratch, file) = crate::cli::support::scratch(&without_controllers());
    let run = || {
        let mut run = posicast();
        run.arg("run")
            .arg(&file)
            .arg("-o")
            .arg(&output)
            .args(["--json", "--cycles", CYCLES]);
        json(&run.assert().success().get_output().stdout)
    };
    let document = run();
    assert_eq!(document["result"], "pass");
    assert_eq!(document["verify"]["result"], "match");
    let x = &document["axes"][0]["plant"];
    let overshoot = |case: &str| x[case]["overshoot"].as_f64().unwrap();
    // Measured on the simulated machine; published are 60.53 % unshaped, 1.50 % at -10 %.
    assert!((overshoot("unshaped") - 0.6053).abs() < 5e-5);
    assert!((overshoot("minus_10_percent") - 0.0150).abs() < 5e-5);
    for file in [
        "machine.toml",
        "posicast.json",
        "report.json",
        "rtl/xy_stage.v",
        "wave/model.vcd",
        "wave/rtl.vcd",
        "wave/float.vcd",
    ] {
        assert!(output.join(file).is_file(), "{file}");
    }
    for wave in ["model", "rtl", "float", "merged"] {
        let text = std::fs::read_to_string(output.join(format!("wave/{wave}.vcd"))).unwrap();
        assert!(text.contains("$timescale 1 ns $end"), "{wave}");
        // The machine's clock is 20 ns; the strobe of sample 1 comes 100 us after that of sample 0, at the end of the
        // reset.
        assert!(
            text.contains("\n#10\n0!\n") && text.contains("\n#100040\n1!\n"),
            "{wave}"
        );
    }
    assert_eq!(
        run(),
        document,
        "a second run into the same folder gives the same report"
    );
}

#[test]
fn cli_run_of_the_zv_shaper_gives_its_published_overshoot() {
    let text = without_controllers().replace("\"zvd\"", "\"zv\"");
    let (folder, file) = crate::cli::support::scratch(&text);
    let mut run = posicast();
    run.arg("run")
        .arg(&file)
        .arg("-o")
        .arg(folder.path().join("out"))
        .args(["--json", "--cycles", CYCLES]);
    let document = json(&run.assert().success().get_output().stdout);
    let overshoot = document["axes"][0]["plant"]["minus_10_percent"]["overshoot"]
        .as_f64()
        .unwrap();
    assert!((overshoot - 0.0953).abs() < 5e-5, "{overshoot}");
}

#[test]
fn cli_a_modulo_axis_goes_the_whole_way_across_the_end_of_its_word() {
    // 24 bits with 8 bits of fraction wrap after 65,536 counts: the table turns round five times and comes back a
    // little.
    let text = crate::cli::support::one_axis("kind = \"zvd\"", "frequency_hz = 40.0\ndamping = 0.1")
        .replace("1_000_000", "1_000\nmodulo = true")
        .replace("[[axis]]", "[fixed_point]\ncommand_bits = 24\n[[axis]]");
    let (folder, file) = crate::cli::support::scratch(&text);
    let command = folder.path().join("turns.csv");
    std::fs::write(&command, "time_s,position\n0,40\n0.4,360\n0.45,350\n").unwrap();
    let output = folder.path().join("out");
    let mut run = posicast();
    run.arg("run")
        .arg(&file)
        .arg("-o")
        .arg(&output)
        .arg("--command")
        .arg(&command)
        .args(["--json", "--cycles", CYCLES]);
    let document = json(&run.assert().success().get_output().stdout);
    assert_eq!(document["result"], "pass");
    let axis = &document["axes"][0];
    assert!(axis["largest_difference_lsb"].as_f64().unwrap() <= axis["bound_lsb"].as_f64().unwrap());
    let top = std::fs::read_to_string(output.join("rtl/one.v")).unwrap();
    assert!(top.contains("x_swap_how") && top.contains("x_y_0"), "{top}");
    let mut simulate = posicast();
    simulate
        .arg("simulate")
        .arg(&file)
        .arg("--command")
        .arg(&command)
        .arg("-o")
        .arg(folder.path().join("turns.vcd"))
        .arg("--json");
    json(&simulate.assert().success().get_output().stdout);
    let samples = std::fs::read_to_string(folder.path().join("turns.vcd")).unwrap();
    assert!(
        samples.contains("$timescale 1 us $end") && samples.contains(" sample_clk $end"),
        "{}",
        &samples[..400]
    );

    // Half a turn of the word within the shaper's delay cannot be told from the other half.
    std::fs::write(&command, "time_s,position\n0,0\n0.01,200\n").unwrap();
    let refused = posicast()
        .arg("simulate")
        .arg(&file)
        .arg("--command")
        .arg(&command)
        .output()
        .unwrap();
    assert_eq!((refused.status.code(), refused.stdout.is_empty()), (Some(2), true));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("move slower"));
}

#[test]
fn cli_verify_without_any_tool_still_gives_a_verdict_and_names_it_the_weaker_check() {
    let mut verify = posicast();
    verify
        .arg("verify")
        .arg(example("robot-joint.toml"))
        .args(["--json", "--block", "shaper"])
        .env("PATH", "");
    let assert = verify.assert().success().stderr(predicates::str::contains("weaker"));
    // A size of the shaper is not compiled for each machine, and the message names what is simulated instead.
    let assert = assert.stderr(predicates::str::contains("at larger sizes with equal outputs"));
    assert_eq!(json(&assert.get_output().stdout)["simulator"], "rusthdl");
}

#[test]
fn cli_the_shaper_component_of_a_controlled_axis_has_three_channels_where_it_can() {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let words_of_16 = "[fixed_point]\ncommand_bits = 16\n[[axis]]";
    // 1 Hz rings for 10,000 samples: the ring of a shaper with several channels does not reach back so far.
    let slow = text.replacen("131.117015808451", "1.0", 1);
    let cases = [
        (text.clone(), ["x_2", "swap_how"].as_slice(), [].as_slice()),
        (
            text.replacen("[[axis]]", words_of_16, 1).replace("travel =", "# "),
            &["x"],
            &["x_1", "swap_how"],
        ),
        (slow, &["x_0", "swap_how"], &["x_1"]),
    ];
    for (machine, there, missing) in cases {
        let (folder, file) = crate::cli::support::scratch(&machine);
        let output = folder.path().join("out");
        let mut generate = posicast();
        let run = generate
            .arg("generate")
            .arg(&file)
            .arg("-o")
            .arg(&output)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{said}");
        assert_eq!(said.contains("only the channel of the"), !missing.is_empty(), "{said}");
        let top = std::fs::read_to_string(output.join("rtl/xy_stage_x_shaper_avalon.v")).unwrap();
        let has = |name: &&str| {
            top.split(|c: char| !c.is_alphanumeric() && c != '_')
                .any(|word| word == *name)
        };
        assert!(
            there.iter().all(has) && !missing.iter().any(has),
            "{there:?} {missing:?}"
        );
    }
}

fn generated(folder: &Path) -> PathBuf {
    let output = folder.join("xy_stage");
    generate(&example("xy-stage.toml"), &output);
    output
}

/// Replaces text in one of the generated files, which must contain it.
fn break_file(file: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "{} does not hold `{from}`", file.display());
    std::fs::write(file, text.replacen(from, to, 1)).unwrap();
}

#[test]
fn long_cli_verify_reports_a_broken_bit_of_the_multiplier_and_of_the_address() {
    for (file, from, to) in [
        ("rtl/posicast_smul_18x18.v", "a_q * b_q", "(a_q ^ 18'sd1) * b_q"),
        (
            "rtl/posicast_history_32x128x1.v",
            "head - delay;",
            "head - delay - 7'd1;",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let output = generated(folder.path());
        break_file(&output.join(file), from, to);
        let verify = posicast()
            .arg("verify")
            .arg(&output)
            .args(["--json", "--cycles", CYCLES, "--block", "shaper"])
            .output()
            .unwrap();
        assert_eq!(
            verify.status.code(),
            Some(1),
            "{}",
            String::from_utf8_lossy(&verify.stderr)
        );
        let document = json(&verify.stdout);
        assert_eq!(document["result"], "mismatch");
        // Both axes use the module.
        for axis in ["x", "y"] {
            let blocks = document["blocks"].as_array().unwrap();
            let block = blocks.iter().find(|b| b["instance"] == axis).unwrap();
            let signal = block["first"]["signal"].as_str().unwrap();
            assert!(signal.starts_with(&format!("{axis}_y")), "{block}");
            assert_ne!(block["first"]["expected"], block["first"]["actual"]);
        }
    }
}

#[test]
fn cli_generate_refuses_to_overwrite_an_edited_file_and_verify_takes_no_rusthdl_for_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let output = generated(folder.path());
    let rusthdl = posicast()
        .arg("verify")
        .arg(&output)
        .args(["--simulator", "rusthdl"])
        .output()
        .unwrap();
    assert_eq!((rusthdl.status.code(), rusthdl.stdout.is_empty()), (Some(2), true));
    let top = output.join("rtl/xy_stage.v");
    break_file(&top, "endmodule", "// mine\nendmodule");
    let again = posicast()
        .arg("generate")
        .arg(example("xy-stage.toml"))
        .arg("-o")
        .arg(&output)
        .output()
        .unwrap();
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("xy_stage.v"));
    assert!(std::fs::read_to_string(&top).unwrap().contains("// mine"));
}

#[test]
fn cli_verilog_that_verilator_refuses_is_bad_input() {
    let folder = tempfile::tempdir().unwrap();
    let output = generated(folder.path());
    break_file(&output.join("rtl/xy_stage.v"), "endmodule", "endmodul");
    let verify = posicast()
        .arg("verify")
        .arg(&output)
        .args(["--cycles", "100"])
        .output()
        .unwrap();
    assert_eq!((verify.status.code(), verify.stdout.is_empty()), (Some(2), true));
    assert!(String::from_utf8_lossy(&verify.stderr).contains("verilator"));
}
