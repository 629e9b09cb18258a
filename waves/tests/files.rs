//! Files as continuous integration has them: packed, piped, cut off.

use std::path::{Path, PathBuf};

use wavecmp::WaveError;
use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)
}

fn compare(a: &Path, b: &Path, options: &DiffOptions) -> Result<Comparison, WaveError> {
    diff::compare(a, b, options, &mut |_| {})
}

fn cut_allowed() -> DiffOptions {
    DiffOptions {
        allow_truncated: true,
        ..DiffOptions::default()
    }
}

#[test]
fn golden_packed_files_compare_as_their_content() {
    let plain = fixture("waves/verilator.vcd");
    for packed in ["gz", "xz", "zst"] {
        let packed = fixture(&format!("packed/counter.vcd.{packed}"));
        let result = compare(&plain, &packed, &DiffOptions::default()).unwrap();
        assert_eq!(result.result, DiffVerdict::Equal, "{packed:?}: {result}");
        assert!(result.samples > 10, "{result}");
    }
}

#[test]
fn several_packed_parts_are_one_file() {
    let text = std::fs::read(fixture("waves/verilator.vcd")).unwrap();
    let gzip = std::fs::read(fixture("packed/counter.vcd.gz")).unwrap();
    let zstd = std::fs::read(fixture("packed/counter.vcd.zst")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    // The same changes again, later: what follows $enddefinitions is read as changes at the same times, and refused.
    for packed in [gzip, zstd] {
        let path = folder.path().join("twice");
        std::fs::write(&path, [packed.clone(), packed].concat()).unwrap();
        let error = compare(&path, &path, &DiffOptions::default()).unwrap_err().to_string();
        assert!(
            error.contains(&format!("byte {}", text.len())) || error.contains("after $enddefinitions"),
            "{error}"
        );
    }
}

#[test]
fn a_packed_file_that_is_cut_off_is_refused_or_compared_up_to_there() {
    let folder = tempfile::tempdir().unwrap();
    for packed in ["gz", "xz", "zst"] {
        let whole = std::fs::read(fixture(&format!("packed/counter.vcd.{packed}"))).unwrap();
        let path = folder.path().join(packed);
        std::fs::write(&path, &whole[..whole.len() - 9]).unwrap();
        let plain = fixture("waves/verilator.vcd");
        assert!(compare(&plain, &path, &DiffOptions::default()).is_err(), "{packed}");
    }
}

#[test]
fn a_vcd_cut_in_a_line_is_refused_with_the_place_or_compared_up_to_there() {
    let whole = fixture("waves/icarus.vcd");
    let text = std::fs::read(&whole).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let cut = folder.path().join("cut.vcd");
    let mut compared = 0;
    for end in text.len() / 2..text.len() / 2 + 60 {
        std::fs::write(&cut, &text[..end]).unwrap();
        let result = compare(&whole, &cut, &cut_allowed()).unwrap();
        if text[end - 1] == b'\n' {
            continue;
        }
        compared += 1;
        let error = compare(&whole, &cut, &DiffOptions::default()).unwrap_err().to_string();
        assert!(error.contains(&format!(": byte {end}: ")), "{error}");
        assert!(error.contains("cut off"), "{error}");
        assert_eq!(result.result, DiffVerdict::Equal, "{end}: {result}");
        assert_eq!(
            (result.cut[0].file, &*result.cut[0].place),
            ("second", &*format!("byte {end}"))
        );
        assert!(
            result.to_string().starts_with("equal up to where a file was cut off"),
            "{result}"
        );
        let other_way = compare(&cut, &whole, &cut_allowed()).unwrap();
        assert_eq!(other_way.result, DiffVerdict::Equal, "{end}: {other_way}");
        assert_eq!(other_way.samples, result.samples);
    }
    assert!(compared > 40);
}

#[test]
fn a_difference_before_the_cut_is_found() {
    let text = std::fs::read_to_string(fixture("waves/icarus.vcd")).unwrap();
    let at = text.rfind("\n#").unwrap();
    let change = text[..at].rfind("\nb").unwrap() + 2;
    let mut other = text.clone().into_bytes();
    other[change] ^= 1;
    other.truncate(text.len() - 1);
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a.vcd", "b.vcd"].map(|name| folder.path().join(name));
    std::fs::write(&a, &text).unwrap();
    std::fs::write(&b, other).unwrap();
    let raw = DiffOptions {
        raw: true,
        ..cut_allowed()
    };
    assert_eq!(compare(&a, &b, &raw).unwrap().result, DiffVerdict::Different);
}

#[test]
fn golden_the_fst_of_a_killed_simulator_is_compared_up_to_where_it_was_cut() {
    let (killed, ran) = (fixture("cut/killed.fst"), fixture("cut/ran.fst"));
    let result = compare(&killed, &ran, &DiffOptions::default()).unwrap();
    assert_eq!(result.result, DiffVerdict::Equal, "{result}");
    // 10 ns a clock, and 4 us were written.
    assert!((380..=400).contains(&result.samples), "{result}");
    assert_eq!(result.cut[0].file, "first");
    let folder = tempfile::tempdir().unwrap();
    let part = folder.path().join("part.fst");
    std::fs::copy(fixture("cut/killed.fst.hier"), folder.path().join("part.fst.hier")).unwrap();
    let bytes = std::fs::read(&killed).unwrap();
    std::fs::write(&part, &bytes[..bytes.len() - 200]).unwrap();
    let result = compare(&ran, &part, &DiffOptions::default()).unwrap();
    assert_eq!(result.result, DiffVerdict::Equal, "{result}");
    assert!((180..=200).contains(&result.samples), "{result}");
    std::fs::remove_file(folder.path().join("part.fst.hier")).unwrap();
    let error = compare(&ran, &part, &DiffOptions::default()).unwrap_err().to_string();
    assert!(error.contains("cut off"), "{error}");
}

#[test]
fn ghw_names_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ghw");
    std::fs::write(&path, b"GHDLwave\n\x10\0\0\x01").unwrap();
    let error = compare(&path, &path, &DiffOptions::default()).unwrap_err().to_string();
    assert!(error.contains("--fst="), "{error}");
}
