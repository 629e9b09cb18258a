//! Compares the result of following equal stretches with that of reading every change. Pieces are small in tests
//! (`cfg(test)`), so that short files have many.

use std::fmt::Write as _;
use std::path::Path;

use proptest::prelude::*;

use super::{Comparison, DiffOptions, compare_by};

const WIDTHS: [usize; 6] = [1, 1, 8, 33, 64, 100];

/// A clock's time and the changes at it.
type Row = Vec<(usize, u128)>;

#[derive(Debug, Clone)]
struct Edit {
    row: prop::sample::Index,
    signal: usize,
    value: u128,
    /// Whether the value is corrected in the next row.
    transient: bool,
}

fn text(rows: &[Row], odd: &[(prop::sample::Index, usize)]) -> String {
    let mut text = "$timescale 1ns $end\n$scope module t $end\n$var wire 1 ! clk $end\n".to_owned();
    for (at, width) in WIDTHS.iter().enumerate() {
        let _ = writeln!(text, "$var wire {width} s{at} w{at} $end");
    }
    text += "$var real 64 r r $end\n$upscope $end\n$enddefinitions $end\n#0\n$dumpvars\n0!\n$end\n";
    for (clock, row) in rows.iter().enumerate() {
        for (index, what) in odd {
            if index.index(rows.len()) == clock {
                text += [
                    "$comment a\n#5\n$end\n",
                    "#\n",
                    "$dumpoff\n$end\n$dumpon\n$end\n",
                    "1s0 \n",
                    "x!\n",
                ][*what];
            }
        }
        let _ = write!(text, "#{}\n1!\n", 10 * clock + 5);
        for (signal, value) in row {
            let width = WIDTHS[*signal];
            let value = value & (u128::MAX >> (128 - width));
            let _ = match width {
                1 => writeln!(text, "{value}s{signal}"),
                _ if value % 7 == 3 => writeln!(text, "bx{:b} s{signal}", value & 1),
                _ => writeln!(text, "b{value:b} s{signal}"),
            };
        }
        if clock % 3 == 0 {
            let _ = writeln!(text, "r{}.5 r", clock / 6);
        }
        let _ = write!(text, "#{}\n0!\n", 10 * clock + 10);
    }
    text
}

/// Returns the whole result as text, or its error.
fn result_text(path: [&Path; 2], options: &DiffOptions, plainly: bool) -> String {
    let compared = compare_by(path[0], path[1], options, &mut |_| {}, plainly);
    let whole = |mut comparison: Comparison| {
        // Changes between samples are not counted in equal bytes, so only reading every change reports them.
        comparison.unsampled = None;
        let counts_changes = |note: &String| {
            ["was not compared", "were not compared"]
                .iter()
                .any(|words| note.contains(words))
        };
        comparison.notes.retain(|note| !counts_changes(note));
        format!("{comparison}\n{comparison:?}")
    };
    compared.map_or_else(|error| error.to_string(), whole)
}

fn rows() -> impl Strategy<Value = Vec<Row>> {
    prop::collection::vec(prop::collection::vec((0..WIDTHS.len(), any::<u128>()), 0..6), 1..120)
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let edit = (
        any::<prop::sample::Index>(),
        0..WIDTHS.len(),
        any::<u128>(),
        any::<bool>(),
    );
    let edit = edit.prop_map(|(row, signal, value, transient)| Edit {
        row,
        signal,
        value,
        transient,
    });
    prop::collection::vec(edit, 0..4)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn prop_following_equal_bytes_gives_the_same_result(
        rows in rows(),
        edits in edits(),
        odd in prop::collection::vec((any::<prop::sample::Index>(), 0usize..5), 0..2),
        odd_in_both: bool,
        raw: bool,
        first: bool,
        tolerance: bool,
        some: bool,
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut other = rows.clone();
        for edit in &edits {
            let at = edit.row.index(rows.len());
            other[at].push((edit.signal, edit.value));
            if edit.transient && at + 1 < rows.len() {
                let right = rows[..=at].iter().flatten().rev().find(|(signal, _)| *signal == edit.signal);
                other[at + 1].insert(0, (edit.signal, right.map_or(0, |(_, value)| *value)));
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a.vcd", "b.vcd"].map(|name| folder.path().join(name));
        std::fs::write(&a, text(&rows, if odd_in_both { &odd } else { &[] })).unwrap();
        let mut content = text(&other, &odd);
        if let Some(cut) = cut {
            content.truncate(content.len() - cut.index(content.len() / 4));
        }
        std::fs::write(&b, content).unwrap();
        let mut options = DiffOptions { raw, first, allow_truncated: first, ..DiffOptions::default() };
        if tolerance {
            options.add_tolerance("w2=3").unwrap();
        }
        if some {
            options.ignore = ["t.w1", "t.w3", "t.w5"].map(str::to_owned).to_vec();
            // Then there are times at which nothing is compared.
            options.ignore.extend(raw.then(|| "t.clk".to_owned()));
        }
        prop_assert_eq!(result_text([&a, &b], &options, false), result_text([&a, &b], &options, true));
        prop_assert_eq!(result_text([&b, &a], &options, false), result_text([&b, &a], &options, true));
    }
}

#[test]
fn stretches_that_are_the_same_are_found() {
    let rows: Vec<Row> = (0..2000u128)
        .map(|at| vec![(2, at), (0, at % 2), (5, at * at)])
        .collect();
    let mut other = rows.clone();
    other[1000].push((3, 7));
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a.vcd", "b.vcd"].map(|name| folder.path().join(name));
    std::fs::write(&a, text(&rows, &[])).unwrap();
    std::fs::write(&b, text(&other, &[])).unwrap();
    for raw in [false, true] {
        let options = DiffOptions {
            raw,
            ..DiffOptions::default()
        };
        // Between the rare reports of samples, only pieces report.
        let mut reports = 0;
        let result = compare_by(&a, &b, &options, &mut |_| reports += 1, false).unwrap();
        assert!(reports > 100, "{reports}");
        assert_eq!(result.differences.len(), 1, "{result}");
        assert_eq!(
            result_text([&a, &b], &options, false),
            result_text([&a, &b], &options, true)
        );
    }
}

/// Writes the same as an FST whose blocks have this many rows; the times of odd rows have no change of the clock.
fn write_fst(path: &Path, rows: &[Row], block: usize) {
    use fst_writer::{FstFileType, FstInfo, FstScopeType, FstSignalType, FstVarDirection, FstVarType, open_fst};

    let info = FstInfo {
        start_time: 0,
        timescale_exponent: -9,
        version: String::new(),
        date: String::new(),
        file_type: FstFileType::Verilog,
    };
    let mut head = open_fst(path, &info).unwrap();
    head.scope("t", "", FstScopeType::Module).unwrap();
    let mut var = |name: &str, width: usize| {
        let kind = FstSignalType::bit_vec(width as u32);
        head.var(name, kind, FstVarType::Wire, FstVarDirection::Implicit, None)
            .unwrap()
    };
    let clk = var("clk", 1);
    let ids: Vec<_> = WIDTHS
        .iter()
        .enumerate()
        .map(|(at, width)| var(&format!("w{at}"), *width))
        .collect();
    head.up_scope().unwrap();
    let mut body = head.finish().unwrap();
    body.time_change(0).unwrap();
    body.signal_change(clk, b"0").unwrap();
    for (clock, row) in rows.iter().enumerate() {
        if clock > 0 && clock % block == 0 {
            body.flush().unwrap();
        }
        let mut time = 10 * clock as u64 + 5;
        body.time_change(time).unwrap();
        if clock % 2 == 0 {
            body.signal_change(clk, b"1").unwrap();
        }
        for (signal, value) in row {
            if value % 11 == 5 {
                time += 1;
                body.time_change(time).unwrap();
            }
            // The clock, too, may change several times at one time.
            if value % 13 == 4 {
                let digit = [b"x", b"0", b"1", b"z"][(value >> 7) as usize % 4];
                body.signal_change(clk, digit).unwrap();
            }
            let width = WIDTHS[*signal];
            let value = value & (u128::MAX >> (128 - width));
            let mut digits = format!("{value:0width$b}");
            if value % 7 == 3 {
                digits.replace_range(..1, "x");
            }
            body.signal_change(ids[*signal], digits.as_bytes()).unwrap();
        }
        body.time_change(10 * clock as u64 + 14).unwrap();
        body.signal_change(clk, b"0").unwrap();
    }
    body.finish().unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn prop_skipping_equal_chains_gives_the_same_result(
        rows in rows(),
        edits in edits(),
        blocks in [1usize..60, 1usize..60],
        other_blocks: bool,
        raw: bool,
        first: bool,
        later: bool,
    ) {
        let mut other = rows.clone();
        for edit in &edits {
            let at = edit.row.index(rows.len());
            other[at].push((edit.signal, edit.value));
        }
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a.fst", "b.fst"].map(|name| folder.path().join(name));
        write_fst(&a, &rows, blocks[0]);
        write_fst(&b, &other, blocks[usize::from(other_blocks)]);
        let mut options = DiffOptions { raw, first, ..DiffOptions::default() };
        if later {
            let latency = if raw { "w2=7ns" } else { "w2=1" };
            options.add_latency(latency).unwrap();
        }
        prop_assert_eq!(result_text([&a, &b], &options, false), result_text([&a, &b], &options, true));
        prop_assert_eq!(result_text([&b, &a], &options, false), result_text([&b, &a], &options, true));
    }
}

/// Signals of one bit, with id codes of one to three characters.
const BITS: usize = 12;

/// Writes rows of changes of single bits; `reversed` has other id codes and another order at each time.
fn text_of_bits(rows: &[Vec<(usize, char)>], reversed: bool) -> String {
    let id = |at: usize| {
        let at = if reversed { BITS - at } else { at };
        format!("{}{}", char::from(b'!' + at as u8), &["", "~", "a!"][at % 3])
    };
    let mut text = format!(
        "$timescale 1ns $end\n$scope module t $end\n$var wire 1 {} clk $end\n",
        id(BITS)
    );
    for at in 0..BITS {
        let _ = writeln!(text, "$var wire 1 {} s{at} $end", id(at));
    }
    let _ = write!(text, "$upscope $end\n$enddefinitions $end\n#0\n0{}\n", id(BITS));
    for (clock, row) in rows.iter().enumerate() {
        let mut lines: Vec<String> = row.iter().map(|(at, digit)| format!("{digit}{}\n", id(*at))).collect();
        lines.push(format!("1{}\n", id(BITS)));
        if reversed {
            lines.reverse();
        }
        let _ = write!(
            text,
            "#{}\n{}#{}\n0{}\n",
            10 * clock + 5,
            lines.concat(),
            10 * clock + 10,
            id(BITS)
        );
    }
    text
}

/// Returns how many samples differ of each signal, computed a signal and a sample at a time.
fn counted(rows: [&[Vec<(usize, char)>]; 2]) -> Vec<(String, u64)> {
    let mut values = [['x'; BITS]; 2];
    let mut counts = [0; BITS];
    for clock in 0..rows[0].len() {
        for (at, count) in counts.iter_mut().enumerate() {
            *count += u64::from(values[0][at] != values[1][at]);
        }
        for (values, rows) in values.iter_mut().zip(rows) {
            for (at, digit) in &rows[clock] {
                values[*at] = *digit;
            }
        }
    }
    let named = counts.iter().enumerate().filter(|(_, count)| **count > 0);
    named.map(|(at, count)| (format!("t.s{at}"), *count)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn prop_counts_of_single_bits_match_a_signal_by_signal_count(
        rows in prop::collection::vec(prop::collection::btree_map(0..BITS, prop::sample::select(vec!['0', '1', 'x']), 0..8), 1..60),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..BITS, prop::sample::select(vec!['0', '1', 'x'])), 0..4),
        reversed: bool,
    ) {
        let rows: Vec<Vec<(usize, char)>> = rows.into_iter().map(|row| row.into_iter().collect()).collect();
        let mut other = rows.clone();
        for (row, signal, digit) in edits {
            let row = &mut other[row.index(rows.len())];
            row.retain(|(at, _)| *at != signal);
            row.push((signal, digit));
        }
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a.vcd", "b.vcd"].map(|name| folder.path().join(name));
        std::fs::write(&a, text_of_bits(&rows, false)).unwrap();
        std::fs::write(&b, text_of_bits(&other, reversed)).unwrap();
        for [first, second] in [[&a, &b], [&b, &a]] {
            let result = compare_by(first, second, &DiffOptions::default(), &mut |_| {}, false).unwrap();
            let mut found: Vec<_> = result.differences.iter().map(|found| (found.signal.clone(), found.count)).collect();
            let mut expected = counted([&rows, &other]);
            found.sort();
            expected.sort();
            prop_assert_eq!(found, expected);
        }
    }
}
