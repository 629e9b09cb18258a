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
            "the slower axis has 250 mm/s",
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
    assert!(text.contains("a contour takes two axes"), "{text}");
}
