//! `unit` of `[[axis]]`: the same machine in other units is the same machine, and problems are reported in the file's
//! unit.

use crate::machine_file::files::{EVERYTHING, SMALL, breaks, right, wrong};
use posicast_blocks::stage::StageScale;
use posicast_machine::control::{ControlWarning, gains, supervision};
use posicast_machine::hardware;
use posicast_machine::machine_file::{Controller, DriveMode, Machine};
use posicast_machine::plan::design_machine;
use posicast_machine::unit::AxisUnit;

/// Keys in the axis's unit, and the power of it: 1 for a figure per unit, −1 for counts per unit.
const KEYS: [(&str, i32); 16] = [
    ("counts_per_unit", -1),
    ("full_scale_velocity", 1),
    ("epsilon", 1),
    ("boundary", 1),
    ("velocity", 1),
    ("acceleration", 1),
    ("jerk", 1),
    ("travel", 1),
    ("stop_deceleration", 1),
    ("following_error", 1),
    ("deviation", 1),
    ("excitation", 1),
    ("spacing", 1),
    ("first", 1),
    ("hysteresis", 1),
    ("unit", 0),
];

/// Converts a number to the text that an engineer would write in another unit.
fn converted(number: &str, factor: f64) -> String {
    let number: f64 = number.trim().replace('_', "").parse().unwrap();
    let text = format!("{:.12e}", number * factor);
    text.parse::<f64>().unwrap().to_string()
}

/// Returns a file in m, with everything that is in the axis's unit converted to another one.
fn in_unit(text: &str, unit: AxisUnit) -> String {
    let mut lines = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with("unit = ")) {
        let plain = line.split('#').next().unwrap_or_default();
        let Some((key, value)) = plain.split_once('=') else {
            lines.push(line.to_owned());
            continue;
        };
        let key = key.trim();
        let power = KEYS
            .iter()
            .find(|(name, _)| *name == key)
            .map_or(0, |(_, power)| *power);
        let factor = unit.per_si().powi(power);
        lines.push(
            match value.trim().strip_prefix('[').and_then(|list| list.strip_suffix(']')) {
                _ if power == 0 => line.to_owned(),
                Some(list) => {
                    let numbers: Vec<String> = list.split(',').map(|number| converted(number, factor)).collect();
                    format!("{key} = [{}]", numbers.join(", "))
                }
                None => format!("{key} = {}", converted(value, factor)),
            },
        );
        if key == "counts_per_unit" && !lines.iter().rev().take(2).any(|line| line.starts_with("[axis.scale]")) {
            lines.push(format!("unit = \"{}\"", unit.name()));
        }
    }
    lines.join("\n") + "\n"
}

/// Returns the machine with another unit's name.
fn named(mut machine: Machine, unit: AxisUnit) -> Machine {
    machine.axes.iter_mut().for_each(|axis| axis.unit = unit);
    machine
}

#[test]
fn the_examples_in_millimetres_are_the_machines_that_they_are_in_metres() {
    for text in [
        include_str!("../../../../examples/xy-stage.toml"),
        include_str!("../../../../examples/xy-stage-torque.toml"),
        include_str!("../../../../examples/contouring-stage.toml"),
    ] {
        let (metres, millimetres) = (right(text), right(&in_unit(text, AxisUnit::Millimetre)));
        assert_eq!(millimetres.axes[0].unit, AxisUnit::Millimetre);
        assert_eq!(millimetres, named(metres, AxisUnit::Millimetre));
    }
}

#[test]
fn every_unit_gives_the_same_tables_gains_and_words() {
    let stage = |machine: &Machine| {
        let design = design_machine(machine).unwrap();
        let tables: Vec<_> = design.axes.iter().map(|axis| axis.table.clone()).collect();
        (tables, hardware::stage(machine, &design).unwrap().unwrap().config)
    };
    let text = include_str!("../../../../examples/contouring-stage.toml");
    let metres = stage(&right(text));
    for (unit, _) in AxisUnit::ALL {
        let mut found = stage(&right(&in_unit(text, unit)));
        for (found, expected) in found.1.axes.iter_mut().zip(&metres.1.axes) {
            // The relative error of the ratio is not in a register, but includes the last digits of the converted
            // numbers.
            let words = |scale: &StageScale| (scale.ratio.mantissa(), scale.ratio.shift());
            assert_eq!(
                found.scale.as_ref().map(words),
                expected.scale.as_ref().map(words),
                "{unit}"
            );
            found.scale = expected.scale;
            assert_eq!(found, expected, "{unit}");
        }
        assert_eq!(found, metres, "{unit}");
    }
}

#[test]
fn a_file_without_a_unit_is_in_metres() {
    assert_eq!(right(SMALL).axes[0].unit, AxisUnit::Metre);
    assert_eq!(right(EVERYTHING).axes[0].unit, AxisUnit::Metre);
    let joint = right(include_str!("../../../../examples/robot-joint.toml"));
    assert_eq!(joint.axes[0].unit, AxisUnit::Radian);
}

#[test]
fn an_unknown_unit_is_refused() {
    let to = "counts_per_unit = 1_000_000\nunit = \"cm\"";
    breaks(
        "counts_per_unit = 1_000_000",
        to,
        "m.toml:10: axis.unit of axis x: found \"cm\"; allowed: m, mm, um, rad, mrad, deg, rev",
    );
}

#[test]
fn ranges_are_told_in_the_unit_of_the_axis() {
    let text = in_unit(SMALL, AxisUnit::Millimetre);
    assert_eq!(
        wrong(&text.replace("= 1000\n", "= 1e10\n")).to_string(),
        "m.toml:9: axis.counts_per_unit of axis x: found 1e10; allowed: above 0, at most 1e9"
    );
    let text = text + "[axis.limits]\ntravel = [0, 1e13]\n";
    let error = wrong(&text).to_string();
    assert!(error.contains("at most 1e12 mm"), "{error}");
}

#[test]
fn what_a_word_does_not_hold_is_told_in_the_unit_of_the_axis() {
    let text = in_unit(EVERYTHING, AxisUnit::Millimetre);
    let machine = right(&text.replace("following_error = 1\n", "following_error = 40\n"));
    let design = design_machine(&machine).unwrap();
    let table = (&design.axes[0].table).into();
    let error = supervision(&machine.axes[0], &machine.clock, table).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("found 40 mm; allowed: 1.52588e-8 to 32.7679 mm"),
        "{text}"
    );
}

#[test]
fn warnings_of_a_controller_have_the_figures_of_the_file() {
    let text = include_str!("../../../../examples/xy-stage-torque.toml").replace("epsilon = 4.0", "epsilon = 0.5");
    let machine = right(&in_unit(&text, AxisUnit::Millimetre));
    let (axis, clock) = (&machine.axes[0], machine.clock);
    assert!(matches!(
        axis.controller,
        Some(Controller::SlidingMode { epsilon: 0.5, .. })
    ));
    let mode = axis.drive.as_ref().unwrap().mode;
    // These are in SI units in every file.
    assert!(matches!(
        mode,
        DriveMode::Torque {
            force_constant: 475.01,
            ..
        }
    ));
    let found = gains(axis, clock, 150e-6).unwrap().warnings;
    let weak = found
        .iter()
        .find(|w| matches!(w, ControlWarning::WeakSwitching { .. }))
        .unwrap();
    let text = "epsilon = 500 mm/s² does not overcome friction, which decelerates by 622.3356 mm/s²: raise epsilon";
    assert_eq!(weak.to_string(), text);
}
