//! The options of `diff`.

use wavecmp::WaveError;
use wavecmp::diff::{self, Comparison, DiffOptions, DiffVerdict, Shown, UnknownPolicy, junit};

use crate::support::PlainFiles;

/// Returns a clock, a reset and a byte: rising edges at 5, 15, 25 … ns; each word of `values` stays from one edge to
/// the next.
fn clocked(values: &[&str], reset_clocks: usize) -> String {
    let mut text = "$timescale 1 ns $end $scope module t $end $var wire 1 c clk $end $var wire 1 r rst $end \
        $var wire 8 y y $end $upscope $end $enddefinitions $end\n"
        .to_owned();
    for (clock, value) in values.iter().enumerate() {
        let reset = u8::from(clock < reset_clocks);
        text += &format!("#{} 0c {reset}r b{value} y #{} 1c\n", 10 * clock, 10 * clock + 5);
    }
    text
}

fn compare(a: &str, b: &str, options: &DiffOptions) -> Result<Comparison, WaveError> {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["a.vcd", "b.vcd"].map(|name| folder.path().join(name));
    std::fs::write(&paths[0], a).unwrap();
    std::fs::write(&paths[1], b).unwrap();
    diff::compare(&paths[0], &paths[1], options, &mut |_| {})
}

fn verdict(a: &str, b: &str, options: &DiffOptions) -> (DiffVerdict, u64) {
    let result = compare(a, b, options).unwrap();
    (result.result, result.samples)
}

fn with(set: impl FnOnce(&mut DiffOptions)) -> DiffOptions {
    let mut options = DiffOptions::default();
    set(&mut options);
    options
}

#[test]
fn each_side_starts_behind_its_own_reset() {
    let a = clocked(&["0", "1", "10", "11"], 1);
    let b = clocked(&["111", "110", "101", "1", "10", "11"], 3);
    let reset = with(|o| o.set_reset("rst").unwrap());
    assert_eq!(verdict(&a, &b, &reset), (DiffVerdict::Equal, 3));
    assert_eq!(
        verdict(&a, &b, &with(|o| o.reset = diff::Reset::Found)),
        (DiffVerdict::Equal, 3)
    );
    assert_eq!(verdict(&a, &b, &DiffOptions::default()).0, DiffVerdict::Different);
    let text = compare(&a, &b, &reset).unwrap().to_string();
    assert!(text.contains("1 edge of the first file, 3 of the second"), "{text}");
    assert!(compare(&a, &b, &with(|o| o.set_reset("nothing").unwrap())).is_err());
    // The reset is never released: nothing was compared, which is not a success.
    let never = clocked(&["0"; 3], 9);
    assert_eq!(verdict(&never, &never, &reset), (DiffVerdict::Incomparable, 0));
}

#[test]
fn the_falling_edge_samples_on_demand() {
    let a = clocked(&["0", "1", "10"], 0);
    // The byte changes at the rising edge: at the falling one both agree, at the rising one B is ahead.
    let b = a
        .replace("b1 y #15 1c", "#15 b1 y 1c")
        .replace("b10 y #25 1c", "#25 b10 y 1c");
    let falling = with(|o| o.edge = diff::SamplingEdge::Falling);
    assert_eq!(verdict(&a, &b, &DiffOptions::default()).0, DiffVerdict::Different);
    assert_eq!(verdict(&a, &b, &falling), (DiffVerdict::Equal, 2));
}

#[test]
fn start_and_end_bound_what_is_compared() {
    let a = clocked(&["0", "1", "10", "11"], 0);
    let b = clocked(&["1", "1", "10", "0"], 0);
    let ns = 1_000_000;
    let between = |from: u128, to: u128| with(|o| (o.start_fs, o.end_fs) = (Some(from * ns), Some(to * ns)));
    assert_eq!(verdict(&a, &b, &between(15, 25)), (DiffVerdict::Equal, 2));
    assert_eq!(verdict(&a, &b, &between(5, 25)).0, DiffVerdict::Different);
    assert_eq!(verdict(&a, &b, &between(15, 35)).0, DiffVerdict::Different);
    assert_eq!(verdict(&a, &b, &between(100, 200)), (DiffVerdict::Incomparable, 0));
    let raw = |mut options: DiffOptions| {
        options.raw = true;
        verdict(&a, &b, &options).0
    };
    assert_eq!(raw(between(10, 29)), DiffVerdict::Equal);
    assert_eq!(raw(between(10, 30)), DiffVerdict::Different);
}

#[test]
fn a_latency_compares_a_later_sample() {
    let a = clocked(&["1", "10", "11", "100", "101", "110"], 0);
    let b = clocked(&["0", "0", "1", "10", "11", "100"], 0);
    let latency = |text: &str| with(|o| o.add_latency(text).unwrap());
    assert_eq!(verdict(&a, &b, &latency("y=2")), (DiffVerdict::Equal, 6));
    assert_eq!(verdict(&b, &a, &latency("y=-2")).0, DiffVerdict::Equal);
    for wrong in ["y=1", "y=3", "y=-2"] {
        assert_eq!(verdict(&a, &b, &latency(wrong)).0, DiffVerdict::Different, "{wrong}");
    }
    assert!(compare(&a, &b, &latency("y=20ns")).is_err());
    assert!(compare(&a, &b, &latency("z=2")).is_err());
    let raw = with(|o| {
        o.raw = true;
        o.add_latency("y=20ns").unwrap();
    });
    let result = compare(&a, &b, &raw).unwrap();
    assert_eq!((result.result, result.exact), (DiffVerdict::Equal, false), "{result}");
    assert!(result.to_string().contains("equal within the tolerances below") && result.to_string().contains("later"));
}

#[test]
fn raw_with_time_tolerance_and_glitch_filter() {
    let bit = |changes: &str| {
        format!("$timescale 1 ns $end $var wire 1 y y $end $enddefinitions $end #0 0y {changes} #100 0y\n")
    };
    let (straight, late) = (bit("#10 1y #50 0y"), bit("#13 1y #49 0y"));
    let ns = 1_000_000;
    let tolerance = |t: u128| with(|o| o.time_tolerance_fs = t * ns);
    assert_eq!(verdict(&straight, &late, &tolerance(3)).0, DiffVerdict::Equal);
    assert_eq!(verdict(&straight, &late, &tolerance(2)).0, DiffVerdict::Different);
    let text = compare(&straight, &late, &tolerance(3)).unwrap().to_string();
    assert!(
        text.contains("no longer than the time tolerance and not counted: 2 differences"),
        "{text}"
    );

    let glitches = bit("#5 1y #7 0y #10 1y #30 0y #31 1y #50 0y");
    let glitch = |t: u128| with(|o| o.glitch_fs = t * ns);
    assert_eq!(verdict(&straight, &glitches, &glitch(3)).0, DiffVerdict::Equal);
    let kept = compare(&straight, &glitches, &glitch(2)).unwrap();
    assert_eq!(
        (kept.differences[0].time, kept.differences[0].persistent),
        (5e-9, false),
        "{kept}"
    );
    let steps = |changes: &str| {
        format!("$timescale 1 ns $end $var wire 8 y y $end $enddefinitions $end #0 b0 y {changes} #100 b0 y\n")
    };
    let (at_once, in_steps) = (steps("#7 b10 y"), steps("#5 b1 y #7 b10 y"));
    assert_eq!(verdict(&at_once, &in_steps, &glitch(3)).0, DiffVerdict::Equal);
    // A difference that never ends is not tolerated.
    let end = "$timescale 1 ns $end $var wire 1 y y $end $enddefinitions $end #0 0y #10 1y\n";
    let other = end.replace("#10 1y", "#10 0y");
    assert_eq!(verdict(end, &other, &tolerance(1000)).0, DiffVerdict::Different);
    let clocked = clocked(&["0"; 3], 0);
    assert!(compare(&clocked, &clocked, &tolerance(3)).is_err(), "there is a clock");
}

#[test]
fn unknown_bits_by_policy_and_in_the_report() {
    let (a, b) = (clocked(&["1x01", "z0", "1"], 0), clocked(&["1101", "0", "1"], 0));
    for (policy, expected) in [
        (UnknownPolicy::Strict, DiffVerdict::Different),
        (UnknownPolicy::Wildcard, DiffVerdict::Equal),
        (UnknownPolicy::Zero, DiffVerdict::Different),
    ] {
        let result = compare(&a, &b, &with(|o| o.unknown = policy)).unwrap();
        assert_eq!(result.result, expected, "{result}");
        assert_eq!(result.exact, policy == UnknownPolicy::Strict);
    }
    let zero = with(|o| o.unknown = UnknownPolicy::Zero);
    assert_eq!(
        verdict(&clocked(&["x1"], 0), &clocked(&["1"], 0), &zero).0,
        DiffVerdict::Equal
    );
}

#[test]
fn views_read_vectors_as_numbers_with_a_fraction() {
    let vector = clocked(&["11111000", "100"], 0);
    let real = clocked(&["0", "0"], 0)
        .replace("wire 8 y y", "real 64 y y")
        .replacen("b0 y", "r-0.5 y", 1)
        .replace("b0 y", "r0.26 y");
    let view = |text: &str, tolerance: Option<&str>| {
        with(|o| {
            o.add_view(text).unwrap();
            tolerance.into_iter().for_each(|t| o.add_tolerance(t).unwrap());
        })
    };
    let result = compare(&vector, &real, &view("y=q3.4", None)).unwrap();
    assert_eq!(
        (result.differences[0].count, result.differences[0].a_number),
        (1, Some(0.25)),
        "{result}"
    );
    assert_eq!(
        verdict(&vector, &real, &view("y=q3.4", Some("y=0.02abs"))).0,
        DiffVerdict::Equal
    );
    assert_eq!(
        verdict(&vector, &real, &view("y=q3.4", Some("y=0.5lsb"))).0,
        DiffVerdict::Equal
    );
    assert_eq!(
        verdict(&vector, &real, &view("y=q3.4", Some("y=5%"))).0,
        DiffVerdict::Equal
    );
    assert_eq!(
        verdict(&vector, &real, &view("y=q3.4", Some("y=1%"))).0,
        DiffVerdict::Different
    );
    assert_eq!(
        verdict(&vector, &real, &view("y=unsigned", None)).0,
        DiffVerdict::Different
    );
}

#[test]
fn roots_filters_and_patterns_choose_signals() {
    let a = clocked(&["0", "1"], 0);
    let b = a
        .replace("module t", "module tb $end $scope module u_t")
        .replace("$upscope", "$upscope $end $upscope");
    let b = b.replace("y y $end", "q_y $end").replace("wire 8 q_y", "wire 8 y q_y");
    let root = |only: &[&str]| {
        with(|o| {
            o.roots = [Some("t".to_owned()), Some("tb.u_t".to_owned())];
            o.only = only.iter().map(|s| (*s).to_owned()).collect();
        })
    };
    let result = compare(&a, &b, &root(&[])).unwrap();
    assert_eq!(
        (result.signals, &result.only_in_a[..]),
        (2, &["t.y".to_owned()][..]),
        "{result}"
    );
    let mut mapped = root(&[]);
    mapped.add_map("?=q_?").unwrap();
    assert_eq!(compare(&a, &b, &mapped).unwrap().signals, 3);
    let nothing = compare(&a, &b, &root(&["y"])).unwrap();
    assert_eq!(nothing.result, DiffVerdict::Incomparable);
    let mut wrong = DiffOptions::default();
    wrong.roots[1] = Some("nowhere".to_owned());
    assert!(compare(&a, &b, &wrong).is_err());
}

#[test]
fn text_is_compared_as_text() {
    let text = |word: &str| {
        format!(
            "$var string 1 s state $end $var event 1 e e $end $enddefinitions $end #0 sIDLE s #5 s{word} s 1e #9 sIDLE s\n"
        )
    };
    let result = compare(&text("RUN"), &text("STOP"), &DiffOptions::default()).unwrap();
    let first = &result.differences[0];
    assert_eq!(
        (&first.a, &first.b),
        (&Shown::Text("RUN".to_owned()), &Shown::Text("STOP".to_owned()))
    );
    assert_eq!(
        (first.count, first.persistent, result.signals, result.not_compared.len()),
        (1, false, 2, 0)
    );
    assert_eq!(
        verdict(&text("RUN"), &text("RUN"), &DiffOptions::default()).0,
        DiffVerdict::Equal
    );
    let long = "A".repeat(100);
    let (x, y) = (text(&format!("{long}X")), text(&format!("{long}Y")));
    assert_eq!(
        verdict(&x, &y, &DiffOptions::default()).0,
        DiffVerdict::Different,
        "beyond what is shown"
    );
}

#[test]
fn the_context_shows_the_last_equal_sample_and_what_follows() {
    let a = clocked(&["0", "1", "10", "11", "100", "101"], 0);
    let b = clocked(&["0", "1", "110", "11", "100", "101"], 0);
    let result = compare(&a, &b, &DiffOptions::default()).unwrap();
    let context = result.context.as_ref().unwrap();
    assert_eq!((context.sample, context.times.len()), (2, 5));
    let row = &context.rows[0];
    assert_eq!(
        (row.signal.as_str(), &row.a[0], &row.b[0]),
        ("t.y", &row.b[0], &row.a[0])
    );
    assert_eq!(row.b[1], Shown::Bits("00000110".to_owned()));
    let text = result.to_string();
    assert!(
        text.contains("first divergence at sample 2, 25 ns") && text.contains("probable cause"),
        "{text}"
    );
    assert!(text.contains("1 sample, transient"), "{text}");
    let document = junit(&result, "a & b");
    assert!(
        document.contains("<testsuite name=\"a &amp; b\" tests=\"3\" failures=\"1\" errors=\"0\" skipped=\"0\">"),
        "{document}"
    );
    assert!(document.contains("<testcase name=\"t.clk\"/>") && document.contains("<failure message=\"first at 25 ns"));
}

#[test]
fn a_difference_is_shown_in_files_that_open_there() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("a.vcd"), clocked(&["0", "1", "10", "11", "100"], 0)).unwrap();
    std::fs::write(at("b.vcd"), clocked(&["0", "1", "110", "11", "100"], 0)).unwrap();
    let result = diff::compare(&at("a.vcd"), &at("b.vcd"), &DiffOptions::default(), &mut |_| {}).unwrap();
    assert!(diff::show(&PlainFiles, &at("first"), &at("a.vcd"), &at("b.vcd"), &result).unwrap());
    let read = |name: &str| std::fs::read_to_string(at(name)).unwrap();
    let vcd = read("first.vcd");
    assert!(
        vcd.contains("scope module a ") && vcd.contains("scope module difference ") && vcd.contains(" t_y "),
        "{vcd}"
    );
    assert!(vcd.contains("r-4e0 "), "{vcd}");
    assert!(!vcd.contains(" rst "), "only what differs, and the clock: {vcd}");
    assert!(read("first.gtkw").contains(" 25\n") && read("first.gtkw").contains("difference.t_y"));
    assert!(read("first.sucl").contains("cursor_set 25\n"));
    let svg = read("first.svg");
    assert!(
        svg.contains("first divergence, 25 ns") && svg.contains(">06<") && svg.contains("class=\"bad\""),
        "{svg}"
    );
    let same = diff::compare(&at("a.vcd"), &at("a.vcd"), &DiffOptions::default(), &mut |_| {}).unwrap();
    assert!(
        !diff::show(&PlainFiles, &at("none"), &at("a.vcd"), &at("a.vcd"), &same).unwrap() && !at("none.vcd").exists()
    );
}

#[test]
fn a_vector_of_no_bits_is_compared_beside_signals_that_are_left_out() {
    let file = |digit: char| {
        format!(
            "$timescale 1 ns $end $scope module t $end $var wire 0 n none $end $var wire 8 l left $end $upscope $end \
             $enddefinitions $end\n#0\nb0 l\nb{digit} n\n#5\nb1 l\n#7\nb1 n\n#9\nb10 l\n"
        )
    };
    let options = with(|options| {
        options.raw = true;
        options.ignore = vec!["t.left".to_owned()];
    });
    let result = compare(&file('1'), &file('0'), &options).unwrap();
    assert_eq!(result.result, DiffVerdict::Different, "{result}");
    assert_eq!(result.differences[0].signal, "t.none", "{result}");
    // Times at which only the left-out signal changes are no samples.
    assert_eq!(verdict(&file('1'), &file('1'), &options), (DiffVerdict::Equal, 2));
}
