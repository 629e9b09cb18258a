//! `verify`: the conditions for the verdict "match", and cases in which every simulated value is equal without a
//! match.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, generate, json, one_axis, posicast, scratch};
use std::path::{Path, PathBuf};
use std::process::Output;

/// Returns a folder of a machine whose delay line is longer than 20,000 clocks of slow strobes fill: EI at 17 Hz,
/// with the delays of two modes.
fn long_delays(folder: &Path) -> PathBuf {
    let machine = folder.join("machine.toml");
    let text = one_axis("kind = \"zvd\"", "frequency_hz = 17.4\ndamping = 0.05");
    std::fs::write(&machine, text).unwrap();
    let output = folder.join("out");
    generate(&machine, &output);
    output
}

fn verify(source: &Path, arguments: &[&str]) -> Output {
    let mut verify = posicast();
    verify
        .arg("verify")
        .arg(source)
        .args(["--simulator", "icarus", "--json"])
        .args(arguments);
    verify.output().unwrap()
}

fn said(output: &Output) -> String {
    format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    )
}

/// Puts other delays into the ROM of an axis: the same coefficients, one after fewer samples.
fn shorten_a_delay(output: &Path) -> String {
    let rom = output.join("rtl/one_x_machine_taps.v");
    let text = std::fs::read_to_string(&rom).unwrap();
    let line = text.lines().filter(|line| line.contains("words[")).nth(3).unwrap();
    let (before, rest) = line.split_once("'h").unwrap();
    let (digits, after) = rest.split_once(';').unwrap();
    let word = u64::from_str_radix(digits, 16).unwrap() - (43 << 18);
    let changed = format!("{before}'h{word:0width$x};{after}", width = digits.len());
    std::fs::write(&rom, text.replace(line, &changed)).unwrap();
    text
}

#[test]
fn cli_verify_of_a_folder_finds_a_changed_delay_in_the_simulation_and_in_the_rom() {
    let folder = tempfile::tempdir().unwrap();
    let output = long_delays(folder.path());
    let untouched = verify(&output, &[]);
    assert_eq!(untouched.status.code(), Some(0), "{}", said(&untouched));
    let document = json(&untouched.stdout);
    assert_eq!(document["not_exercised"], serde_json::json!([]));
    assert_eq!(document["folder"]["differences"], serde_json::json!([]));

    shorten_a_delay(&output);
    let changed = verify(&output, &[]);
    assert_eq!(changed.status.code(), Some(1), "{}", said(&changed));
    let document = json(&changed.stdout);
    assert_eq!(document["result"], "mismatch");
    assert!(document["blocks"][0]["mismatches"].as_u64().unwrap() > 0, "{document}");
    let difference = &document["folder"]["differences"][0];
    assert_eq!(difference["file"], "rtl/one_x_machine_taps.v");
    assert_eq!(difference["kind"], "table");
    let what = difference["what"].as_str().unwrap();
    assert!(what.starts_with("tap 3 has coefficient "), "{what}");
}

#[test]
fn cli_verify_of_a_folder_whose_machine_file_was_edited_is_no_match() {
    let folder = tempfile::tempdir().unwrap();
    let output = long_delays(folder.path());
    let machine = output.join("machine.toml");
    let text = std::fs::read_to_string(&machine).unwrap();
    std::fs::write(&machine, text.replace("17.4", "17.5")).unwrap();
    let edited = verify(&output, &[]);
    assert_eq!(edited.status.code(), Some(1), "{}", said(&edited));
    let document = json(&edited.stdout);
    let kinds: Vec<&str> = document["folder"]["differences"]
        .as_array()
        .unwrap()
        .iter()
        .map(|difference| difference["kind"].as_str().unwrap())
        .collect();
    assert!(kinds.contains(&"machine") && kinds.contains(&"table"), "{document}");
    // A comment is an edit too: the hash is not the one for which the Verilog was generated.
    std::fs::write(&machine, format!("{text}# mine\n")).unwrap();
    let commented = verify(&output, &[]);
    assert_eq!(commented.status.code(), Some(1), "{}", said(&commented));
    let document = json(&commented.stdout);
    assert_eq!(
        (&document["result"], &document["blocks"][0]["mismatches"]),
        (&"mismatch".into(), &0.into())
    );
}

#[test]
fn cli_verify_names_verilog_that_was_edited_and_the_simulation_judges_it_only_if_asked_to() {
    let folder = tempfile::tempdir().unwrap();
    let output = long_delays(folder.path());
    let top = output.join("rtl/one.v");
    let text = std::fs::read_to_string(&top).unwrap();
    std::fs::write(&top, text.replacen("endmodule", "    wire mine = 1'b0;\nendmodule", 1)).unwrap();
    let edited = verify(&output, &[]);
    assert_eq!(edited.status.code(), Some(1), "{}", said(&edited));
    assert!(
        said(&edited).contains("Verilog of the folder was edited"),
        "{}",
        said(&edited)
    );
    let document = json(&edited.stdout);
    assert_eq!(document["result"], "no_verdict");
    assert!(
        document["reason"].as_str().unwrap().contains("was edited"),
        "{document}"
    );
    let accepted = verify(&output, &["--edited"]);
    assert_eq!(accepted.status.code(), Some(0), "{}", said(&accepted));
    let document = json(&accepted.stdout);
    assert_eq!(
        (&document["result"], &document["reason"]),
        (&"match".into(), &serde_json::Value::Null)
    );
    let difference = &document["folder"]["differences"][0];
    assert_eq!(
        (&difference["file"], &difference["kind"]),
        (&"rtl/one.v".into(), &"verilog".into())
    );
    // Both simulators were asked.
    let rows = document["blocks"].as_array().unwrap();
    let instances: Vec<&str> = rows.iter().map(|row| row["instance"].as_str().unwrap()).collect();
    assert_eq!(instances, ["x", "x, in verilator"]);

    // Icarus has four values and Verilator two, so that they read the same text differently.
    let broken = text.replace("(x_refused)", "(mine)").replacen(
        "    one_x_shaper u_x (",
        "    wire mine;\n    reg never;\n    assign x_refused = mine & (never === 1'bx);\n    one_x_shaper u_x (",
        1,
    );
    assert_ne!(broken, text);
    std::fs::write(&top, broken).unwrap();
    let told = verify(&output, &["--edited"]);
    assert_eq!(told.status.code(), Some(1), "{}", said(&told));
    let document = json(&told.stdout);
    let rows = document["blocks"].as_array().unwrap();
    let wrong: Vec<bool> = rows.iter().map(|row| row["mismatches"] != 0).collect();
    assert_eq!(
        (&document["result"], wrong),
        (&"mismatch".into(), vec![false, true]),
        "{document}"
    );
}

/// Verilog that one tool reads differently from another is no match, whatever a simulator says of it.
#[test]
fn cli_verify_refuses_verilog_that_depends_on_the_tool() {
    let folder = tempfile::tempdir().unwrap();
    let output = long_delays(folder.path());
    let top = output.join("rtl/one.v");
    let text = std::fs::read_to_string(&top).unwrap();
    for (added, what) in [
        ("`ifdef VERILATOR\n`endif\nendmodule", "`ifdef VERILATOR"),
        (
            "// synthesis translate_off\n// synthesis translate_on\nendmodule",
            "the comment `// synthesis translate_off`",
        ),
        (
            "initial if ($test$plusargs(\"mine\")) $finish;\nendmodule",
            "$test$plusargs",
        ),
    ] {
        std::fs::write(&top, text.replacen("endmodule", added, 1)).unwrap();
        let told = verify(&output, &["--edited"]);
        assert_eq!(told.status.code(), Some(1), "{what}: {}", said(&told));
        let document = json(&told.stdout);
        assert_eq!(document["result"], "no_verdict", "{what}: {document}");
        assert!(
            document["reason"].as_str().unwrap().contains("depends on the tool"),
            "{document}"
        );
        let difference = &document["folder"]["differences"][0];
        assert_eq!(
            (&difference["file"], &difference["kind"]),
            (&"rtl/one.v".into(), &"tool".into())
        );
        assert!(difference["line"].is_u64());
        let said = difference["what"].as_str().unwrap();
        assert!(said.starts_with(what), "{said}");
    }
}

#[test]
fn cli_verify_names_what_was_not_exercised_and_is_no_match() {
    let (_folder, machine) = scratch(&one_axis("kind = \"zvd\"", "frequency_hz = 17.4\ndamping = 0.05"));
    let few = verify(&machine, &["--cycles", "1000"]);
    assert_eq!(few.status.code(), Some(1), "{}", said(&few));
    let document = json(&few.stdout);
    assert_eq!(
        (&document["result"], &document["blocks"][0]["mismatches"]),
        (&"no_verdict".into(), &0.into())
    );
    assert!(
        document["reason"]
            .as_str()
            .unwrap()
            .contains("too little was exercised"),
        "{document}"
    );
    let missing = document["not_exercised"].to_string();
    assert!(missing.contains("shaper x: tap 4 of the machine's table"), "{missing}");
    assert!(
        missing.contains("a result over bank 2") && missing.contains("`refused` = 1"),
        "{missing}"
    );
    // The remedy names a number of clocks, and it is enough.
    let remedy = said(&few);
    let (_, cycles) = remedy.split_once("--cycles ").unwrap_or_else(|| panic!("{remedy}"));
    let cycles: String = cycles.chars().take_while(char::is_ascii_digit).collect();
    let enough = verify(&machine, &["--cycles", &cycles]);
    assert_eq!(enough.status.code(), Some(0), "{}", said(&enough));
}

/// The group of a machine with one axis has an output that no input can change.
#[test]
fn cli_verify_of_a_single_axis_has_a_verdict() {
    let single = verify(&example("ball-screw.toml"), &["--block", "group", "--cycles", "20000"]);
    assert_eq!(single.status.code(), Some(0), "{}", said(&single));
    assert_eq!(json(&single.stdout)["not_exercised"], serde_json::json!([]));
}

#[test]
fn cli_verify_of_a_folder_finds_a_fault_latch_that_needs_the_clock() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    generate(&example("xy-stage.toml"), &output);
    let latch = output.join("rtl/posicast_fault_latch.v");
    let text = std::fs::read_to_string(&latch).unwrap();
    let from = "always @(posedge clk or negedge trip_n)";
    assert!(text.contains(from), "{text}");
    std::fs::write(&latch, text.replace(from, "always @(posedge clk)")).unwrap();
    let broken = verify(&output, &["--block", "pwm", "--cycles", "500"]);
    assert_eq!(broken.status.code(), Some(1), "{}", said(&broken));
    let document = json(&broken.stdout);
    let rows = document["blocks"].as_array().unwrap();
    let wrong: Vec<&str> = rows
        .iter()
        .filter(|row| row["mismatches"] != 0)
        .map(|row| row["instance"].as_str().unwrap())
        .collect();
    // One module serves all of them.
    let rows = [
        "x, in the pwm component",
        "y, in the pwm component",
        "x, in the stage",
        "y, in the stage",
    ];
    assert_eq!(wrong, rows.map(|row| format!("{row}, pulses between clocks")));
}

#[test]
fn cli_a_run_of_too_few_clocks_has_no_verdict_and_blames_nobody() {
    let (folder, file) = scratch(&one_axis("kind = \"zv\"", "frequency_hz = 50.0\ndamping = 0.1"));
    let mut run = posicast();
    run.arg("run").arg(file).arg("-o").arg(folder.path().join("out"));
    let run = run
        .args(["--simulator", "rusthdl", "--cycles", "2000"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    assert_eq!(run.status.code(), Some(1), "{said}");
    assert!(
        said.contains("NO VERDICT: nothing differed") && said.contains("leave out `--cycles`"),
        "{said}"
    );
    assert!(!said.contains("changed by hand") && !said.contains("FAIL:"), "{said}");
}
