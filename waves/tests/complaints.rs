//! What people complain of in other comparers: each of these was reported as equal by some tool.

#[path = "../examples/small_pairs.rs"]
mod small_pairs;

use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict};

use self::small_pairs::{Deserves, small_pairs, vcd};

fn compare(a: &str, b: &str, options: &DiffOptions) -> Comparison {
    let folder = tempfile::tempdir().unwrap();
    let [a_path, b_path] = ["a.vcd", "b.vcd"].map(|name| folder.path().join(name));
    std::fs::write(&a_path, a).unwrap();
    std::fs::write(&b_path, b).unwrap();
    diff::compare(&a_path, &b_path, options, &mut |_| {}).unwrap()
}

#[test]
fn each_small_pair_has_its_verdict() {
    let mut options = DiffOptions::default();
    options.add_tolerance("level=0.001abs").unwrap();
    let mut count = 0;
    for pair in small_pairs() {
        let expected = match pair.deserves {
            Deserves::Equal => DiffVerdict::Equal,
            Deserves::Different => DiffVerdict::Different,
            Deserves::Incomparable => DiffVerdict::Incomparable,
        };
        let [a, b] = &pair.texts;
        for (a, b) in [(a, b), (b, a)] {
            let result = compare(a, b, &options);
            assert_eq!(result.result, expected, "{}: {result}", pair.name);
        }
        count += 1;
    }
    assert_eq!(count, 11);
}

#[test]
fn a_tolerance_for_real_numbers_does_not_hide_a_difference_of_vectors() {
    let a = vcd(10, "y", &[1, 2, 3, 4, 5]);
    let b = vcd(10, "y", &[1, 2, 4, 4, 5]).replace("r0.5 r", "r0.5004 r");
    let mut options = DiffOptions::default();
    options.add_tolerance("0.001abs").unwrap();
    let result = compare(&a, &b, &options);
    assert_eq!(result.differences.len(), 1, "{result}");
    assert_eq!(result.differences[0].signal, "t.y");
}

#[test]
fn two_signals_of_one_name_are_not_compared_with_each_other() {
    let twice = vcd(10, "y", &[1, 2, 3]).replace("$upscope", "$var wire 1 t y [15:0] $end\n$upscope");
    let twice = twice.replace("#15\n", "#15\n1t\n");
    for raw in [false, true] {
        let options = DiffOptions {
            raw,
            ..DiffOptions::default()
        };
        let result = compare(&twice, &twice, &options);
        assert_eq!((result.result, result.signals), (DiffVerdict::Equal, 4), "{result}");
        let result = compare(&twice, &twice.replace("1t\n", "0t\n"), &options);
        assert_eq!(result.result, DiffVerdict::Different, "{result}");
    }
}

#[test]
fn files_without_a_common_signal_are_not_equal() {
    let result = compare(
        &vcd(10, "y", &[1, 2]),
        &vcd(10, "z", &[1, 2]).replace("level", "height"),
        &DiffOptions::default(),
    );
    assert_eq!(result.result, DiffVerdict::Incomparable, "{result}");
}

#[test]
fn a_clock_that_runs_at_another_rate_or_stands_still_is_not_equal() {
    let same = [7; 10];
    let a = vcd(10, "y", &same);
    for other in [vcd(20, "y", &same[..5]), vcd(5, "y", &[7; 20])] {
        for (a, b) in [(&a, &other), (&other, &a)] {
            let result = compare(a, b, &DiffOptions::default());
            assert_eq!(result.result, DiffVerdict::Different, "{result}");
            assert_eq!(result.differences[0].signal, "t.clk", "{result}");
        }
    }
    // Nothing is sampled where the clock of either file stands still.
    let still = vcd(0, "y", &same);
    for (a, b) in [(&a, &still), (&still, &a), (&still, &still)] {
        let result = compare(a, b, &DiffOptions::default());
        assert_eq!(result.result, DiffVerdict::Incomparable, "{result}");
    }
}

#[test]
fn a_file_that_ends_early_is_not_equal() {
    let a = vcd(10, "y", &[7; 10]);
    let b = vcd(10, "y", &[7; 6]);
    for raw in [false, true] {
        let options = DiffOptions {
            raw,
            ..DiffOptions::default()
        };
        assert_eq!(compare(&a, &b, &options).result, DiffVerdict::Different);
        assert_eq!(compare(&b, &a, &options).result, DiffVerdict::Different);
    }
}

#[test]
fn a_value_between_two_changes_of_the_other_file_is_found() {
    // At #15 and #16 the second file has another value; the first says nothing at these times.
    let a = vcd(0, "y", &[7; 4]);
    let b = vcd(0, "y", &[7; 4]).replace("#20\n", "#15\nb1 \"\n#16\nb111 \"\n#20\n");
    let options = DiffOptions {
        raw: true,
        ..DiffOptions::default()
    };
    let result = compare(&a, &b, &options);
    assert_eq!(result.result, DiffVerdict::Different, "{result}");
    assert_eq!(
        (result.differences[0].count, result.differences[0].persistent),
        (1, false)
    );
}
