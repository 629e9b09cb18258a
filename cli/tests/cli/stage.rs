//! Machines whose loops are complete: the stage that `generate` and `verify` make of them, and the closed loop of `run`.

#![cfg(test)] // lets clippy see that this is test code

use crate::support::{example, json, posicast, scratch};

/// The XY stage with some text replaced, once.
fn changed(from: &str, to: &str) -> String {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn cli_generate_writes_the_stage_and_verify_of_the_folder_compares_it() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    let mut generate = posicast();
    generate.arg("generate").arg(example("xy-stage.toml"));
    generate.arg("-o").arg(&output).assert().success();
    for module in ["stage", "stage_registers", "stage_x", "stage_y_shaper", "stage_axis"] {
        assert!(output.join(format!("rtl/xy_stage_{module}.v")).is_file(), "{module}");
    }
    let mut verify = posicast();
    verify.arg("verify").arg(&output);
    verify.args([
        "--block",
        "stage",
        "--cycles",
        "3000",
        "--simulator",
        "icarus",
        "--json",
    ]);
    let document = json(&verify.assert().success().get_output().stdout);
    assert_eq!(document["blocks"].as_array().unwrap().len(), 1);
    assert_eq!(document["blocks"][0]["instance"], "x, y, Avalon");
}

#[test]
fn cli_generate_of_a_stage_that_cannot_be_names_line_and_key_and_writes_nothing() {
    let cases = [
        ("name = \"x\"", "name = \"divider\"", "machine.toml:20: axis.name: "),
        ("name = \"y\"", "name = \"avs\"", ": axis.name: "),
        (
            "sample_hz = 10_000",
            "sample_hz = 500_000",
            "machine.toml:13: clock.sample_hz: ",
        ),
    ];
    for (from, to, place) in cases {
        // A PWM for the fast sample too; it changes nothing for the others.
        let text = changed(from, to).replace("frequency_hz = 20_000", "frequency_hz = 500_000");
        let text = text.replace("500e-9", "40e-9").replace("1e-6", "40e-9");
        let (folder, file) = scratch(&text);
        let output = folder.path().join("out");
        let mut generate = posicast();
        let refused = generate
            .arg("generate")
            .arg(&file)
            .arg("-o")
            .arg(&output)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(
            (refused.status.code(), refused.stdout.is_empty()),
            (Some(2), true),
            "{said}"
        );
        assert!(said.contains(place), "{said}");
        assert!(!output.exists());
    }
}

#[test]
fn cli_a_loop_that_is_not_complete_or_has_short_words_gives_no_stage() {
    let controller = "[axis.controller]                     # turns the position's error into the velocity that is asked for\n\
                      kind = \"pd\"";
    let cases = [
        (changed(controller, "# "), ""),
        (
            changed("[[axis]]", "[fixed_point]\ncommand_bits = 16\n[[axis]]"),
            "no stage is built",
        ),
    ];
    for (text, warning) in cases {
        let (folder, file) = scratch(&text);
        let output = folder.path().join("out");
        let mut generate = posicast();
        let run = generate
            .arg("generate")
            .arg(&file)
            .arg("-o")
            .arg(&output)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&run.stderr).into_owned();
        assert!(run.status.success() && said.contains(warning), "{said}");
        assert!(!output.join("rtl/xy_stage_stage.v").exists());
    }
}
