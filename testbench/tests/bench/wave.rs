//! Waveforms: what is written is what was recorded, and the merged view holds all of it.

use std::path::Path;

use posicast_testbench::Error;
use posicast_testbench::diff::{self, Options, Verdict};
use posicast_testbench::wave::{self, Difference, Part, Recorder, Signal};

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
        " 10 ns $end\n$scope module stage $end\n$scope module x $end\n$var wire 1 ! clk $end\n$var wire 4 \" y $end\n\
         $var wire 1 # valid $end\n$var real 64 $ error $end\n$upscope $end\n$upscope $end\n$enddefinitions $end\n\
         #0\n$dumpvars\n1!\nb0101 \"\n0#\nr5e-1 $\n$end\n#1\n0!\n#2\n1!\n1#\nr-1e300 $\n#3\n0!\n\
         #4\n1!\nb1001 \"\nr0e0 $\n#5\n0!\n#6\n1!\n"
    );
}

#[test]
fn unit_a_waveform_that_is_not_finished_leaves_no_file() {
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
fn unit_the_merged_view_holds_all_parts_and_their_difference() {
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
        Part {
            scope: "rtl",
            path: &at("rtl.vcd"),
        },
        Part {
            scope: "float",
            path: &at("float.vcd"),
        },
    ];
    let difference = Difference {
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
    let options = Options {
        maps: vec![("stage".to_owned(), "rtl".to_owned())],
        clock: Some("stage.clk".to_owned()),
        ..Options::default()
    };
    let compared = diff::compare(&at("rtl.vcd"), &at("merged.vcd"), &options, &mut |_| {}).unwrap();
    assert_eq!(
        (compared.result, compared.signals, compared.samples),
        (Verdict::Equal, 3, 3),
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

    let wrong = Difference {
        minuend: (7, "y"),
        ..difference
    };
    assert!(wave::merge(&at("other.vcd"), &parts, &[wrong]).is_err());
    assert!(!at("other.vcd").exists());
}
