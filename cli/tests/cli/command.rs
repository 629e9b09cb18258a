//! Command files: columns that are not used, and commands that jump at their beginning or end.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, posicast};
use std::fmt::Write as _;

/// Runs `simulate` with this command file for the XY stage, and returns the exit status and what was said.
fn simulate(command: &str) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("command.csv");
    std::fs::write(&path, command).unwrap();
    let mut simulate = posicast();
    simulate
        .arg("simulate")
        .arg(example("xy-stage.toml"))
        .arg("--command")
        .arg(&path);
    simulate.arg("-o").arg(folder.path().join("wave.vcd"));
    let output = simulate.output().unwrap();
    (
        output.status.code(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

#[test]
fn cli_a_column_that_is_most_likely_misspelt_or_there_twice_is_refused() {
    for (heading, expected) in [
        ("time_s,position,Y", "line 1: unknown column `Y`: did you mean `y`?"),
        (
            "time_s,x,y,positon",
            "line 1: unknown column `positon`: did you mean `position`?",
        ),
        ("time_s,x,y,x", "line 1: the column `x` is there twice"),
        (
            "time_s,position,position",
            "line 1: the column `position` is there twice",
        ),
    ] {
        let cells = vec!["0"; heading.split(',').count()].join(",");
        let (status, said) = simulate(&format!("{heading}\n{cells}\n"));
        assert_eq!(status, Some(2), "{heading}: {said}");
        assert!(
            said.contains(expected) && said.contains("command.csv"),
            "{heading}: {said}"
        );
    }
}

#[test]
fn cli_a_column_that_is_not_used_is_named() {
    for (heading, expected) in [
        ("time_s,position,force", Some("line 1: column `force` is not used")),
        ("time_s,x,y,position", Some("line 1: column `position` is not used")),
        ("time_s,position,", Some("line 1: column 3 has no name and is not used")),
        ("time_s,position,y", None),
        ("y,time_s,x", None),
    ] {
        let cells = vec!["0"; heading.split(',').count()].join(",");
        let (status, said) = simulate(&format!("{heading}\n{cells}\n"));
        assert_eq!(status, Some(0), "{heading}: {said}");
        match expected {
            Some(expected) => assert!(
                said.contains(expected) && said.contains("command.csv"),
                "{heading}: {said}"
            ),
            None => assert!(!said.contains("is not used"), "{heading}: {said}"),
        }
    }
}

#[test]
fn cli_a_command_that_jumps_at_its_beginning_or_end_says_so_with_its_line() {
    // A quintic move of 10 mm in 0.2 s: whole, and cut where it is fastest, at 15/8 of its mean velocity of 50 mm/s.
    let smooth = |rows: u32| {
        let mut text = "time_s,position\n".to_owned();
        for row in 0..=rows {
            let u = f64::from(row) / 200.0;
            let position = 0.01 * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
            writeln!(text, "{:.3},{position:.9}", f64::from(row) * 1e-3).unwrap();
        }
        text
    };
    let (status, said) = simulate(&smooth(200));
    assert_eq!(status, Some(0), "{said}");
    assert!(!said.contains("command file"), "{said}");
    let (status, said) = simulate(&smooth(100));
    assert_eq!(status, Some(0), "{said}");
    for axis in ["x", "y"] {
        assert!(
            said.contains(&format!("line 102: axis `{axis}` ends in mid-motion, at 0.0937")),
            "{said}"
        );
    }
    let (_, said) = simulate("time_s,x,y\n0,0,0.002\n0.1,0,0.002\n");
    assert!(
        said.contains("line 2: axis `y` begins at 0.002 m") && !said.contains("axis `x`"),
        "{said}"
    );
    assert!(!said.contains("mid-motion"), "{said}");
}
