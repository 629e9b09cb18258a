//! Nothing that a user owns is replaced, appended to or made useless.

use super::{mode, printer};
use crate::cli::support::{MODEL, posicast, rust_sources, scratch};
use std::fs::{self, OpenOptions};
use std::path::{Path, PathBuf};

/// The end of a printer's configuration, as SAVE_CONFIG writes it.
const CONFIG: &str = "[printer]\nkinematics: corexy\nmax_velocity: 300\n\n\
    #*# <---------------------- SAVE_CONFIG ---------------------->\n#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.\n\
    #*#\n#*# [extruder]\n#*# pid_kp = 22.2\n";

fn mzv() -> (tempfile::TempDir, PathBuf) {
    scratch(&printer(&[("x", "kind = \"mzv\"", &mode(52.4, 0.06))]))
}

/// Runs an export; its exit status and what it says.
fn run(machine: &Path, words: &[&str]) -> (i32, String) {
    let output = posicast().arg("export").arg(machine).args(words).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).replace("\n  │ ", " ");
    (output.status.code().unwrap(), said)
}

#[test]
fn cli_a_users_configuration_stays_as_it_is() {
    let (folder, machine) = mzv();
    for (format, name) in [
        ("klipper", "printer.cfg"),
        ("kalico", "printer.cfg"),
        ("klipper", "other.cfg"),
        ("reprapfirmware", "config.g"),
        ("c", "main.c"),
        ("csv", "data.csv"),
    ] {
        let file = folder.path().join(name);
        for option in ["-o", "--output", "--include"] {
            fs::write(&file, CONFIG).unwrap();
            let (status, said) = run(&machine, &["--to", format, option, file.to_str().unwrap()]);
            assert_eq!(status, 2, "{format} {name}: {said}");
            assert_eq!(fs::read_to_string(&file).unwrap(), CONFIG);
            assert!(
                !format.starts_with('k') || said.contains("[include posicast.cfg]"),
                "{said}"
            );
        }
        fs::remove_file(&file).unwrap();
    }
    // Nor is one begun under that name, nor a machine file replaced.
    let (status, _) = run(
        &machine,
        &[
            "--to",
            "klipper",
            "-o",
            folder.path().join("printer.cfg").to_str().unwrap(),
        ],
    );
    assert_eq!((status, folder.path().join("printer.cfg").exists()), (2, false));
    let before = fs::read_to_string(&machine).unwrap();
    let (status, _) = run(&machine, &["--to", "klipper", "-o", machine.to_str().unwrap()]);
    assert_eq!((status, fs::read_to_string(&machine).unwrap()), (2, before));
}

#[cfg(target_os = "linux")]
#[test]
fn cli_nothing_is_appended_behind_klippers_own_block() {
    let (folder, machine) = mzv();
    let file = folder.path().join("printer.cfg");
    fs::write(&file, CONFIG).unwrap();
    let append = || OpenOptions::new().append(true).open(&file).unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_posicast"));
    command.arg("export").arg(&machine).args(["--to", "klipper"]);
    let output = command.stdout(append()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("SAVE_CONFIG"));
    assert_eq!(fs::read_to_string(&file).unwrap(), CONFIG);
    // A file without such a block may grow.
    fs::write(&file, "[printer]\nkinematics: corexy\n").unwrap();
    let output = command.stdout(append()).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(fs::read_to_string(&file).unwrap().contains("[input_shaper]"));
}

#[test]
fn cli_a_file_of_its_own_is_written_again_until_somebody_edits_it() {
    let (folder, machine) = mzv();
    for (format, name, step) in [
        ("klipper", "posicast.cfg", "[include posicast.cfg]"),
        ("kalico", "shaper.cfg", "[include shaper.cfg]"),
        ("reprapfirmware", "shaper.g", "M98 P\"shaper.g\""),
        ("marlin-ft", "shaper.gcode", "M500"),
        ("c", "shapers.h", "written"),
        ("matlab", "shapers.m", "written"),
    ] {
        let file = folder.path().join(name);
        let words = ["--to", format, "--include", file.to_str().unwrap()];
        for _ in 0..2 {
            let (status, said) = run(&machine, &words);
            assert_eq!(status, 0, "{format}: {said}");
            assert!(said.contains(step), "{format}: {said}");
        }
        let text = fs::read_to_string(&file).unwrap();
        fs::write(&file, text + "\n").unwrap();
        assert_eq!(run(&machine, &words).0, 2, "{format}");
    }
    // The seal is a comment of the format: the standard output is the rest.
    let file = folder.path().join("again.cfg");
    assert_eq!(run(&machine, &["--to", "klipper", "-o", file.to_str().unwrap()]).0, 0);
    let text = fs::read_to_string(&file).unwrap();
    let (seal, rest) = text.split_once('\n').unwrap();
    assert!(seal.starts_with("# written by posicast "), "{seal}");
    let output = posicast()
        .arg("export")
        .arg(&machine)
        .args(["--to", "klipper"])
        .output()
        .unwrap();
    assert_eq!(String::from_utf8(output.stdout).unwrap(), rest);
}

#[test]
fn no_command_of_ours_appends_to_a_configuration() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut pages = rust_sources(&[&MODEL[..], &["cli", "flow", "identify", "host", "synth"]].concat());
    for folder in ["", "docs", "docs/tutorial", "docs/examples", "scripts"] {
        let entries = fs::read_dir(root.join(folder))
            .unwrap()
            .map(|entry| entry.unwrap().path());
        pages.extend(entries.filter(|path| path.is_file()));
    }
    let mut with_an_export = 0;
    for page in pages {
        let text = String::from_utf8_lossy(&fs::read(&page).unwrap()).into_owned();
        with_an_export += usize::from(text.contains("posicast export"));
        assert!(
            !text.contains(">> printer.cfg") && !text.contains(">>printer.cfg"),
            "{}",
            page.display()
        );
        assert!(!text.contains("> printer.cfg"), "{}", page.display());
    }
    assert!(with_an_export >= 3);
}
