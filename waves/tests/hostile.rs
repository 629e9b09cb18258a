//! Damaged and hostile waveforms: an error with the place, never a panic, never much memory.

use std::io::{Read, Write};
use std::path::Path;

use proptest::prelude::*;
use wavecmp::WaveError;
use wavecmp::diff::{self, DiffOptions, DiffVerdict};

const GOOD: &str = "$date today $end\n$timescale 1 ns $end\n$scope module t $end\n$var wire 1 c clk $end\n\
    $var wire 8 y y [7:0] $end\n$var real 64 r r $end\n$upscope $end\n$enddefinitions $end\n\
    #0\n$dumpvars\n0c\nb1 y\nr1.5 r\n$end\n#5\n1c\nb10 y\n#10\n0c\n#15\n1c\n";

fn compare(path: &Path) -> Result<diff::Comparison, WaveError> {
    diff::compare(path, path, &DiffOptions::default(), &mut |_| {})
}

/// Returns the error of a file with this content.
fn error(content: &[u8]) -> String {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), content).unwrap();
    match compare(file.path()) {
        Ok(result) => panic!("{result}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_file_cut_in_the_middle_of_a_line_is_never_equal_to_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, part) = (folder.path().join("whole.vcd"), folder.path().join("part.vcd"));
    std::fs::write(&whole, GOOD).unwrap();
    for end in 0..GOOD.len() {
        let cut = &GOOD[..end];
        std::fs::write(&part, cut).unwrap();
        let result = diff::compare(&whole, &part, &DiffOptions::default(), &mut |_| {});
        let in_header = !cut.contains("$enddefinitions $end");
        let in_dump = cut.contains("$dumpvars") && !cut.contains("1.5 r\n");
        match result {
            Err(error) => assert!(!error.to_string().is_empty()),
            Ok(_) if in_header || in_dump => panic!("{end}: no error"),
            Ok(result) => assert_eq!(
                result.result == DiffVerdict::Equal,
                end + 1 == GOOD.len(),
                "{end}: {result}"
            ),
        }
    }
}

#[test]
fn the_last_line_needs_no_line_break_but_a_file_that_ends_early_without_one_is_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let whole = file("whole.vcd", GOOD);
    let compared = |other: std::path::PathBuf| diff::compare(&whole, &other, &DiffOptions::default(), &mut |_| {});
    assert_eq!(
        compared(file("same.vcd", GOOD.trim_end())).unwrap().result,
        DiffVerdict::Equal
    );
    let early = GOOD.find("#15").unwrap();
    let message = compared(file("early.vcd", GOOD[..early].trim_end()))
        .unwrap_err()
        .to_string();
    assert!(message.contains("cut off"), "{message}");
}

#[test]
fn damage_is_named_with_its_line() {
    let damaged = |from: &str, to: &str| error(GOOD.replacen(from, to, 1).as_bytes());
    for (from, to, line, what) in [
        ("#15", "#5", 20, "time goes back"),
        ("#5\n1c", "#5\n1d", 16, "never declared"),
        ("b10 y", "b12 y", 17, "invalid VCD logic value"),
        ("#5\n", "#5\n$var wire 1 q q $end\n", 16, "after $enddefinitions"),
        ("1 ns", "1 ks", 2, "timescale"),
        ("8 y y", "many y y", 5, "not a width"),
        ("$upscope", "x $upscope", 7, "before $enddefinitions"),
        ("#5\n", "!\n", 15, "unexpected character"),
    ] {
        let message = damaged(from, to);
        assert!(
            message.contains(what) && message.contains(&format!("line {line}:")),
            "{message}"
        );
    }
    assert!(error(b"\x7fELF\x00\xff\xfe not a waveform").contains("line 1"));
    assert!(error(b"").contains("byte 0"));
}

#[test]
fn control_characters_are_space_and_no_endless_word() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let content = GOOD.replacen("#5\n", "$comment \u{1} x\u{b} \0 $end\u{1}\n#5\n", 1);
    std::fs::write(file.path(), content).unwrap();
    assert_eq!(compare(file.path()).unwrap().result, DiffVerdict::Equal);
}

#[test]
fn files_that_would_exhaust_memory_are_refused() {
    let wide = GOOD.replace("wire 8 y y", "wire 4294967295 y y");
    assert!(error(wide.as_bytes()).contains("leave out memories"));

    let mut deep = "$scope module t $end\n".repeat(100_000);
    deep.push_str("$enddefinitions $end\n");
    assert!(error(deep.as_bytes()).contains("deep"));

    let mut many = "$scope module t $end\n".to_owned();
    (0..2_000).for_each(|n| many.push_str(&format!("$var wire 100000 a{n} a{n} $end\n")));
    assert!(error(many.as_bytes()).contains("leave out memories"));

    let endless = format!("$comment {}", "x".repeat(40 << 20));
    assert!(error(endless.as_bytes()).contains("longer than"));
    let endless = format!("$scope module {}", "x".repeat(40 << 20));
    assert!(error(endless.as_bytes()).contains("longer than"));
}

#[test]
fn a_packed_file_that_is_cut_anywhere_is_read_to_an_end() {
    let packed = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/packed");
    let folder = tempfile::tempdir().unwrap();
    for name in ["counter.vcd.gz", "counter.vcd.xz", "counter.vcd.zst"] {
        let whole = std::fs::read(packed.join(name)).unwrap();
        let path = folder.path().join(name);
        for end in (0..64).chain((64..whole.len()).step_by(5)) {
            std::fs::write(&path, &whole[..end]).unwrap();
            for allow_truncated in [false, true] {
                let options = DiffOptions {
                    allow_truncated,
                    ..DiffOptions::default()
                };
                // Before the last bytes, which are checksums, something is always missing.
                let result = diff::compare(&path, &path, &options, &mut |_| {});
                let complete = result.is_ok_and(|result| result.result == DiffVerdict::Equal);
                assert!(allow_truncated || !complete || end + 64 > whole.len(), "{name} {end}");
            }
        }
    }
}

/// An FST as a writer packs it as a whole.
fn packed_as_a_whole(plain: &[u8]) -> Vec<u8> {
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(plain).unwrap();
    let gzip = gzip.finish().unwrap();
    let length = (gzip.len() as u64 + 16).to_be_bytes();
    [&[254], &length[..], &(plain.len() as u64).to_be_bytes(), &gzip].concat()
}

#[test]
fn lengths_that_an_fst_cannot_have_are_refused_before_memory_is_reserved() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("killed.fst");
    let mut refused = 0;
    for name in ["waves/icarus.fst", "waves/ghdl.fst", "cut/ran.fst", "cut/killed.fst"] {
        let mut plain = std::fs::read(fixtures.join(name)).unwrap();
        if plain[0] == 254 {
            let mut unpacked = Vec::new();
            flate2::read::GzDecoder::new(&plain[17..])
                .read_to_end(&mut unpacked)
                .unwrap();
            plain = unpacked;
        }
        if name.contains("killed") {
            std::fs::copy(
                fixtures.join("cut/killed.fst.hier"),
                folder.path().join("killed.fst.hier"),
            )
            .unwrap();
        }
        let length = |at: usize| u64::from_be_bytes(plain[at + 1..at + 9].try_into().unwrap()) as usize;
        let mut at = 0;
        while at + 9 < plain.len() && length(at) >= 8 && at + 1 + length(at) <= plain.len() {
            let next = at + 1 + length(at);
            // Lengths are at the beginning of a block and at its end.
            for place in (at + 1..at + 60).chain(next.max(60) - 40..next).step_by(3) {
                if place + 6 > next {
                    continue;
                }
                let mut damaged = plain.clone();
                damaged[place..place + 6].copy_from_slice(&[0x01, 0x12, 0xa4, 0xff, 0xff, 0x7f]);
                for content in [packed_as_a_whole(&damaged), damaged] {
                    std::fs::write(&path, content).unwrap();
                    match compare(&path) {
                        Ok(result) => assert_ne!(result.result, DiffVerdict::Different, "{name} {place}"),
                        Err(_) => refused += 1,
                    }
                }
            }
            at = next;
        }
    }
    assert!(refused > 300, "{refused}");
}

#[test]
fn folders_and_missing_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().to_owned(), folder.path().join("absent.vcd")] {
        let error = compare(&path).unwrap_err();
        assert!(
            matches!(error, WaveError::File { .. }) && error.to_string().contains(path.to_str().unwrap()),
            "{error}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn prop_no_damage_makes_it_panic(
        at in any::<prop::sample::Index>(),
        length in 0usize..8,
        bytes in prop::collection::vec(any::<u8>(), 0..8),
    ) {
        let mut content = GOOD.as_bytes().to_vec();
        let from = at.index(content.len());
        let to = (from + length).min(content.len());
        content.splice(from..to, bytes);
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), &content).unwrap();
        if let Ok(result) = compare(file.path()) {
            prop_assert!(result.differences.is_empty(), "a file differs from itself: {}", result);
        }
    }
}
