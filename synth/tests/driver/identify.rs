//! A machine is measured through its own loop: the driver excites an axis and reads its trace, and the modes are
//! identified.

use crate::driver::bridge::Bridge;
use crate::driver::support::Driver;
use posicast_identify::log::{self, Log};
use posicast_identify::position::{self, motor};
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plant::axis::{Coordinate, PlantOptions};
use std::fmt::Write;

/// Returns the example with a scale at its load, a trace, and room for an excitation.
fn measured_machine() -> Machine {
    let text = include_str!("../../../examples/xy-stage.toml");
    let scale = "[axis.scale]\ncounts_per_unit = 10_000_000\nuse = \"monitor\"\n";
    let text = text.replacen(
        "[axis.pwm]",
        &format!("[axis.trace]\nsamples = 1024\n{scale}[axis.pwm]"),
        1,
    );
    let text = text.replacen(
        "[axis.limits]",
        "[axis.limits]\nexcitation = 100e-6\ndeviation = 500e-6\n",
        1,
    );
    machine_file::parse("xy-stage.toml", &text).unwrap()
}

#[test]
fn the_stages_own_trace_gives_its_mode() {
    let driver = Driver::of(measured_machine());
    let mut bridge = Bridge::new(&driver, "identify.c", false);
    let said = bridge.talk(&[]);
    assert_eq!(said["causes"], 0, "{said:?}");
    // The lines are as a program would write them: every second tick of 100 µs.
    let mut csv = String::from("time_s,captured_position,deviation\n");
    for row in 0..said["rows"] {
        let word = |name: &str| said[&format!("{name}_{row}")];
        let time_s = 200e-6 * row as f64;
        let _ = writeln!(csv, "{time_s:.4},{},{}", word("captured_position"), word("deviation"));
    }
    let Log::Position(log) = log::read(csv.as_bytes()).unwrap().log else {
        panic!()
    };
    let found = position::identify(&log).unwrap();
    let truth = driver.machine.axes[0].modes[0].mode;
    assert_eq!(found.modes.len(), 1, "{:#?}", found.modes);
    let mode = found.modes[0].mode;
    assert!(
        (mode.frequency_hz / truth.frequency_hz - 1.0).abs() < 0.01,
        "{:#?}",
        found.modes
    );
    assert!((mode.damping / truth.damping - 1.0).abs() < 0.15, "{:#?}", found.modes);
}

/// Returns the torque-driven example with motor and table as two masses, and a trace in place of any sensor at the
/// table. It has no dry friction, which looks like damping where a motor turns round, as it does at rest.
fn motor_machine() -> Machine {
    let text = include_str!("../../../examples/xy-stage-torque.toml");
    let mode = text.find("[[axis.mode]]").unwrap()..text.find("[axis.encoder]").unwrap();
    let mechanics = "[axis.mechanics]
lead_m = 0.005
screw_diameter_m = 0.012
screw_length_m = 0.34
coupling_diameter_m = 0.008
coupling_length_m = 0.025
nut_stiffness = 200e6
bearing_stiffness = 133.4873e6
motor_inertia = 3.64e-6
table_mass = 50.0
motor_held_damping = 0.15
breakaway = 0.0

[axis.trace]
samples = 2048

";
    let text = text.replacen(&text[mode], mechanics, 1);
    let text = text.replacen("name = \"xy_stage_torque\"", "name = \"xy_stage\"", 1);
    let text = text.replacen("velocity = 0.25", "excitation = 250e-6\nvelocity = 0.25", 1);
    let text = text.replacen("coulomb = 40.0", "coulomb = 0.0", 1);
    machine_file::parse("xy-stage-torque.toml", &text).unwrap_or_else(|error| panic!("{error:?}"))
}

#[test]
fn the_stages_own_trace_gives_its_mode_at_the_motor() {
    let driver = Driver::of(motor_machine());
    let options = PlantOptions {
        encoder_at: Some(Coordinate::Driven),
        ..PlantOptions::default()
    };
    let mut bridge = Bridge::with_plants(&driver, "identify_motor.c", false, &options);
    let said = bridge.talk(&[]);
    assert_eq!((said["causes"], said["rows"]), (0, 1024));
    let mut csv = String::from("time_s,drive_command,captured_position\n");
    for row in 0..said["rows"] {
        let word = |name: &str| said[&format!("{name}_{row}")];
        let time_s = 100e-6 * row as f64;
        let _ = writeln!(csv, "{time_s:.4},{},{}", word("command"), word("captured_position"));
    }
    let Log::Drive(log) = log::read(csv.as_bytes()).unwrap().log else {
        panic!()
    };
    let found = motor::identify(&log).unwrap();
    let axis = &driver.machine.axes[0];
    let (screw, drive) = (axis.mechanics.as_ref().unwrap(), axis.drive.unwrap());
    let mut truth = screw.held_mode();
    // The viscous friction of the table damps the mode too.
    truth.damping *= 1.0 + drive.viscous / screw.relative_damping();
    let [only] = found.held.modes[..] else {
        panic!("{found:#?}")
    };
    assert!(
        (only.mode.frequency_hz / truth.frequency_hz - 1.0).abs() < 0.01,
        "{only:#?} {truth:?}"
    );
    assert!(
        (only.mode.damping / truth.damping - 1.0).abs() < 0.15,
        "{only:#?} {truth:?}"
    );
}
