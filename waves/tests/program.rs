//! The program: exit status, files, documents.

use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;

fn vcd(folder: &Path, name: &str, values: &[u8]) -> PathBuf {
    let mut text = "$timescale 1ns $end\n$scope module top $end\n$var wire 1 ! clk $end\n$var wire 4 \" y $end\n\
                    $var wire 1 # ok $end\n$upscope $end\n$enddefinitions $end\n"
        .to_owned();
    for (clock, value) in values.iter().enumerate() {
        text += &format!("#{}\n0!\nb{value:04b} \"\n1#\n#{}\n1!\n", 10 * clock, 10 * clock + 5);
    }
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn wavecmp(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wavecmp"));
    command
        .env_remove("GITHUB_STEP_SUMMARY")
        .args(arguments)
        .output()
        .unwrap()
}

struct Two {
    folder: tempfile::TempDir,
    a: String,
    b: String,
}

fn two() -> Two {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = [("a.vcd", [1, 2, 3, 4, 5]), ("b.vcd", [1, 2, 7, 4, 5])]
        .map(|(name, values)| vcd(folder.path(), name, &values).to_str().unwrap().to_owned());
    Two { folder, a, b }
}

impl Two {
    fn at(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.at(name)).unwrap()
    }
}

#[test]
fn cli_the_exit_status_is_the_verdict() {
    let two = two();
    let code = |arguments: &[&str]| wavecmp(arguments).status.code();
    assert_eq!(code(&[&two.a, &two.a]), Some(0));
    assert_eq!(code(&[&two.a, &two.b]), Some(1));
    assert_eq!(code(&[&two.a, &two.b, "--only", "ok", "--raw"]), Some(0));
    assert_eq!(code(&[&two.a, &two.b, "--only", "nothing"]), Some(2));
    assert_eq!(code(&[&two.a, &two.at("absent")]), Some(2));
    assert_eq!(code(&["--nonsense"]), Some(2));
    assert_eq!(code(&[&two.a]), Some(2));
}

#[test]
fn cli_every_document_fits_the_published_schema() {
    let two = two();
    let schema = wavecmp(&["--schema"]);
    let schema: Value = serde_json::from_slice(&schema.stdout).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let other = vcd(two.folder.path(), "other.vcd", &[1, 2]);
    let text = std::fs::read_to_string(&other).unwrap();
    let other = other.to_str().unwrap();
    std::fs::write(other, text.replace(" y ", " z ").trim_end()).unwrap();
    for arguments in [
        &[&*two.a, &*two.a][..],
        &[&two.a, &two.b],
        &[&two.a, &two.b, "--first", "--explain"],
        &[&two.a, &two.b, "--tolerance", "y=1", "--view", "y=signed"],
        &[&two.a, other, "--explain", "--require-all", "--allow-truncated"],
        &[&two.a, other, "--only", "y"],
    ] {
        let output = wavecmp(&[arguments, &["--json"]].concat());
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        let errors: Vec<String> = validator
            .iter_errors(&document)
            .map(|error| error.to_string())
            .collect();
        assert!(errors.is_empty(), "{arguments:?}: {errors:?}\n{document:#}");
    }
    assert!(!validator.is_valid(&serde_json::json!({"result": "same"})));
}

#[test]
fn cli_standard_input_is_a_file() {
    let two = two();
    let mut command = Command::new(env!("CARGO_BIN_EXE_wavecmp"));
    let text = two.read("b.vcd");
    command.args([&two.a, "-"]).write_stdin(text.clone()).assert().code(1);
    let mut command = Command::new(env!("CARGO_BIN_EXE_wavecmp"));
    command.args(["-", &two.b]).write_stdin(text).assert().code(0);
    let mut command = Command::new(env!("CARGO_BIN_EXE_wavecmp"));
    command
        .args([&two.a, "-", "--html", &two.at("x.html")])
        .assert()
        .code(2);
}

#[test]
fn cli_first_stops_and_shows_the_state_of_all_signals() {
    let two = two();
    let output = wavecmp(&[&two.a, &two.b, "--first", "--json"]);
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(document["samples"], 3);
    let state = document["state"].as_array().unwrap();
    assert_eq!(state.len(), 3);
    let y = &state[1];
    assert_eq!(
        (&y["before"], &y["a"], &y["b"]),
        (&"0010".into(), &"0011".into(), &"0111".into())
    );
    let ok = &state[2];
    assert_eq!(
        (&ok["before"], &ok["a"], &ok["b"]),
        (&"1".into(), &"1".into(), &"1".into())
    );
    let text = String::from_utf8(wavecmp(&[&two.a, &two.b, "--first"]).stdout).unwrap();
    assert!(
        text.contains("stopped at the first difference") && text.contains("top.y  0x2, 0x3 | 0x7"),
        "{text}"
    );
}

#[test]
fn cli_explain_says_how_signals_met_and_why_others_did_not() {
    let two = two();
    let text = two
        .read("b.vcd")
        .replace("module top", "module other")
        .replace(" ok ", " fine ");
    std::fs::write(
        two.at("c.vcd"),
        text.replace("$upscope $end\n", "$var wire 1 $ clk2 $end\n$upscope $end\n"),
    )
    .unwrap();
    let output = wavecmp(&[&two.a, &two.at("c.vcd"), "--explain"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("  top.y = other.y, by the name below the scopes that all signals share\n"),
        "{text}"
    );
    assert!(
        text.contains("  top.ok of the first file: the second file has no signal of that name in any scope\n"),
        "{text}"
    );
    assert!(text.contains("other.clk2 of the second file"), "{text}");
}

#[test]
fn cli_github_annotates_and_writes_the_summary() {
    let two = two();
    let summary = two.at("summary.md");
    std::fs::write(&summary, "before\n").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_wavecmp"));
    let output = command
        .env("GITHUB_STEP_SUMMARY", &summary)
        .args([&*two.a, &two.b, "--github", "--json"])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("::error title=top.y differs::first at 25 ns: 0x3 | 0x7, 1 sample\n"),
        "{said}"
    );
    serde_json::from_slice::<Value>(&output.stdout).unwrap();
    let text = two.read("summary.md");
    assert!(text.starts_with("before\n### ❌ different: "), "{text}");
    assert!(text.contains("| `top.y` | 25 ns | `0x3` | `0x7` | 1 |\n"), "{text}");
}

#[test]
fn cli_files_are_written_and_only_ours_are_replaced() {
    let two = two();
    let (html, merged, junit) = (two.at("d.html"), two.at("m.vcd"), two.at("j.xml"));
    let arguments = [&*two.a, &two.b, "--html", &html, "--merged", &merged, "--junit", &junit];
    for _ in 0..2 {
        let output = wavecmp(&arguments);
        assert_eq!(
            output.status.code(),
            Some(1),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    let page = two.read("d.html");
    assert!(
        page.starts_with("<!DOCTYPE html>") && page.contains("<svg ") && page.contains("top.y"),
        "{page}"
    );
    assert!(
        !page.contains("http://") || !page.contains("src="),
        "it needs nothing else"
    );
    let text = two.read("m.vcd");
    for name in [" y ", " ok ", " top_y "] {
        assert!(text.contains(name), "{text}");
    }
    assert!(two.read("m.gtkw").contains("difference.top_y"));
    assert!(two.read("j.xml").contains("failures=\"1\""));
    // Theirs, an input, twice, a folder.
    std::fs::write(&html, "mine").unwrap();
    for wrong in [
        &["--html", &*html][..],
        &["--junit", &two.a],
        &["--junit", &junit, "--html", &junit],
        &["--junit", two.folder.path().to_str().unwrap()],
        &["--junit", &two.at("no/j.xml")],
        &["--merged", &two.at("m.fst")],
    ] {
        let output = wavecmp(&[&[&*two.a, &*two.b], wrong].concat());
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
    }
    assert_eq!(two.read("d.html"), "mine");
    assert_eq!(
        wavecmp(&[&two.a, &two.b, "--html", &html, "--force"]).status.code(),
        Some(1)
    );
    assert!(two.read("d.html").starts_with("<!DOCTYPE"));
    let left: Vec<_> = std::fs::read_dir(two.folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert!(
        left.iter().all(|name| !name.to_string_lossy().starts_with('.')),
        "{left:?}"
    );
}

#[test]
fn cli_manual_and_completions_name_the_options() {
    let man = String::from_utf8(wavecmp(&["--man"]).stdout).unwrap();
    assert!(
        man.contains(".TH wavecmp 1") && man.contains("allow\\-truncated"),
        "{man}"
    );
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = String::from_utf8(wavecmp(&["--completions", shell]).stdout).unwrap();
        assert!(script.contains("allow-truncated"), "{shell}");
    }
    assert_eq!(wavecmp(&["--completions", "cobol"]).status.code(), Some(2));
}
