//! The machines of `examples/` are sound, and the pages about them show what posicast prints and draws.

use super::followed::{Commands, docs, follow};
use super::support::{example, posicast};
use std::path::{Path, PathBuf};

/// The machine files of the examples.
fn machines() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(example(""))
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries.filter(|path| is(path, "toml")).collect();
    files.sort();
    assert!(files.len() >= 14, "{} machine files", files.len());
    files
}

/// The pages about examples.
fn pages() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(docs("examples"))
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let files: Vec<PathBuf> = entries.filter(|path| is(path, "md")).collect();
    assert_eq!(files.len(), 7, "{files:?}");
    files
}

fn is(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found == extension)
}

/// Follows the pages, each in a folder with a copy of the examples, and compares the pictures that their commands draw. Without the
/// slow commands, those of some pages are not drawn.
fn follow_pages(commands: Commands) {
    let mut drawn = 0;
    for page in pages() {
        let folder = tempfile::tempdir().unwrap();
        let copy = folder.path().join("examples");
        std::fs::create_dir(&copy).unwrap();
        for entry in std::fs::read_dir(example("")).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() {
                std::fs::copy(&path, copy.join(path.file_name().unwrap())).unwrap();
            }
        }
        follow(&page, folder.path(), "", commands);
        let picture = page.with_extension("svg");
        let own = folder.path().join(picture.file_name().unwrap());
        if commands == Commands::All || own.exists() {
            let same = std::fs::read(&own).unwrap() == std::fs::read(&picture).unwrap();
            assert!(same, "the commands of {} draw another picture", page.display());
            drawn += 1;
        }
    }
    assert!(drawn >= 2, "{drawn} pictures");
}

#[test]
fn cli_the_pages_of_the_examples_show_their_designs() {
    follow_pages(Commands::Fast);
}

#[test]
fn long_the_pages_of_the_examples_show_the_results_of_a_run() {
    follow_pages(Commands::All);
}

#[test]
fn cli_every_example_is_designed_and_fits() {
    for machine in machines() {
        let output = posicast().arg("design").arg(&machine).assert().success();
        let printed = String::from_utf8(output.get_output().stdout.clone()).unwrap();
        assert!(!printed.contains("does not fit"), "{}: {printed}", machine.display());
    }
}

/// The machines that have a page are run by the test of the pages.
#[test]
fn long_every_other_example_passes_its_run() {
    let text: String = pages()
        .iter()
        .map(|page| std::fs::read_to_string(page).unwrap())
        .collect();
    for machine in machines() {
        let name = machine.file_name().unwrap().to_str().unwrap();
        if text.contains(&format!("posicast run examples/{name}")) {
            continue;
        }
        let folder = tempfile::tempdir().unwrap();
        let run = posicast()
            .args(["run", "--quiet"])
            .arg(&machine)
            .arg("-o")
            .arg(folder.path().join("run"))
            .assert()
            .success();
        let printed = String::from_utf8(run.get_output().stdout.clone()).unwrap();
        assert!(printed.contains("PASS"), "{name}: {printed}");
    }
}
