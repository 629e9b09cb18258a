//! The machine file as its users meet it: the examples, every class of error with line, key, found and allowed, and the
//! values that a right file yields.

use posicast_model::design::kind::Kind;
use posicast_model::spec::{self, Cause, Digitise, MAX_PROBLEMS, Machine, SpecError};

const XY_STAGE: &str = include_str!("../../examples/xy-stage.toml");
const GANTRY: &str = include_str!("../../examples/gantry.toml");
const ROBOT_JOINT: &str = include_str!("../../examples/robot-joint.toml");
const CUSTOM_SHAPER: &str = include_str!("../../examples/custom-shaper.toml");
const EVERYTHING: &str = include_str!("spec_files/everything.toml");

/// A right file of one axis, a key per line, that the tests below break in one place each.
const SMALL: &str = r#"name = "slide"
[clock]
frequency_hz = 50_000_000
sample_hz = 10_000
[fixed_point]
command_bits = 32
[[axis]]
name = "x"
counts_per_unit = 1_000_000
[axis.shaper]
kind = "zvd"
[[axis.mode]]
frequency_hz = 40.0
damping = 0.1
"#;

fn right(text: &str) -> Machine {
    spec::parse("m.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

fn wrong(text: &str) -> SpecError {
    spec::parse("m.toml", text).expect_err("the file is wrong")
}

/// Replaces `from` by `to` in the small file, and expects one problem whose plain text is `expected`.
#[track_caller]
fn breaks(from: &str, to: &str, expected: &str) {
    assert_eq!(SMALL.matches(from).count(), 1, "{from} stands in the small file once");
    let error = wrong(&SMALL.replace(from, to));
    assert_eq!(error.to_string(), expected);
    assert_eq!(error.problems().len(), 1);
    assert!(!error.problems()[0].remedy.is_empty());
}

#[test]
fn golden_xy_stage_is_the_machine_of_the_thesis() {
    let machine = right(XY_STAGE);
    assert_eq!(machine.name, "xy_stage");
    assert_eq!(machine.clock.clocks_per_sample(), 5000);
    let modes = [(131.117015808451, 0.157799065776), (93.2897800884888, 0.153542487341)];
    for (axis, (frequency_hz, damping)) in machine.axes.iter().zip(modes) {
        assert_eq!(axis.kind_name(), "zvd");
        assert_eq!(axis.modes[0].mode.frequency_hz, frequency_hz);
        assert_eq!(axis.modes[0].mode.damping, damping);
        let limits = axis.limits.unwrap();
        assert_eq!(
            (limits.velocity, limits.acceleration, limits.jerk),
            (Some(0.25), Some(8.0), Some(400.0))
        );
    }
}

#[test]
fn unit_every_example_is_a_right_machine_with_a_name_of_its_own() {
    let machines = [XY_STAGE, GANTRY, ROBOT_JOINT, CUSTOM_SHAPER].map(right);
    let mut names: Vec<&str> = machines.iter().map(|m| m.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["gantry", "pick_and_place", "robot_joint", "xy_stage"]);
}

#[test]
fn unit_each_mode_has_its_effective_kind_and_tolerance() {
    let gantry = right(GANTRY);
    let axis = &gantry.axes[0];
    assert_eq!(
        axis.modes.iter().map(|m| axis.kind_of(m)).collect::<Vec<_>>(),
        [Kind::Ei, Kind::Zv]
    );
    assert_eq!(axis.kind_name(), "ei+zv");
    assert_eq!(axis.joint_kind(), None);

    let custom = right(CUSTOM_SHAPER);
    let axis = &custom.axes[0];
    assert_eq!(axis.joint_kind(), Some(Kind::Custom));
    assert_eq!(axis.kind_name(), "custom");
    assert_eq!(axis.shaper.as_ref().unwrap().impulses[3], (0.06, 0.25));
    assert_eq!(custom.fixed_point.digitise, Digitise::Nearest);

    let text = SMALL.replace(
        "damping = 0.1",
        "damping = 0.1\ntolerance = 0.02\n[[axis.mode]]\nfrequency_hz = 90\ndamping = 0",
    );
    let tolerances = |text: &str| {
        let machine = right(text);
        let axis = &machine.axes[0];
        axis.modes.iter().map(|m| axis.tolerance_of(m)).collect::<Vec<_>>()
    };
    assert_eq!(tolerances(&text), [0.02, 0.05]);
    assert_eq!(
        tolerances(&text.replace("\"zvd\"", "\"zvd\"\ntolerance = 0.1")),
        [0.02, 0.1]
    );
    let machine = right(&text);
    assert_eq!(machine.axes[0].order_of(&machine.axes[0].modes[0]), 1);
}

#[test]
fn unit_defaults_of_the_number_formats() {
    let format = |text: &str| right(text).fixed_point;
    let wide = format(&SMALL.replace("[fixed_point]\ncommand_bits = 32\n", ""));
    assert_eq!(wide, format(SMALL));
    assert_eq!(
        (wide.command_bits, wide.coefficient_fraction, wide.digitise),
        (32, None, Digitise::Modal)
    );
    assert_eq!(
        (
            wide.command_fraction,
            wide.velocity_fraction,
            wide.acceleration_fraction
        ),
        (8, 16, 24)
    );
    let narrow = format(&SMALL.replace("32", "16"));
    assert_eq!(
        (
            narrow.command_fraction,
            narrow.velocity_fraction,
            narrow.acceleration_fraction
        ),
        (8, 15, 15)
    );
}

#[test]
fn unit_a_damped_frequency_is_converted_to_the_undamped_one() {
    let machine = right(&SMALL.replace("frequency_hz = 40.0", "damped_frequency_hz = 40.0"));
    let mode = machine.axes[0].modes[0].mode;
    assert!((mode.frequency_hz - 40.0 / 0.99f64.sqrt()).abs() < 1e-12);
    assert!((mode.omega_damped() - std::f64::consts::TAU * 40.0).abs() < 1e-9);
}

#[test]
fn unit_integers_of_any_radix_and_floats_are_numbers() {
    let clock = right(&SMALL.replace("10_000", "0x2710").replace("50_000_000", "5e7")).clock;
    assert_eq!((clock.frequency_hz, clock.sample_hz), (50e6, 10e3));
}

#[test]
fn unit_text_that_is_no_toml_names_the_line() {
    let error = wrong(&SMALL.replace("name = \"x\"", "name = \"x"));
    assert!(matches!(error.problems()[0].cause, Cause::Syntax(_)));
    assert!(
        error.to_string().starts_with("m.toml:8: found a TOML syntax error: "),
        "{error}"
    );
    let twice = wrong(&SMALL.replace("[clock]", "name = \"again\"\n[clock]"));
    assert!(
        twice
            .to_string()
            .starts_with("m.toml:2: found a TOML syntax error: duplicate key"),
        "{twice}"
    );
}

#[test]
fn unit_an_empty_file_says_what_a_machine_has() {
    for text in ["", "\n\n", "# a comment\n", "\u{feff}"] {
        let expected = "m.toml:1: found an empty file; allowed: a machine with the keys name, [clock] and [[axis]]";
        assert_eq!(wrong(text).to_string(), expected, "{text:?}");
    }
}

#[test]
fn unit_an_unknown_key_lists_the_allowed_ones_and_suggests_the_nearest() {
    let error = wrong(&SMALL.replace("damping = 0.1", "damping = 0.1\ndampng = 0.1"));
    assert_eq!(
        error.to_string(),
        "m.toml:15: axis.mode.dampng of axis x, mode 1: found the unknown key dampng; allowed: frequency_hz, \
         damped_frequency_hz, damping, shaper, tolerance, order, participation"
    );
    assert_eq!(
        error.problems()[0].remedy,
        "did you mean `damping`? Else remove the key"
    );
    let expected =
        "m.toml:5: wibble: found the unknown key wibble; allowed: name, clock, fixed_point, target, axis, stage";
    breaks("[fixed_point]\ncommand_bits = 32", "[wibble]", expected);
}

#[test]
fn unit_a_missing_key_names_the_table_and_the_values() {
    let expected = "m.toml:12: axis.mode.damping of axis x, mode 1: found no such key; allowed: at least 0, below 1";
    breaks("damping = 0.1\n", "", expected);
    let expected = "m.toml:2: clock.sample_hz: found no such key; allowed: above 0, at most 1000000000 Hz";
    breaks("sample_hz = 10_000\n", "", expected);
    let expected =
        "m.toml:10: axis.shaper.kind of axis x: found no such key; allowed: zv, zvd, zvdd, zvddd, ei, custom, none";
    breaks("kind = \"zvd\"\n", "", expected);
    let error = wrong("name = \"slide\"");
    let expected = "m.toml:1: clock: found no such key; allowed: a table [clock] with frequency_hz and sample_hz\n\
                    m.toml:1: axis: found no such key; allowed: 1 to 4 tables [[axis]]";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn unit_a_wrong_type_names_both_types() {
    let expected = "m.toml:14: axis.mode.damping of axis x, mode 1: found the string \"low\"; allowed: a number, at least 0, \
                    below 1";
    breaks("damping = 0.1", "damping = \"low\"", expected);
    let expected = "m.toml:6: fixed_point.command_bits: found the float 32.0; allowed: a whole number, 1 to 4294967295";
    breaks("32", "32.0", expected);
    let expected = "m.toml:11: axis.shaper.kind of axis x: found the array [1]; allowed: a text: zv, zvd, zvdd, zvddd, ei, \
                    custom, none";
    breaks("\"zvd\"", "[1]", expected);
    let expected = "m.toml:5: fixed_point: found the integer 5; allowed: a table, [fixed_point]";
    let text = SMALL
        .replace("[fixed_point]\ncommand_bits = 32\n", "")
        .replace("[clock]", "fixed_point = 5\n[clock]");
    assert_eq!(wrong(&text).to_string(), expected.replace(":5:", ":2:"));
    let single = SMALL.replace("[[axis.mode]]", "[axis.mode]");
    let expected = "m.toml:12: axis.mode of axis x: found the table [axis.mode]; allowed: 1 to 8 tables [[axis.mode]]";
    assert_eq!(wrong(&single).to_string().lines().next(), Some(expected));
}

#[test]
fn unit_a_number_out_of_range_names_the_range() {
    let damping = |value| {
        let expected =
            format!("m.toml:14: axis.mode.damping of axis x, mode 1: found {value}; allowed: at least 0, below 1");
        breaks("damping = 0.1", &format!("damping = {value}"), &expected);
    };
    for value in [
        "1.0",
        "-0.1",
        "nan",
        "inf",
        "-inf",
        "1e400",
        "99999999999999999999999999",
        "0xffff_ffff_ffff_ffff",
    ] {
        damping(value);
    }
    let expected = "m.toml:13: axis.mode.frequency_hz of axis x, mode 1: found -40.0; allowed: at least 0.001, at most \
                    1000000000 Hz";
    breaks("40.0", "-40.0", expected);
    let expected = "m.toml:9: axis.counts_per_unit of axis x: found 0; allowed: above 0, at most 1000000000000";
    breaks("1_000_000", "0", expected);
    let expected = "m.toml:6: fixed_point.command_bits: found 20; allowed: 16, 24, 32";
    breaks("32", "20", expected);
    let expected = "m.toml:6: fixed_point.command_fraction: found 16; allowed: a whole number, 0 to 15";
    breaks(
        "command_bits = 32",
        "command_bits = 16\ncommand_fraction = 16",
        &expected.replace(":6:", ":7:"),
    );
    for (key, allowed) in [
        ("coefficient_fraction = 17", "1 to 16"),
        ("coefficient_fraction = 0", "1 to 16"),
    ] {
        let (name, value) = key.split_once(" = ").unwrap();
        let expected = format!("m.toml:6: fixed_point.{name}: found {value}; allowed: a whole number, {allowed}");
        breaks("command_bits = 32", key, &expected);
    }
    for value in ["0.0", "1", "-0.05"] {
        let expected = format!("m.toml:12: axis.shaper.tolerance of axis x: found {value}; allowed: above 0, below 1");
        breaks("\"zvd\"", &format!("\"zvd\"\ntolerance = {value}"), &expected);
    }
}

#[test]
fn unit_an_unknown_word_lists_the_words_and_suggests_the_nearest() {
    let error = wrong(&SMALL.replace("\"zvd\"", "\"zvf\""));
    let expected =
        "m.toml:11: axis.shaper.kind of axis x: found \"zvf\"; allowed: zv, zvd, zvdd, zvddd, ei, custom, none";
    assert_eq!(error.to_string(), expected);
    assert_eq!(error.problems()[0].remedy, "did you mean \"zv\"?");
    let expected = "m.toml:6: fixed_point.digitise: found \"modl\"; allowed: modal, linear, nearest";
    breaks("command_bits = 32", "digitise = \"modl\"", expected);
    let text = format!("{SMALL}[target]\nfamily = \"cyclone3\"\n");
    let expected =
        "m.toml:16: target.family: found \"cyclone3\"; allowed: cyclone2, cyclone4e, cyclone10lp, cyclone5, max10";
    assert_eq!(wrong(&text).to_string(), expected);
}

#[test]
fn unit_names_that_verilog_cannot_hold_are_refused() {
    let rule =
        "[a-z][a-z0-9_]*, at most 64 characters, no Verilog or SystemVerilog keyword, no name of a hardware block";
    for name in ["Slide", "2slide", "", "a-b", "wire", "logic", "shaper", "a\\n"] {
        let expected = format!("m.toml:1: name: found \"{name}\"; allowed: {rule}");
        breaks("\"slide\"", &format!("\"{name}\""), &expected);
    }
    breaks(
        "\"x\"",
        "\"reg\"",
        &format!("m.toml:8: axis.name: found \"reg\"; allowed: {rule}"),
    );
    let long = "a".repeat(65);
    let expected = format!("m.toml:1: name: found \"{}…; allowed: {rule}", &long[..47]);
    breaks("\"slide\"", &format!("\"{long}\""), &expected);
}

#[test]
fn unit_axis_names_are_unique_and_axes_at_most_four() {
    let axis = &SMALL[SMALL.find("[[axis]]").unwrap()..];
    let twice = format!("{SMALL}{axis}");
    let expected = "m.toml:16: axis.name of axis x: found \"x\", which line 8 already has; allowed: every axis has a name of its own";
    assert_eq!(wrong(&twice).to_string(), expected);
    let five: String = ["a", "b", "c", "d"]
        .iter()
        .map(|n| axis.replace("\"x\"", &format!("\"{n}\"")))
        .collect();
    let expected = "m.toml:7: axis: found 5 tables; allowed: 1 to 4 tables [[axis]]";
    assert_eq!(wrong(&format!("{SMALL}{five}")).to_string(), expected);
}

#[test]
fn unit_the_sample_rate_divides_the_clock_and_the_message_names_the_nearest() {
    let case = |sample: &str, nearest: &str| {
        let expected = format!(
            "m.toml:4: clock.sample_hz: found {sample}; allowed: what divides clock.frequency_hz = 50000000 Hz a whole \
             number of times; the nearest is {nearest}"
        );
        breaks("10_000", sample, &expected);
        for named in nearest.split(", in whole hertz ") {
            right(&SMALL.replace("10_000", named));
        }
    };
    case("10_001", "10000");
    case("15_000", "15001.500150015001, in whole hertz 15625");
    case("9_999", "9998.000399920016, in whole hertz 10000");
    case("60_000_000", "50000000");
    case("30_000_000", "25000000");
    let expected = "m.toml:4: clock.sample_hz: found 10; allowed: at least 50 Hz, a sample of at most 1000000 clocks";
    breaks("10_000", "10", expected);
}

#[test]
fn unit_a_mode_at_or_above_half_the_sample_rate_is_refused() {
    let place = "m.toml:13: axis.mode.frequency_hz of axis x, mode 1";
    for value in ["5000", "5000.1", "1e8"] {
        let expected = format!("{place}: found {value}; allowed: below 5000 Hz, half of clock.sample_hz");
        breaks("40.0", value, &expected);
    }
    right(&SMALL.replace("40.0", "4999.9"));
    let expected = "m.toml:13: axis.mode.damped_frequency_hz of axis x, mode 1: found 4990, an undamped frequency of \
                    5015.138698143468 Hz; allowed: below 5000 Hz, half of clock.sample_hz";
    breaks("frequency_hz = 40.0", "damped_frequency_hz = 4990", expected);
}

#[test]
fn unit_one_of_the_two_frequencies_is_given() {
    let expected = "m.toml:14: axis.mode.damped_frequency_hz of axis x, mode 1: found both frequency_hz and \
                    damped_frequency_hz; allowed: one of the two";
    breaks(
        "frequency_hz = 40.0",
        "frequency_hz = 40.0\ndamped_frequency_hz = 39.0",
        expected,
    );
    let expected = "m.toml:12: axis.mode.frequency_hz of axis x, mode 1: found no such key; allowed: at least 0.001, at most \
                    1000000000 Hz, or damped_frequency_hz in its place";
    breaks("frequency_hz = 40.0\n", "", expected);
}

#[test]
fn unit_an_axis_has_modes_and_each_has_a_shaper() {
    let modes = "[[axis.mode]]\nfrequency_hz = 40.0\ndamping = 0.1\n";
    let expected = "m.toml:7: axis.mode of axis x: found an axis without modes; allowed: at least one [[axis.mode]], except \
                    with kind custom or none";
    breaks(modes, "", expected);
    right(&SMALL.replace(modes, "").replace("zvd", "none"));
    let expected = "m.toml:7: axis.shaper of axis x: found no [axis.shaper], and a mode without `shaper`; allowed: \
                    [axis.shaper], or `shaper` in every [[axis.mode]]";
    breaks("[axis.shaper]\nkind = \"zvd\"\n", "", expected);
    let nine = modes.repeat(9);
    let expected = "m.toml:12: axis.mode of axis x: found 9 tables; allowed: 1 to 8 tables [[axis.mode]]";
    breaks(modes, &nine, expected);
    let expected = "m.toml:12: axis.mode of axis x: found participation 0 in every mode; allowed: at least one mode with a \
                    participation above 0";
    breaks("damping = 0.1", "damping = 0.1\nparticipation = 0.0", expected);
}

#[test]
fn unit_a_modes_own_shaper_serves_one_mode() {
    let expected = "m.toml:15: axis.mode.shaper of axis x, mode 1: found shaper = \"custom\", which serves an axis and not one \
                    mode; allowed: zv, zvd, zvdd, zvddd, ei";
    breaks("damping = 0.1", "damping = 0.1\nshaper = \"custom\"", expected);
    let text = SMALL
        .replace("damping = 0.1", "damping = 0.1\nshaper = \"zv\"")
        .replace("\"zvd\"", "\"none\"");
    let expected = "m.toml:15: axis.mode.shaper of axis x, mode 1: found shaper = \"zv\" under kind = \"none\", which would \
                    ignore it; allowed: no `shaper` in a mode under kind = \"none\"";
    assert_eq!(wrong(&text).to_string(), expected);
}

#[test]
fn unit_keys_of_other_kinds_are_refused() {
    let expected =
        "m.toml:12: axis.shaper.method of axis x: found method with kind zvd; allowed: method with kind antisymmetric";
    breaks("\"zvd\"", "\"zvd\"\nmethod = \"exact\"", expected);
    let expected = "m.toml:15: axis.mode.order of axis x, mode 1: found order with kind zvd; allowed: order with kind \
                    chebyshev-ei, vibrationless";
    breaks("damping = 0.1", "damping = 0.1\norder = 2", expected);
    let expected = "m.toml:12: axis.shaper.impulses of axis x: found impulses with kind = \"zvd\"; allowed: impulses with \
                    kind = \"custom\" only";
    breaks("\"zvd\"", "\"zvd\"\nimpulses = [[0, 1]]", expected);
}

#[test]
fn unit_the_impulses_of_custom_start_at_zero_increase_and_sum_to_one() {
    let key = "axis.shaper.impulses of axis x";
    let case = |impulses: &str, problem: &str| {
        let to = format!("\"custom\"\nimpulses = {impulses}");
        breaks("\"zvd\"", &to, &format!("m.toml:12: {key}: {problem}"));
    };
    case(
        "[[0.1, 1.0]]",
        "found a first impulse at 0.1 s; allowed: a first impulse at 0 s",
    );
    let times = "found an impulse at 0.1 s after one at 0.1 s; allowed: times that increase from impulse to impulse";
    case("[[0, 0.5], [0.1, 0.25], [0.1, 0.25]]", times);
    case(
        "[[0, 0.5], [0.1, 0.49]]",
        "found amplitudes with the sum 0.99; allowed: amplitudes with the sum 1, within 1e-9",
    );
    let rows = "allowed: a list of 1 to 256 pairs [time_s, amplitude], each number at least -65535, at most 65535";
    case("[]", &format!("found the array []; {rows}"));
    for row in ["[0, nan]", "[0, 1, 2]", "[0]", "[0, \"1\"]"] {
        case(&format!("[{row}]"), &format!("found the array {row}; {rows}"));
    }
    case("[0, 1]", &format!("found the integer 0; {rows}"));
    right(&SMALL.replace("\"zvd\"", "\"custom\"\nimpulses = [[0, 2], [0.1, -1.0000000001]]"));
    let expected = "m.toml:10: axis.shaper.impulses of axis x: found no such key; allowed: a list of 1 to 256 pairs [time_s, \
                    amplitude]";
    breaks("\"zvd\"", "\"custom\"", expected);
}

#[test]
fn unit_the_travel_fits_the_position_word_or_the_next_size_is_named() {
    let limits = |bits: &str, travel: &str| format!("{}[axis.limits]\ntravel = {travel}\n", SMALL.replace("32", bits));
    let place = "m.toml:16: axis.limits.travel of axis x";
    let expected = format!(
        "{place}: found a travel of up to 50000 counts; allowed: at most 32767.99609375 counts in 24 bits \
                            with 8 fraction bits; set fixed_point.command_bits = 32"
    );
    assert_eq!(wrong(&limits("24", "[-0.05, 0.01]")).to_string(), expected);
    let expected = format!(
        "{place}: found a travel of up to 10000000 counts; allowed: at most 8388607.99609375 counts in 32 \
                            bits with 8 fraction bits; set fixed_point.command_fraction = 7"
    );
    assert_eq!(wrong(&limits("32", "[0.0, 10.0]")).to_string(), expected);
    let expected = format!("{place}: found [0.1, -0.1]; allowed: [low, high] with low below high");
    assert_eq!(wrong(&limits("32", "[0.1, -0.1]")).to_string(), expected);
    assert_eq!(
        right(&limits("24", "[-0.03, 0.03]")).axes[0].limits.unwrap().travel,
        Some([-0.03, 0.03])
    );
}

#[test]
fn unit_what_is_not_built_is_refused_by_name_once_all_else_is_right() {
    let error = wrong(EVERYTHING);
    let lines: Vec<String> = error.to_string().lines().map(str::to_owned).collect();
    let blocks = [
        (33, "axis.encoder of axis x", "encoder"),
        (37, "axis.scale of axis x", "scale"),
        (41, "axis.pwm of axis x", "pwm"),
        (48, "axis.drive of axis x", "drive"),
        (58, "axis.controller of axis x", "controller"),
        (70, "axis.limits.following_error of axis x", "following_error"),
        (71, "axis.limits.brake_release_s of axis x", "brake_release_s"),
        (72, "axis.limits.brake_apply_s of axis x", "brake_apply_s"),
        (74, "axis.trace of axis x", "trace"),
        (77, "stage", "stage"),
    ];
    let expected = blocks.map(|(line, key, name)| format!("m.toml:{line}: {key}: not built in this version: {name}"));
    assert_eq!(lines, expected);
    assert_eq!(error.problems()[0].remedy, "leave the table [axis.encoder] out");

    let also_wrong = wrong(&EVERYTHING.replace("damping = 0.157799065776", "damping = 2"));
    let expected = "m.toml:30: axis.mode.damping of axis x, mode 1: found 2; allowed: at least 0, below 1";
    assert_eq!(also_wrong.to_string(), expected);
}

#[test]
fn unit_a_kind_that_is_not_built_is_refused_by_name() {
    for (kind, name) in Kind::ALL.iter().filter(|(kind, _)| !kind.is_built()) {
        let expected = format!(
            "m.toml:11: axis.shaper.kind of axis x: not built in this version: {name}; allowed: zv, zvd, zvdd, zvddd, ei, \
             custom, none"
        );
        breaks("\"zvd\"", &format!("\"{kind}\""), &expected);
    }
    let expected = "m.toml:15: axis.mode.shaper of axis x, mode 1: not built in this version: ps-zv; allowed: zv, zvd, zvdd, \
                    zvddd, ei, custom, none";
    breaks("damping = 0.1", "damping = 0.1\nshaper = \"ps-zv\"", expected);
}

#[test]
fn unit_blocks_that_are_not_built_are_checked_all_the_same() {
    let case = |from: &str, to: &str, expected: &str| {
        assert!(EVERYTHING.contains(from), "{from}");
        assert_eq!(wrong(&EVERYTHING.replace(from, to)).to_string(), expected);
    };
    let expected = "m.toml:34: axis.encoder.filter_clocks of axis x: found 256; allowed: a whole number, 0 to 255";
    case("filter_clocks = 8", "filter_clocks = 256", expected);
    case(
        "\"monitor\"",
        "\"both\"",
        "m.toml:39: axis.scale.use of axis x: found \"both\"; allowed: monitor, position",
    );
    let expected = "m.toml:43: axis.pwm.frequency_hz of axis x: found 25_000; allowed: what divides clock.frequency_hz = \
                    50000000 Hz and is a multiple of clock.sample_hz = 10000 Hz; the nearest is 20000";
    case("= 20_000", "= 25_000", expected);
    let expected = "m.toml:44: axis.pwm.dead_time_s of axis x: found a dead time and a minimum pulse of 0.000101 s together; \
                    allowed: below 0.00005 s, the PWM period";
    case("500e-9", "100e-6", expected);
    let expected = "m.toml:52: axis.drive.current_limit_a of axis x: found a current limit of 3.5 A; allowed: at most \
                    full_scale_a = 3 A";
    case("2.73", "3.5", expected);
    let expected = "m.toml:48: axis.drive.full_scale_velocity of axis x: found no such key; allowed: above 0, at most \
                    1000000000000\nm.toml:53: axis.drive.full_scale_a of axis x: found full_scale_a with mode = \"velocity\"; \
                    allowed: full_scale_a with mode torque, full_scale_velocity with mode velocity";
    case("\"torque\"", "\"velocity\"", expected);
    let expected =
        "m.toml:58: axis.controller.boundary of axis x: found no such key; allowed: above 0, at most 1000000000000";
    case("boundary = 0.05", "", expected);
    case(
        "1024",
        "1000",
        "m.toml:75: axis.trace.samples of axis x: found 1000; allowed: 256, 512, 1024, 2048",
    );
    let expected = "m.toml:79: stage.contour_speed: found 0; allowed: above 0, at most 1000000000000";
    case("contour_speed = 0.1", "contour_speed = 0", expected);
    let expected = "m.toml:70: axis.limits.following_error of axis x: found the boolean true; allowed: a number, above 0, at \
                    most 1000000000";
    case("following_error = 0.001", "following_error = true", expected);
}

#[test]
fn unit_all_problems_of_a_file_are_shown_and_a_flood_is_cut() {
    let text = SMALL.replace("damping = 0.1", "damping = 7").replace("10_000", "-1");
    let keys: Vec<String> = wrong(&text).problems().iter().map(|p| p.key.clone()).collect();
    assert_eq!(keys, ["clock.sample_hz", "axis.mode.damping"]);
    let flood: String = (0..1000).map(|n| format!("unknown{n} = 1\n")).collect();
    let error = wrong(&format!("{flood}{SMALL}"));
    assert_eq!(error.problems().len(), MAX_PROBLEMS);
    assert!(error.to_string().ends_with("\nm.toml: and 980 more"));
}

#[test]
fn unit_the_diagnostic_marks_the_place_and_says_what_to_do() {
    use miette::Diagnostic;
    let error = wrong(&SMALL.replace("damping = 0.1", "damping = 7"));
    let label = error.labels().unwrap().next().unwrap();
    assert_eq!(&SMALL[..label.offset()], &SMALL[..SMALL.find("0.1").unwrap()]);
    assert_eq!(label.len(), 1);
    assert_eq!(
        error.help().unwrap().to_string(),
        "give `damping` a value in this range"
    );
    let picture = format!("{:?}", miette::Report::new(error));
    for part in ["m.toml", "damping = 7", "at least 0, below 1", "give `damping` a value"] {
        assert!(picture.contains(part), "{part} in {picture}");
    }
}

#[test]
fn unit_control_characters_of_the_file_do_not_reach_the_terminal() {
    let error = wrong(&SMALL.replace("\"slide\"", "\"\"\"a\nb\"\"\""));
    assert!(
        error.to_string().contains("found \"\"\"a\\nb\"\"\"; allowed"),
        "{error}"
    );
}
