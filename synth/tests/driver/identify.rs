//! A machine is measured through its own loop: the driver excites an axis and reads its trace, and the modes are
//! identified.

use crate::driver::bridge::Bridge;
use crate::driver::support::Driver;
use posicast_identify::log::{self, Log};
use posicast_identify::position;
use posicast_model::machine_file::{self, Machine};
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
fn unit_the_stages_own_trace_tells_its_mode() {
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
