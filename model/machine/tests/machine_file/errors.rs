//! Errors of one key: syntax, unknown key, missing key, wrong type, out of range, unknown word, invalid or duplicate
//! name.

use crate::machine_file::files::{SMALL, breaks, kinds, wrong};
use posicast_machine::machine_file::ProblemCause;

#[test]
fn text_that_is_no_toml_names_the_line() {
    let error = wrong(&SMALL.replace("name = \"x\"", "name = \"x"));
    assert!(matches!(error.problems()[0].cause, ProblemCause::Syntax(_)));
    assert!(
        error.to_string().starts_with("m.toml:8: found a TOML syntax error: "),
        "{error}"
    );
    let twice = wrong(&SMALL.replace("[clock]", "name = \"again\"\n[clock]"));
    assert!(
        twice
            .to_string()
            .starts_with("m.toml:2: found a TOML syntax error: duplicate key, which line 1 has already, in `name"),
        "{twice}"
    );
}

#[test]
fn an_empty_file_says_what_a_machine_has() {
    for text in ["", "\n\n", "# a comment\n", "\u{feff}"] {
        let expected = "m.toml:1: found an empty file; allowed: a machine with the keys name, [clock] and [[axis]]";
        assert_eq!(wrong(text).to_string(), expected, "{text:?}");
    }
}

#[test]
fn an_unknown_key_lists_the_allowed_ones_and_suggests_the_nearest() {
    let error = wrong(&SMALL.replace("damping = 0.1", "damping = 0.1\ndampng = 0.1"));
    assert_eq!(
        error.to_string(),
        "m.toml:15: axis.mode.dampng of axis x, mode 1: found the unknown key dampng; allowed: frequency_hz, \
         damped_frequency_hz, damping, points, moves_with, measured, motor_mass, load_mass, shaper, tolerance, order, frequency_band, damping_band, participation"
    );
    assert_eq!(
        error.problems()[0].remedy,
        "did you mean `damping`? Else remove the key"
    );
    let expected = "m.toml:5: wibble: found the unknown key wibble; allowed: name, clock, fixed_point, target, axis, stage, capture, link";
    breaks("[fixed_point]\ncommand_bits = 32", "[wibble]", expected);
}

#[test]
fn a_missing_key_names_the_table_and_the_values() {
    let expected = "m.toml:12: axis.mode.damping of axis x, mode 1: found no such key; allowed: at least 0, below 1";
    breaks("damping = 0.1\n", "", expected);
    let expected = "m.toml:2: clock.sample_hz: found no such key; allowed: above 0, at most 1e9 Hz";
    breaks("sample_hz = 10_000\n", "", expected);
    let kinds = kinds(|_| true);
    let expected = format!("m.toml:10: axis.shaper.kind of axis x: found no such key; allowed: {kinds}");
    breaks("kind = \"zvd\"\n", "", &expected);
    let error = wrong("name = \"slide\"");
    let expected = "m.toml:1: clock: found no such key; allowed: a table [clock] with frequency_hz and sample_hz\n\
                    m.toml:1: axis: found no such key; allowed: 1 to 4 tables [[axis]]";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn a_wrong_type_names_both_types() {
    let expected = "m.toml:14: axis.mode.damping of axis x, mode 1: found the string \"low\"; allowed: a number, at least 0, \
                    below 1";
    breaks("damping = 0.1", "damping = \"low\"", expected);
    let expected = "m.toml:6: fixed_point.command_bits: found the float 32.0; allowed: a whole number, 8 to 32";
    breaks("32", "32.0", expected);
    let kinds = kinds(|_| true);
    let expected = format!("m.toml:11: axis.shaper.kind of axis x: found the array [1]; allowed: a text: {kinds}");
    breaks("\"zvd\"", "[1]", &expected);
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
fn a_number_out_of_range_names_the_range() {
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
                    1e9 Hz";
    breaks("40.0", "-40.0", expected);
    let expected = "m.toml:9: axis.counts_per_unit of axis x: found 0; allowed: above 0, at most 1e12";
    breaks("1_000_000", "0", expected);
    for bits in ["7", "33"] {
        let expected = format!("m.toml:6: fixed_point.command_bits: found {bits}; allowed: a whole number, 8 to 32");
        breaks("32", bits, &expected);
    }
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
fn an_unknown_word_lists_the_words_and_suggests_the_nearest() {
    let error = wrong(&SMALL.replace("\"zvd\"", "\"zvf\""));
    let kinds = kinds(|_| true);
    let expected = format!("m.toml:11: axis.shaper.kind of axis x: found \"zvf\"; allowed: {kinds}");
    assert_eq!(error.to_string(), expected);
    assert_eq!(error.problems()[0].remedy, "did you mean \"zvd\"?");
    let expected = "m.toml:6: fixed_point.digitise: found \"modl\"; allowed: modal, linear, nearest";
    breaks("command_bits = 32", "digitise = \"modl\"", expected);
    let text = format!("{SMALL}[target]\nfamily = \"cyclone3\"\n");
    let expected =
        "m.toml:16: target.family: found \"cyclone3\"; allowed: cyclone2, cyclone4e, cyclone10lp, cyclone5, max10";
    assert_eq!(wrong(&text).to_string(), expected);
}

#[test]
fn names_that_verilog_cannot_hold_are_refused() {
    let rule = "[a-z][a-z0-9_]*, at most 64 characters, no Verilog or SystemVerilog keyword, no name of a hardware block, not \
                beginning with posicast";
    for name in [
        "Slide",
        "2slide",
        "",
        "a-b",
        "wire",
        "logic",
        "shaper",
        "posicast_pwm",
        "a\\n",
    ] {
        let expected = format!("m.toml:1: name: found \"{name}\"; allowed: {rule}");
        breaks("\"slide\"", &format!("\"{name}\""), &expected);
    }
    breaks(
        "\"x\"",
        "\"reg\"",
        &format!("m.toml:8: axis.name: found \"reg\"; allowed: {rule}"),
    );
    let expected = format!("m.toml:8: axis.name: found the integer 5; allowed: a text: {rule}");
    breaks("\"x\"", "5", &expected);
    let long = "a".repeat(65);
    let expected = format!("m.toml:1: name: found \"{}…; allowed: {rule}", &long[..47]);
    breaks("\"slide\"", &format!("\"{long}\""), &expected);
}

#[test]
fn axis_names_are_unique_and_axes_at_most_four() {
    let axis = &SMALL[SMALL.find("[[axis]]").unwrap()..];
    let twice = format!("{SMALL}{axis}");
    let expected = "m.toml:16: axis.name of axis x: found \"x\", which line 8 already has; allowed: every axis must have a different name";
    assert_eq!(wrong(&twice).to_string(), expected);
    let beside_x = format!("{SMALL}{}", axis.replace("\"x\"", "\"u\""));
    let expected = "m.toml:16: axis.name of axis u: found \"u\"; allowed: not `u` where another axis is `x` or `y`";
    assert!(
        wrong(&beside_x).to_string().starts_with(expected),
        "{}",
        wrong(&beside_x)
    );
    let five: String = ["a", "b", "c", "d"]
        .iter()
        .map(|n| axis.replace("\"x\"", &format!("\"{n}\"")))
        .collect();
    let expected = "m.toml:7: axis: found 5 tables; allowed: 1 to 4 tables [[axis]]";
    assert_eq!(wrong(&format!("{SMALL}{five}")).to_string(), expected);
}
