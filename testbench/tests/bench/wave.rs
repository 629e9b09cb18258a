//! Tests waveforms: the file has what was recorded, and the merged view has all of it.

use std::path::Path;

use posicast_testbench::Error;
use posicast_testbench::wave::{self, Heading, Recorder, SealedFiles, Signal};
use wavecmp::diff::{self, DiffOptions, DiffVerdict};
use wavecmp::merge::{DifferenceSignal, Focus, MergePart, merge_around};

use crate::bench::waves::{read, times_of_ones, unit_and_times};

fn record(path: &Path, scope: &[&str], signals: &[Signal], rows: &[&[u64]]) {
    let mut recorder = Recorder::create(path, 50e6, scope, signals).unwrap();
    for row in rows {
        recorder.clock(&[row]).unwrap();
    }
    recorder.finish().unwrap();
}

#[test]
fn golden_a_recorded_waveform_is_this_text() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vcd");
    let signals = [Signal::bits("y", 4), Signal::bits("valid", 1), Signal::real("error")];
    let real = |value: f64| value.to_bits();
    record(
        &path,
        &["stage", "x"],
        &signals,
        &[&[5, 0, real(0.5)], &[5, 1, real(-1e300)], &[9, 1, real(0.0)]],
    );
    let text = std::fs::read_to_string(&path).unwrap();
    let body = text.split_once("$timescale").unwrap().1;
    assert_eq!(
        body,
        " 1 ns $end\n$scope module stage $end\n$scope module x $end\n$var wire 1 ! clk $end\n$var wire 4 \" y $end\n\
         $var wire 1 # valid $end\n$var real 64 $ error $end\n$upscope $end\n$upscope $end\n$enddefinitions $end\n\
         #0\n$dumpvars\n1!\nb0101 \"\n0#\nr5e-1 $\n$end\n#10\n0!\n#20\n1!\n1#\nr-1e300 $\n#30\n0!\n\
         #40\n1!\nb1001 \"\nr0e0 $\n#50\n0!\n#60\n1!\n"
    );
}

#[test]
fn golden_clocks_that_are_left_out_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vcd");
    let heading = Heading {
        clock: "",
        comment: "true times",
        gaps: true,
    };
    let mut recorder = Recorder::create_with(&path, 50e6, &["t"], &[Signal::bits("y", 4)], &heading).unwrap();
    for (clock, y) in [(0, 1), (1, 2), (5000, 3), (5001, 3)] {
        recorder.skip_to(clock).unwrap();
        recorder.clock(&[&[y]]).unwrap();
    }
    assert!(recorder.skip_to(5001).is_err(), "it was recorded");
    recorder.finish().unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    // The first comment is the seal of posicast's own files.
    let body = text.splitn(3, "$comment").nth(2).unwrap();
    assert_eq!(
        body,
        "\n    true times\n$end\n$timescale 1 ns $end\n$scope module t $end\n$var wire 1 ! clk $end\n\
         $var wire 1 \" recording $end\n$var wire 4 # y $end\n$upscope $end\n$enddefinitions $end\n\
         #0\n$dumpvars\n1!\n1\"\nb0001 #\n$end\n#10\n0!\n#20\n1!\nb0010 #\n#30\n0!\n#40\nx!\n0\"\n\
         #99990\n0!\n1\"\n#100000\n1!\nb0011 #\n#100010\n0!\n#100020\n1!\n#100030\n0!\n#100040\n1!\n"
    );
    let mut plain = Recorder::create(&path, 50e6, &["t"], &[]).unwrap();
    assert!(
        plain.skip_to(1).is_err(),
        "without `recording` no clock can be left out"
    );
}

/// Clocks whose half period is a whole number of each unit, of 10 or 100 units, or of none.
const CLOCKS_HZ: [f64; 12] = [
    0.5, 5.0, 50.0, 10e3, 37.5e3, 180e3, 3e6, 40e6, 50e6, 66.666e6, 125e6, 2.5e9,
];

#[test]
fn every_file_has_a_unit_of_a_power_of_1000_and_readers_see_the_true_times() {
    let folder = tempfile::tempdir().unwrap();
    for clock_hz in CLOCKS_HZ {
        let path = folder.path().join("a.vcd");
        let mut recorder = Recorder::create(&path, clock_hz, &["t"], &[Signal::bits("y", 4)]).unwrap();
        (0..200).for_each(|row| recorder.clock(&[&[row & 15]]).unwrap());
        recorder.finish().unwrap();
        let (unit_fs, times) = unit_and_times(&path);
        let edges = times_of_ones(&read(&path).1["t.clk"]);
        assert_eq!((edges.len(), times.len()), (201, 401), "{clock_hz} Hz");
        for (clock, edge) in (0..).zip(edges) {
            let seconds = edge as f64 * unit_fs as f64 * 1e-15;
            let expected = f64::from(clock) / clock_hz;
            assert!(
                (seconds - expected).abs() <= 0.51e-15 + 1e-12 * expected,
                "{clock_hz} Hz: {seconds} s"
            );
        }
    }
}

/// Returns the numbers that GTKWave takes as times, and the zoom: [begin of the view, zoom, marker].
fn gtkwave_times(session: &str) -> [f64; 3] {
    let start = session.lines().find_map(|line| line.strip_prefix("[timestart] "));
    let zoom = session.lines().find_map(|line| line.strip_prefix('*')).unwrap();
    let (zoom, marker) = zoom.split_once(' ').unwrap();
    [start.unwrap_or("0"), zoom, marker].map(|number| number.parse().unwrap())
}

/// Number of pixels of GTKWave's waves in a window of 1400 pixels, and pixels per unit of time of a zoom.
const GTKWAVE_PIXELS: f64 = 920.0;
fn pixels_per_unit(zoom: f64) -> f64 {
    200.0 * zoom.exp2()
}

#[test]
fn sessions_name_times_in_the_unit_of_their_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    // These are files of other tools, with the same times in three units; viewers disagree on two of them.
    for (timescale, unit_fs) in [
        ("10 fs", 10u64),
        ("100 ps", 100_000),
        ("10 ns", 10_000_000),
        ("1 us", 1_000_000_000),
    ] {
        let end = 117_000_000_000_000 / unit_fs;
        let text = format!(
            "$timescale {timescale} $end\n$scope module t $end\n$var wire 8 y y $end\n$upscope $end\n$enddefinitions $end\n\
             #0\nb1 y\n#{}\nb10 y\n#{end}\nb11 y\n",
            40_689_000_000_000 / unit_fs
        );
        std::fs::write(at("a.vcd"), text).unwrap();
        let path = at("a.vcd");
        let part = |scope| MergePart { scope, path: &path };
        let parts = [part("a"), part("b")];
        let focus = Focus {
            signals: vec![["t.y".to_owned()].into(); 2],
            time_fs: 40_689_000_000_000,
            span_fs: 100_000_000_000,
        };
        for focus in [None, Some(&focus)] {
            merge_around(&SealedFiles, &at("merged.vcd"), &parts, &[], focus).unwrap();
            let (unit_fs, _) = unit_and_times(&at("merged.vcd"));
            let ms = |units: f64| units * unit_fs as f64 * 1e-12;
            let changes = &read(&at("merged.vcd")).1["a.y"];
            let true_times: Vec<f64> = changes.iter().map(|(time, _)| ms(*time as f64)).collect();
            assert_eq!(true_times, [0.0, 40.689, 117.0], "{timescale}");

            let session = std::fs::read_to_string(at("merged.gtkw")).unwrap();
            let [start, zoom, marker] = gtkwave_times(&session);
            let shown = ms(GTKWAVE_PIXELS / pixels_per_unit(zoom));
            let surfer = std::fs::read_to_string(at("merged.sucl")).unwrap();
            let cursor = surfer.lines().find_map(|line| line.strip_prefix("cursor_set "));
            if focus.is_none() {
                assert_eq!((start, marker, cursor), (0.0, -1.0, None));
                assert!(
                    (shown - 117.0).abs() < 0.01,
                    "{timescale}: {shown} ms of 117 are in view"
                );
                continue;
            }
            assert_eq!(ms(marker), 40.689, "{timescale}");
            assert_eq!(ms(cursor.unwrap().parse().unwrap()), 40.689, "{timescale}");
            assert!((shown - 0.1).abs() < 0.001, "{timescale}: {shown} ms are in view");
            assert!(
                (ms(start) - 40.639).abs() < 1e-9,
                "{timescale}: from {} ms on",
                ms(start)
            );
            let halvings = surfer.lines().filter(|line| *line == "zoom_in").count();
            let in_view = 117.0 / (halvings as f64).exp2();
            assert!((0.1..0.2).contains(&in_view), "{timescale}: Surfer shows {in_view} ms");
        }
    }
}

#[test]
fn a_divergence_at_either_end_of_a_file_is_in_view() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let rows: Vec<[u64; 1]> = (0..1000).map(|row| [row & 1]).collect();
    let rows: Vec<&[u64]> = rows.iter().map(<[u64; 1]>::as_slice).collect();
    record(&at("a.vcd"), &["t"], &[Signal::bits("y", 1)], &rows);
    let part = MergePart {
        scope: "a",
        path: &at("a.vcd"),
    };
    for time_ns in [0, 20, 20_000] {
        let focus = Focus {
            signals: vec![["t.y".to_owned()].into()],
            time_fs: time_ns * 1_000_000,
            span_fs: 220_000_000,
        };
        merge_around(&SealedFiles, &at("first.vcd"), &[part], &[], Some(&focus)).unwrap();
        let text = std::fs::read_to_string(at("first.vcd")).unwrap();
        let end: f64 = text
            .lines()
            .rev()
            .find_map(|line| line.strip_prefix('#'))
            .unwrap()
            .parse()
            .unwrap();
        let [start, _, marker] = gtkwave_times(&std::fs::read_to_string(at("first.gtkw")).unwrap());
        assert_eq!(marker, time_ns as f64);
        assert!(
            start <= marker && marker <= start + 220.0,
            "{time_ns} ns: from {start} ns on"
        );
        // GTKWave ignores a beginning after which the file does not fill its window, here without the list of scopes.
        assert!(start + 1.4 * 220.0 <= end, "{time_ns} ns: from {start} to {end} ns");
    }
}

#[test]
fn a_waveform_that_is_not_finished_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vcd");
    let mut recorder = Recorder::create(&path, 50e6, &["t"], &[Signal::bits("y", 4)]).unwrap();
    recorder.clock(&[&[1]]).unwrap();
    assert!(matches!(recorder.clock(&[&[1, 2]]), Err(Error::Option(_))));
    drop(recorder);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    assert!(matches!(
        Recorder::create(&path, 50e6, &["two words"], &[]),
        Err(Error::Option(_))
    ));
    assert!(matches!(
        Recorder::create(&folder.path().join("no/a.vcd"), 50e6, &["t"], &[]),
        Err(Error::File { .. })
    ));
}

#[test]
fn the_merged_view_holds_all_parts_and_their_difference() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let bits = [Signal::bits("y", 8), Signal::bits("valid", 1)];
    record(&at("rtl.vcd"), &["stage"], &bits, &[&[10, 0], &[0xff, 1], &[12, 0]]);
    let reals = [Signal::real("y")];
    let real = |value: f64| value.to_bits();
    record(
        &at("float.vcd"),
        &["stage"],
        &reals,
        &[&[real(9.75)], &[real(-1.0)], &[real(12.5)]],
    );
    let parts = [
        MergePart {
            scope: "rtl",
            path: &at("rtl.vcd"),
        },
        MergePart {
            scope: "float",
            path: &at("float.vcd"),
        },
    ];
    let difference = DifferenceSignal {
        name: "y",
        minuend: (0, "y"),
        subtrahend: (1, "stage.y"),
    };
    wave::merge(&at("merged.vcd"), &parts, &[difference]).unwrap();

    let text = std::fs::read_to_string(at("merged.vcd")).unwrap();
    let changes: Vec<&str> = text.lines().filter(|line| line.starts_with('r')).collect();
    assert_eq!(
        changes,
        ["r9.75e0 %", "r2.5e-1 &", "r-1e0 %", "r0e0 &", "r1.25e1 %", "r-5e-1 &"],
        "{text}"
    );
    let options = DiffOptions {
        maps: vec![("stage".to_owned(), "rtl".to_owned())],
        clock: Some("stage.clk".to_owned()),
        ..DiffOptions::default()
    };
    let compared = diff::compare(&at("rtl.vcd"), &at("merged.vcd"), &options, &mut |_| {}).unwrap();
    assert_eq!(
        (compared.result, compared.signals, compared.samples),
        (DiffVerdict::Equal, 3, 3),
        "{compared}"
    );

    let gtkwave = std::fs::read_to_string(at("merged.gtkw")).unwrap();
    assert!(
        gtkwave.contains("[dumpfile] \"merged.vcd\"") && gtkwave.contains("@420\nrtl.y[7:0]\n"),
        "{gtkwave}"
    );
    assert!(gtkwave.contains("@8420\ndifference.y\n"));
    let surfer = std::fs::read_to_string(at("merged.sucl")).unwrap();
    assert!(
        surfer.starts_with("load_file merged.vcd\n") && surfer.contains("scope_add float\n"),
        "{surfer}"
    );

    let wrong = DifferenceSignal {
        minuend: (7, "y"),
        ..difference
    };
    assert!(wave::merge(&at("other.vcd"), &parts, &[wrong]).is_err());
    assert!(!at("other.vcd").exists());
}
