//! What people complain of in other comparers: each of these was reported as equal by some tool.

use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict};

/// A clock of the period in ns and a word, `values` from clock to clock; 100 ns in all.
fn vcd(period: usize, name: &str, values: &[u32]) -> String {
    let mut text = format!(
        "$timescale 1ns $end $scope module t $end $var wire 1 ! clk $end $var wire 16 \" {name} $end $var real 64 r level $end \
         $upscope $end $enddefinitions $end\n#0\n0!\nr0.5 r\n"
    );
    for (at, value) in values.iter().enumerate() {
        if period > 0 {
            text += &format!(
                "#{}\n0!\nb{value:b} \"\n#{}\n1!\n",
                period * at,
                period * at + period / 2
            );
        } else {
            text += &format!("#{}\nb{value:b} \"\n", 10 * at);
        }
    }
    text
}

fn compare(a: &str, b: &str, options: &DiffOptions) -> Comparison {
    let folder = tempfile::tempdir().unwrap();
    let [a_path, b_path] = ["a.vcd", "b.vcd"].map(|name| folder.path().join(name));
    std::fs::write(&a_path, a).unwrap();
    std::fs::write(&b_path, b).unwrap();
    diff::compare(&a_path, &b_path, options, &mut |_| {}).unwrap()
}

#[test]
fn unit_a_tolerance_for_real_numbers_does_not_hide_a_difference_of_vectors() {
    let a = vcd(10, "y", &[1, 2, 3, 4, 5]);
    let b = vcd(10, "y", &[1, 2, 4, 4, 5]).replace("r0.5 r", "r0.5004 r");
    let mut options = DiffOptions::default();
    options.add_tolerance("0.001abs").unwrap();
    let result = compare(&a, &b, &options);
    assert_eq!(result.differences.len(), 1, "{result}");
    assert_eq!(result.differences[0].signal, "t.y");
}

#[test]
fn unit_files_without_a_common_signal_are_not_equal() {
    let result = compare(
        &vcd(10, "y", &[1, 2]),
        &vcd(10, "z", &[1, 2]).replace("level", "height"),
        &DiffOptions::default(),
    );
    assert_eq!(result.result, DiffVerdict::Incomparable, "{result}");
}

#[test]
fn unit_a_clock_that_runs_at_another_rate_or_stands_still_is_not_equal() {
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
fn unit_a_file_that_ends_early_is_not_equal() {
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
fn unit_a_value_that_is_only_there_between_two_changes_of_the_other_file_is_found() {
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
