//! A file of tests that no `mod` declares would never run, and nobody would notice.

use std::fs;
use std::path::Path;

/// Returns the files under `folder` that neither the file `head` declares as a module nor another program of the `manifest`.
fn forgotten(folder: &Path, head: &Path, manifest: &str) -> Vec<String> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_program = |path: &Path| {
        let name = path.file_stem().unwrap().to_str().unwrap();
        path == head || manifest.contains(&format!("[[test]]\nname = \"{name}\""))
    };
    let (programs, others): (Vec<_>, Vec<_>) = files.partition(|path| is_program(path));
    let text: String = programs.iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let mut found = Vec::new();
    for path in others {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let inner = path.join("mod.rs");
        if path.extension().is_none_or(|end| end != "rs") && !inner.is_file() {
            continue;
        }
        if !text.lines().any(|line| line.ends_with(&format!("mod {name};"))) {
            found.push(path.display().to_string());
        }
        if inner.is_file() {
            found.extend(forgotten(&path, &inner, ""));
        }
    }
    found
}

#[test]
fn every_file_of_tests_is_named_in_the_suite_of_its_crate() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut suites = 0;
    for entry in fs::read_dir(workspace).unwrap() {
        let member = entry.unwrap().path();
        let tests = member.join("tests");
        let head = tests.join("main.rs");
        if !head.is_file() {
            continue;
        }
        suites += 1;
        let manifest = fs::read_to_string(member.join("Cargo.toml")).unwrap();
        let forgotten = forgotten(&tests, &head, &manifest);
        assert!(
            forgotten.is_empty(),
            "no `mod` in {} or below names {forgotten:?}",
            head.display()
        );
    }
    assert!(suites >= 6, "only {suites} of the six crates have a suite");
}
