//! `simulate --contour` with a path of two axes.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, posicast};
use serde_json::Value;

fn simulate(arguments: &[&str]) -> assert_cmd::assert::Assert {
    posicast()
        .arg("simulate")
        .arg(example("xy-stage.toml"))
        .args(arguments)
        .assert()
}

/// The figures of the notes on the XY stage: 71.06 um with each axis's own delay, 4.2 um with equal ones.
#[test]
fn golden_a_circle_has_the_figures_of_the_notes() {
    let folder = tempfile::tempdir().unwrap();
    let plot = folder.path().join("circle.svg");
    let circle = [
        "--contour",
        "circle",
        "--radius",
        "0.01",
        "--speed",
        "0.1",
        "--json",
        "--plot",
    ];
    let output = simulate(&[&circle[..], &[plot.to_str().unwrap()]].concat()).success();
    let document: Value = serde_json::from_slice(&output.get_output().stdout).unwrap();
    let shapers = document["shapers"].as_array().unwrap();
    let steady_um = |kind: &str, equal: bool| {
        let row = shapers
            .iter()
            .find(|row| row["kind"] == kind && row["equal_delays"] == equal)
            .unwrap();
        1e6 * row["error_steady"].as_f64().unwrap()
    };
    for (kind, equal, expected_um) in [
        ("zvd", false, 71.06),
        ("zvd", true, 4.2),
        ("zv", false, 37.97),
        ("none", false, 9.17),
    ] {
        let found_um = steady_um(kind, equal);
        assert!(
            (found_um - expected_um).abs() < 0.005 * expected_um + 0.05,
            "{kind} {equal}: {found_um}"
        );
    }
    let picture = std::fs::read_to_string(plot).unwrap();
    assert!(picture.contains("zvd, equal delays") && picture.contains("unshaped"));
}

#[test]
fn cli_programs_and_points_are_driven() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let part = file("part.nc", "G21\nG1 X10 F3000\nG3 X20 Y10 I0 J10\n");
    let shown = simulate(&["--contour", &part]).success();
    let text = String::from_utf8_lossy(&shown.get_output().stdout).into_owned();
    assert!(text.contains("25.7 mm") && text.contains("0 stops"), "{text}");
    let points = file("points.csv", "x,y\n0,0\n0.01,0\n0.01,0.01\n");
    let shown = simulate(&["--contour", &points, "--speed", "0.05"]).success();
    let text = String::from_utf8_lossy(&shown.get_output().stdout).into_owned();
    assert!(text.contains("20 mm") && text.contains("1 stop\n"), "{text}");
}

#[test]
fn cli_paths_that_cannot_be_driven_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("bad.gcode");
    std::fs::write(&bad, "G21\nG28 X0\n").unwrap();
    let bad = bad.to_str().unwrap().to_owned();
    for (arguments, expected) in [
        (vec!["--contour", &bad], "bad.gcode:2: G28 is not read"),
        (vec!["--contour", "missing.csv"], "cannot read `missing.csv`"),
        (vec!["--contour", "circle", "--radius", "-1"], "the radius is -1"),
        (
            vec!["--contour", "circle", "--radius", "0.2"],
            "axis x would go to -200 mm; its travel is -100 mm to 100 mm",
        ),
        (
            vec!["--contour", "circle", "--speed", "1"],
            "the velocity limit of the slower axis is 250 mm/s",
        ),
        (
            vec!["--contour", "square", "--radius", "0.01"],
            "--radius: `--contour square` has its own",
        ),
        (
            vec!["--contour", "circle", "--move", "1"],
            "the contour defines where the axes go",
        ),
        (
            vec!["--contour", "circle", "--plot", "x.png"],
            "pictures are written as SVG",
        ),
        (vec!["--radius", "1"], "--contour <SHAPE|FILE>"),
    ] {
        let output = simulate(&arguments).code(2);
        let text = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
        assert!(text.contains(expected), "{arguments:?}: {text}");
    }
    let one_axis = posicast()
        .arg("simulate")
        .arg(example("robot-joint.toml"))
        .args(["--contour", "circle"])
        .assert()
        .code(2);
    let text = String::from_utf8_lossy(&one_axis.get_output().stderr).into_owned();
    assert!(text.contains("a contour needs two linear axes"), "{text}");
}

/// The mill of the cases: 38 and 29 Hz, 150 mm/s, 1500 mm/s², 50 m/s³.
const MILL: &str = include_str!("fixtures/mill.toml");

struct Case {
    folder: tempfile::TempDir,
}

impl Case {
    fn new(machine: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("m.toml"), machine).unwrap();
        Self { folder }
    }

    fn file(&self, name: &str, text: &str) -> String {
        std::fs::write(self.folder.path().join(name), text).unwrap();
        name.to_owned()
    }

    fn simulate(&self, arguments: &[&str]) -> assert_cmd::assert::Assert {
        let mut command = posicast();
        command
            .current_dir(self.folder.path())
            .args(["simulate", "m.toml"])
            .args(arguments);
        command.assert()
    }

    fn json(&self, arguments: &[&str]) -> Value {
        let output = self.simulate(&[arguments, &["--json"]].concat()).success();
        serde_json::from_slice(&output.get_output().stdout).unwrap()
    }
}

/// The row of the machine's own shaper with each axis's own delay.
fn own(document: &Value) -> &Value {
    &document["shapers"][0]
}

/// A circle of 40 mm as chords.
fn ring(chords: u32) -> String {
    let points = (0..=chords).map(|k| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(chords)).sin_cos();
        format!("{:.4},{:.4}\n", 150.0 + 40.0 * cos, 150.0 + 40.0 * sin)
    });
    format!("x,y\n{}", points.collect::<String>())
}

/// A circle of 40 mm at 60 mm/s takes 251.3/60 = 4.19 s and the ramps; its error is v·Δdelay/2 = 122 um, with delays of
/// half a period of 38 and 29 Hz, damping 0.05 and 0.04.
#[test]
fn golden_a_circle_of_chords_has_the_time_and_the_error_of_the_circle() {
    let case = Case::new(MILL);
    let delay_s = |frequency_hz: f64, damping: f64| {
        // ZVD: 2K/(1 + K) half periods after the first impulse, on average.
        let k = (-std::f64::consts::PI * damping / (1.0 - damping * damping).sqrt()).exp();
        2.0 * k / (1.0 + k) / (2.0 * frequency_hz * (1.0 - damping * damping).sqrt())
            + 2.0 * damping / (std::f64::consts::TAU * frequency_hz)
    };
    let expected = 0.06 * (delay_s(38.0, 0.05) - delay_s(29.0, 0.04)).abs() / 2.0;
    assert!((expected - 122e-6).abs() < 3e-6, "{expected}");
    for chords in [90, 720, 3600] {
        let points = case.file("ring.csv", &ring(chords));
        let document = case.json(&["--contour", &points, "--speed", "60"]);
        let duration_s = document["duration_s"].as_f64().unwrap();
        assert!((duration_s - 4.25).abs() < 0.1, "{chords}: {duration_s}");
        let steady = own(&document)["error_steady"].as_f64().unwrap();
        // The load rounds the chords, whose middle lies inside the circle by the sagitta.
        let sagitta = 0.04 * (1.0 - (std::f64::consts::PI / f64::from(chords)).cos());
        let range = 0.98 * expected..1.03 * expected + sagitta;
        assert!(range.contains(&steady), "{chords}: {steady} {expected}");
    }
    // Full speed is never reached where the arc limits it.
    let tight = case.json(&["--contour", "circle", "--radius", "2", "--speed", "150"]);
    assert_eq!(own(&tight)["error_steady"], Value::Null);
    let points = case.file("ring.csv", &ring(90));
    let stopping = case.json(&["--contour", &points, "--speed", "60", "--corner-tolerance", "0"]);
    assert_eq!(
        (&stopping["stops"], &own(&stopping)["error_steady"]),
        (&Value::from(89), &Value::Null)
    );
}

/// The case: 301 um come from a rapid with unequal delays; the feeds leave 1.6 um, more or less, whatever the modes.
#[test]
fn golden_the_error_of_rapids_is_apart() {
    let case = Case::new(MILL);
    let travel = case.file(
        "travel.gcode",
        "G21\nG90\nG0 X20 Y20 F9000\nG1 X60 F600\nG1 Y60\nG0 X280 Y250 F9000\n",
    );
    let document = case.json(&["--contour", &travel]);
    let peaks = |key: &str| -> Vec<f64> {
        own(&document)[key]
            .as_array()
            .unwrap()
            .iter()
            .map(|peak| 1e6 * peak.as_f64().unwrap())
            .collect()
    };
    let (feed, rapid) = (peaks("error_peak"), peaks("error_rapid"));
    assert!(feed.iter().all(|peak| (1.0..2.5).contains(peak)), "{feed:?}");
    assert!(rapid.iter().all(|peak| (peak - 301.0).abs() < 3.0), "{rapid:?}");
    let shown = case.simulate(&["--contour", &travel]).success();
    let text = String::from_utf8_lossy(&shown.get_output().stdout).into_owned();
    assert!(text.contains("while feeding") && text.contains("in rapids"), "{text}");
    let rapids = case.file("rapids.nc", "G0 X20 Y30\nX40\n");
    let document = case.json(&["--contour", &rapids]);
    assert_eq!(own(&document)["error_peak"], Value::Null);
    assert!(own(&document)["error_rapid"].is_array());
}

#[test]
fn cli_programs_of_slicers_and_cam_are_driven() {
    let case = Case::new(MILL);
    for (name, text, length) in [
        (
            "small.gcode",
            "G21\nG90\nM83\nEXCLUDE_OBJECT_START NAME=part_1\nG92 E0\nG0 X10 Y10 F6000\nM117 Layer 1 of 2\nG1 X40 Y10 E1 F3000\nM486 Apart.stl\nG10\nG1 X40 Y40 E1\n",
            0.01 * 2f64.sqrt() + 0.06,
        ),
        (
            "fusion.nc",
            "%\r\nN10 G90 G94 G17\r\nN20 G53 G0 Z0.\r\nN30 G0 X12.7 Y10.\r\nN40 G43 Z15. H1\r\nN50 G1 X40. F1000.\r\nN60 G28 G91 Z0.\r\nM30\r\n%\r\n",
            12.7e-3f64.hypot(10e-3) + 27.3e-3,
        ),
    ] {
        let document = case.json(&["--contour", &case.file(name, text)]);
        let found = document["length"].as_f64().unwrap();
        assert!((found - length).abs() < 1e-9, "{name}: {found} {length}");
    }
    let bad = case.file("bad.nc", "G21\nG1 X5 F600\nG5 X10 Y5 I1 J2\n");
    let output = case.simulate(&["--contour", &bad]).code(2);
    let text = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
    assert!(text.contains("bad.nc:3: G5 is not read"), "{text}");
    for (arguments, expected) in [
        (
            ["--contour", "circle", "--corner-tolerance", "-1"],
            "--corner-tolerance: outside its range",
        ),
        (
            ["--contour", "circle", "--stop-angle", "181"],
            "--stop-angle: outside its range",
        ),
        (["--move", "1", "--stop-angle", "30"], "--contour <SHAPE|FILE>"),
    ] {
        let output = case.simulate(&arguments).code(2);
        let text = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
        assert!(text.contains(expected), "{arguments:?}: {text}");
    }
}

/// A print of this many lines: layers of rings with infill, travels and retractions.
fn print(lines: u32) -> String {
    let mut text = String::from("; generated\nG21\nG90\nM83\nG28\n");
    let mut count = 0;
    let mut layer = 0;
    while count < lines {
        layer += 1;
        text += &format!(
            ";LAYER:{layer}\nG1 Z{:.2} F600\nG1 X190 Y150 F9000\n",
            0.2 * f64::from(layer)
        );
        for k in 1..=360u32 {
            let (sin, cos) = (f64::from(k) / 360.0 * std::f64::consts::TAU).sin_cos();
            let radius = 40.0 + 0.3 * f64::from(layer % 7);
            text += &format!(
                "G1 X{:.3} Y{:.3} E0.0267 F3600\n",
                150.0 + radius * cos,
                150.0 + radius * sin
            );
        }
        text += "G1 E-0.8 F2400\n";
        for k in 0..60u32 {
            let x = 120.0 + f64::from(k);
            let (from, to) = if k % 2 == 0 { (140.0, 160.0) } else { (160.0, 140.0) };
            text += &format!("G1 X{x:.3} Y{from:.3} E0.02 F6000\nG1 X{x:.3} Y{to:.3} E1.9\n");
        }
        count += 480;
    }
    text
}

/// Runs the path and returns its peak memory in bytes, and its output.
fn peak_memory(case: &Case, path: &str, plot: &str) -> (u64, Value) {
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_posicast"))
        .current_dir(case.folder.path())
        .args(["simulate", "m.toml", "--contour", path, "--json", "--plot", plot])
        .stdout(std::fs::File::create(case.folder.path().join("out.json")).unwrap())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    let exit = loop {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok());
        peak = peak.max(1024 * kilobytes.unwrap_or(0));
        match child.try_wait().unwrap() {
            Some(exit) => break exit,
            None => std::thread::sleep(std::time::Duration::from_millis(20)),
        }
    };
    assert!(exit.success() && peak > 0);
    let text = std::fs::read_to_string(case.folder.path().join("out.json")).unwrap();
    (peak, serde_json::from_str(&text).unwrap())
}

/// Eight times the path takes no more memory, and its picture is no larger than a few thousand points a curve.
#[test]
fn long_cli_memory_does_not_depend_on_the_length_of_the_path() {
    let case = Case::new(&MILL.replace("sample_hz = 10_000", "sample_hz = 1_000"));
    let short = peak_memory(&case, &case.file("short.gcode", &print(4_000)), "short.svg");
    let long = peak_memory(&case, &case.file("long.gcode", &print(32_000)), "long.svg");
    assert!(long.1["duration_s"].as_f64() > Some(7.0 * short.1["duration_s"].as_f64().unwrap()));
    assert!(long.0 < short.0 + (16 << 20), "{} {}", short.0, long.0);
    let picture = std::fs::metadata(case.folder.path().join("long.svg")).unwrap().len();
    assert!(picture < 1 << 20, "{picture}");
}

/// A print of 100 MB stays below 200 MB of memory.
#[test]
fn long_a_print_of_100_megabytes_runs_in_bounded_memory() {
    let case = Case::new(&MILL.replace("sample_hz = 10_000", "sample_hz = 250"));
    let text = print(3_000_000);
    assert!(text.len() > 100_000_000, "{}", text.len());
    let path = case.file("print.gcode", &text);
    drop(text);
    let (peak, _) = peak_memory(&case, &path, "print.svg");
    assert!(peak < 200 << 20, "{peak}");
}
