//! The result of a comparison as text: numbers, units, at most 100 columns; and as a document for programs.

use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict};

/// Returns a file with a clock of 20 ns, words of these widths, and these values of each word, clock by clock.
fn vcd(timescale: &str, ticks_per_ns: u64, widths: &[u32], rows: &[&[i64]], scope: &str) -> String {
    let mut text = format!("$timescale {timescale} $end\n$scope module {scope} $end\n$var wire 1 ! clk $end\n");
    for (at, width) in widths.iter().enumerate() {
        text += &format!("$var wire {width} s{at} word{at} $end\n");
    }
    text += "$upscope $end\n$enddefinitions $end\n";
    for (clock, row) in rows.iter().enumerate() {
        let time = |ns: u64| (40_689_000 + 20 * clock as u64 + ns) * ticks_per_ns;
        text += &format!("#{}\n0!\n", time(0));
        for (at, (value, width)) in row.iter().zip(widths).enumerate() {
            let word = *value as i128 as u128 & (u128::MAX >> (128 - width));
            text += &format!("b{word:0width$b} s{at}\n", width = *width as usize);
        }
        text += &format!("#{}\n1!\n", time(10));
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

const A: [&[i64]; 4] = [&[1223547, 3, 5], &[1223548, 3, 5], &[-2, 3, 5], &[-2, 3, 5]];
const B: [&[i64]; 4] = [&[1223547, 3, 5], &[1223549, 3, 5], &[-2, 3, 5], &[-2, 3, 5]];

#[test]
fn golden_one_signal_of_four_differs() {
    let file = |rows| vcd("1 ns", 1, &[32, 8, 32], rows, "stage");
    let result = compare(&file(&A), &file(&B), &DiffOptions::default());
    assert_eq!(
        result.to_string(),
        "different: 1 of 4 signals differs, compared at 4 samples
  sampled at the rising edges of `stage.clk`
first divergence at sample 1, 40.68903 ms
                40.68901 ms >40.68903 ms 40.68905 ms 40.68907 ms
  stage.word0 a     1223547      1223548          -2          -2
              b     1223547      1223549          -2          -2
differing signals, the earliest first
  stage.word0  first at 40.68903 ms, 1 sample, transient
      a 1223548 (0x0012ab7c) | b 1223549 (0x0012ab7d), probable cause"
    );
    assert_eq!(result.differing(), "1 of 4 signals differs");
    // Programs still get binary digits and seconds.
    let document = serde_json::to_value(&result).unwrap();
    let first = &document["differences"][0];
    assert_eq!(first["a"], "00000000000100101010101101111100");
    assert_eq!(
        (&first["time"], &document["first_time"]),
        (&0.04068903.into(), &0.04068903.into())
    );
    assert_eq!(
        document["context"]["rows"][0]["b"][1],
        "00000000000100101010101101111101"
    );

    let mut two = B;
    two[3] = &[-2, 3, 6];
    let result = compare(&file(&A), &file(&two), &DiffOptions::default());
    assert!(
        result
            .to_string()
            .starts_with("different: 2 of 4 signals differ, compared at 4 samples"),
        "{result}"
    );
}

#[test]
fn a_view_shows_the_value_in_its_format() {
    let file = |rows| vcd("1 ns", 1, &[32, 8, 32], rows, "stage");
    let mut options = DiffOptions::default();
    options.add_view("word0=q23.8").unwrap();
    let text = compare(&file(&A), &file(&B), &options).to_string();
    assert!(
        text.contains("  stage.word0 a 4779.48046875 4779.48437500 -0.00781250 -0.00781250\n"),
        "{text}"
    );
    assert!(
        text.contains("a 4779.48437500 (0x0012ab7c) | b 4779.48828125 (0x0012ab7d)"),
        "{text}"
    );
}

#[test]
fn the_text_fits_100_columns() {
    let scope = "a_scope_with_a_long_name.of_many_parts_that_go_on.and_on";
    let scopes = scope.replace('.', " $end\n$scope module ");
    // These are times in femtoseconds that need all their digits.
    let file = |rows: &[&[i64]]| {
        let text = vcd("1 fs", 1_000_001, &[64, 100, 16], rows, &scopes);
        text.replacen("$upscope $end", "$upscope $end\n$upscope $end\n$upscope $end", 1)
    };
    let mut b: [&[i64]; 4] = [&[i64::MIN, -3, 5]; 4];
    b[0] = A[0];
    for view in [None, Some("*word*=q60"), Some("*word*=signed")] {
        let mut options = DiffOptions::default();
        view.iter().for_each(|view| options.add_view(view).unwrap());
        let text = compare(&file(&A), &file(&b), &options).to_string();
        assert!(text.contains("2 of 4 signals differ"), "{text}");
        let widest = text.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(widest <= 100, "{widest} columns\n{text}");
        assert!(text.contains(">40.689070689"), "the diverging sample is shown\n{text}");
    }
}

#[test]
fn widths_that_differ_are_named() {
    let file = |width| vcd("1 ns", 1, &[width, 8], &[&[7, 3], &[8, 3]], "stage");
    let result = compare(&file(32), &file(33), &DiffOptions::default());
    assert_eq!((result.result, result.exact), (DiffVerdict::Equal, false));
    let text = result.to_string();
    assert!(
        text.starts_with("equal, but for the widths below: 3 signals at 2 samples\n"),
        "{text}"
    );
    assert!(
        text.contains("stage.word0: compared as bits, 32 bits in the first file and 33 in the second: the narrower extended with zeros"),
        "{text}"
    );
    let document = serde_json::to_value(&result).unwrap();
    assert_eq!(document["lenient"][0]["widths"], serde_json::json!([32, 33]));
    let mut options = DiffOptions::default();
    options.add_view("word0=signed").unwrap();
    let text = compare(&file(32), &file(33), &options).to_string();
    assert!(text.contains("extended with its sign"), "{text}");
    options.add_tolerance("word0=1").unwrap();
    let text = compare(&file(32), &file(33), &options).to_string();
    assert!(text.starts_with("equal within the tolerances below"), "{text}");

    let exact = compare(&file(32), &file(32), &DiffOptions::default());
    assert!(
        exact.exact && exact.to_string().starts_with("equal: 3 signals at 2 samples"),
        "{exact}"
    );
}

#[test]
fn signals_of_only_one_file_are_counted_separately() {
    let file = |widths: &[u32]| vcd("1 ns", 1, widths, &[&[7, 3, 4], &[8, 3, 4]], "stage");
    let options = DiffOptions {
        require_all: true,
        ..DiffOptions::default()
    };
    let result = compare(&file(&[32]), &file(&[32, 8, 8]), &options);
    assert_eq!(
        result.differing(),
        "0 of 2 signals differ, 2 signals are in one file only"
    );
}
