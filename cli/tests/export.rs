//! `export`: each format holds the impulses of the design, checked against the formulas of those who read it.

use crate::cli::support::{example, json, one_axis, posicast, scratch};
use std::f64::consts::{PI, SQRT_2};
use std::path::Path;

const MODE: &str = "frequency_hz = 40.0\ndamping = 0.1";

fn export(machine: &Path, words: &[&str]) -> String {
    let output = posicast().arg("export").arg(machine).args(words).output().unwrap();
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

/// The impulses of an axis as `design --json` has them.
fn impulses(machine: &Path, axis: usize) -> Vec<[f64; 2]> {
    let output = posicast().arg("design").arg(machine).arg("--json").output().unwrap();
    let document = json(&output.stdout);
    let impulses = document["axes"][axis]["impulses"].as_array().unwrap();
    let number = |impulse: &serde_json::Value, key: &str| impulse[key].as_f64().unwrap();
    let pair = |impulse| [number(impulse, "time_s"), number(impulse, "amplitude")];
    impulses.iter().map(pair).collect()
}

/// The number after `key` in the text.
fn after(text: &str, key: &str) -> f64 {
    let rest = text.split_once(key).unwrap_or_else(|| panic!("{key} in {text}")).1;
    let end = rest.find(|c: char| !"0123456789.e-".contains(c)).unwrap_or(rest.len());
    rest[..end].parse().unwrap()
}

fn near(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() < 1e-6 * expected.abs().max(1e-3),
        "{found} instead of {expected}"
    );
}

/// Amplitudes, which need not sum to 1, and times that Klipper computes from what is in its configuration.
fn of_klipper(name: &str, frequency_hz: f64, damping: f64) -> Vec<[f64; 2]> {
    let root = (1.0 - damping * damping).sqrt();
    let period_s = 1.0 / (frequency_hz * root);
    let k = (-damping * PI / root).exp();
    let m = (-0.75 * damping * PI / root).exp();
    match name {
        "zv" => vec![[0.0, 1.0], [0.5 * period_s, k]],
        "zvd" => vec![[0.0, 1.0], [0.5 * period_s, 2.0 * k], [period_s, k * k]],
        _ => vec![
            [0.0, 1.0 - 1.0 / SQRT_2],
            [0.375 * period_s, (SQRT_2 - 1.0) * m],
            [0.75 * period_s, (1.0 - 1.0 / SQRT_2) * m * m],
        ],
    }
}

#[test]
fn cli_klipper_computes_the_designed_impulses_from_its_section() {
    for kind in ["zv", "zvd", "mzv"] {
        let (_folder, machine) = scratch(&one_axis(&format!("kind = \"{kind}\""), MODE));
        let text = export(&machine, &["--to", "klipper"]);
        assert!(
            text.contains(&format!("[input_shaper]\nshaper_type_x: {kind}\n")),
            "{text}"
        );
        let theirs = of_klipper(kind, after(&text, "shaper_freq_x: "), after(&text, "damping_ratio_x: "));
        let sum: f64 = theirs.iter().map(|[_, amplitude]| amplitude).sum();
        let ours = impulses(&machine, 0);
        assert_eq!(ours.len(), theirs.len());
        for ([time, amplitude], [their_time, their_amplitude]) in ours.into_iter().zip(theirs) {
            near(time, their_time);
            near(amplitude, their_amplitude / sum);
        }
    }
    let (_folder, machine) = scratch(&one_axis("kind = \"two-hump-ei\"", MODE));
    assert!(export(&machine, &["--to", "klipper"]).contains("shaper_type_x: 2hump_ei\n"));
}

#[test]
fn cli_marlin_delays_by_half_a_period_of_its_frequency() {
    let (_folder, machine) = scratch(&one_axis("kind = \"zv\"", MODE));
    let text = export(&machine, &["--to", "marlin"]);
    let frequency_hz = after(&text, "M593 X F");
    assert!((frequency_hz - 40.0 * 0.99f64.sqrt()).abs() < 1e-4, "{text}");
    let [time_s, amplitude] = impulses(&machine, 0)[1];
    assert!((0.5 / frequency_hz - time_s).abs() < 1e-7, "{text}");
    let damping = after(&text, " D");
    let k = (-damping * PI / (1.0 - damping * damping).sqrt()).exp();
    near(amplitude, k / (1.0 + k));
}

#[test]
fn cli_reprapfirmware_adds_amplitudes_up_and_counts_times_from_impulse_to_impulse() {
    for (kind, row) in [("zvd", vec![1.0, 2.0, 1.0]), ("zvddd", vec![1.0, 4.0, 6.0, 4.0, 1.0])] {
        let (_folder, machine) = scratch(&one_axis(&format!("kind = \"{kind}\""), MODE));
        let text = export(&machine, &["--to", "reprapfirmware"]);
        let command = text
            .lines()
            .find(|line| line.starts_with("M593 P\"custom\" H"))
            .unwrap();
        let (sums, times) = command["M593 P\"custom\" H".len()..].split_once(" T").unwrap();
        let numbers = |text: &str| text.split(':').map(|n| n.parse::<f64>().unwrap()).collect::<Vec<f64>>();
        // Powers of 1 + K in Pascal's triangle.
        let k = (-0.1 * PI / 0.99f64.sqrt()).exp();
        let shares: Vec<f64> = row.iter().enumerate().map(|(i, n)| n * k.powi(i as i32)).collect();
        let all: f64 = shares.iter().sum();
        let [sums, times] = [sums, times].map(numbers);
        assert_eq!((sums.len(), times.len()), (row.len() - 1, row.len() - 1), "{command}");
        let mut sum = 0.0;
        for (share, (found, time)) in shares.iter().zip(sums.iter().zip(&times)) {
            sum += share / all;
            assert!((found - sum).abs() < 1e-6, "{command}");
            assert!((time - 0.5 / (40.0 * 0.99f64.sqrt())).abs() < 1e-6, "{command}");
        }
    }
}

#[test]
fn cli_tables_have_the_numbers_of_the_design() {
    let machine = example("xy-stage.toml");
    let ours: Vec<(usize, [f64; 2])> = [0, 1]
        .into_iter()
        .flat_map(|axis| impulses(&machine, axis).into_iter().map(move |pair| (axis, pair)))
        .collect();
    let csv = export(&machine, &["--to", "csv"]);
    let numpy = export(&machine, &["--to", "numpy"]);
    assert!(csv.starts_with("axis,time_s,amplitude\nx,0.0,"), "{csv}");
    let numbers = numpy.lines().filter(|line| !line.starts_with('#'));
    for (text, separator) in [(csv.lines().skip(1).collect::<Vec<_>>(), ','), (numbers.collect(), ' ')] {
        assert_eq!(text.len(), ours.len());
        for (line, (axis, pair)) in text.iter().zip(&ours) {
            let cells: Vec<&str> = line.split(separator).collect();
            assert!([["x", "y"][*axis], &axis.to_string()].contains(&cells[0]), "{line}");
            assert_eq!([cells[1], cells[2]].map(|cell| cell.parse::<f64>().unwrap()), *pair);
        }
    }
    let matlab = export(&machine, &["--to", "matlab", "--axis", "y"]);
    let row = matlab
        .split_once("xy_stage.y.amplitude = [")
        .unwrap()
        .1
        .split_once("];")
        .unwrap()
        .0;
    let amplitudes: Vec<f64> = row.split(' ').map(|n| n.parse().unwrap()).collect();
    let expected: Vec<f64> = impulses(&machine, 1).iter().map(|[_, amplitude]| *amplitude).collect();
    assert_eq!(amplitudes, expected);
    assert!(!matlab.contains("xy_stage.x."), "{matlab}");
}

#[test]
fn cli_the_header_compiles_and_its_numbers_sum_up() {
    let folder = tempfile::tempdir().unwrap();
    let header = export(&example("xy-stage.toml"), &["--to", "c"]);
    std::fs::write(folder.path().join("shapers.h"), header).unwrap();
    let main = "#include \"shapers.h\"\n#include \"shapers.h\"\n#include <stdio.h>\nint main(void) {\n\
        double a = 0; long x = 0, y = 0; int i;\n\
        for (i = 0; i < XY_STAGE_X_IMPULSES; i++) a += xy_stage_x_amplitude[i] + 0 * xy_stage_y_amplitude[i] + 0 * xy_stage_x_time_s[i];\n\
        for (i = 0; i < XY_STAGE_X_TAPS; i++) x += xy_stage_x_coefficient[i] + 0 * (int) xy_stage_x_delay_samples[i];\n\
        for (i = 0; i < XY_STAGE_Y_TAPS; i++) y += xy_stage_y_coefficient[i] + 0 * (int) xy_stage_y_delay_samples[i];\n\
        printf(\"%.9f %g %d %d %.6f\", a, XY_STAGE_SAMPLE_HZ, x == 1L << XY_STAGE_COEFFICIENT_FRACTION, x == y, xy_stage_y_time_s[1]);\n\
        return 0; }\n";
    std::fs::write(folder.path().join("main.c"), main).unwrap();
    let program = folder.path().join("main");
    let compiled = std::process::Command::new("gcc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&program)
        .arg(folder.path().join("main.c"))
        .output()
        .unwrap();
    assert!(
        compiled.status.success(),
        "{}",
        String::from_utf8_lossy(&compiled.stderr)
    );
    let said = std::process::Command::new(program).output().unwrap().stdout;
    // Half a damped period of y's mode.
    let (frequency_hz, damping): (f64, f64) = (93.2897800884888, 0.153542487341);
    let half_s = 0.5 / (frequency_hz * (1.0 - damping * damping).sqrt());
    assert_eq!(
        String::from_utf8(said).unwrap(),
        format!("1.000000000 10000 1 1 {half_s:.6}")
    );
}

#[test]
fn cli_what_a_firmware_cannot_express_is_refused_with_a_remedy() {
    let two_modes = format!("{MODE}\n[[axis.mode]]\nfrequency_hz = 90.0\ndamping = 0.05");
    let z = one_axis("kind = \"zvd\"", MODE).replace("name = \"x\"", "name = \"z\"");
    let machines = [
        (
            "klipper",
            one_axis("kind = \"zvdd\"", MODE),
            "does not have the kind `zvdd`",
            "mzv",
        ),
        (
            "klipper",
            one_axis("kind = \"zvd\"", &two_modes),
            "one mode per axis",
            "reprapfirmware",
        ),
        (
            "klipper",
            one_axis("kind = \"ei\"\ntolerance = 0.1", MODE),
            "tolerance of 0.05",
            "set it to 0.05",
        ),
        (
            "klipper",
            one_axis("kind = \"three-hump-ei\"", "frequency_hz = 40.0\ndamping = 0.25"),
            "up to 0.2",
            "choose zv",
        ),
        ("klipper", z, "the axes x and y", "--axis"),
        ("marlin", one_axis("kind = \"zvd\"", MODE), "only ZV", "--to klipper"),
        (
            "marlin",
            one_axis("kind = \"custom\"\nimpulses = [[0.0, 0.5], [0.02, 0.5]]", MODE),
            "`custom`",
            "reprapfirmware",
        ),
        (
            "reprapfirmware",
            one_axis("kind = \"zvd\"", &two_modes),
            "2 to 5 impulses",
            "fewer impulses",
        ),
        (
            "reprapfirmware",
            one_axis("kind = \"ps-zv\"", MODE),
            "negative",
            "positive",
        ),
        (
            "reprapfirmware",
            one_axis("kind = \"none\"", MODE),
            "this shaper has 1",
            "choose a kind",
        ),
    ];
    for (format, machine, why, remedy) in machines {
        let (_folder, file) = scratch(&machine);
        let output = posicast()
            .arg("export")
            .arg(&file)
            .args(["--to", format])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr)
            .replace("\n  │ ", " ")
            .replace('\n', " ");
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(2), "{machine}");
        assert!(output.stdout.is_empty(), "{machine}");
        assert!(
            said.contains(why) && said.contains(remedy) && said.contains("machine.toml"),
            "{said}"
        );
    }
    let xy = example("xy-stage.toml");
    let refused = posicast()
        .arg("export")
        .arg(&xy)
        .args(["--to", "reprapfirmware"])
        .output()
        .unwrap();
    assert_eq!(refused.status.code(), Some(2), "its axes have different shapers");
    assert!(export(&xy, &["--to", "reprapfirmware", "--axis", "y"]).contains("M593"));
    let missing = posicast()
        .arg("export")
        .arg(&xy)
        .args(["--to", "csv", "--axis", "q"])
        .output()
        .unwrap();
    assert_eq!(missing.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("x, y"));
}
