//! `posicast new`: what it writes, and what it never replaces.

use crate::cli::support::posicast;
use std::path::Path;
use std::process::Output;

const KINDS: [&str; 4] = ["--printer", "--gantry", "--joint", "--crane"];

fn new(folder: &Path, words: &[&str]) -> Output {
    posicast().current_dir(folder).arg("new").args(words).output().unwrap()
}

fn status(folder: &Path, words: &[&str]) -> (Option<i32>, String) {
    let output = new(folder, words);
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn every_kind_designs_and_generates_without_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    for kind in KINDS {
        let file = format!("my{}.toml", kind.replace("--", "-"));
        let output = new(folder.path(), &[kind, &file]);
        assert_eq!(output.status.code(), Some(0));
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains(&format!("`posicast design {file}`")), "{said}");
        let name = file.trim_end_matches(".toml").replace('-', "_");
        for words in [["design", &file], ["generate", &file]] {
            let output = posicast().current_dir(folder.path()).args(words).output().unwrap();
            let said = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(0), "{kind}: {said}");
            assert!(said.is_empty(), "{kind}: {said}");
        }
        assert!(folder.path().join(&name).join(format!("rtl/{name}.v")).is_file());
    }
}

#[test]
fn the_line_to_a_host_is_there_to_be_switched_on() {
    let folder = tempfile::tempdir().unwrap();
    for kind in ["--gantry", "--joint"] {
        let name = &kind[2..];
        let file = format!("{name}.toml");
        status(folder.path(), &[kind, &file]);
        let mut text = read(folder.path(), &file);
        for key in ["[link]", "line =", "baud ="] {
            text = text.replacen(&format!("# {key}"), key, 1);
        }
        std::fs::write(folder.path().join(&file), text).unwrap();
        let output = posicast()
            .current_dir(folder.path())
            .args(["generate", &file])
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{kind}: {said}");
        let top = folder.path().join(name).join(format!("rtl/{name}_link.v"));
        assert!(top.is_file(), "{}", top.display());
    }
}

#[test]
fn without_a_terminal_and_a_kind_it_writes_a_gantry() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(status(folder.path(), &["stage.toml"]).0, Some(0));
    assert_eq!(status(folder.path(), &["--gantry", "other.toml"]).0, Some(0));
    let without_name = |file: &str| {
        let text = read(folder.path(), file);
        let lines = text
            .lines()
            .filter(|line| !line.starts_with("name") && !line.contains("sha256"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(without_name("stage.toml"), without_name("other.toml"));
}

#[test]
fn the_first_line_names_the_schema_for_editors() {
    let folder = tempfile::tempdir().unwrap();
    status(folder.path(), &["--crane", "crane.toml"]);
    let text = read(folder.path(), "crane.toml");
    assert!(text.starts_with("#:schema ./posicast-machine.schema.json\n# written by posicast "));
}

#[test]
fn a_file_that_exists_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert_eq!(status(folder, &["--crane", "m.toml"]).0, Some(0));
    let ours = read(folder, "m.toml");
    let (code, said) = status(folder, &["--joint", "m.toml"]);
    assert_eq!(code, Some(2));
    assert!(
        said.contains("m.toml: this file exists") && said.contains("--force"),
        "{said}"
    );
    assert_eq!(read(folder, "m.toml"), ours);
    // This file is ours and unchanged.
    assert_eq!(status(folder, &["--joint", "--force", "m.toml"]).0, Some(0));
    assert!(read(folder, "m.toml").contains("elbow"));
    // This file has been edited by its user.
    let edited = read(folder, "m.toml").replace("elbow", "wrist");
    std::fs::write(folder.join("m.toml"), &edited).unwrap();
    let (code, said) = status(folder, &["--crane", "--force", "m.toml"]);
    assert_eq!(code, Some(2));
    assert!(
        said.contains("m.toml: posicast did not write this file, or it was changed since"),
        "{said}"
    );
    assert!(
        said.contains("help: name another file, or move this one away"),
        "{said}"
    );
    assert_eq!(read(folder, "m.toml"), edited);
}

#[test]
fn a_name_that_cannot_be_written_is_bad_input() {
    let folder = tempfile::tempdir().unwrap();
    let (code, said) = status(folder.path(), &["."]);
    assert_eq!((code, said.contains("that is a folder")), (Some(2), true), "{said}");
    let (code, said) = status(folder.path(), &["no/where.toml"]);
    assert_eq!(
        (code, said.contains("the folder no does not exist")),
        (Some(2), true),
        "{said}"
    );
    assert_eq!(status(folder.path(), &["--crane", "--joint", "m.toml"]).0, Some(2));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn standard_output_takes_the_file_alone() {
    let folder = tempfile::tempdir().unwrap();
    let output = new(folder.path(), &["--printer", "-"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.starts_with("#:schema") && text.trim_end().ends_with("watchdog_s = 0.5"),
        "{text}"
    );
    assert!(String::from_utf8(output.stderr).unwrap().contains("next: "));
}

#[test]
fn a_name_with_a_space_is_quoted_and_the_schema_is_mentioned() {
    let folder = tempfile::tempdir().unwrap();
    let output = new(folder.path(), &["--joint", "my joint.toml"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.starts_with("my joint.toml written"), "{said}");
    for words in [
        "`posicast design 'my joint.toml'`",
        "`posicast run 'my joint.toml'`",
        "`posicast schema -o posicast-machine.schema.json`",
    ] {
        assert!(said.contains(words), "{said}");
    }
    std::fs::create_dir(folder.path().join("a b")).unwrap();
    let output = new(folder.path(), &["--crane", "a b/crane.toml"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.contains("`posicast schema -o 'a b/posicast-machine.schema.json'`"),
        "{said}"
    );
    // The line may be given to a shell as it stands.
    let line = said.lines().last().unwrap().split('`').nth(1).unwrap().to_owned();
    let program = format!("{} \"$@\"", env!("CARGO_BIN_EXE_posicast"));
    let script = format!("posicast() {{ {program}; }}; {line}");
    let status = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path())
        .status();
    assert!(status.unwrap().success());
    assert!(folder.path().join("a b/posicast-machine.schema.json").is_file());
}
