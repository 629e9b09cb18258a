//! A move by step pulses through the inline shaper: every step arrives, and the load rings as little as the design says.

use posicast_closed_loop::inline_run::{InlineMoved, InlineRun};
use posicast_closed_loop::stage_run::{Expected, Shaping};
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::motion::AxisMove;
use posicast_machine::plan::design_machine;

const EXAMPLE: &str = include_str!("../../examples/inline.toml");

fn machine(text: &str) -> Machine {
    machine_file::parse("inline.toml", text).unwrap()
}

/// The default move of `machine` through the inline shaper that is made for `built`.
fn moved(machine: &Machine, built: &Machine) -> (InlineMoved, [Vec<Expected>; 2]) {
    let (design, of_built) = (design_machine(machine).unwrap(), design_machine(built).unwrap());
    let hardware = Hardware::of(built, &of_built).unwrap();
    let inline = hardware.inline().unwrap().unwrap();
    let axes = machine.axes.iter();
    let moves: Vec<AxisMove> = axes.map(|axis| AxisMove::of_axis(axis, &machine.fixed_point)).collect();
    let run = InlineRun::new(machine, &design, inline, &moves, 1).unwrap();
    let expected = [Shaping::Shaped, Shaping::Unshaped].map(|shaping| run.expected(shaping).unwrap());
    (run.moved().unwrap(), expected)
}

/// Ringing of an axis with the shaper and without it, in m.
fn ringing(machine: &Machine, moved: &InlineMoved, axis: usize) -> [f64; 2] {
    let unit = machine.axes[axis].counts_per_unit;
    [Shaping::Shaped, Shaping::Unshaped].map(|shaping| moved.axes[axis].figures(shaping, unit).residual.peak)
}

#[test]
fn every_step_arrives_and_the_load_rings_as_designed() {
    let machine = machine(EXAMPLE);
    let (moved, [shaped, unshaped]) = moved(&machine, &machine);
    assert!(moved.settled && !moved.fault);
    for (axis, of) in machine.axes.iter().zip(&moved.axes) {
        assert_eq!(of.sent_steps, of.given_steps, "{}", axis.name);
        assert!(of.sent_steps > 100, "{}: {} steps", axis.name, of.sent_steps);
    }
    for axis in 0..2 {
        let [with, without] = ringing(&machine, &moved, axis);
        assert!(with <= shaped[axis].ringing_allowed(), "{with} {:?}", shaped[axis]);
        assert!(
            without <= unshaped[axis].ringing_allowed(),
            "{without} {:?}",
            unshaped[axis]
        );
        assert!(
            shaped[axis].exercises(&unshaped[axis]),
            "{:?} {:?}",
            shaped[axis],
            unshaped[axis]
        );
    }
}

#[test]
fn a_shaper_for_another_mode_rings_more_than_is_allowed() {
    let [right, wrong] =
        ["38.0", "60.0"].map(|hz| machine(&EXAMPLE.replace("frequency_hz = 38.0", &format!("frequency_hz = {hz}"))));
    let (moved, [shaped, _]) = moved(&right, &wrong);
    let [with, _] = ringing(&right, &moved, 0);
    assert!(with > shaped[0].ringing_allowed(), "{with} {:?}", shaped[0]);
}

#[test]
fn every_kind_of_input_and_output_is_read_as_the_drive_reads_it() {
    let up_and_down = EXAMPLE.replace("kind = \"step_direction\"", "kind = \"up_down\"");
    let quadrature = EXAMPLE
        .replace("kind = \"step_direction\"", "kind = \"quadrature\"")
        .replacen("mode = \"step_direction\"", "mode = \"up_down\"", 1)
        .replacen("pulse_s = 5e-6 ", "active_low = [\"step_a\"]\npulse_s = 5e-6 ", 1);
    for text in [up_and_down, quadrature] {
        let machine = machine(&text);
        let (moved, _) = moved(&machine, &machine);
        assert!(moved.settled && !moved.fault, "{text}");
        for of in &moved.axes {
            assert_eq!(of.sent_steps, of.given_steps, "{text}");
            assert!(of.sent_steps > 100, "{} steps: {text}", of.sent_steps);
        }
    }
}
