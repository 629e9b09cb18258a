//! Recordings as simulators write them: the name of each in `fixtures/recordings` says how it compares with the one that
//! has its first name, and what is right follows from the formats, not from our reader.

use std::path::{Path, PathBuf};

use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict, Shown};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/recordings")
}

fn compare(a: &Path, b: &Path, options: &DiffOptions) -> Comparison {
    diff::compare(a, b, options, &mut |_| {}).unwrap_or_else(|error| panic!("{error}"))
}

/// Compares two texts, and the other way round, which must say the same.
fn compare_texts(a: &str, b: &str) -> Comparison {
    let folder = tempfile::tempdir().unwrap();
    let [a_path, b_path] = ["a.vcd", "b.vcd"].map(|name| folder.path().join(name));
    std::fs::write(&a_path, a).unwrap();
    std::fs::write(&b_path, b).unwrap();
    let one_way = compare(&a_path, &b_path, &DiffOptions::default());
    let other_way = compare(&b_path, &a_path, &DiffOptions::default());
    assert_eq!(
        (one_way.result, one_way.exact, one_way.differences.len()),
        (other_way.result, other_way.exact, other_way.differences.len()),
        "{one_way}\n{other_way}"
    );
    one_way
}

/// Returns a VCD with these declarations in the scope `t`, and these changes.
fn vcd(variables: &str, changes: &str) -> String {
    format!("$timescale 1ns $end\n$scope module t $end\n{variables}\n$upscope $end\n$enddefinitions $end\n{changes}\n")
}

#[test]
fn golden_recordings_compare_as_their_names_say() {
    let mut compared = 0;
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let words: Vec<&str> = name.split('.').collect();
        let (other, expected) = match words[..] {
            [_, "read", _] => (path.clone(), DiffVerdict::Equal),
            [first, .., "different", _] => (folder().join(format!("{first}.vcd")), DiffVerdict::Different),
            [first, .., "equal" | "collapsed", _] => (folder().join(format!("{first}.vcd")), DiffVerdict::Equal),
            _ => continue,
        };
        for (a, b) in [(&path, &other), (&other, &path)] {
            let result = compare(a, b, &DiffOptions::default());
            assert_eq!(result.result, expected, "{name}: {result}");
            assert!(result.signals > 0 && result.samples > 0, "{name}: {result}");
            if name.contains("collapsed") {
                assert_eq!((result.exact, result.collapsed.len()), (false, 1), "{name}: {result}");
            }
        }
        let itself = compare(&path, &path, &DiffOptions::default());
        assert_eq!(
            (itself.result, itself.exact),
            (DiffVerdict::Equal, true),
            "{name}: {itself}"
        );
        compared += 1;
    }
    assert_eq!(compared, 15);
}

#[test]
fn golden_values_of_an_undeclared_kind_are_compared_by_their_actual_kind() {
    for (declared, values) in [
        // MyHDL: enumerations and numbers on real numbers.
        ("real 1", ["sidle", "srun"]),
        ("real 1", ["s0.75", "s0.875"]),
        ("real 64", ["r1.5", "sidle"]),
        ("real 64", ["b101", "b111"]),
        // Text on a wire, as producers of enumerations write it.
        ("wire 8", ["sIDLE", "sRUN"]),
        ("wire 1", ["sidle", "srun"]),
        ("wire 64", ["sidle", "srun"]),
        ("wire 100", ["sidle", "srun"]),
        ("wire 8", ["sIDLE", "b11"]),
        ("wire 8", ["r1.5", "r2.5"]),
        // Digits on a text.
        ("string 1", ["b0101", "b0111"]),
        ("string 1", ["r1.5", "r2.5"]),
        ("string 1", ["s007", "s7"]),
        // Words that are wider than declared.
        ("wire 4", ["b10101", "b10111"]),
        ("wire 4", ["b10101", "b00101"]),
    ] {
        let [first, second] = values;
        let file = |value: &str| {
            let variables = format!("$var wire 1 ! en $end\n$var {declared} \" v $end");
            // The value differs from 5 on.
            vcd(&variables, &format!("#0\n0!\n{first} \"\n#5\n1!\n{value} \"\n#9\n0!"))
        };
        let same = compare_texts(&file(second), &file(second));
        assert_eq!(
            (same.result, same.exact),
            (DiffVerdict::Equal, true),
            "{declared} {values:?}: {same}"
        );
        let other = compare_texts(&file(first), &file(second));
        assert_eq!(other.result, DiffVerdict::Different, "{declared} {values:?}: {other}");
        assert_eq!(
            (other.differences[0].signal.as_str(), other.differences[0].time),
            ("t.v", 5e-9),
            "{declared} {values:?}: {other}"
        );
    }
}

#[test]
fn golden_one_number_is_equal_however_it_is_written() {
    let file = |declared: &str, value: &str| {
        let variables = format!("$var wire 1 ! en $end\n$var {declared} \" v $end");
        vcd(&variables, &format!("#0\n0!\n{value} \"\n#5\n1!\n{value} \"\n#9\n0!"))
    };
    for (declared, a, b) in [
        ("real 64", "r0.75", "s0.75"),
        ("real 64", "r1,5", "r1.50"),
        ("real 64", "rNaN", "rnan(0x8000)"),
        ("wire 8", "b00000101", "b101"),
        ("wire 8", "bx", "bxxxxxxxx"),
        ("wire 8", "bxxxxxxxxxxxxxxxx", "bX"),
        ("wire 8", "bz1", "bzzzzzzz1"),
        ("wire 8", "b0b101", "B101"),
        (
            "wire 40",
            "b0000000000000000000000000000000000000000000000000000000000000111",
            "b111",
        ),
        ("string 1", r"sa\040b", "sa b"),
        ("string 1", r"s\x41", "sA"),
    ] {
        let result = compare_texts(&file(declared, a), &file(declared, b));
        assert_eq!(result.result, DiffVerdict::Equal, "{declared}: {a} {b}: {result}");
    }
}

/// Returns the declarations of single bits with these indices, and a file that gives them the digits of `words`, by index
/// from `first` on.
fn in_bits(indices: &[i64], name: impl Fn(i64) -> String, words: [u32; 2]) -> String {
    let id = |index: i64| format!("i{}", index + 50);
    let variables: Vec<String> = indices
        .iter()
        .map(|index| format!("$var wire 1 {} {} $end", id(*index), name(*index)))
        .collect();
    let changes = |word: u32| -> String {
        let bit = |index: &i64| word >> (index + 8) & 1;
        indices
            .iter()
            .map(|index| format!("{}{}\n", bit(index), id(*index)))
            .collect()
    };
    vcd(
        &variables.join("\n"),
        &format!("#0\n{}#5\n{}#9", changes(words[0]), changes(words[1])),
    )
}

/// Returns a file that has a vector with the digits of `words` as a whole; bit k of a word is index k − 8.
fn as_a_whole(left: i64, right: i64, words: [u32; 2]) -> String {
    let width = left.abs_diff(right) + 1;
    let digits = |word: u32| -> String {
        let step = if left >= right { -1 } else { 1 };
        let indices = (0..width as i64).map(|at| left + step * at);
        indices
            .map(|index| if word >> (index + 8) & 1 == 1 { '1' } else { '0' })
            .collect()
    };
    vcd(
        &format!("$var wire {width} ! v [{left}:{right}] $end"),
        &format!("#0\nb{} !\n#5\nb{} !\n#9", digits(words[0]), digits(words[1])),
    )
}

#[test]
fn golden_bits_of_a_vector_meet_by_their_index() {
    let names: [fn(i64) -> String; 5] = [
        |index| format!("v [{index}]"),
        |index| format!("v[{index}]"),
        |index| format!("\\v[{index}]"),
        |index| format!("v({index})"),
        |index| format!("v [{index}:{index}]"),
    ];
    // Every single bit that differs is found at its index, and nothing else.
    for (left, right) in [(3, 0), (0, 3), (7, 4), (4, 7), (-1, -4), (-4, -1), (2, -3), (-3, 2)] {
        let names = if (left, right) == (0, 3) {
            &names[..]
        } else {
            &names[..1]
        };
        for name in names {
            let (low, high) = (left.min(right), left.max(right));
            let all: Vec<i64> = (low..=high).collect();
            let reversed: Vec<i64> = all.iter().rev().copied().collect();
            let before = 0b0101_1010_0110_1001;
            let whole = as_a_whole(left, right, [before, !before]);
            for order in [&all, &reversed] {
                let same = compare_texts(&whole, &in_bits(order, name, [before, !before]));
                assert_eq!(
                    (same.result, same.signals, same.exact),
                    (DiffVerdict::Equal, 1, true),
                    "{same}"
                );
                for index in &all {
                    let wrong = in_bits(order, name, [before, !before ^ 1 << (index + 8)]);
                    let found = compare_texts(&whole, &wrong);
                    assert_eq!(
                        found.result,
                        DiffVerdict::Different,
                        "[{left}:{right}] {index}: {found}"
                    );
                    let [Shown::Bits(a), Shown::Bits(b)] = [&found.differences[0].a, &found.differences[0].b] else {
                        panic!("{found}");
                    };
                    let at = a.bytes().zip(b.bytes()).position(|(a, b)| a != b).unwrap() as u64;
                    assert_eq!(at, index.abs_diff(left), "[{left}:{right}] {index}: {found}");
                    assert_eq!(found.differences[0].time, 5e-9);
                }
            }
            // Some bits are missing.
            let some: Vec<i64> = all[1..all.len() - 1].to_vec();
            let part = compare_texts(&in_bits(&some, name, [before, !before]), &whole);
            assert_eq!(
                (part.result, part.only_in_b.len()),
                (DiffVerdict::Equal, 2),
                "[{left}:{right}]: {part}"
            );
            assert!(part.only_in_a.is_empty(), "{part}");
            let wrong = in_bits(&some, name, [before, !before ^ 1 << (some[0] + 8)]);
            let found = compare_texts(&wrong, &whole);
            assert_eq!(found.differences.len(), 1, "[{left}:{right}]: {found}");
            assert!(
                found.differences[0].signal.contains(&some[0].to_string()),
                "[{left}:{right}] {some:?}: {found}"
            );
            // A bit that is missing may be anything.
            let outside = as_a_whole(left, right, [before, !before ^ 1 << (high + 8)]);
            let part = compare_texts(&in_bits(&some, name, [before, !before]), &outside);
            assert_eq!(part.result, DiffVerdict::Equal, "{part}");
        }
    }
}

#[test]
fn golden_parts_of_different_length_meet_by_their_index() {
    let file = |parts: &[(&str, &str)], scope: &str| {
        let variables: String = parts
            .iter()
            .zip(0..)
            .map(|((range, digits), at)| format!("$var wire {} i{at} v{range} $end\n", digits.len()))
            .collect();
        let changes: String = parts
            .iter()
            .zip(0..)
            .map(|((_, digits), at)| format!("b{digits} i{at}\n"))
            .collect();
        vcd(
            &format!("$scope begin {scope} $end\n{variables}$upscope $end"),
            &format!("#0\n{changes}#9"),
        )
    };
    let whole = file(&[("[5:0]", "101100")], "g[0]");
    for parts in [
        &[("[5:3]", "101"), ("[2:0]", "100")][..],
        &[("[1:0]", "00"), ("[5:2]", "1011")],
        &[("[5]", "1"), ("[4:1]", "0110"), ("[0]", "0")],
        // The other way round within a part.
        &[("[3:5]", "101"), ("[0:2]", "001")],
    ] {
        for scope in ["g[0]", "g(0)"] {
            let result = compare_texts(&whole, &file(parts, scope));
            assert_eq!(
                (result.result, result.signals),
                (DiffVerdict::Equal, 1),
                "{parts:?}: {result}"
            );
            assert!(result.only_in_a.is_empty() && result.only_in_b.is_empty(), "{result}");
        }
        for other in [
            &[("[5:3]", "101"), ("[2]", "1"), ("[1:0]", "00")][..],
            &[("[5:4]", "10"), ("[3:0]", "1100")],
        ] {
            let result = compare_texts(&file(parts, "g[0]"), &file(other, "g[0]"));
            assert_eq!(result.result, DiffVerdict::Equal, "{parts:?} {other:?}: {result}");
            assert!(result.only_in_a.is_empty() && result.only_in_b.is_empty(), "{result}");
        }
    }
    let wrong = file(&[("[5:3]", "101"), ("[2:0]", "101")], "g[0]");
    assert_eq!(compare_texts(&whole, &wrong).result, DiffVerdict::Different);
    // One part alone is not the whole with zeros before it.
    let result = compare_texts(&file(&[("[5:2]", "1011")], "g[0]"), &whole);
    assert_eq!(
        (result.result, result.only_in_b.len()),
        (DiffVerdict::Equal, 1),
        "{result}"
    );
    let result = compare_texts(&file(&[("[5:2]", "1010")], "g[0]"), &whole);
    assert_eq!(result.result, DiffVerdict::Different, "{result}");
    let shifted = file(&[("[5:2]", "1100")], "g[0]");
    assert_eq!(compare_texts(&shifted, &whole).result, DiffVerdict::Different);
}

/// Returns a VCD of a vector `v` in these parts, with the digits of `values`, the highest index first, at 0 and at 5.
fn in_parts(parts: &[(i64, i64)], values: [&str; 2]) -> String {
    let width = |(left, right): (i64, i64)| left.abs_diff(right) + 1;
    let variables: String = (0..)
        .zip(parts)
        .map(|(at, &(left, right))| format!("$var wire {} i{at} v [{left}:{right}] $end\n", width((left, right))))
        .collect();
    let changes = values.map(|digits| {
        let digit = |index: i64| char::from(digits.as_bytes()[digits.len() - 1 - index as usize]);
        let part = |(at, &(left, right)): (usize, &(i64, i64))| {
            let all: String = if left < right {
                (left..=right).map(digit).collect()
            } else {
                (right..=left).rev().map(digit).collect()
            };
            format!("b{all} i{at}\n")
        };
        parts.iter().enumerate().map(part).collect::<String>()
    });
    vcd(&variables, &format!("#0\n{}#5\n{}#9", changes[0], changes[1]))
}

#[test]
fn golden_a_bit_is_reported_once_however_both_files_are_cut() {
    let cuts: [&[(i64, i64)]; 8] = [
        &[(3, 1), (0, 0)],
        &[(3, 3), (2, 2), (1, 1), (0, 0)],
        &[(0, 0), (3, 1)],
        &[(1, 1), (3, 3), (0, 0), (2, 2)],
        &[(3, 2), (1, 0)],
        &[(3, 2), (1, 1), (0, 0)],
        &[(0, 1), (2, 3)],
        &[(2, 2), (0, 1), (3, 3)],
    ];
    for (one, other) in cuts.iter().flat_map(|one| cuts.iter().map(move |other| (one, other))) {
        let right = in_parts(one, ["0110", "1010"]);
        let result = compare_texts(&right, &in_parts(other, ["0110", "1010"]));
        assert_eq!(result.result, DiffVerdict::Equal, "{one:?} {other:?}: {result}");
        assert!(result.only_in_a.is_empty() && result.only_in_b.is_empty(), "{result}");
        for wrong in ["1011", "1000", "1110", "0010"] {
            let found = compare_texts(&right, &in_parts(other, ["0110", wrong]));
            let times: Vec<(f64, u64)> = found
                .differences
                .iter()
                .map(|found| (found.time, found.count))
                .collect();
            assert_eq!(times, [(5e-9, 1)], "{one:?} {other:?} {wrong}: {found}");
        }
    }
    // Bits that only one file has leave the others as they are.
    for (one, other) in [
        (&[(0, 1), (2, 3)][..], &[(0, 1), (2, 2)][..]),
        (&[(3, 1), (0, 0)], &[(0, 0), (1, 1)]),
        (&[(1, 0), (3, 2)], &[(1, 0), (2, 2)]),
    ] {
        let right = in_parts(one, ["0110", "1010"]);
        for wrong in ["1011", "1000"] {
            let found = compare_texts(&right, &in_parts(other, ["0110", wrong]));
            assert_eq!(found.differences.len(), 1, "{one:?} {other:?} {wrong}: {found}");
        }
    }
    // Another name of the same bit is a signal of its own.
    let named =
        |text: String, of: usize| text.replacen("$upscope", &format!("$var wire 1 i{of} other $end\n$upscope"), 1);
    let found = compare_texts(
        &named(in_parts(cuts[0], ["0110", "1010"]), 1),
        &named(in_parts(cuts[1], ["0110", "1011"]), 3),
    );
    let mut names: Vec<&str> = found.differences.iter().map(|found| found.signal.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["t.other", "t.v"], "{found}");
}

#[test]
fn golden_a_vector_without_a_range_meets_its_bits_with_a_note() {
    let whole = vcd("$var wire 4 ! v $end", "#0\nb0001 !\n#9");
    let bits = in_bits(&[0, 1, 2, 3], |index| format!("v [{index}]"), [1 << 8; 2]);
    let result = compare_texts(&whole, &bits);
    assert_eq!((result.result, result.exact), (DiffVerdict::Equal, false), "{result}");
    assert!(
        result.to_string().contains("lowest index is taken for the last digit"),
        "{result}"
    );
}

#[test]
fn golden_states_of_vhdl_are_equal_only_by_a_rule_that_is_printed() {
    let file = |digits: &str| {
        vcd(
            "$var wire 4 ! v $end\n$var wire 1 # b $end",
            &format!("#0\nb{digits} !\n{}#\n#5\nb1 !\n0#\n#9", &digits[..1]),
        )
    };
    for (a, b) in [
        ("UUUU", "xxxx"),
        ("1L0H", "1001"),
        ("-01W", "x01x"),
        ("HHHH", "1111"),
        ("UUUU", "WWWW"),
    ] {
        let result = compare_texts(&file(a), &file(b));
        assert_eq!(
            (result.result, result.exact),
            (DiffVerdict::Equal, false),
            "{a} {b}: {result}"
        );
        assert!(result.collapsed.contains(&"t.v".to_owned()), "{result}");
        assert!(result.to_string().starts_with("equal by the rules below"), "{result}");
        let itself = compare_texts(&file(a), &file(a));
        assert_eq!(
            (itself.result, itself.exact),
            (DiffVerdict::Equal, true),
            "{a}: {itself}"
        );
    }
    for (a, b) in [("LLLL", "xxxx"), ("HHHH", "0000"), ("UUUU", "zzzz")] {
        assert_eq!(
            compare_texts(&file(a), &file(b)).result,
            DiffVerdict::Different,
            "{a} {b}"
        );
    }
}

#[test]
fn golden_ports_of_an_extended_vcd_are_read() {
    let file = |value: &str| {
        vcd(
            "$var port [3:0] <0 d $end\n$var port 1 <1 e $end",
            &format!("#0\n$dumpports\npDDDU 6660 0006 <0\npN 6 6 <1\n$end\n#5\n{value} <0\n$vcdclose #9 $end"),
        )
    };
    let word = vcd(
        "$var wire 4 ! d [3:0] $end\n$var wire 1 # e $end",
        "#0\nb0001 !\nx#\n#5\nb1z0x !\n#9",
    );
    let ports = file("pHTL? 0000 6660");
    let result = compare_texts(&ports, &word);
    assert_eq!(
        (result.result, result.exact, result.signals),
        (DiffVerdict::Equal, false, 2),
        "{result}"
    );
    assert!(result.to_string().contains("EVCD"), "{result}");
    let itself = compare_texts(&ports, &ports);
    assert_eq!((itself.result, itself.exact), (DiffVerdict::Equal, true), "{itself}");
    let driven = compare_texts(&ports, &file("pUTL? 0000 6660"));
    assert_eq!((driven.result, driven.exact), (DiffVerdict::Equal, false), "{driven}");
    assert_eq!(
        compare_texts(&ports, &file("pHHL? 0000 6660")).result,
        DiffVerdict::Different
    );
}

#[test]
fn golden_events_are_compared_by_the_times_at_which_they_happen() {
    let file = |changes: &str| vcd("$var wire 1 ! a $end\n$var event 1 # e $end", changes);
    let both = file("#0\n$dumpvars\n0!\n1#\n$end\n#5\n1!\n1#\n#9\n0!\n#12\n1!\n1#\n#15\n0!");
    // Icarus writes an event among the first values, Verilator does not.
    let without_first = both.replacen("1#\n$end", "$end", 1);
    let result = compare_texts(&both, &without_first);
    assert_eq!((result.result, result.signals), (DiffVerdict::Equal, 2), "{result}");
    // The first time may have nothing but events.
    let alone = |changes: &str| {
        vcd(
            "$var event 1 # e $end\n$var wire 1 ! a $end",
            &format!("#0\n1#\n{changes}#9\n1!"),
        )
    };
    assert_eq!(
        compare_texts(&alone("#5\n1#\n"), &alone("#5\n1#\n")).differences.len(),
        0
    );
    let found = compare_texts(&alone("#5\n1#\n"), &alone(""));
    assert_eq!(
        (found.differences.len(), found.differences[0].time),
        (1, 5e-9),
        "{found}"
    );
    let once = both.replacen("#12\n1!\n1#", "#12\n1!", 1);
    let result = compare_texts(&both, &once);
    assert_eq!(result.result, DiffVerdict::Different, "{result}");
    let found = &result.differences[0];
    assert_eq!(
        (found.signal.as_str(), found.time, found.count),
        ("t.e", 1.2e-8, 1),
        "{result}"
    );
    let as_value = both.replace("event 1", "wire 1");
    let result = compare_texts(&both, &as_value);
    assert_eq!(
        (result.result, result.not_compared.as_slice()),
        (DiffVerdict::Incomparable, &["t.e".to_owned()][..])
    );
}

#[test]
fn golden_files_of_every_producer_are_read() {
    let plain = vcd(
        "$var wire 1 ! a $end\n$var wire 4 # v [3:0] $end",
        "#0\n0!\nb0 #\n#5\n1!\nb101 #\n#9\n0!",
    );
    for (from, to, note) in [
        // Treadle, fst2vcd: the block of first values is closed by nothing.
        ("#0\n", "$dumpvars\n#0\n", ""),
        ("#0\n", "#0\n$dumpvars\n", ""),
        ("#5\n", "#5\n$dumpall\n", ""),
        // MyHDL, PyRTL and others.
        (
            "$scope module t $end\n",
            "$scope module t\n$end\n$comment\na\n$end\n",
            "",
        ),
        ("$enddefinitions $end\n", "$enddefinitions\n$end\r\n", ""),
        ("$upscope $end\n", "$unscope $end\n", "`$unscope` is read as `$upscope`"),
        ("$scope module t", "$scope t", "has no type"),
        ("$upscope $end\n", "", "still open"),
        ("$enddefinitions $end\n", "", "without $enddefinitions"),
        ("#5\n", "$somewhat new $end\n#5\n", "`$somewhat` is not known"),
        ("$timescale 1ns $end", "$timescale\n  1 ns\n$end", ""),
        ("$timescale 1ns $end", "$timescale 1 NS $end", ""),
        ("v [3:0]", "v [ 3 : 0 ]", ""),
        ("#9\n0!", "#9 0!", ""),
        ("$var wire 4 #", "$attrbegin misc 02 x 1 $end\n$var logic 4 #", ""),
        ("$var wire 1 ! a $end", "$var wire 0 $ n $end\n$var wire 1 ! a $end", ""),
        ("#9\n0!", "#9\n$comment a text, #5 and b1 # in it $end\n0!", ""),
    ] {
        let other = plain.replacen(from, to, 1);
        assert_ne!(other, plain);
        let result = compare_texts(&plain, &other);
        assert_eq!(
            (result.result, result.signals),
            (DiffVerdict::Equal, 2),
            "{to}: {result}"
        );
        let notes = result.notes.join("\n");
        assert!(notes.contains(note), "{to}: {result}");
    }
    for id in [
        "pc_source_reg",
        "a_very_long_name_as_an_id_code_as_pyrtl_has_it",
        "größe",
        "abcdefghij",
    ] {
        let other = plain
            .replace("4 # v", &format!("4 {id} v"))
            .replace(" #\n", &format!(" {id}\n"));
        assert_eq!(compare_texts(&plain, &other).result, DiffVerdict::Equal, "{id}");
    }
}

#[test]
fn a_file_of_first_values_alone_needs_no_end_of_dumpvars() {
    let file = |values: &str| {
        vcd(
            "$var wire 1 ! a $end\n$var wire 4 # b $end",
            &format!("#0\n$dumpvars\n{values}"),
        )
    };
    let closed = file("1!\nb101 #\n$end");
    let result = compare_texts(&file("1!\nb101 #"), &closed);
    assert_eq!((result.result, result.signals), (DiffVerdict::Equal, 2), "{result}");
    assert_eq!(compare_texts(&file("1!\nb100 #"), &closed).differences.len(), 1);
    // Where a signal has no value, the file may have been cut off.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vcd");
    std::fs::write(&path, file("1!")).unwrap();
    let error = diff::compare(&path, &path, &DiffOptions::default(), &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("inside a $dump block"), "{error}");
}

#[test]
fn a_note_names_a_file_without_signals_or_changes() {
    for (text, reason) in [
        (
            "$timescale 1ns $end\n$enddefinitions $end\n#0\n".to_owned(),
            "declares no signal",
        ),
        (vcd("$var wire 1 ! a $end", "#0"), "has no change"),
    ] {
        let result = compare_texts(&text, &text);
        assert_eq!(result.result, DiffVerdict::Incomparable, "{result}");
        assert!(result.notes.join("\n").contains(reason), "{result}");
    }
}
