//! `posicast identify` on logs as firmware and tools write them, and its commands for the two axes of a printer.

use crate::cli::support::{identify, posicast};
use posicast_identify::sweep::Sweep;
use posicast_identify::synthetic::{Sensor, known, resonance_test};
use std::path::Path;

const XYZ_G: &str = include_str!("../cases/identify/xyz_g.csv");
const RRF: &str = include_str!("../cases/identify/rrf.csv");
const PSD: &str = include_str!("../cases/identify/psd.csv");

/// Text with its lines joined, as boxes of errors break them.
fn joined(text: &str) -> String {
    let words = text
        .split_whitespace()
        .filter(|word| !matches!(*word, "│" | "×" | "help:"));
    words.collect::<Vec<_>>().join(" ")
}

#[test]
fn cli_stops_of_an_accelerometer_are_found_without_renaming_columns() {
    let folder = tempfile::tempdir().unwrap();
    let named = XYZ_G.replacen("time,x,y,z", "time,accel_x (g),accel_y (g),accel_z (g)", 1);
    for (name, text) in [("xyz_g.csv", XYZ_G), ("rrf.csv", RRF), ("named_g.csv", &named)] {
        std::fs::write(folder.path().join(name), text).unwrap();
        let (status, said, problems) = identify(folder.path(), &[name, "--json"]);
        assert_eq!((status, problems.as_str()), (Some(0), ""), "{name}: {said}");
        let document: serde_json::Value = serde_json::from_str(&said).unwrap();
        assert_eq!(
            (&document["axis"], &document["method"]),
            (&"x".into(), &"ring-down".into()),
            "{name}"
        );
        let modes = document["modes"].as_array().unwrap();
        let (hz, damping) = (
            modes[0]["frequency_hz"].as_f64().unwrap(),
            modes[0]["damping"].as_f64().unwrap(),
        );
        assert_eq!(modes.len(), 1, "{name}: {said}");
        assert!(
            (hz / 18.1 - 1.0).abs() < 0.005 && (damping / 0.05 - 1.0).abs() < 0.1,
            "{name}: {hz} {damping}"
        );
    }
    let (status, said, _) = identify(folder.path(), &["rrf.csv", "--direction", "y", "-o", "y.toml"]);
    assert!(
        status == Some(0) && said.contains("direction y") && said.contains("51."),
        "{said}"
    );
    let (status, _, problems) = identify(folder.path(), &["rrf.csv", "--direction", "w"]);
    assert!(
        status == Some(2) && joined(&problems).contains("the directions of the log are x, y, z"),
        "{problems}"
    );
}

#[test]
fn cli_ambiguous_columns_and_spectra_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let two: String = XYZ_G
        .lines()
        .map(|line| line.split(',').take(3).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    write("xy.csv", &two);
    let (status, said, problems) = identify(folder.path(), &["xy.csv", "-o", "m.toml"]);
    assert_eq!((status, said.as_str()), (Some(2), ""));
    assert!(
        joined(&problems).contains("`--columns time,accel_x_g,accel_y_g`"),
        "{problems}"
    );
    assert!(!folder.path().join("m.toml").exists());
    let words = ["xy.csv", "--columns", "time,accel_x_g,accel_y_g", "-o", "m.toml"];
    let (status, said, problems) = identify(folder.path(), &words);
    assert!(status == Some(0) && said.contains("18.1"), "{said}{problems}");
    let (status, said, _) = identify(folder.path(), &["xy.csv", "--columns", "time,-,response"]);
    assert!(status == Some(0) && said.contains("51."), "{said}");
    write("psd.csv", PSD);
    let (status, said, problems) = identify(folder.path(), &["psd.csv"]);
    assert_eq!((status, said.as_str()), (Some(2), ""));
    assert!(
        joined(&problems).contains("TEST_RESONANCES AXIS=X OUTPUT=raw_data"),
        "{problems}"
    );
    // A file that was cut lacks its rate.
    let cut: String = RRF.lines().take(400).map(|line| format!("{line}\n")).collect();
    write("cut.csv", &cut);
    let (status, _, problems) = identify(folder.path(), &["cut.csv"]);
    assert!(status == Some(2) && problems.contains("--rate HZ"), "{problems}");
    let (status, said, _) = identify(folder.path(), &["cut.csv", "--rate", "1344"]);
    assert!(status == Some(0) && said.contains("direction x"), "{said}");
}

/// Writes a resonance test of 13 s, of the direction of this column.
fn write_test(folder: &Path, name: &str, column: &str, frequency_hz: f64) {
    let sweep = Sweep {
        rate_hz_per_s: 10.0,
        ..Sweep::default()
    };
    let sensor = Sensor {
        sample_s: 1.0 / 1600.0,
        ..Sensor::default()
    };
    let mut log = resonance_test(&[known(frequency_hz, 0.05, 1.0)], &sweep, &sensor, 1);
    log.directions[0].0 = column.into();
    let mut text = Vec::new();
    log.write_csv(&mut text).unwrap();
    std::fs::write(folder.join(name), text).unwrap();
}

#[test]
fn cli_the_two_commands_for_x_and_y_work_from_either_axis() {
    let axes = [("x", 52.0), ("y", 41.0)];
    for (first, second) in [(axes[0], axes[1]), (axes[1], axes[0])] {
        let folder = tempfile::tempdir().unwrap();
        for (axis, hz) in axes {
            write_test(
                folder.path(),
                &format!("raw_data_{axis}.csv"),
                &format!("accel_{axis}"),
                hz,
            );
        }
        let sweep = ["--sweep", "5:135:10:60"];
        let log = format!("raw_data_{}.csv", first.0);
        let (status, said, problems) = identify(
            folder.path(),
            &[&[log.as_str(), "-o", "printer.toml"][..], &sweep].concat(),
        );
        assert_eq!(status, Some(0), "{said}{problems}");
        assert!(said.contains("max_accel mm/s²") && said.contains("120 µm"), "{said}");
        let log = format!("raw_data_{}.csv", second.0);
        let words = [
            log.as_str(),
            "--machine",
            "printer.toml",
            "--axis",
            second.0,
            "-o",
            "both.toml",
        ];
        let (status, said, problems) = identify(folder.path(), &[&words[..], &sweep].concat());
        assert_eq!(status, Some(0), "{said}{problems}");
        assert!(said.contains(&format!("copies of those of axis {}", first.0)), "{said}");
        let text = std::fs::read_to_string(folder.path().join("both.toml")).unwrap();
        let machine = posicast_machine::machine_file::parse("both.toml", &text).unwrap();
        assert_eq!(machine.axes.len(), 2);
        for (axis, (name, hz)) in machine.axes.iter().zip(axes) {
            assert_eq!(axis.name, name);
            assert!((axis.modes[0].mode.frequency_hz / hz - 1.0).abs() < 0.01, "{text}");
        }
        let design = posicast()
            .current_dir(folder.path())
            .args(["design", "both.toml"])
            .output()
            .unwrap();
        assert_eq!(design.status.code(), Some(0));
        // The same command again, into the machine that has both now.
        let words = [
            log.as_str(),
            "--machine",
            "both.toml",
            "--axis",
            second.0,
            "-o",
            "again.toml",
        ];
        let (status, said, problems) = identify(folder.path(), &[&words[..], &sweep].concat());
        assert!(status == Some(0) && !said.contains("copies of"), "{said}{problems}");
    }
}

#[test]
fn cli_shapers_that_leave_too_much_have_their_own_heading() {
    let folder = tempfile::tempdir().unwrap();
    write_test(folder.path(), "x.csv", "accel_x", 60.0);
    let words = ["x.csv", "--sweep", "5:135:10:60", "--margin", "6"];
    let (status, said, problems) = identify(folder.path(), &words);
    assert_eq!(status, Some(0), "{problems}");
    let (few, more) = said.split_once("more than 5 % is left").unwrap();
    let (_, few) = few.split_once("5 % or less is left").unwrap();
    let ratios = |text: &str| -> Vec<f64> {
        let rows = text.lines().map(|line| {
            line.split("  ")
                .map(str::trim)
                .filter(|cell| !cell.is_empty())
                .collect::<Vec<_>>()
        });
        rows.filter_map(|cells| cells.get(4)?.parse().ok()).collect()
    };
    let (few, more) = (ratios(few), ratios(more));
    assert!(!few.is_empty() && !more.is_empty(), "{said}");
    assert!(
        few.iter().all(|ratio| *ratio <= 5.0) && more.iter().all(|ratio| *ratio > 5.0),
        "{said}"
    );
}
