//! What is said beside the verdict: the files that show a difference, numbers that are rounded, and what no sample sees.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict};

use crate::support::PlainFiles;

struct Files {
    folder: tempfile::TempDir,
}

impl Files {
    fn new(a: &str, b: &str) -> Self {
        let files = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        std::fs::write(files.at("a.vcd"), a).unwrap();
        std::fs::write(files.at("b.vcd"), b).unwrap();
        files
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn compare(&self, options: &DiffOptions) -> Comparison {
        diff::compare(&self.at("a.vcd"), &self.at("b.vcd"), options, &mut |_| {}).unwrap()
    }

    /// Returns the values of the merged file by name, each with its time, as another reader sees them.
    fn merged(&self, comparison: &Comparison) -> BTreeMap<String, Vec<(u64, String)>> {
        let path = self.at("merged.vcd");
        diff::merged(&PlainFiles, &path, &self.at("a.vcd"), &self.at("b.vcd"), comparison).unwrap();
        let mut wave = wellen::simple::read(&path).unwrap();
        let hierarchy = wave.hierarchy();
        let vars = hierarchy.all_vars();
        let vars: Vec<_> = vars
            .map(|var| (hierarchy[var].full_name(hierarchy), hierarchy[var].signal_ref()))
            .collect();
        let signals: Vec<_> = vars.iter().map(|(_, signal)| *signal).collect();
        wave.load_signals(&signals);
        let times = wave.time_table();
        let changes = vars.iter().map(|(name, signal)| {
            let changes = wave.get_signal(*signal).unwrap().iter_changes();
            let changes = changes.map(|(at, value)| (times[at as usize], value.to_string()));
            (name.clone(), changes.collect())
        });
        changes.collect()
    }
}

fn vcd(variables: &str, changes: &str) -> String {
    format!("$timescale 1ns $end\n$scope module t $end\n{variables}\n$upscope $end\n$enddefinitions $end\n{changes}\n")
}

fn raw() -> DiffOptions {
    DiffOptions {
        raw: true,
        ..DiffOptions::default()
    }
}

fn last(values: &[(u64, String)], time: u64) -> Option<&str> {
    let found = values.iter().rfind(|(at, _)| *at <= time)?;
    Some(&found.1)
}

#[test]
fn a_merged_file_has_text_and_vectors_that_were_put_together() {
    let whole = vcd(
        "$var wire 4 ! v [3:0] $end\n$var string 1 s s $end\n$var wire 1 e en $end",
        "#0\nb0110 !\nsidle s\n0e\n#5\nb1110 !\n1e\n#7\nsrun s\n#9\n0e",
    );
    let bits = vcd(
        "$var wire 1 a v [0] $end\n$var wire 1 b v [1] $end\n$var wire 1 c v [2] $end\n$var wire 1 d v [3] $end\n\
         $var string 1 s s $end\n$var wire 1 e en $end",
        "#0\n0a\n1b\n1c\n0d\nsidle s\n0e\n#5\n1d\n0c\n1e\n#7\nsstop s\n#9\n0e",
    );
    for [a, b] in [[&whole, &bits], [&bits, &whole]] {
        let files = Files::new(a, b);
        let comparison = files.compare(&raw());
        let found: Vec<(&str, u64)> = comparison
            .differences
            .iter()
            .map(|found| (found.signal.as_str(), (found.time * 1e9).round() as u64))
            .collect();
        assert_eq!(found, [("t.v", 5), ("t.s", 7)], "{comparison}");
        let merged = files.merged(&comparison);
        let value =
            |name: &str, time: u64| last(merged.get(name).unwrap_or_else(|| panic!("{name}: {merged:?}")), time);
        let [of_whole, of_bits] = if std::ptr::eq(a, &whole) {
            ["a", "b"]
        } else {
            ["b", "a"]
        };
        for (time, whole, bits) in [(0, "0110", "0110"), (5, "1110", "1010")] {
            assert_eq!(value(&format!("{of_whole}.v"), time), Some(whole), "{merged:?}");
            assert_eq!(value(&format!("{of_bits}.v"), time), Some(bits), "{merged:?}");
        }
        for (time, whole, bits) in [(0, "idle", "idle"), (7, "run", "stop")] {
            assert_eq!(value(&format!("{of_whole}.s"), time), Some(whole), "{merged:?}");
            assert_eq!(value(&format!("{of_bits}.s"), time), Some(bits), "{merged:?}");
        }
        assert!(
            !diff::html(&files.at("a.vcd"), &files.at("b.vcd"), &comparison)
                .unwrap()
                .is_empty()
        );
        assert!(
            diff::show(
                &PlainFiles,
                &files.at("show"),
                &files.at("a.vcd"),
                &files.at("b.vcd"),
                &comparison
            )
            .unwrap()
        );
        let shown = std::fs::read_to_string(files.at("show.vcd")).unwrap();
        assert!(shown.contains("b1110 ") && shown.contains("b1010 "), "{shown}");
        assert!(shown.contains("srun ") && shown.contains("sstop "), "{shown}");
    }
}

#[test]
fn a_selection_of_signals_gives_the_same_result_as_all() {
    // The signals that are left out come first, and have values of any kind.
    let others =
        "$var wire 4 0 x0 [3:0] $end\n$var real 64 1 x1 $end\n$var string 1 2 x2 $end\n$var event 1 3 x3 $end\n";
    let before = "#0\nb0101 0\nr1.5 1\nsa 2\n13\n";
    let a = vcd(
        &format!("{others}$var wire 4 ! v [3:0] $end\n$var real 64 s state $end"),
        &format!("{before}b0110 !\nsidle s\n#3\nb0 0\nr2 1\nsb 2\n13\n#5\nb1110 !\nsrun s\n#9\nb0 !"),
    );
    let bits: String = (0..4)
        .map(|bit| format!("$var wire 1 v{bit} v [{bit}] $end\n"))
        .collect();
    let b = vcd(
        &format!("{others}{bits}$var real 64 s state $end"),
        &format!("{before}0v0\n1v1\n1v2\n0v3\nsidle s\n#5\n1v3\n0v2\nsstop s\n#9\n0v1\n0v3"),
    );
    let files = Files::new(&a, &b);
    for only in [&["t.v", "t.state"][..], &["**.v", "**.state"], &["t"]] {
        let mut options = raw();
        options.only = only.iter().map(|only| (*only).to_owned()).collect();
        options.ignore = vec!["**.x?".to_owned()];
        let comparison = files.compare(&options);
        let found: Vec<(&str, f64)> = comparison
            .differences
            .iter()
            .map(|found| (found.signal.as_str(), found.time))
            .collect();
        assert_eq!(found, [("t.state", 5e-9), ("t.v", 5e-9)], "{comparison}");
        assert_eq!(comparison.signals, 2, "{comparison}");
        let merged = files.merged(&comparison);
        for (name, value) in [
            ("a.v", "1110"),
            ("b.v", "1010"),
            ("a.state", "run"),
            ("b.state", "stop"),
            ("a.x0", "0000"),
            ("b.x0", "0101"),
        ] {
            assert_eq!(last(&merged[name], 5), Some(value), "{name}: {merged:?}");
        }
    }
}

#[test]
fn a_merged_file_ends_where_the_comparison_ended() {
    let variables = "$var wire 4 ! v $end";
    let a = vcd(variables, "#0\nb0001 !\n#5\nb0010 !\n#9\nb0011 !\n#11");
    // Without its line break, the last line counts.
    let whole_line = a[..a.find("#9").unwrap()].to_owned() + "#9\nb1011 !";
    let files = Files::new(&a, &whole_line);
    let comparison = files.compare(&raw());
    assert_eq!(comparison.result, DiffVerdict::Different);
    assert_eq!(last(&files.merged(&comparison)["b.v"], 20), Some("1011"));
    // Cut off in a line, what was not compared is not shown, though it may look like a whole line.
    for end in ["b1111 !\nb11", "b1111 !"] {
        let cut = a[..a.find("#5").unwrap()].to_owned() + "#5\nb1010 !\n#9\n" + end;
        let files = Files::new(&a, &cut);
        let options = DiffOptions {
            allow_truncated: true,
            ..raw()
        };
        let comparison = files.compare(&options);
        assert_eq!(comparison.differences[0].time, 5e-9, "{comparison}");
        assert_eq!(last(&files.merged(&comparison)["b.v"], 20), Some("1010"), "{end}");
    }
}

/// Writes an FST of a real number `r` in `t`, which is 1 at 0 and then `number`.
fn write_real(path: &Path, number: f64) {
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
    let kind = FstSignalType::real();
    let r = head
        .var("r", kind, FstVarType::Real, FstVarDirection::Implicit, None)
        .unwrap();
    head.up_scope().unwrap();
    let mut body = head.finish().unwrap();
    for (time, number) in [(0, 1.0), (5, number)] {
        body.time_change(time).unwrap();
        body.signal_change(r, &f64::to_le_bytes(number)).unwrap();
    }
    body.finish().unwrap();
}

#[test]
fn golden_a_number_of_a_vcd_is_that_of_an_fst_to_16_digits() {
    // What C's `%.16g` prints of 0.1 + 0.2, of the number after it, and of the circle's.
    for (written, number, is_equal, exact) in [
        ("0.3", 0.1 + 0.2, true, false),
        ("0.3", 0.300_000_000_000_000_1, false, false),
        ("0.3000000000000001", 0.300_000_000_000_000_1, true, true),
        ("3.141592653589793", std::f64::consts::PI, true, true),
        ("2.718281828459046", std::f64::consts::E, false, false),
    ] {
        let files = Files::new(
            &vcd("$var real 64 ! r $end", &format!("#0\nr1 !\n#5\nr{written} !")),
            "",
        );
        let fst = files.at("b.fst");
        write_real(&fst, number);
        for [a, b] in [[files.at("a.vcd"), fst.clone()], [fst.clone(), files.at("a.vcd")]] {
            let result = diff::compare(&a, &b, &raw(), &mut |_| {}).unwrap();
            let verdict = if is_equal {
                DiffVerdict::Equal
            } else {
                DiffVerdict::Different
            };
            assert_eq!(result.result, verdict, "{written} {number}: {result}");
            assert!(!is_equal || result.exact == exact, "{written} {number}: {result}");
            let text = result.to_string();
            assert_eq!(text.contains("equal to 16 digits"), is_equal && !exact, "{text}");
            assert!(
                is_equal || text.contains("--tolerance"),
                "the tolerance that helps: {text}"
            );
        }
        // Two files of the same kind have no such rule.
        let other = files.at("other.vcd");
        std::fs::write(
            &other,
            vcd("$var real 64 ! r $end", &format!("#0\nr1 !\n#5\nr{number:?} !")),
        )
        .unwrap();
        let result = diff::compare(&files.at("a.vcd"), &other, &raw(), &mut |_| {}).unwrap();
        assert_eq!(
            result.result == DiffVerdict::Equal,
            exact,
            "{written} {number}: {result}"
        );
    }
}

/// Returns a file with edges at 5, 15 … ns, and these changes between them.
fn clocked(changes: &[(u64, &str)]) -> String {
    let mut at: BTreeMap<u64, String> = BTreeMap::new();
    for edge in 0..4 {
        *at.entry(10 * edge + 5).or_default() += "1!\n";
        *at.entry(10 * edge + 10).or_default() += "0!\n";
    }
    *at.entry(0).or_default() += "0!\n0y\nb0 w\n";
    for (time, change) in changes {
        *at.entry(*time).or_default() += &format!("{change}\n");
    }
    let text: String = at.iter().map(|(time, text)| format!("#{time}\n{text}")).collect();
    vcd(
        "$var wire 1 ! clk $end\n$var wire 1 y y $end\n$var wire 8 w w $end",
        &text,
    )
}

#[test]
fn changes_between_samples_are_counted_by_signal() {
    // By hand: the values that others replace before the next edge, of both files.
    for (a, b, changes, signals) in [
        (&[(7, "1y")][..], &[(7, "1y")][..], 0, &[][..]),
        (&[(7, "1y")], &[(12, "1y")], 0, &[]),
        (&[(6, "1y"), (7, "0y"), (8, "1y")], &[(8, "1y")], 2, &["t.y"]),
        // At the clock's falling edge, too, and in the second file alone.
        (&[(8, "b11 w")], &[(7, "b10 w"), (10, "b11 w")], 1, &["t.w"]),
        // Twice at one time, and in the order of the file or not.
        (&[(6, "b1 w\nb10 w\n1y")], &[(6, "1y\nb10 w")], 1, &["t.w"]),
        (
            &[(6, "1y\nb1 w"), (7, "b10 w\n0y")],
            &[(7, "b10 w")],
            2,
            &["t.w", "t.y"],
        ),
        // What is written again is no change.
        (&[(6, "1y"), (7, "1y"), (8, "1y")], &[(8, "1y")], 0, &[]),
        (&[(6, "0y"), (7, "0y\n0y"), (8, "b0 w")], &[], 0, &[]),
        (&[(6, "1y"), (7, "1y"), (8, "0y"), (9, "0y")], &[(6, "0y")], 1, &["t.y"]),
        // Around an edge, each is sampled.
        (&[(14, "1y"), (16, "0y")], &[(13, "1y"), (15, "0y")], 0, &[]),
    ] {
        let files = Files::new(&clocked(a), &clocked(b));
        let comparison = files.compare(&DiffOptions::default());
        assert_eq!(comparison.result, DiffVerdict::Equal, "{a:?} {b:?}: {comparison}");
        let (counted, mut named) = match &comparison.unsampled {
            Some(unsampled) => (unsampled.changes, unsampled.signals.clone()),
            None => (0, Vec::new()),
        };
        named.sort();
        assert_eq!(
            (counted, named),
            (changes, signals.iter().map(|name| (*name).to_owned()).collect()),
            "{a:?} {b:?}: {comparison}"
        );
        let said = format!("{changes} change");
        assert_eq!(comparison.to_string().contains(&said), changes > 0, "{comparison}");
    }
    // With --raw, they are compared.
    let files = Files::new(&clocked(&[(6, "1y"), (7, "0y"), (8, "1y")]), &clocked(&[(8, "1y")]));
    assert_eq!(files.compare(&raw()).result, DiffVerdict::Different);
}

#[test]
fn changes_and_differences_after_the_last_edge_are_named() {
    let files = Files::new(&clocked(&[(36, "1y"), (37, "b1 w")]), &clocked(&[(37, "b1 w")]));
    let comparison = files.compare(&DiffOptions::default());
    assert_eq!(comparison.result, DiffVerdict::Equal, "{comparison}");
    let unsampled = comparison.unsampled.as_ref().unwrap();
    assert_eq!(unsampled.changes_after, 3, "{comparison}");
    assert_eq!(unsampled.differ_after, ["t.y"], "{comparison}");
    assert!(
        comparison.to_string().contains("1 signal differs there, t.y"),
        "{comparison}"
    );
    // Each change of value counts there, at the edge's own time too; what is written again does not.
    for (a, b, changes, signals, differ) in [
        (
            &[(36, "1y"), (37, "0y"), (38, "0y")][..],
            &[][..],
            2,
            &["t.y"][..],
            &[][..],
        ),
        (
            &[(35, "1y"), (37, "0y"), (38, "1y")],
            &[(36, "1y\n1y")],
            4,
            &["t.y"],
            &[],
        ),
        (
            &[(36, "b1 w\nb1 w"), (37, "0y")],
            &[(36, "b0 w")],
            1,
            &["t.w"],
            &["t.w"],
        ),
        (&[(36, "0y\nb0 w"), (38, "0y")], &[(40, "0y")], 0, &[], &[]),
    ] {
        let comparison = Files::new(&clocked(a), &clocked(b)).compare(&DiffOptions::default());
        assert_eq!(comparison.result, DiffVerdict::Equal, "{a:?} {b:?}: {comparison}");
        let unsampled = comparison.unsampled.clone().unwrap_or_default();
        assert_eq!(
            (unsampled.changes, unsampled.changes_after),
            (0, changes),
            "{a:?} {b:?}: {comparison}"
        );
        assert_eq!(unsampled.signals_after, signals, "{a:?} {b:?}: {comparison}");
        assert_eq!(unsampled.differ_after, differ, "{a:?} {b:?}: {comparison}");
    }
}

#[test]
fn without_a_clock_values_replaced_at_the_same_time_are_counted() {
    let file = |changes: &str| {
        vcd(
            "$var wire 1 y y $end\n$var wire 8 w w $end",
            &format!("#0\n0y\nb0 w\n{changes}"),
        )
    };
    let files = Files::new(&file("#5\n1y\n0y\n1y\nb1 w"), &file("#5\n1y\nb1 w"));
    let comparison = files.compare(&raw());
    assert_eq!(comparison.result, DiffVerdict::Equal, "{comparison}");
    let unsampled = comparison.unsampled.as_ref().unwrap();
    assert_eq!(
        (unsampled.changes, unsampled.signals.clone()),
        (2, vec!["t.y".to_owned()]),
        "{comparison}"
    );
    assert!(!unsampled.between_edges);
    // What is written again, at the same time or later, is no change.
    let files = Files::new(&file("#5\n1y\n1y\nb1 w\n#7\n1y\nb1 w\nb1 w"), &file("#5\n1y\nb1 w"));
    let comparison = files.compare(&raw());
    assert_eq!(comparison.result, DiffVerdict::Equal, "{comparison}");
    assert_eq!(comparison.unsampled, None, "{comparison}");
}
