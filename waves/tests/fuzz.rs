//! Damaged recordings of every producer, as `wavecmp::damage` says: an error or a result, never a panic.
//!
//! Every test run has a few hundred cases, or as many as `PROPTEST_CASES` says. `posicast campaign waveforms` has as many as you like;
//! `fuzz/` has the same for `cargo fuzz`, without end.

use std::path::{Path, PathBuf};

use wavecmp::damage::trial;
use wavecmp::diff::{self, DiffOptions};

fn recordings(extension: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/waves");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == extension));
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// Returns this number of cases, or `PROPTEST_CASES`.
fn cases(ordinary: u32) -> u32 {
    let wanted = std::env::var("PROPTEST_CASES")
        .ok()
        .and_then(|cases| cases.parse().ok());
    wanted.unwrap_or(ordinary)
}

#[test]
fn prop_damaged_recordings_are_survived() {
    let folder = tempfile::tempdir().unwrap();
    for extension in ["vcd", "fst"] {
        let recordings = recordings(extension);
        for seed in 0..cases(200) {
            if let Err(problem) = trial(&recordings, seed.into(), folder.path()) {
                panic!("{extension}, seed {seed}: {problem}");
            }
        }
    }
}

#[test]
fn fsts_cut_anywhere_are_errors() {
    for content in recordings("fst") {
        for end in (0..content.len()).step_by(23) {
            let file = tempfile::NamedTempFile::new().unwrap();
            std::fs::write(file.path(), &content[..end]).unwrap();
            let result = diff::compare(file.path(), file.path(), &DiffOptions::default(), &mut |_| {});
            assert!(result.is_err(), "{end} of {}: {}", content.len(), result.unwrap());
        }
    }
}
