//! Invalid input: exit status 2, nothing on standard output, a message that names place and remedy, no files written.

#![cfg(test)] // lets clippy see that this is test code

use crate::cli::support::{example, one_axis, posicast, scratch};
use predicates::prelude::*;

const MODE: &str = "frequency_hz = 100.0\ndamping = 0.1";

/// Runs `command` on a machine file with this text and checks that it is refused with these words.
fn refused(command: &[&str], machine: &str, words: &[&str]) {
    let (folder, file) = scratch(machine);
    let mut run = posicast();
    run.arg(command[0])
        .arg(&file)
        .args(&command[1..])
        .current_dir(folder.path());
    let mut assert = run.assert().code(2).stdout("");
    for word in words {
        assert = assert.stderr(predicate::str::contains(*word));
    }
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|e| e.unwrap().file_name())
        .collect();
    assert_eq!(left, ["machine.toml"], "something was left behind");
}

#[test]
fn cli_an_empty_file_is_refused() {
    refused(&["design", "--json"], "", &["machine.toml", "name"]);
}

#[test]
fn cli_an_unknown_kind_is_refused_with_the_list() {
    refused(
        &["run"],
        &one_axis("kind = \"zvx\"", MODE),
        &["machine.toml:9", "zvx", "zvd"],
    );
}

#[test]
fn cli_a_negative_frequency_is_refused() {
    let machine = one_axis("kind = \"zvd\"", "frequency_hz = -3.0\ndamping = 0.1");
    refused(&["design"], &machine, &["machine.toml:11", "frequency_hz", "-3"]);
}

#[test]
fn cli_a_damping_of_one_is_refused() {
    let machine = one_axis("kind = \"zvd\"", "frequency_hz = 3.0\ndamping = 1.0");
    refused(&["generate"], &machine, &["machine.toml:12", "damping"]);
}

#[test]
fn cli_a_mode_above_half_the_sample_rate_is_refused() {
    let machine = one_axis("kind = \"zvd\"", "frequency_hz = 5000.0\ndamping = 0.1");
    refused(&["simulate"], &machine, &["machine.toml:11", "frequency_hz", "5000"]);
}

#[test]
fn cli_a_delay_longer_than_the_ring_is_refused() {
    let machine = one_axis("kind = \"zvd\"", "frequency_hz = 0.1\ndamping = 0.1");
    refused(&["generate"], &machine, &["16382", "lower"]);
}

#[test]
fn cli_more_taps_than_a_table_holds_are_refused() {
    let impulses: Vec<String> = (0..150)
        .map(|k| format!("[{}, {}]", f64::from(k) * 1.03e-3, 1.0 / 150.0))
        .collect();
    let machine = one_axis(
        &format!("kind = \"custom\"\nimpulses = [{}]", impulses.join(", ")),
        MODE,
    );
    refused(&["verify"], &machine, &["285 taps", "256"]);
}

#[test]
fn cli_a_pass_longer_than_a_sample_is_printed_by_design_and_refused_by_generate() {
    let machine = one_axis("kind = \"zvd\"", MODE).replace("50_000_000", "100_000");
    refused(&["generate"], &machine, &["axis `x`", "13 clocks", "10"]);
    let (_folder, file) = scratch(&machine);
    let output = posicast().arg("design").arg(&file).arg("--json").assert().success();
    assert_eq!(
        crate::cli::support::json(&output.get_output().stdout)["axes"][0]["quantised"]["fits"],
        false
    );
}

/// Returns the XY stage with another sample rate and PWM frequency.
fn fast_stage(sample_hz: &str, pwm_hz: &str) -> String {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    text.replace("sample_hz = 10_000 ", &format!("sample_hz = {sample_hz} "))
        .replace("frequency_hz = 20_000", &format!("frequency_hz = {pwm_hz}"))
        .replace("dead_time_s = 500e-9", "dead_time_s = 0.0")
        .replace("minimum_pulse_s = 1e-6", "minimum_pulse_s = 0.0")
        // The times of the guards are words of 16 bits, in ticks.
        .replace("watchdog_s = 0.5", "watchdog_s = 0.05")
}

#[test]
fn cli_a_tick_too_short_for_the_controller_is_printed_by_design_and_refused_by_the_others() {
    // The tick has 200 clocks, and 700 at the largest rate of whole periods of 100 clocks.
    let machine = fast_stage("250_000", "500_000");
    let sum = "capture 4 + divide 102 + shape 43 + control 517 = 666 clocks";
    let words = [
        "machine.toml:13: clock.sample_hz",
        sum,
        "lasts only 200",
        "up to 71428.5",
    ];
    for command in ["generate", "run", "verify"] {
        refused(&[command], &machine, &words);
    }
    let (_folder, file) = scratch(&machine);
    let design = posicast().arg("design").arg(&file).assert().success();
    design.stdout(predicate::str::contains("does not fit").and(predicate::str::contains(sum)));
    // A shaper alone is accepted: 250 clocks are enough for its pass.
    let alone = one_axis("kind = \"zvd\"", MODE).replace("10_000", "200_000");
    let (folder, file) = scratch(&alone);
    let mut generate = posicast();
    generate.arg("generate").arg(&file).current_dir(folder.path());
    generate.assert().success();
}

#[test]
fn cli_a_tick_too_short_for_a_division_names_the_sample_rate() {
    let machine = one_axis("kind = \"zvd\"", MODE).replace("10_000", "500_000") + "[axis.encoder]\n";
    let words = [
        "machine.toml:4: clock.sample_hz",
        "divide 102",
        "lasts only 100",
        "up to",
    ];
    refused(&["generate"], &machine, &words);
}

#[test]
fn cli_a_gain_that_the_hardware_does_not_hold_names_its_key_and_line() {
    let text = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let with = |from: &str, to: &str| text.replacen(from, to, 1);
    let cases = [
        (
            with("full_scale_velocity = 0.5 ", "full_scale_velocity = 1e-300 "),
            "machine.toml:43: axis.drive.full_scale_velocity: ",
            "= 1e-300: raise it",
        ),
        (
            with("kind = \"pd\" ", "proportional = 1e-300\nkind = \"pd\" "),
            "machine.toml:46: axis.controller.proportional: ",
            "it would be 0",
        ),
        (
            with(
                "kind = \"pd\" ",
                "c = 1.0\nk = 1.0\nepsilon = 1.0\nboundary = 1.0\nkind = \"sliding-mode\" ",
            ),
            "axis.drive.bandwidth_hz: ",
            "give bandwidth_hz",
        ),
    ];
    for (machine, place, remedy) in cases {
        refused(&["design"], &machine, &[place, remedy]);
        refused(&["generate"], &machine, &[place, remedy]);
    }
}

#[test]
fn cli_a_mode_in_kilohertz_names_its_line_and_the_question() {
    let machine = one_axis("kind = \"zvd\"", "frequency_hz = 0.030\ndamping = 0.1");
    let words = [
        "machine.toml:11: axis.mode.frequency_hz of axis x, mode 1: ",
        "lasts 33.50 s",
        "help: 0.03 Hz is a period of 33.3 s: ",
        "if it was meant in kHz, write `frequency_hz = 30`",
    ];
    refused(&["design"], &machine, &words);
    refused(&["generate"], &machine, &words);
}

#[test]
fn cli_too_many_taps_say_what_fits() {
    let modes = "frequency_hz = 20.0\ndamping = 0.1\n[[axis.mode]]\nfrequency_hz = 31.0\ndamping = 0.1\n\
                 [[axis.mode]]\nfrequency_hz = 47.0\ndamping = 0.05";
    let words = [
        "machine.toml:8: axis.shaper of axis x: ",
        "help: each of these fits",
        "clock.sample_hz = ",
    ];
    refused(&["design"], &one_axis("kind = \"three-hump-ei\"", modes), &words);
}

#[test]
fn cli_every_problem_has_its_remedy_in_a_pipe() {
    let machine = one_axis("kind = \"zdv\"", "frequency_hz = 100.0\ndamping = 5");
    let words = [
        "help: line 9: did you mean \"zvd\"?",
        "help: line 12: percent? 5 % is 0.05",
    ];
    refused(&["design"], &machine, &words);
}

#[test]
fn cli_messages_about_one_thing_are_in_the_singular() {
    let (_folder, file) = scratch(&one_axis("kind = \"none\"", MODE));
    let design = posicast().arg("design").arg(&file).assert().success();
    design.stdout(predicate::str::contains("one: 1 axis, 50 MHz").and(predicate::str::contains("1 tap at 10000 Hz")));
}

#[test]
fn cli_errors_of_optimal_name_the_key_and_a_remedy() {
    refused(
        &["design"],
        &one_axis(
            "kind = \"optimal\"\ntaps = 2",
            "frequency_hz = 40\ndamping = 0.01\nfrequency_band = 0.2\n",
        ),
        &["axis.shaper.taps", "with 2 taps", "allow `taps = "],
    );
}

#[test]
fn cli_a_binary_or_missing_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("binary.toml");
    std::fs::write(&file, [0xff, 0xfe, 0]).unwrap();
    posicast()
        .arg("design")
        .arg(&file)
        .assert()
        .code(2)
        .stdout("")
        .stderr(predicate::str::contains("UTF-8"));
    posicast()
        .arg("design")
        .arg(folder.path())
        .assert()
        .code(2)
        .stderr(predicate::str::contains("folder"));
    posicast()
        .arg("design")
        .arg("nowhere.toml")
        .assert()
        .code(2)
        .stderr(predicate::str::contains("nowhere.toml"));
}

#[test]
fn cli_a_folder_that_is_not_ours_is_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("thesis.txt"), "years of work").unwrap();
    for command in ["generate", "run"] {
        posicast()
            .arg(command)
            .arg(example("xy-stage.toml"))
            .arg("-o")
            .arg(folder.path())
            .assert()
            .code(2)
            .stdout("")
            .stderr(predicate::str::contains("posicast.json"));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn cli_a_command_file_names_its_bad_line() {
    let (folder, file) = scratch(&one_axis("kind = \"zvd\"", MODE));
    let command = folder.path().join("moves.csv");
    for (text, words) in [
        ("time,position\n0,0\n", "time_s"),
        ("time_s,position\n0,0\n0.1,abc\n", "line 3"),
        (
            "time_s,position\n0,0\n0.1,NaN\n",
            "moves.csv`: line 3: `position` is `NaN`",
        ),
        (
            "time_s,position\n0.1,0\n0.0,1\n",
            "moves.csv`: line 3: time 0 s does not lie after 0.1 s",
        ),
        ("time_s,position\n", "moves.csv`: no points"),
        ("", "moves.csv`: the file is empty"),
        ("time_s;position\n0;0\n", "semicolons"),
        ("time_s,position\n0,0\n1,1e9\n", "beyond a word"),
    ] {
        std::fs::write(&command, text).unwrap();
        posicast()
            .arg("simulate")
            .arg(&file)
            .arg("--command")
            .arg(&command)
            .current_dir(folder.path())
            .assert()
            .code(2)
            .stdout("")
            .stderr(predicate::str::contains(words));
    }
}

#[test]
fn cli_a_command_beyond_the_limits_is_warned_of() {
    let limits = "[axis.limits]\nvelocity = 0.1\ntravel = [-0.02, 0.02]\n";
    let (folder, file) = scratch(&(one_axis("kind = \"zvd\"", MODE) + limits));
    let command = folder.path().join("moves.csv");
    let outside = "line 4: axis `x` goes to 0.021 m, beyond its travel of -0.02 m to 0.02 m";
    let too_fast = "line 3: axis `x` moves faster than limits.velocity, 0.1 m/s";
    for (text, words) in [
        ("time_s,position\n0,0\n1,0.01\n3,0.021\n4,0.021\n", outside),
        ("time_s,position\n0,0\n0.01,0.01\n3,0.02\n4,0.02\n", too_fast),
        ("time_s,position\n0,0\n1,0.01\n3,0.02\n4,0.02\n", ""),
    ] {
        std::fs::write(&command, text).unwrap();
        let output = posicast()
            .args(["simulate"])
            .arg(&file)
            .arg("--command")
            .arg(&command)
            .current_dir(folder.path())
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{said}");
        assert_eq!(
            said.matches("warning").count(),
            usize::from(!words.is_empty()),
            "{said}"
        );
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn cli_options_of_a_path_need_a_path() {
    let (folder, file) = scratch(&one_axis("kind = \"zvd\"", MODE));
    for option in [["--plot", "a.svg"], ["--side", "0.01"], ["--radius", "0.01"]] {
        posicast()
            .arg("simulate")
            .arg(&file)
            .args(["-o", "wave.vcd"])
            .args(option)
            .current_dir(folder.path())
            .assert()
            .code(2)
            .stdout("")
            .stderr(predicate::str::contains("belongs to --contour"));
    }
    assert!(!folder.path().join("wave.vcd").exists());
}

#[test]
fn cli_a_named_simulator_that_is_missing_is_exit_status_3() {
    for simulator in ["verilator", "icarus"] {
        posicast()
            .arg("verify")
            .arg(example("xy-stage.toml"))
            .args(["--simulator", simulator])
            .env("PATH", "")
            .assert()
            .code(3)
            .stdout("")
            .stderr(predicate::str::contains("not found"));
    }
}

/// Returns the ball screw, whose mode follows from [axis.mechanics], with another value of a key.
fn ball_screw(key: &str, value: &str) -> String {
    let text = std::fs::read_to_string(example("ball-screw.toml")).unwrap();
    with_value(&text, key, value)
}

/// Replaces the value of every line that begins with this key.
fn with_value(text: &str, key: &str, value: &str) -> String {
    let start = format!("{key} = ");
    let lines = text.lines().map(|line| {
        if line.starts_with(&start) {
            format!("{start}{value}\n")
        } else {
            format!("{line}\n")
        }
    });
    let changed: String = lines.collect();
    assert_ne!(changed, text, "{key}");
    changed
}

#[test]
fn cli_an_error_of_a_mode_that_follows_from_mechanics_blames_the_mechanics() {
    for (key, value, words) in [
        (
            "motor_held_damping",
            "0.7",
            &[
                "machine.toml:36: axis.mechanics.motor_held_damping of axis z: shaper",
                "or use \"zv\"",
            ][..],
        ),
        (
            "bearing_stiffness",
            "1e3",
            &[
                "machine.toml:26: axis.mechanics of axis z: the shaper lasts",
                "check the units, lengths in m",
            ],
        ),
        (
            "tolerance",
            "0.99",
            &[
                "machine.toml:24: axis.shaper.tolerance of axis z: shaper",
                "tolerance 0.99",
            ],
        ),
    ] {
        let machine = ball_screw(key, value);
        let machine = match key {
            // Soft bearings alone still hold 38 kg at 0.8 Hz.
            "bearing_stiffness" => with_value(&machine, "table_mass", "1e5"),
            _ => machine,
        };
        refused(&["design"], &machine, words);
    }
}

#[test]
fn cli_lengths_of_a_screw_in_millimetres_are_asked_for() {
    for (key, value, hint) in [
        ("lead_m", "16", "`lead_m` is in metres: 16 mm is 0.016; else"),
        (
            "screw_diameter_m",
            "13.5",
            "`screw_diameter_m` is in metres: 13.5 mm is 0.0135; else",
        ),
        (
            "screw_length_m",
            "600",
            "`screw_length_m` is in metres: 600 mm is 0.6; else",
        ),
    ] {
        refused(
            &["design"],
            &ball_screw(key, value),
            &[&format!("axis.mechanics.{key}"), hint],
        );
    }
}

#[test]
fn cli_values_that_the_supervisor_does_not_hold_get_their_range_and_a_remedy() {
    let stage = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let ticks = "allowed: at least 0, at most 6.5535 s, the 65,535 ticks that its word counts";
    for value in ["7.0", "60.0", "500.0"] {
        refused(
            &["design"],
            &with_value(&stage, "watchdog_s", value),
            &[ticks, "a lower clock.sample_hz allows more"],
        );
    }
    let counts = with_value(&stage, "following_error", "0.04");
    let words = [
        "axis.limits.following_error: axis x: found 0.04 m; allowed: 1.52588e-11 to 0.0327679 m",
        "help: write `following_error = 0.0327679`, or less; a lower counts_per_unit allows more",
    ];
    refused(&["design"], &counts, &words);
}

#[test]
fn cli_a_stop_that_leaves_the_position_word_is_blamed_on_the_keys_that_decide() {
    let stage = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let slow = with_value(&with_value(&stage, "travel", "[-4.0, 4.1]"), "acceleration", "0.01");
    let words = [
        ": axis.limits.acceleration: axis x: found a travel from -4 to 4.1 m",
        "a quick stop from `velocity` at `acceleration` 3.125 m",
        "help: shorten `travel`, raise `acceleration` or lower `velocity`",
    ];
    refused(&["design"], &slow, &words);
    // Here the travel alone is too long.
    let long = with_value(&stage, "travel", "[-4.0, 4.3]");
    refused(
        &["design"],
        &long,
        &[": axis.limits.travel: axis x", "help: shorten `travel`"],
    );
}

#[test]
fn cli_a_travel_beyond_the_word_is_reported_in_whole_counts() {
    let stage = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let narrow = format!(
        "{}\n[fixed_point]\ncommand_bits = 24\n",
        with_value(&stage, "travel", "[-0.1, 0.4339036]")
    );
    let words = [
        "found a travel of up to 433904 counts; allowed: at most 32767 counts in 24 bits",
        "help: set fixed_point.command_bits = 32, which a stage needs",
    ];
    refused(&["design"], &narrow, &words);
    // Without a controller the narrowest word that holds it is enough.
    let alone =
        one_axis("kind = \"zvd\"", MODE) + "[axis.limits]\ntravel = [0, 0.1]\n[fixed_point]\ncommand_bits = 24\n";
    refused(&["design"], &alone, &["help: set fixed_point.command_bits = 26"]);
}

#[test]
fn cli_a_device_of_another_vendor_is_refused_with_a_remedy() {
    let machine = one_axis("kind = \"zvd\"", MODE) + "[target]\nfamily = \"ecp5\"\n";
    let words = [
        "machine.toml:14: target.family: found \"ecp5\"",
        "leave it out: the Verilog suits every device",
    ];
    refused(&["design"], &machine, &words);
}

#[test]
fn cli_sliding_mode_without_gains_gets_starting_values() {
    let stage = std::fs::read_to_string(example("xy-stage-torque.toml")).unwrap();
    let without = stage
        .lines()
        .filter(|line| !["c = ", "k = ", "boundary = "].iter().any(|key| line.starts_with(key)));
    let without = without.collect::<Vec<_>>().join("\n");
    let words = [
        "axis.controller.c of axis x: found no such key",
        "begin with c = 150.0, k = 50.0, and in m/s² and m/s epsilon = 4, boundary = 0.05",
        "`kind = \"pd\"`",
    ];
    refused(&["design"], &without, &words);
    // The figures are in the axis's unit.
    let rotary = without.replacen("unit = \"m\"", "unit = \"mrad\"", 1);
    refused(
        &["design"],
        &rotary,
        &["in mrad/s² and mrad/s epsilon = 4000, boundary = 50 ("],
    );
}

#[test]
fn cli_an_unknown_unit_is_refused_with_a_remedy() {
    let machine = one_axis("kind = \"zvd\"", MODE).replace("\"x\"", "\"x\"\nunit = \"inch\"");
    let words = [
        "axis.unit of axis x: found \"inch\"",
        "help: write lengths in mm (an inch is 25.4 mm)",
    ];
    refused(&["design"], &machine, &words);
}

#[test]
fn cli_a_file_in_another_encoding_is_refused_with_its_line_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("latin.toml");
    std::fs::write(&file, b"name = \"m\"\n# Gr\xf6\xdfe\n").unwrap();
    let assert = posicast().arg("design").arg(&file).assert().code(2).stdout("");
    assert.stderr(
        predicate::str::contains("latin.toml:2: found the byte 0xF6 after \"# Gr\"; allowed: text in UTF-8")
            .and(predicate::str::contains("help: save the file as UTF-8")),
    );
}

#[test]
fn cli_warnings_name_file_line_and_key() {
    let stage = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let without = stage.lines().filter(|line| !line.starts_with("watchdog_s"));
    let (_folder, file) = scratch(&without.collect::<Vec<_>>().join("\n"));
    let text = std::fs::read_to_string(&file).unwrap();
    let limits = 1 + text.lines().position(|line| line.starts_with("[axis.limits]")).unwrap();
    let expected = format!(
        "warning: {}:{limits}: axis.limits.watchdog_s: axis `x` has no watchdog_s in [axis.limits]",
        file.display()
    );
    let assert = posicast().arg("design").arg(&file).assert().success();
    assert.stderr(predicate::str::contains(expected));
    // A stage needs words of 32 bits.
    let narrow = with_value(&stage, "travel", "[-0.01, 0.01]") + "\n[fixed_point]\ncommand_bits = 24\n";
    let (folder, file) = scratch(&narrow);
    let line = narrow.lines().count();
    let generate = posicast()
        .arg("generate")
        .arg(&file)
        .current_dir(folder.path())
        .assert()
        .success();
    let expected = format!("machine.toml:{line}: fixed_point.command_bits: no stage is built");
    generate.stderr(predicate::str::contains(expected));
}

#[test]
fn cli_a_number_in_quotes_is_refused_with_the_place_of_its_unit() {
    let stage = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    for (key, words) in [
        ("watchdog_s", "`watchdog_s` has one unit, and its name says which"),
        (
            "following_error",
            "`following_error` has one unit, which docs/machine-file.md says",
        ),
    ] {
        refused(&["design"], &with_value(&stage, key, "\"0.5 ms\""), &[words]);
    }
}

#[test]
fn cli_a_misspelt_table_is_the_only_error_reported() {
    let stage = std::fs::read_to_string(example("xy-stage.toml")).unwrap();
    let (_folder, file) = scratch(&stage.replace("[axis.controller]", "[axis.controler]"));
    let design = posicast().arg("design").arg(&file).assert().code(2).stdout("");
    design.stderr(
        predicate::str::contains("did you mean `controller`?")
            .and(predicate::str::contains("without [axis.controller]").not()),
    );
}
