//! Distance and speed of the axes' moves, and the circle: `--move`, `--speed` and `--radius`.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::stage::{quick, run};
use crate::cli::support::{example, one_axis, posicast, scratch};

#[test]
fn long_cli_run_moves_each_axis_by_its_distance_and_speed() {
    let told = [
        "--simulator",
        "rusthdl",
        "--move",
        "x=4e-3,y=-3e-3",
        "--speed",
        "0.2",
        "--radius",
        "5e-3",
    ];
    let (status, document, said, _folder) = run(&quick(), &told);
    assert_eq!(status, Some(0), "{said} {document}");
    let checks = document["checks"].as_array().unwrap();
    let moved = |check: &&serde_json::Value| check["name"] == "the command moves every axis";
    let detail = &checks.iter().find(moved).unwrap()["detail"];
    assert_eq!(detail, "x by 4000 counts, y by 3000 counts");
    assert_eq!(document["stage"]["circle"]["radius"], 5e-3);
}

#[test]
fn cli_an_impossible_move_is_refused_with_its_option_and_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let command = folder.path().join("command.csv");
    std::fs::write(&command, "time_s,position\n0,0\n0.1,0.01\n").unwrap();
    let command = command.to_str().unwrap();
    let cases: [(&[&str], &str); 8] = [
        (
            &["--move", "0"],
            "--move, axis `x`: a move of 0 causes no motion: give a distance in m",
        ),
        (
            &["--move", "y=-0.3"],
            "--move, axis `y`: a move of -0.3 m goes from 0 m to -0.3 m, beyond the travel of -0.1 m to 0.1 m: give",
        ),
        (&["--move", "1e-9"], "less than one: give at least 0.000001 m"),
        (&["--move", "z=1"], "--move: no axis `z`"),
        (&["--move", "far"], "`far` is not a number"),
        (
            &["--speed", "0.3"],
            "--speed, axis `x`: a speed of 0.3 m/s is above the axis's velocity limit of 0.25 m/s",
        ),
        (&["--speed", "-1"], "--speed, axis `x`: a speed of -1 causes no motion"),
        (
            &["--command", command, "--move", "0.01"],
            "--move: the command file defines how the axes move",
        ),
    ];
    for (arguments, expected) in cases {
        let mut simulate = posicast();
        simulate.arg("simulate").arg(example("xy-stage.toml")).args(arguments);
        let refused = simulate.current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!((refused.status.code(), refused.stdout.len()), (Some(2), 0), "{said}");
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
    assert!(!folder.path().join("xy_stage.vcd").exists());
}

#[test]
fn cli_a_radius_that_no_circle_has_is_refused_before_any_work() {
    let cases = [
        ("0.06", "has room for a radius of 45 mm, less than 60 mm"),
        ("-1", "its radius is -1 m, but the smallest"),
        ("nan", "but the smallest"),
    ];
    for (radius, expected) in cases {
        let folder = tempfile::tempdir().unwrap();
        let mut run = posicast();
        run.arg("run").arg(example("xy-stage.toml")).args(["--radius", radius]);
        let refused = run.current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!((refused.status.code(), refused.stdout.len()), (Some(2), 0), "{said}");
        assert!(
            said.contains("--radius: no circle is driven: ") && said.contains(expected),
            "{said}"
        );
        assert!(!folder.path().join("xy_stage").exists());
    }
    let (_folder, shapers) = scratch(&one_axis("kind = \"zv\"", "frequency_hz = 50.0\ndamping = 0.1"));
    let mut run = posicast();
    run.arg("run").arg(shapers).args(["--radius", "0.01"]);
    run.assert()
        .code(2)
        .stderr(predicates::str::contains("the machine has no stage"));
}

#[test]
fn cli_a_move_beyond_the_command_word_is_reported_in_readable_counts() {
    let machine =
        one_axis("kind = \"zvd\"", "frequency_hz = 100.0\ndamping = 0.1") + "[fixed_point]\ncommand_bits = 24\n";
    let (folder, file) = scratch(&machine);
    let mut simulate = posicast();
    // As a product of binary fractions this is 433903.60000000003 counts.
    simulate
        .arg("simulate")
        .arg(&file)
        .args(["--move", "0.4339036"])
        .current_dir(folder.path());
    let said = String::from_utf8(simulate.assert().code(2).get_output().stderr.clone()).unwrap();
    assert!(
        said.contains("ends at 433904 counts, beyond a command word of 24 bits"),
        "{said}"
    );
}
