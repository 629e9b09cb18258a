//! `[axis.compare]`: values, defaults, what the hardware gets, and what is refused with which message.

use posicast_blocks::stage::StageCompare;
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file::{CompareDirection, CompareSection};
use posicast_machine::plan::design_machine;

use super::files::{right, wrong};

const SCAN: &str = include_str!("../../../../examples/line-scan.toml");

/// Replaces the first `from` by `to` in the file, and expects this in the message, and this in the remedy.
#[track_caller]
fn case(from: &str, to: &str, expected: &str, remedy: &str) {
    assert!(SCAN.contains(from), "{from}");
    let error = wrong(&SCAN.replacen(from, to, 1));
    assert!(error.to_string().contains(expected), "{error}");
    let found = &error.problems()[0].remedy;
    assert!(found.contains(remedy), "{found}");
}

#[test]
fn the_positions_become_counts_of_the_encoder() {
    let machine = right(SCAN);
    let design = design_machine(&machine).unwrap();
    let hardware = Hardware::of(&machine, &design).unwrap();
    let stage = hardware.stage().unwrap().unwrap();
    let expected = StageCompare {
        first: -80_000,
        spacing: 20,
        positions: 8001,
        rises: true,
        falls: true,
        hysteresis: 2,
        pulse_clocks: 250,
    };
    assert_eq!(stage.of_machine.config.axes[0].compare, Some(expected));
}

#[test]
fn what_is_left_out_has_a_default() {
    let text = SCAN
        .replacen("first = -40 ", "# ", 1)
        .replacen("direction", "# ", 1)
        .replacen("hysteresis", "# ", 1);
    let compare = right(&text).axes[0].compare.unwrap();
    let expected = CompareSection {
        spacing: compare.spacing,
        positions: 8001,
        first: 0.0,
        direction: CompareDirection::Both,
        hysteresis: 0.0,
        pulse_s: 5e-6,
    };
    assert_eq!(compare, expected);
}

#[test]
fn positions_that_are_no_counts_are_refused() {
    case(
        "spacing = 0.01 ",
        "spacing = 0.0103 ",
        "axis.compare.spacing of axis scan: found spacing = 0.0103, 20.6 counts; allowed: a whole number of counts",
        "take 0.0105, 21 counts",
    );
    case(
        "spacing = 0.01 ",
        "spacing = 0.0001 ",
        "spacing = 0.0001, 0.2 counts",
        "take 0.0005, 1 counts",
    );
    case(
        "first = -40 ",
        "first = -40.0002 ",
        "first = -40.0002, -80000.4 counts",
        "take -40, -80000 counts",
    );
    case(
        "positions = 8_001",
        "positions = 2_000_000_000",
        "positions = 2000000000, the last of them at",
        "lower `positions`",
    );
}

#[test]
fn pulses_that_merge_or_do_not_fit_are_refused() {
    case(
        "pulse_s = 5e-6 ",
        "pulse_s = 50e-6 ",
        "allowed: less than 40.00 µs, which the axis takes from position to position",
        "shorten it",
    );
    case("pulse_s = 5e-6 ", "pulse_s = 0.5 ", "16777215 clocks", "shorten it");
    case(
        "hysteresis = 0.001 ",
        "hysteresis = 0.01 ",
        "hysteresis = 0.01 with spacing = 0.01",
        "a count or two",
    );
    case(
        "direction = \"both\"",
        "direction = \"left\"",
        "axis.compare.direction",
        "",
    );
    case("spacing = 0.01 ", "# ", "axis.compare.spacing", "");
}

#[test]
fn a_compare_needs_a_count() {
    let bare: String = SCAN
        .split("\n[axis.")
        .filter(|table| {
            !["encoder]", "pwm]", "drive]", "controller]", "limits]"]
                .iter()
                .any(|name| table.starts_with(name))
        })
        .collect::<Vec<_>>()
        .join("\n[axis.");
    let error = wrong(&bare);
    assert!(
        error
            .to_string()
            .contains("found [axis.compare] without [axis.controller]"),
        "{error}"
    );
}
