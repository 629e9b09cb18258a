//! The position compare, on the model of the stage with its simulated machine.
#![cfg(test)]

use crate::home::{LINK, bench};
use crate::stage::stage;
use posicast_blocks::linked_stage::address_limit;
use posicast_closed_loop::linked_bench::LinkedBench;
use posicast_host::{HostMove, HostedStage, Link, LinkOptions};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plant::axis::PlantOptions;

fn machine() -> Machine {
    machine_file::parse("line-scan.toml", include_str!("../../examples/line-scan.toml")).unwrap()
}

fn open<'m>(machine: &'m Machine, stage: &'m StageHardware) -> HostedStage<'m, LinkedBench> {
    let bench = bench(machine, stage, &PlantOptions::default());
    let line = LinkedBench::new(bench, &LINK, &machine.clock, address_limit(&stage.component));
    HostedStage::open(Link::new(line, LinkOptions::default()), machine, stage).unwrap()
}

fn shift(distance: f64) -> [HostMove; 1] {
    [HostMove {
        axis: 0,
        distance,
        speed: None,
    }]
}

#[test]
fn a_row_gives_a_pulse_at_each_position_in_both_directions() {
    let machine = machine();
    let stage = stage(&machine);
    let mut host = open(&machine, &stage);
    host.switch_on(&[0], false).unwrap();
    // Half way between two positions, which are 0.01 mm apart.
    host.move_axes(&shift(0.005)).unwrap();
    let state = host.arm_compare(0, None).unwrap();
    assert!(state.armed && state.ready && state.passes == 0, "{state:?}");
    host.move_axes(&shift(1.0)).unwrap();
    assert_eq!(host.compare_state(0).unwrap().passes, 100);
    host.move_axes(&shift(-0.5)).unwrap();
    let state = host.compare_state(0).unwrap();
    assert_eq!((state.passes, state.merged, state.jumped), (150, false, false));
    host.disarm_compare(0).unwrap();
    host.move_axes(&shift(0.1)).unwrap();
    let state = host.compare_state(0).unwrap();
    assert_eq!((state.armed, state.ready, state.passes), (false, false, 150));
}

#[test]
fn positions_count_from_the_origin() {
    let machine = machine();
    let stage = stage(&machine);
    let mut host = open(&machine, &stage);
    host.switch_on(&[0], false).unwrap();
    let mut line = host.into_link().into_line();
    // The axis stands at count 0, which is now at 39.995 mm: 5 positions of the row are still above it.
    line.bench.write("scan_preset", 79_990).unwrap();
    let mut host = HostedStage::open(Link::new(line, LinkOptions::default()), &machine, &stage).unwrap();
    host.arm_compare(0, None).unwrap();
    host.move_axes(&shift(0.5)).unwrap();
    assert_eq!(host.compare_state(0).unwrap().passes, 1);
    host.arm_compare(0, Some(&[40.0, 40.002, 40.1, 40.3])).unwrap();
    host.move_axes(&shift(-0.5)).unwrap();
    assert_eq!(host.compare_state(0).unwrap().passes, 4);
}

#[test]
fn lists_that_the_hardware_cannot_have_are_refused() {
    let machine = machine();
    let stage = stage(&machine);
    let mut host = open(&machine, &stage);
    let mut refused = |at: &[f64], expected: &str| {
        let error = host.arm_compare(0, Some(at)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    };
    refused(&[], "1 to 256 positions, not 0");
    refused(&[0.0; 257], "not 257");
    refused(&[1.0, 1.0015], "position 1.0015 is 3 counts above the one before");
    refused(&[1.0, 0.5], "-1000 counts above");
    refused(&[1.1e6], "leaves the position word");
    refused(&[f64::NAN], "leaves the position word");
    assert!(!host.compare_state(0).unwrap().armed);

    let other = machine_file::parse("xy-stage.toml", include_str!("../../examples/xy-stage.toml")).unwrap();
    let stage = crate::stage::stage(&other);
    let mut host = open(&other, &stage);
    let error = host.arm_compare(0, None).unwrap_err().to_string();
    assert_eq!(error, "axis x compares no positions: it has no [axis.compare]");
}
