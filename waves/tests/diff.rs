//! `diff`: which files are equal, which are not, and what it reports.

use std::path::PathBuf;

use proptest::prelude::*;
use tempfile::TempDir;
use wavecmp::WaveError;
use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict, Shown};

use crate::support;

/// Returns a VCD with the given declarations and changes, timescale 1 ns.
fn text(variables: &str, changes: &str) -> String {
    format!("$timescale 1 ns $end\n{variables}\n$enddefinitions $end\n{changes}\n")
}

/// Returns `top` with a clock and a signed byte.
fn clocked(scope: &str, changes: &str) -> String {
    let variables =
        format!("$scope module {scope} $end $var wire 1 c clk $end $var wire 8 y y [7:0] $end $upscope $end");
    text(&variables, changes)
}

struct Two {
    folder: TempDir,
}

impl Two {
    fn new(a: &str, b: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.vcd"), a).unwrap();
        std::fs::write(folder.path().join("b.vcd"), b).unwrap();
        Self { folder }
    }

    fn paths(&self) -> [PathBuf; 2] {
        ["a.vcd", "b.vcd"].map(|name| self.folder.path().join(name))
    }

    fn compare(&self, options: &DiffOptions) -> Result<Comparison, WaveError> {
        let [a, b] = self.paths();
        diff::compare(&a, &b, options, &mut |_| {})
    }
}

fn options(maps: &[&str], tolerances: &[&str]) -> DiffOptions {
    let mut options = DiffOptions::default();
    maps.iter().for_each(|map| options.add_map(map).unwrap());
    tolerances.iter().for_each(|lsb| options.add_tolerance(lsb).unwrap());
    options
}

#[test]
fn registers_compare_the_same_at_and_after_the_edge() {
    // A shows the change at the edge, B a nanosecond later; B has another timescale.
    let a = clocked("t", "#0 0c b1 y #5 1c b10 y #10 0c #15 1c b11 y #20 0c #25 1c");
    let b = clocked(
        "t",
        "#0 0c b1 y #5000 1c #6000 b10 y #10000 0c #15000 1c #16000 b11 y #20000 0c #25000 1c",
    );
    let b = b.replace("1 ns", "1ps");
    let result = Two::new(&a, &b).compare(&DiffOptions::default()).unwrap();
    assert_eq!(
        (result.result, result.signals, result.samples),
        (DiffVerdict::Equal, 2, 3),
        "{result}"
    );
    assert_eq!(result.first_time, None);
    assert_eq!(
        serde_json::to_string(&result).unwrap(),
        r#"{"result":"equal","signals":2,"samples":3,"differences":[],"first_time":null,"exact":true,"unknown":"strict","notes":["sampled at the rising edges of `t.clk`"]}"#
    );
}

#[test]
fn the_first_difference_and_the_count_are_reported() {
    let a = clocked("t", "#0 0c b1 y #5 1c #10 0c #15 1c #20 0c #25 1c #30 0c #35 1c");
    let b = clocked(
        "t",
        "#0 0c b1 y #5 1c b11111110 y #10 0c #15 1c #20 0c b1 y #25 1c bx y #30 0c #35 1c",
    );
    let result = Two::new(&a, &b).compare(&DiffOptions::default()).unwrap();
    let document = serde_json::to_string(&result).unwrap();
    assert!(
        document.starts_with(r#"{"result":"different","signals":2,"samples":4,"differences":[{"signal":"t.y","time":1.5e-8,"a":"00000001","b":"11111110","count":2,"persistent":true}],"first_time":1.5e-8,"exact":true,"#),
        "{document}"
    );
    let within = Two::new(&a, &b).compare(&options(&[], &["y=3"])).unwrap();
    assert_eq!(
        within.differences[0].b,
        Shown::Bits("xxxxxxxx".to_owned()),
        "x is never within a tolerance"
    );
    assert_eq!(within.differences[0].count, 1);
    assert_eq!(within.lenient[0].tolerance.as_deref(), Some("3 LSB"));
    assert!(
        !within.exact && within.to_string().contains("t.y: compared as bits, tolerance 3 LSB"),
        "{within}"
    );
    let outside = Two::new(&a, &b).compare(&options(&[], &["t.y=2.9"])).unwrap();
    assert_eq!(outside.differences[0].count, 2);
}

#[test]
fn unknown_bits_equal_only_themselves() {
    let with = |digit: char| clocked("t", &format!("#0 0c b1{digit} y #5 1c"));
    for a in ['0', '1', 'x', 'z'] {
        for b in ['0', '1', 'x', 'z'] {
            let result = Two::new(&with(a), &with(b)).compare(&DiffOptions::default()).unwrap();
            assert_eq!(result.result == DiffVerdict::Equal, a == b, "{a} {b}");
        }
    }
}

#[test]
fn missing_edges_are_a_difference_of_the_clock() {
    let a = clocked("t", "#0 0c b1 y #5 1c #10 0c #15 1c #20 0c #25 1c");
    let b = clocked("t", "#0 0c b1 y #5 1c #10 0c");
    for (a, b, swapped) in [(&a, &b, false), (&b, &a, true)] {
        let result = Two::new(a, b).compare(&DiffOptions::default()).unwrap();
        assert_eq!((result.result, result.samples), (DiffVerdict::Different, 1));
        let clock = &result.differences[0];
        assert_eq!((clock.signal.as_str(), clock.time, clock.count), ("t.clk", 1.5e-8, 2));
        assert_eq!(clock.a == Shown::Missing, swapped);
    }
}

#[test]
fn signals_without_partner_are_listed_or_differ_on_demand() {
    let a = clocked("t", "#0 0c b1 y #5 1c");
    let b = a
        .replace("$upscope", "$var wire 2 z z $end $upscope")
        .replace("b1 y", "b1 y b10 z");
    let all = DiffOptions {
        require_all: true,
        ..DiffOptions::default()
    };
    let result = Two::new(&a, &b).compare(&all).unwrap();
    assert_eq!((result.result, result.signals), (DiffVerdict::Different, 2));
    let alone = &result.differences[0];
    assert_eq!(
        (alone.signal.as_str(), &alone.a, &alone.b),
        ("t.z", &Shown::Missing, &Shown::Bits("10".to_owned()))
    );
    assert_eq!(result.only_in_b, ["t.z"]);
    let result = Two::new(&a, &b).compare(&DiffOptions::default()).unwrap();
    assert_eq!((result.result, result.only_in_b.len()), (DiffVerdict::Equal, 1));
}

#[test]
fn nothing_in_common_is_incomparable() {
    let a = clocked("t", "#0 0c b1 y #5 1c");
    let only_clock = a.replace(" y [7:0]", " other");
    let no_edge = clocked("t", "#0 0c b1 y");
    for (b, samples) in [(&only_clock, 0), (&no_edge, 0), (&text("", ""), 0)] {
        for (a, b) in [(&a, b), (b, &a)] {
            let result = Two::new(a, b).compare(&DiffOptions::default()).unwrap();
            let expected = if *b == no_edge || *a == no_edge {
                // They have no common sample, but one has edges that the other lacks.
                (DiffVerdict::Incomparable, samples)
            } else {
                (DiffVerdict::Incomparable, 0)
            };
            assert_eq!((result.result, result.samples), expected, "{result}");
            assert!(result.differences.is_empty());
        }
    }
}

#[test]
fn a_note_says_that_nanoseconds_are_assumed_without_a_timescale() {
    let with = clocked("t", "#0 0c b1 y #5 1c b10 y #10 0c #15 1c");
    let without = with.replace("$timescale 1 ns $end\n", "");
    let notes = |a: &str, b: &str| {
        let result = Two::new(a, b).compare(&DiffOptions::default()).unwrap();
        assert_eq!(result.result, DiffVerdict::Equal);
        result.notes.join("\n")
    };
    assert!(!notes(&with, &with).contains("$timescale"));
    for (text, file) in [(notes(&without, &with), "first"), (notes(&with, &without), "second")] {
        assert!(text.contains(&format!("the {file} file has no $timescale")), "{text}");
        assert_eq!(text.matches("$timescale").count(), 1, "{text}");
    }
}

#[test]
fn incomparable_names_filters_that_leave_nothing() {
    let text = clocked("t", "#0 0c b1 y #5 1c b10 y #10 0c #15 1c");
    for (only, ignore) in [(Some("nowhere"), None), (None, Some("*")), (None, Some("y"))] {
        let options = DiffOptions {
            only: only.map(str::to_owned).into_iter().collect(),
            ignore: ignore.map(str::to_owned).into_iter().collect(),
            ..DiffOptions::default()
        };
        let result = Two::new(&text, &text).compare(&options).unwrap();
        assert_eq!(result.result, DiffVerdict::Incomparable);
        assert!(result.notes.join("").contains("--only and --ignore"), "{result}");
    }
}

#[test]
fn without_a_clock_every_change_counts() {
    let variables = "$scope module t $end $var wire 8 y y $end $var real 64 r r $end $upscope $end";
    let a = text(variables, "#0 b1 y r1.5 r #10 b10 y #20 r2.5 r #30 b0 y");
    let b = text(variables, "#0 b1 y r1.5 r #10 b10 y #21 r2.5 r #30 b0 y");
    let result = Two::new(&a, &b).compare(&DiffOptions::default()).unwrap();
    assert_eq!((result.result, result.samples), (DiffVerdict::Different, 5));
    let late = &result.differences[0];
    assert_eq!((late.signal.as_str(), late.time, late.count), ("t.r", 2e-8, 1));
    assert_eq!((&late.a, &late.b), (&Shown::Real(2.5), &Shown::Real(1.5)));
    assert_eq!(
        Two::new(&a, &b).compare(&options(&[], &["r=1"])).unwrap().result,
        DiffVerdict::Equal
    );
    assert_eq!(
        Two::new(&a, &b).compare(&options(&[], &["1"])).unwrap().result,
        DiffVerdict::Equal
    );
}

#[test]
fn reals_compare_with_vectors_as_signed_numbers() {
    let vector = clocked("rtl", "#0 0c b11111100 y #5 1c b11 y #10 0c #15 1c");
    let real = clocked("float", "#0 0c r-4.25 y #5 1c r3 y #10 0c #15 1c").replace("wire 8 y y [7:0]", "real 64 y y");
    let two = Two::new(&vector, &real);
    let exact = two.compare(&DiffOptions::default()).unwrap();
    assert_eq!(
        (exact.result, exact.differences[0].count),
        (DiffVerdict::Different, 1),
        "{exact}"
    );
    assert_eq!(
        two.compare(&options(&["rtl=float"], &["0.25"])).unwrap().result,
        DiffVerdict::Equal
    );
}

#[test]
fn widths_extend_with_zeros_or_with_a_tolerance_by_sign() {
    let narrow = clocked("t", "#0 0c b11111111 y #5 1c");
    let wide = |digits: &str| clocked("t", &format!("#0 0c b{digits} y #5 1c")).replace("8 y y [7:0]", "70 y y");
    let (unsigned, signed) = (wide("11111111"), wide(&"1".repeat(70)));
    let verdict = |b: &str, options: &DiffOptions| Two::new(&narrow, b).compare(options).unwrap().result;
    assert_eq!(verdict(&unsigned, &DiffOptions::default()), DiffVerdict::Equal);
    assert_eq!(verdict(&signed, &DiffOptions::default()), DiffVerdict::Different);
    assert_eq!(verdict(&unsigned, &options(&[], &["y=0"])), DiffVerdict::Different);
    assert_eq!(verdict(&signed, &options(&[], &["0"])), DiffVerdict::Equal);
    let far_bit = wide(&format!("1{}11111111", "0".repeat(61)));
    assert_eq!(verdict(&far_bit, &DiffOptions::default()), DiffVerdict::Different);
    let shown = Two::new(&narrow, &signed).compare(&DiffOptions::default()).unwrap();
    assert_eq!(
        shown.differences[0].a,
        Shown::Bits(format!("{}{}", "0".repeat(62), "1".repeat(8)))
    );
}

#[test]
fn clock_options() {
    let two_clocks =
        clocked("t", "#0 0c 0d b1 y #5 1c #10 0c 1d").replace("$var wire 8", "$var wire 1 d clock $end $var wire 8");
    let two = Two::new(&two_clocks, &two_clocks);
    let raw = two.compare(&DiffOptions::default()).unwrap();
    assert_eq!((raw.result, raw.samples), (DiffVerdict::Equal, 3));
    assert!(raw.notes[0].contains("2 candidates"), "{raw}");
    let with = |clock: &str| {
        two.compare(&DiffOptions {
            clock: Some(clock.to_owned()),
            ..DiffOptions::default()
        })
    };
    assert_eq!(with("t.clock").unwrap().samples, 1);
    assert_eq!(with("clk").unwrap().samples, 1);
    assert!(with("lk").is_err());
    assert!(with("y").unwrap_err().to_string().contains("one bit"));
    assert!(with("nothing").unwrap_err().to_string().contains("no such signal"));
}

#[test]
fn wrong_options_are_errors() {
    let a = clocked("t", "#0 0c b1 y #5 1c");
    let mut unknown = DiffOptions::default();
    unknown.add_tolerance("nothing=1").unwrap();
    assert!(matches!(Two::new(&a, &a).compare(&unknown), Err(WaveError::Option(_))));
    let wide = a.replace("8 y y [7:0]", "129 y y");
    let mut too_wide = DiffOptions::default();
    too_wide.add_tolerance("y=1").unwrap();
    assert!(matches!(
        Two::new(&wide, &wide).compare(&too_wide),
        Err(WaveError::Option(_))
    ));
}

const WIDTHS: [u32; 4] = [1, 7, 33, 64];

fn record(path: &std::path::Path, clock: bool, rows: &[[u64; 4]]) {
    let mask = |row: &[u64; 4]| {
        row.iter()
            .zip(WIDTHS)
            .map(|(v, w)| v & (u64::MAX >> (64 - w)))
            .collect()
    };
    let rows: Vec<Vec<u64>> = rows.iter().map(mask).collect();
    support::record(path, if clock { "clk" } else { "other" }, &WIDTHS, &rows);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn prop_a_file_equals_itself_and_one_flipped_bit_is_found_where_it_is(
        rows in prop::collection::vec(any::<[u64; 4]>(), 1..40),
        at in any::<prop::sample::Index>(),
        signal in 0usize..4,
        bit in any::<prop::sample::Index>(),
        clock: bool,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a.vcd", "b.vcd"].map(|name| folder.path().join(name));
        record(&a, clock, &rows);
        let itself = diff::compare(&a, &a, &DiffOptions::default(), &mut |_| {}).unwrap();
        prop_assert_eq!(itself.result, DiffVerdict::Equal);
        prop_assert_eq!(itself.signals, 5);
        if clock {
            prop_assert_eq!(itself.samples, rows.len() as u64);
        }

        let mut flipped = rows.clone();
        let row = at.index(rows.len());
        flipped[row][signal] ^= 1 << bit.index(WIDTHS[signal] as usize);
        record(&b, clock, &flipped);
        let there = diff::compare(&a, &b, &DiffOptions::default(), &mut |_| {}).unwrap();
        prop_assert_eq!(there.differences.len(), 1);
        let found = &there.differences[0];
        prop_assert_eq!(&found.signal, &format!("top.dut.s{}", WIDTHS[signal]));
        // 25 MHz is 40 ns; with the clock, the sample is at the edge that ends the step.
        let step = row as u64 + u64::from(clock);
        prop_assert_eq!(found.time, step as f64 * 40.0 / 1e9);
        // Without a clock, a step has two times of change, and the last one a third.
        prop_assert_eq!(found.count, if clock { 1 } else { 2 + u64::from(row + 1 == rows.len()) });

        let back = diff::compare(&b, &a, &DiffOptions::default(), &mut |_| {}).unwrap();
        prop_assert_eq!(back.differences.len(), 1);
        prop_assert_eq!((&back.differences[0].a, &back.differences[0].b), (&found.b, &found.a));
        prop_assert_eq!((back.samples, back.first_time), (there.samples, there.first_time));
    }
}
