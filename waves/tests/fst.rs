//! FST: what writers may put into it, and what is said of what cannot be read.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use wavecmp::WaveError;
use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)
}

fn raw(a: &Path, b: &Path) -> Result<Comparison, WaveError> {
    let options = DiffOptions {
        raw: true,
        ..DiffOptions::default()
    };
    diff::compare(a, b, &options, &mut |_| {})
}

fn equal(a: &Path, b: &Path) -> Comparison {
    let result = raw(a, b).unwrap();
    assert_eq!(result.result, DiffVerdict::Equal, "{result}");
    result
}

/// Parts of a file: the hierarchy, and the width of each signal as it is written.
struct File {
    hierarchy: Vec<u8>,
    widths: Vec<u64>,
    /// The time at which the recording begins, and the values of all signals before any change.
    start: u64,
    values: Vec<u8>,
    /// The changes of the first signal, of which each begins with a time.
    chain: Vec<u8>,
}

const SCOPE: &[u8] = b"\xfe\0t\0\0";
const UP: u8 = 255;

fn number(mut value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value > 0x7f {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}

/// A variable of a kind (16 is a wire); `alias` is 0 for a signal of its own.
fn variable(kind: u8, name: &str, width: u64, alias: u64) -> Vec<u8> {
    [&[kind, 0], name.as_bytes(), &[0], &number(width), &number(alias)].concat()
}

impl File {
    /// `a`, one bit, is 0 at 0 and 1 at 10.
    fn one_bit(hierarchy: &[u8]) -> Self {
        Self {
            hierarchy: [SCOPE, &variable(16, "a", 1, 0), hierarchy].concat(),
            widths: vec![1],
            start: 0,
            values: b"0".to_vec(),
            chain: vec![0b10],
        }
    }

    /// `a`, one bit, changes at the first time, 10.
    fn write(&self, path: &Path) {
        let block =
            |kind: u8, content: &[u8]| [&[kind][..], &(content.len() as u64 + 8).to_be_bytes(), content].concat();
        let mut header = vec![0; 321];
        header[16..24].copy_from_slice(&std::f64::consts::E.to_le_bytes());
        header[64] = (-9i8) as u8;
        let mut hierarchy = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        hierarchy.write_all(&self.hierarchy).unwrap();
        let length = (self.hierarchy.len() as u64).to_be_bytes();
        let hierarchy = [&length[..], &hierarchy.finish().unwrap()].concat();
        let widths: Vec<u8> = self.widths.iter().flat_map(|width| number(*width)).collect();
        let geometry = [
            &(widths.len() as u64).to_be_bytes()[..],
            &(self.widths.len() as u64).to_be_bytes(),
            &widths,
        ]
        .concat();
        let count = number(self.widths.len() as u64);
        let length = number(self.values.len() as u64);
        // The chain begins one byte after the letter of the packing, and the others are missing.
        let table = [vec![3], number((self.widths.len() as u64 - 1) << 1)].concat();
        let table = if self.widths.len() == 1 {
            &table[..1]
        } else {
            &table[..]
        };
        let changes = [
            &self.start.to_be_bytes()[..],
            &10u64.to_be_bytes(),
            &[0; 8],
            &length,
            &length,
            &count,
            &self.values,
            &count,
            b"4\0",
            &self.chain,
            table,
            &(table.len() as u64).to_be_bytes(),
            &[10],
            &1u64.to_be_bytes(),
            &1u64.to_be_bytes(),
            &1u64.to_be_bytes(),
        ]
        .concat();
        let file = [
            block(0, &header),
            block(8, &changes),
            block(3, &geometry),
            block(4, &hierarchy),
        ]
        .concat();
        std::fs::write(path, file).unwrap();
    }

    fn compared(&self, vcd: &str) -> Result<Comparison, WaveError> {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a.fst", "b.vcd"].map(|name| folder.path().join(name));
        self.write(&a);
        std::fs::write(&b, vcd).unwrap();
        raw(&a, &b)
    }

    fn refused(&self) -> String {
        self.compared(VCD).unwrap_err().to_string()
    }
}

const VCD: &str = "$timescale 1 ns $end\n$scope module t $end\n$var wire 1 a a $end\n$upscope $end\n$enddefinitions $end\n\
    #0\n0a\n#10\n1a\n";

#[test]
fn golden_a_hierarchy_shorter_than_a_head_of_gzip_is_read() {
    let result = equal(&fixture("fst/small_hierarchy.fst"), &fixture("fst/small_hierarchy.vcd"));
    assert_eq!((result.signals, result.samples), (1, 2));
}

#[test]
fn golden_fastlz_unpacks_to_what_gtkwave_packed() {
    let mut text = "$timescale 1ns $end\n$scope module t $end\n$var wire 1 ! clk $end\n$var wire 12 \" y $end\n\
        $var real 64 # r $end\n$upscope $end\n$enddefinitions $end\n"
        .to_owned();
    for step in 0..400 {
        writeln!(text, "#{}\n{}!", step * 5, step & 1).unwrap();
        if step % 4 == 1 {
            writeln!(text, "b{:b} \"", step * 37 % 4096).unwrap();
        }
        if step % 8 == 1 {
            writeln!(text, "r{} #", f64::from(step) / 8.0).unwrap();
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.vcd");
    std::fs::write(&path, &text).unwrap();
    assert_eq!(equal(&path, &fixture("fst/fastlz.fst")).samples, 400);
    let at = text.rfind("b1").unwrap() + 2;
    text.replace_range(at..=at, if &text[at..=at] == "0" { "1" } else { "0" });
    std::fs::write(&path, &text).unwrap();
    assert_eq!(raw(&path, &fixture("fst/fastlz.fst")).unwrap().differences.len(), 1);
}

#[test]
fn golden_periods_without_recording_are_those_of_the_vcd() {
    let [vcd, fst, whole] =
        ["icarus_dumpoff.vcd", "icarus_dumpoff.fst", "icarus.fst"].map(|name| fixture("waves").join(name));
    let unrecorded = "not recorded in one file ($dumpoff) and not compared";
    for (a, b, is_one_whole) in [(&vcd, &fst, false), (&fst, &whole, true), (&whole, &fst, true)] {
        let result = diff::compare(a, b, &DiffOptions::default(), &mut |_| {}).unwrap();
        assert_eq!((result.result, result.samples), (DiffVerdict::Equal, 30), "{result}");
        let named = result.to_string().contains(&format!("{unrecorded}: 10 samples"));
        assert_eq!(named, is_one_whole, "{result}");
        assert!(raw(a, b).unwrap().to_string().contains(unrecorded), "{result}");
    }
}

#[test]
fn attributes_of_any_kind_and_length_and_open_scopes_change_nothing() {
    let long = [b"\xfc\0\0", "long ".repeat(100_000).as_bytes(), b"\0\x05\xfd"].concat();
    let kinds: Vec<u8> = (0..=255u8)
        .flat_map(|kind| [&[252, kind, kind][..], b"what?\0\x81\x01"].concat())
        .collect();
    for hierarchy in [
        &[UP][..],
        b"",
        &long,
        &kinds,
        &[long.clone(), kinds.clone(), vec![UP]].concat(),
    ] {
        let result = File::one_bit(hierarchy).compared(VCD).unwrap();
        assert_eq!(result.result, DiffVerdict::Equal, "{result}");
        assert_eq!((result.signals, result.samples), (1, 2));
    }
    // Names that are no UTF-8 do not match, and do no harm.
    let mut bytes = File::one_bit(&[UP]);
    bytes.hierarchy.extend(b"\xfe\0\xff\xfe\0\0\x10\0\xe4\0\x01\x01\xff");
    assert_eq!(bytes.compared(VCD).unwrap().result, DiffVerdict::Equal);
}

#[test]
fn golden_the_states_of_a_port_are_those_of_an_extended_vcd() {
    let port = |bits: u64, value: &str| File {
        hierarchy: [
            SCOPE,
            &variable(16, "a", 1, 0),
            &variable(18, "p", 3 * bits + 2, 0),
            &[UP],
        ]
        .concat(),
        widths: vec![1, 3 * bits + 2],
        start: 0,
        values: [b"0", value.as_bytes()].concat(),
        chain: vec![0b10],
    };
    let vcd = |range: &str, value: &str| {
        let declared = format!("$var wire 1 a a $end\n$var port {range} <0 p $end");
        VCD.replace("$var wire 1 a a $end", &declared)
            .replace("#0\n0a", &format!("#0\n0a\np{value} <0"))
    };
    for (bits, range, value, other, is_equal, exact) in [
        (1, "1", "D 6 0", "D 6 0", true, true),
        (1, "1", "D 6 0", "D 5 0", true, false),
        (1, "1", "D 6 0", "L 6 0", true, false),
        (1, "1", "D 6 0", "U 6 0", false, false),
        (3, "[2:0]", "DUZ 666 606", "DUZ 666 606", true, true),
        (3, "[2:0]", "DUZ 666 606", "LHT 666 606", true, false),
        (3, "[2:0]", "DUZ 666 606", "DUN 666 606", false, false),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let [a, b, text] = ["a.fst", "b.fst", "b.vcd"].map(|name| folder.path().join(name));
        port(bits, value).write(&a);
        port(bits, other).write(&b);
        std::fs::write(&text, vcd(range, other)).unwrap();
        for [a, b] in [[&a, &b], [&b, &a], [&a, &text], [&text, &a]] {
            let result = raw(a, b).unwrap();
            let verdict = if is_equal {
                DiffVerdict::Equal
            } else {
                DiffVerdict::Different
            };
            assert_eq!(
                (result.result, result.signals),
                (verdict, 2),
                "{value} {other}: {result}"
            );
            assert!(!is_equal || result.exact == exact, "{value} {other}: {result}");
            assert!(is_equal || result.differences[0].signal == "t.p", "{result}");
        }
    }
}

#[test]
fn values_that_were_written_before_any_time_are_there_though_changes_are_at_the_same_time() {
    // As GTKWave's vcd2fst writes the parameters that Icarus dumps before `#0`.
    let mut file = File::one_bit(&[variable(2, "size", 4, 0), variable(16, "later", 4, 0), vec![UP]].concat());
    file.widths = vec![1, 4, 4];
    file.start = 10;
    file.values = b"x0110xxxx".to_vec();
    let vcd = |size: &str| {
        VCD.replace(
            "$upscope",
            "$var parameter 4 s size $end\n$var wire 4 l later $end\n$upscope",
        )
        .replace("#0\n0a\n", "")
        .replace("1a\n", &format!("1a\nb{size} s\n"))
    };
    let result = file.compared(&vcd("110")).unwrap();
    assert_eq!(
        (result.result, result.signals, result.samples),
        (DiffVerdict::Equal, 3, 1)
    );
    let result = file.compared(&vcd("111")).unwrap();
    assert_eq!(result.differences[0].signal, "t.size", "{result}");
}

#[test]
fn long_hundreds_of_thousands_of_names_are_compared() {
    let mut file = File::one_bit(&[]);
    let mut vcd = VCD.replace("$upscope $end\n$enddefinitions $end\n", "");
    let (head, changes) = VCD.split_once("$upscope").unwrap();
    vcd.clear();
    vcd.push_str(head);
    for at in 0..420_000 {
        let name = format!("n{at}");
        file.hierarchy.extend(variable(16, &name, 1, 1));
        writeln!(vcd, "$var wire 1 a {name} $end").unwrap();
    }
    write!(vcd, "$upscope{changes}").unwrap();
    let result = file.compared(&vcd).unwrap();
    assert_eq!((result.result, result.signals), (DiffVerdict::Equal, 420_001));
}

#[test]
fn damaged_and_unsupported_blocks_give_different_errors() {
    let with = |hierarchy: &[u8]| File::one_bit(hierarchy).refused();
    for (message, what) in [
        (with(b"\xc8"), "found an entry of unknown kind 200 in the hierarchy"),
        (
            with(b"\xfe\0unended"),
            "the hierarchy ends in the middle of an entry: the file is damaged",
        ),
        (
            with(&variable(16, "b", 1, 5)),
            "aliases one that is declared later or never: the file is damaged",
        ),
        (
            with(&variable(16, "b", 1, 0)),
            "more signals than the file: the file is damaged",
        ),
    ] {
        assert!(message.contains(what), "{message}");
    }
    // As `vcd2fst` writes it of a VCD with scopes without names.
    let ended_twice = File::one_bit(&[UP, UP]).compared(VCD).unwrap();
    assert_eq!(ended_twice.result, DiffVerdict::Equal);
    assert!(
        ended_twice.to_string().contains("never began is ignored"),
        "{ended_twice}"
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.fst");
    File::one_bit(&[]).write(&path);
    let whole = std::fs::read(&path).unwrap();
    let changed = |at: usize, bytes: &[u8]| {
        let mut content = whole.clone();
        content[at..at + bytes.len()].copy_from_slice(bytes);
        std::fs::write(&path, content).unwrap();
        raw(&path, &path).unwrap_err().to_string()
    };
    assert!(changed(330, &[77]).contains("found a block of unknown kind 77"));
    // A writer that was stopped, or wrote no time, leaves a block like this.
    let unfinished = changed(330, &[[255].as_slice(), &[0; 8]].concat());
    assert!(
        unfinished.contains("never finished") && !unfinished.contains("damaged"),
        "{unfinished}"
    );
    let geometry = whole
        .windows(9)
        .position(|nine| nine[0] == 3 && nine[1..] == 25u64.to_be_bytes()[..])
        .unwrap();
    let many = changed(geometry + 17, &(1u64 << 40).to_be_bytes());
    assert!(many.contains("more than 4194304 signals"), "{many}");
}

#[test]
fn damage_that_both_files_have_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a.fst", "b.fst"].map(|name| folder.path().join(name));
    for (chain, problem) in [
        // Two times later than the only one, a change that is cut off, and a digit that is none.
        (vec![0b1010], "later than the last time"),
        (vec![0x80], "end too early"),
        (vec![0b1, b'0', b'1', b'y', b'0'], "not a digit"),
    ] {
        let mut file = File::one_bit(&[UP]);
        if chain.len() > 1 {
            file.hierarchy = [SCOPE, &variable(16, "a", 4, 0), &[UP]].concat();
            (file.widths, file.values) = (vec![4], b"0000".to_vec());
        }
        file.chain = chain;
        file.write(&a);
        file.write(&b);
        let error = raw(&a, &b).unwrap_err().to_string();
        assert!(error.contains(problem), "{error}");
    }
}
