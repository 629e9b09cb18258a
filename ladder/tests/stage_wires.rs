//! Wrong wires of one axis in a stage, which the scenes of its row must find.
//!
//! The example `mutate --wires` makes one of every constant and wire, in `scripts/verify-all`.

use posicast_ladder::mutation::{MutationOptions, WireMutant, hunt_wires};
use posicast_machine::plan::design_machine;
use posicast_machine::{hardware, machine_file};

/// Part and port, the wire, and the wrong one. A million clocks found no clear that comes a clock early before the stimuli read the flags
/// in the clocks after `CLEAR_FAULTS`.
const WRONG: [([&str; 2], &str, &str); 8] = [
    (["segments", "clear_flags"], "clear_sources", "clear_faults"),
    (["shaper", "clear_flags"], "clear_sources", "clear_faults"),
    (["sliding_mode", "clear_flags"], "clear_sources", "clear_faults"),
    (["pulse_counter", "clear_flags"], "clear_sources", "clear_faults"),
    (["pwm", "clear_flags"], "clear_sources", "clear_faults"),
    (["pwm", "clear_trip"], "clear_sources", "clear_faults"),
    (["axis", "reference_position"], "shaped_position", "command_position"),
    (
        ["sliding_mode", "velocity_reference"],
        "shaped_velocity",
        "command_velocity",
    ),
];

#[test]
fn long_lockstep_catches_wrong_wires_of_each_axis() {
    let machine = machine_file::parse("xy-stage.toml", include_str!("../../examples/xy-stage.toml")).unwrap();
    let stage = hardware::stage(&machine, &design_machine(&machine).unwrap());
    let config = stage.unwrap().unwrap().config;
    let of_axis = |axis| WRONG.map(|(port, from, to)| WireMutant::exchange(axis, port, from, to));
    let mutants = ["x", "y"].into_iter().flat_map(of_axis).collect();
    let folder = tempfile::tempdir().unwrap();
    let options = MutationOptions::default();
    let fates = hunt_wires(&config, "xy_stage_stage", mutants, &options, folder.path()).unwrap();
    for fate in &fates {
        println!("{}: {:?}", fate.mutant.describe(), fate.kill);
    }
    let unseen = fates.iter().filter(|fate| fate.kill.is_none());
    let unseen: Vec<String> = unseen.map(|fate| fate.mutant.describe()).collect();
    assert_eq!(unseen, [""; 0]);
}
