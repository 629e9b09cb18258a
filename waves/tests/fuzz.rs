//! Damaged recordings of every producer: an error or a result, never a panic, and always the same result for the same
//! file.
//!
//! Every test run has a few hundred cases, or as many as `PROPTEST_CASES` says; `fuzz/` has the same for
//! `cargo fuzz`, without end.

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use wavecmp::diff::{self, DiffOptions, DiffVerdict};

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

/// Words with a meaning for a parser, inserted at wrong places.
const WORDS: [&[u8]; 12] = [
    b"$end ",
    b"$scope module x $end ",
    b"$upscope $end ",
    b"$var wire 99999999 ! y $end ",
    b"$enddefinitions $end\n",
    b"$dumpoff\n",
    b"$comment ",
    b"\n#18446744073709551615\n",
    b"\n#18446744073709551616\n",
    b"b",
    b"r1e999 !\n",
    b"\n",
];

fn damage() -> impl Strategy<Value = Vec<(prop::sample::Index, usize, Vec<u8>)>> {
    let bytes = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..6),
        prop::sample::select(WORDS.to_vec()).prop_map(<[u8]>::to_vec),
    ];
    prop::collection::vec((any::<prop::sample::Index>(), 0usize..20, bytes), 1..6)
}

fn damaged(mut content: Vec<u8>, damage: &[(prop::sample::Index, usize, Vec<u8>)]) -> Vec<u8> {
    for (at, length, bytes) in damage {
        let from = at.index(content.len() + 1);
        let to = (from + length).min(content.len());
        content.splice(from..to, bytes.iter().copied());
    }
    content
}

fn survives(content: &[u8], options: &DiffOptions) -> Result<(), TestCaseError> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), content).unwrap();
    if let Ok(result) = diff::compare(file.path(), file.path(), options, &mut |_| {}) {
        prop_assert_ne!(
            result.result,
            DiffVerdict::Different,
            "a file differs from itself: {}",
            result
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(200), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn prop_damaged_vcds_are_survived(
        which in any::<[prop::sample::Index; 2]>(),
        cut in any::<[prop::sample::Index; 2]>(),
        damage in damage(),
        raw: bool,
        spliced in prop::bool::weighted(0.3),
    ) {
        let recordings = recordings("vcd");
        let [mut content, other] = which.map(|which| recordings[which.index(recordings.len())].clone());
        if spliced {
            // The beginning of one file with the end of another.
            content.truncate(cut[0].index(content.len()));
            content.extend(&other[cut[1].index(other.len())..]);
        }
        let content = damaged(content, &damage);
        survives(&content, &DiffOptions { raw, glitch_fs: u128::from(raw) * 3_000_000, ..DiffOptions::default() })?;
    }
}

#[test]
fn unit_fsts_cut_anywhere_are_errors() {
    for content in recordings("fst") {
        for end in (0..content.len()).step_by(23) {
            let file = tempfile::NamedTempFile::new().unwrap();
            std::fs::write(file.path(), &content[..end]).unwrap();
            let result = diff::compare(file.path(), file.path(), &DiffOptions::default(), &mut |_| {});
            assert!(result.is_err(), "{end} of {}: {}", content.len(), result.unwrap());
        }
    }
}
