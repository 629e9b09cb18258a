//! `posicast identify`: from a log to modes, a machine file and a run; and the inputs that it refuses.

use crate::cli::support::{identify, posicast};
use posicast_identify::sweep::Sweep;
use posicast_identify::synthetic::{KnownMode, Sensor, known, resonance_test};
use posicast_machine::plant::drive_train::{Amplifier, DriveTrain, DriveTrainPlant, quantised};
use std::path::Path;

/// A resonance test of 13 s.
const SWEEP: &str = "5:135:10:60";

fn write_log(file: &Path, modes: &[KnownMode]) {
    let sweep = Sweep {
        rate_hz_per_s: 10.0,
        ..Sweep::default()
    };
    let log = resonance_test(modes, &sweep, &Sensor::default(), 1);
    let mut text = Vec::new();
    log.write_csv(&mut text).unwrap();
    std::fs::write(file, text).unwrap();
}

#[test]
fn cli_a_printers_log_becomes_a_machine_that_generates_hardware() {
    let folder = tempfile::tempdir().unwrap();
    write_log(
        &folder.path().join("x.csv"),
        &[known(44.0, 0.05, 0.8), known(71.0, 0.04, 0.2)],
    );
    let words = ["x.csv", "--sweep", SWEEP, "-o", "head.toml", "--plot", "x.svg"];
    let (status, said, problems) = identify(folder.path(), &words);
    assert_eq!((status, problems.as_str()), (Some(0), ""), "{said}");
    assert!(
        said.contains("head.toml written") && said.contains("direction accel_x"),
        "{said}"
    );
    let machine = std::fs::read_to_string(folder.path().join("head.toml")).unwrap();
    let machine = posicast_machine::machine_file::parse("head.toml", &machine).unwrap();
    assert_eq!(
        (machine.name.as_str(), machine.axes.len(), machine.axes[0].name.as_str()),
        ("head", 1, "x")
    );
    for (mode, truth) in machine.axes[0].modes.iter().zip([(44.0, 0.05, 0.8), (71.0, 0.04, 0.2)]) {
        assert!((mode.mode.frequency_hz / truth.0 - 1.0).abs() < 0.01);
        assert!((mode.mode.damping / truth.1 - 1.0).abs() < 0.15);
        assert!((mode.participation - truth.2).abs() < 0.03);
    }
    let picture = std::fs::read_to_string(folder.path().join("x.svg")).unwrap();
    assert!(picture.contains("measured") && picture.contains("interval and margin"));
    let generated = posicast()
        .current_dir(folder.path())
        .args(["generate", "head.toml"])
        .output()
        .unwrap();
    assert_eq!(generated.status.code(), Some(0));
}

#[test]
fn cli_the_document_has_modes_and_shapers() {
    let folder = tempfile::tempdir().unwrap();
    write_log(&folder.path().join("y.csv"), &[known(60.0, 0.05, 1.0)]);
    let (status, said, _) = identify(folder.path(), &["y.csv", "--sweep", SWEEP, "--json"]);
    assert_eq!(status, Some(0));
    let document: serde_json::Value = serde_json::from_str(&said).unwrap();
    let mode = &document["modes"][0];
    assert!((mode["frequency_hz"].as_f64().unwrap() - 60.0).abs() < 0.6);
    for key in ["damping", "participation", "frequency_sd_hz", "damping_sd"] {
        assert!(mode[key].as_f64().unwrap() > 0.0, "{key}");
    }
    let first = &document["recommended"][0];
    assert!(first["kind"].is_string() && first["duration_s"].as_f64().unwrap() > 0.0);
    assert!(first["residual_displacement_m"].as_f64().unwrap() < first["unshaped_displacement_m"].as_f64().unwrap());
}

#[test]
fn cli_modes_replace_only_those_of_an_axis_of_an_existing_machine() {
    let folder = tempfile::tempdir().unwrap();
    write_log(&folder.path().join("log.csv"), &[known(60.0, 0.05, 1.0)]);
    posicast()
        .current_dir(folder.path())
        .args(["new", "--printer", "old.toml"])
        .output()
        .unwrap();
    let old = std::fs::read_to_string(folder.path().join("old.toml")).unwrap();
    let base = ["log.csv", "--sweep", SWEEP, "--machine", "old.toml", "-o"];
    let (status, _, problems) = identify(folder.path(), &[&base[..], &["new.toml", "--axis", "y"]].concat());
    assert_eq!(status, Some(0), "{problems}");
    let new = std::fs::read_to_string(folder.path().join("new.toml")).unwrap();
    let parsed = |text: &str| posicast_machine::machine_file::parse("m", text).unwrap();
    let (before, after) = (parsed(&old), parsed(&new));
    assert_eq!(before.axes[0], after.axes[0]);
    assert!((after.axes[1].modes[0].mode.frequency_hz - 60.0).abs() < 0.6);
    // Comments stay, except for those of the replaced lines.
    let comments = |text: &str| text.matches('#').count();
    assert!(comments(&new) + 6 > comments(&old), "{new}");
    for (words, expected) in [
        (&["new2.toml", "--axis", "z"][..], "no axis \"z\""),
        (&["old.toml", "--axis", "y"][..], "an input is never replaced"),
    ] {
        let (status, said, problems) = identify(folder.path(), &[&base[..], words].concat());
        assert_eq!((status, said.as_str()), (Some(2), ""));
        assert!(problems.contains(expected), "{problems}");
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("old.toml")).unwrap(), old);
}

#[test]
fn cli_a_step_and_a_decay_become_machines() {
    let folder = tempfile::tempdir().unwrap();
    let (frequency_hz, damping) = (0.45f64, 0.01f64);
    let omega = std::f64::consts::TAU * frequency_hz;
    // The load swings after the trolley has stopped; before that comes the trolley's step.
    let swing = |t: f64| (-damping * omega * t).exp() * (omega * (1.0 - damping * damping).sqrt() * t).cos();
    let decay: String = (0..1000)
        .map(|n| format!("{},{}\n", f64::from(n) * 0.02, swing(f64::from(n) * 0.02)))
        .collect();
    let step: String = (-50..950)
        .map(|n| {
            let t = f64::from(n) * 0.02;
            let sine = damping / (1.0 - damping * damping).sqrt() * (-damping * omega * t).exp();
            let sine = sine * (omega * (1.0 - damping * damping).sqrt() * t).sin();
            let (command, response) = if n < 0 {
                (0.0, 0.0)
            } else {
                (1.0, 1.0 - swing(t) - sine)
            };
            format!("{},{command},{response}\n", t + 1.0)
        })
        .collect();
    for (name, header, rows) in [
        ("decay", "time,response", decay),
        ("step", "time,command,response", step),
    ] {
        let log = format!("{name}.csv");
        std::fs::write(folder.path().join(&log), format!("{header}\n{rows}")).unwrap();
        let machine = format!("{name}.toml");
        let (status, said, problems) = identify(folder.path(), &[&log, "-o", &machine, "--json"]);
        assert_eq!(status, Some(0), "{problems}");
        let document: serde_json::Value = serde_json::from_str(&said).unwrap();
        let found = &document["modes"][0];
        assert!(
            (found["frequency_hz"].as_f64().unwrap() - frequency_hz).abs() < 1e-6,
            "{found}"
        );
        assert!((found["damping"].as_f64().unwrap() - damping).abs() < 1e-6, "{found}");
        // A crane is a slow machine.
        let text = std::fs::read_to_string(folder.path().join(&machine)).unwrap();
        assert!(text.contains("crane"), "{text}");
        let generated = posicast()
            .current_dir(folder.path())
            .args(["generate", &machine])
            .output()
            .unwrap();
        assert_eq!(generated.status.code(), Some(0));
    }
}

#[test]
fn cli_new_from_a_log_writes_the_same_machine_and_replaces_none() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..500)
        .map(|n| {
            let t = 1e-3 * f64::from(n);
            format!("{t},{}\n", (-6.0 * t).exp() * (190.0 * t).cos())
        })
        .collect();
    std::fs::write(folder.path().join("stop.csv"), format!("time,response\n{rows}")).unwrap();
    let new = || {
        let mut command = posicast();
        command
            .current_dir(folder.path())
            .args(["new", "--from-log", "stop.csv", "head.toml"]);
        command.output().unwrap().status.code()
    };
    assert_eq!(new(), Some(0));
    let written = std::fs::read_to_string(folder.path().join("head.toml")).unwrap();
    assert_eq!(identify(folder.path(), &["stop.csv", "-o", "other.toml"]).0, Some(0));
    let other = std::fs::read_to_string(folder.path().join("other.toml")).unwrap();
    let modes = |text: &str| {
        text.lines()
            .filter(|line| line.contains("measured"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(modes(&written), modes(&other));
    assert_eq!(modes(&written).len(), 2);
    assert_eq!(new(), Some(2), "it is there already");
}

/// Writes a free decay at 30 Hz.
fn write_decay(folder: &Path) {
    let rows: String = (0..500)
        .map(|n| {
            let t = 1e-3 * f64::from(n);
            format!("{t},{}\n", (-6.0 * t).exp() * (190.0 * t).cos())
        })
        .collect();
    std::fs::write(folder.join("stop.csv"), format!("time,response\n{rows}")).unwrap();
}

#[test]
fn cli_a_rotary_axis_has_angles_in_text_picture_and_document() {
    let folder = tempfile::tempdir().unwrap();
    write_decay(folder.path());
    let joint = ["stop.csv", "--joint", "--plot", "joint.svg"];
    let (status, said, _) = identify(folder.path(), &joint);
    assert_eq!(status, Some(0));
    assert!(
        said.contains("acceleration by 5 rad/s²") && said.contains("µrad"),
        "{said}"
    );
    assert!(!said.contains("µm") && !said.contains("m/s²"), "{said}");
    let picture = std::fs::read_to_string(folder.path().join("joint.svg")).unwrap();
    assert!(picture.contains("by 5 rad/s²") && picture.contains("deflection, µrad"));
    let (_, said, _) = identify(folder.path(), &["stop.csv", "--joint", "--json"]);
    let document: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(document["si_unit"], "rad");
    // The axis of a machine that is there says its unit.
    std::fs::write(
        folder.path().join("arm.toml"),
        std::fs::read_to_string(crate::cli::support::example("robot-joint.toml")).unwrap(),
    )
    .unwrap();
    let (status, said, problems) = identify(folder.path(), &["stop.csv", "--machine", "arm.toml", "-o", "new.toml"]);
    assert_eq!(status, Some(0), "{problems}");
    assert!(said.contains("rad/s²") && !said.contains("m/s²"), "{said}");
    let (_, said, _) = identify(folder.path(), &["stop.csv"]);
    assert!(said.contains("acceleration by 5 m/s²") && said.contains("µm"), "{said}");
}

#[test]
fn cli_new_from_a_log_names_the_values_left_to_measure() {
    let folder = tempfile::tempdir().unwrap();
    write_decay(folder.path());
    let new = |kind: &str, file: &str| {
        let mut command = posicast();
        command.current_dir(folder.path());
        let output = command
            .args(["new", kind, "--from-log", "stop.csv", file])
            .output()
            .unwrap();
        (
            String::from_utf8(output.stdout).unwrap(),
            std::fs::read_to_string(folder.path().join(file)).unwrap(),
        )
    };
    // The mode of the joint is measured; its counts and the bandwidth of its drive are not.
    let (said, text) = new("--joint", "arm.toml");
    assert_eq!(text.matches("# MEASURE").count(), 2, "{text}");
    assert!(text.contains("Measure what is marked MEASURE"), "{text}");
    assert!(
        said.contains("next: put your values in the 2 lines that say MEASURE, then `posicast design arm.toml`"),
        "{said}"
    );
    assert!(said.contains("rad/s²") && !said.contains("m/s²"), "{said}");
    // Of a crane everything is.
    let (said, text) = new("--crane", "crane.toml");
    assert!(
        !text.contains("MEASURE") && text.contains("The modes are from the log"),
        "{text}"
    );
    assert!(said.contains("next: `posicast design crane.toml`"), "{said}");
    assert!(
        said.contains("`posicast schema -o posicast-machine.schema.json`"),
        "{said}"
    );
}

#[test]
fn cli_with_unknown_excitation_the_spectrum_gives_a_mode() {
    let folder = tempfile::tempdir().unwrap();
    write_log(&folder.path().join("log.csv"), &[known(60.0, 0.05, 1.0)]);
    let (status, said, _) = identify(folder.path(), &["log.csv", "--output-only", "--json"]);
    assert_eq!(status, Some(0), "{said}");
    let document: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert!(
        (document["modes"][0]["frequency_hz"].as_f64().unwrap() / 60.0 - 1.0).abs() < 0.02,
        "{said}"
    );
    assert!(
        document["remarks"][0]
            .as_str()
            .unwrap()
            .contains("even over the frequencies")
    );
}

#[test]
fn cli_a_log_without_a_mode_fails_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    write_log(&folder.path().join("rigid.csv"), &[]);
    let words = ["rigid.csv", "--sweep", SWEEP, "-o", "machine.toml"];
    let (status, said, problems) = identify(folder.path(), &words);
    assert_eq!(status, Some(1), "{said}");
    assert!(
        problems.contains("no mode was found, and no machine file written"),
        "{problems}"
    );
    assert!(!folder.path().join("machine.toml").exists());
    for (log, expected) in [
        ("time,accel_x\n", "0 rows"),
        ("", "the log is empty"),
        ("1,2,3\n", "line 1 is the first"),
    ] {
        std::fs::write(folder.path().join("bad.csv"), log).unwrap();
        let (status, said, problems) = identify(folder.path(), &["bad.csv", "--json"]);
        assert_eq!((status, said.as_str()), (Some(2), ""));
        assert!(
            problems.contains("bad.csv") && problems.contains(expected),
            "{problems}"
        );
    }
    // This sweep is not that of the log.
    let (status, _, problems) = identify(folder.path(), &["rigid.csv", "--sweep", "5:135:3:60"]);
    assert_eq!(status, Some(2), "{problems}");
    assert!(problems.contains("describes another sweep"), "{problems}");
}

#[test]
fn cli_a_drive_and_its_motor_become_a_machine_with_the_motor_held() {
    // X of the XY stage behind its current loop, shaken by a loop on its motor.
    let train = DriveTrain {
        torque_constant: 0.378,
        motor_inertia: 9.038_814e-6,
        load_mass: 50.0,
        lead_per_radian: 0.005 / std::f64::consts::TAU,
        stiffness: 33.9357e6,
        damping: 1.3e4,
        ..DriveTrain::rigid(Amplifier::TunedCurrent {
            bandwidth_rad_s: 6283.0,
        })
    };
    let mut plant = DriveTrainPlant::new(train, 1e-4);
    let (mut before, mut register, mut bit) = (0.0, 1u32, 1.0);
    let mut text = String::from("Time (ms),Current (A),Position (um)\n");
    for tick in 0..1000 {
        if tick % 8 == 0 {
            let next = (register >> 9 ^ register >> 6) & 1;
            register = (register << 1 | next) & 0x3ff;
            bit = f64::from(next) * 2.0 - 1.0;
        }
        let x = quantised(train.lead_per_radian * plant.state().angle, 1e-7);
        let current = 4e3 * (200e-6 * bit - x) - 30.0 * (x - before) / 1e-4;
        before = x;
        text += &format!("{:.1},{current},{:.1}\n", f64::from(tick) * 0.1, 1e6 * x);
        plant.hold(current);
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("drive.csv"), text).unwrap();
    let (status, said, problems) = identify(folder.path(), &["drive.csv", "-o", "x.toml"]);
    assert_eq!(status, Some(0), "{said}{problems}");
    assert!(
        said.contains("modes with the motor held") && said.contains("with the motor free"),
        "{said}"
    );
    let machine = std::fs::read_to_string(folder.path().join("x.toml")).unwrap();
    assert!(machine.contains("measured = \"motor_held\""), "{machine}");
    let machine = posicast_machine::machine_file::parse("x.toml", &machine).unwrap();
    let (found, truth) = (machine.axes[0].modes[0].mode, train.held_mode());
    assert!(
        (found.frequency_hz / truth.frequency_hz - 1.0).abs() < 0.01,
        "{found:?}"
    );
    assert!((found.damping / truth.damping - 1.0).abs() < 0.15, "{found:?}");
}

#[test]
fn cli_the_sweep_of_the_example_is_found_in_it_and_stated() {
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/printer-x.csv");
    let folder = tempfile::tempdir().unwrap();
    let (status, said, problems) = identify(folder.path(), &[example]);
    assert_eq!(status, Some(0), "{problems}");
    for expected in [
        "estimated from the log, of 30 … 85 Hz at 2 Hz/s",
        "without a square wave",
        "44.3",
        "71",
    ] {
        assert!(said.contains(expected), "{expected}: {said}");
    }
}

#[test]
fn cli_a_rigid_machine_under_the_present_test_has_no_mode() {
    let log = concat!(env!("CARGO_MANIFEST_DIR"), "/../identify/tests/data/rigid-5-40.csv");
    let folder = tempfile::tempdir().unwrap();
    for sweep in ["5:40:1:60", "5:40:1:60:400:1.2"] {
        let (status, said, problems) = identify(folder.path(), &[log, "--sweep", sweep]);
        assert_eq!(status, Some(1), "{said} {problems}");
        assert!(said.contains("square wave of 400 mm/s² and 1.2 s"), "{said}");
    }
    let (status, _, problems) = identify(folder.path(), &[log, "--sweep", "5:40:1:60:400"]);
    assert_eq!(status, Some(2));
    assert!(problems.contains("or six as 5:135:1:60:400:1.2"), "{problems}");
}
