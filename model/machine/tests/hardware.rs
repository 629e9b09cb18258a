//! The hardware configuration of a machine, which is derived in one place.

use posicast_blocks::component::Component;
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::design_machine;

const STAGE: &str = include_str!("../../../examples/xy-stage.toml");

fn machine(text: &str) -> Machine {
    machine_file::parse("machine.toml", text).unwrap()
}

#[test]
fn an_axis_has_the_gains_and_the_lag_of_its_stage() {
    let machine = machine(STAGE);
    let hardware = Hardware::of(&machine, &design_machine(&machine).unwrap()).unwrap();
    let stage = hardware.stage().unwrap().unwrap();
    assert_eq!(hardware.axes().len(), 2);
    for (index, axis) in hardware.axes().iter().enumerate() {
        let control = axis.control.as_ref().unwrap();
        assert_eq!(control.lag_s, stage.of_machine.loops[index].as_ref().unwrap().lag_s);
        let built = stage.of_machine.config.axes[index].closed_loop().unwrap();
        assert_eq!(control.derived.settings, built.settings);
    }
    let components = hardware.components().unwrap();
    let built = stage.of_machine.config.axes[1].closed_loop().unwrap();
    let controller = Component::sliding_mode(&built.settings, built.law, machine.axes[1].modulo).unwrap();
    assert_eq!(
        components.iter().map(|one| one.axis).collect::<Vec<_>>(),
        [0, 0, 0, 0, 1, 1, 1, 1]
    );
    assert_eq!(components.last().unwrap().component, controller);
}

#[test]
fn a_machine_whose_tick_is_too_short_can_still_be_looked_at() {
    let text = STAGE
        .replace("sample_hz = 10_000", "sample_hz = 100_000")
        .replace("frequency_hz = 20_000", "frequency_hz = 100_000");
    let machine = machine(&text);
    let hardware = Hardware::of(&machine, &design_machine(&machine).unwrap()).unwrap();
    let error = hardware.shapers().unwrap_err();
    assert_eq!((error.axis, error.key.as_str()), (0, "clock.sample_hz"));
    assert!(error.reason.contains("allowed: up to"), "{error}");
    assert_eq!(hardware.components().unwrap_err().key, "clock.sample_hz");
    assert!(hardware.axes()[0].control.is_some());
}

#[test]
fn shapers_that_do_not_suit_a_stage_are_a_reason_and_no_error() {
    // 16 bits cannot hold a travel of a hundred millimetres, so the file must not name one.
    let lines = STAGE.lines().filter(|line| !line.trim_start().starts_with("travel"));
    let text = lines.collect::<Vec<_>>().join("\n") + "\n[fixed_point]\ncommand_bits = 16\n";
    let machine = machine(&text);
    let hardware = Hardware::of(&machine, &design_machine(&machine).unwrap()).unwrap();
    assert!(hardware.stage().unwrap().is_none());
    assert!(
        hardware
            .without_stage()
            .unwrap()
            .reason
            .contains("stage shapes position"),
        "{:?}",
        hardware.without_stage()
    );
    assert!(
        hardware
            .axes()
            .iter()
            .all(|axis| axis.control.as_ref().unwrap().is_one_channel)
    );
}
