//! Values of a valid file: the examples, defaults, and the effective values of each mode.

use crate::machine_file::files::{CUSTOM_SHAPER, GANTRY, ROBOT_JOINT, SMALL, XY_STAGE, right};
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::digitise::Digitise;

#[test]
fn golden_xy_stage_is_the_machine_of_the_thesis() {
    let machine = right(XY_STAGE);
    assert_eq!(machine.name, "xy_stage");
    assert_eq!(machine.clock.clocks_per_sample(), 5000);
    let modes = [(131.117015808451, 0.157799065776), (93.2897800884888, 0.153542487341)];
    for (axis, (frequency_hz, damping)) in machine.axes.iter().zip(modes) {
        assert_eq!(axis.shaped().kind_name(), "zvd");
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
fn every_example_is_a_right_machine_with_a_name_of_its_own() {
    let machines = [XY_STAGE, GANTRY, ROBOT_JOINT, CUSTOM_SHAPER].map(right);
    let mut names: Vec<&str> = machines.iter().map(|m| m.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["gantry", "pick_and_place", "robot_joint", "xy_stage"]);
}

#[test]
fn each_mode_has_its_effective_kind_and_tolerance() {
    let gantry = right(GANTRY);
    let axis = &gantry.axes[0];
    assert_eq!(
        axis.modes.iter().map(|m| axis.shaped().kind_of(m)).collect::<Vec<_>>(),
        [ShaperKind::Ei, ShaperKind::Zv]
    );
    assert_eq!(axis.shaped().kind_name(), "ei+zv");
    assert_eq!(axis.shaped().joint_kind(), None);

    let custom = right(CUSTOM_SHAPER);
    let axis = &custom.axes[0];
    assert_eq!(axis.shaped().joint_kind(), Some(ShaperKind::Custom));
    assert_eq!(axis.shaped().kind_name(), "custom");
    assert_eq!(axis.shaper.as_ref().unwrap().impulses[3], (0.06, 0.25));
    assert_eq!(custom.fixed_point.digitise, Digitise::Nearest);

    let text = SMALL.replace(
        "damping = 0.1",
        "damping = 0.1\ntolerance = 0.02\n[[axis.mode]]\nfrequency_hz = 90\ndamping = 0",
    );
    let tolerances = |text: &str| {
        let machine = right(text);
        let axis = &machine.axes[0];
        axis.modes
            .iter()
            .map(|m| axis.shaped().tolerance_of(m))
            .collect::<Vec<_>>()
    };
    assert_eq!(tolerances(&text), [0.02, 0.05]);
    assert_eq!(
        tolerances(&text.replace("\"zvd\"", "\"zvd\"\ntolerance = 0.1")),
        [0.02, 0.1]
    );
    let machine = right(&text);
    assert_eq!(machine.axes[0].shaped().order_of(&machine.axes[0].modes[0]), 1);
}

#[test]
fn defaults_of_the_number_formats() {
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
fn a_damped_frequency_is_converted_to_the_undamped_one() {
    let machine = right(&SMALL.replace("frequency_hz = 40.0", "damped_frequency_hz = 40.0"));
    let mode = machine.axes[0].modes[0].mode;
    assert!((mode.frequency_hz - 40.0 / 0.99f64.sqrt()).abs() < 1e-12);
    assert!((mode.omega_damped() - std::f64::consts::TAU * 40.0).abs() < 1e-9);
}

#[test]
fn integers_of_any_radix_and_floats_are_numbers() {
    let clock = right(&SMALL.replace("10_000", "0x2710").replace("50_000_000", "5e7")).clock;
    assert_eq!((clock.frequency_hz, clock.sample_hz), (50e6, 10e3));
}
