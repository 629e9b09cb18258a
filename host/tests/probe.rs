//! Probing at a capture line, on the model of the stage with its simulated machine.
#![cfg(test)]

use crate::home::{LINK, bench};
use crate::stage::stage;
use posicast_blocks::linked_stage::address_limit;
use posicast_closed_loop::linked_bench::LinkedBench;
use posicast_closed_loop::touching::{Contact, Touching};
use posicast_host::{HostMove, HostedStage, Link, LinkOptions};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plant::axis::PlantOptions;

fn machine(more: &str) -> Machine {
    let text = include_str!("../../examples/xy-stage.toml");
    machine_file::parse("xy-stage.toml", &format!("{text}{more}")).unwrap()
}

/// The stage with a probe that touches, with a low line, while X is at this count or beyond it; all the time with 0.
fn open<'m>(machine: &'m Machine, stage: &'m StageHardware, count: i64) -> HostedStage<'m, LinkedBench<Touching>> {
    let contact = Contact {
        axis: 0,
        count,
        is_low: true,
        // 20 mm/s at 1000 counts per mm and 50 MHz.
        fastest: 4e-4,
    };
    let bench = bench(machine, stage, &PlantOptions::default());
    let limit = address_limit(&stage.component);
    let line = LinkedBench::new(Touching::new(bench, contact), &LINK, &machine.clock, limit);
    HostedStage::open(Link::new(line, LinkOptions::default()), machine, stage).unwrap()
}

fn way(axis: usize, distance: f64) -> HostMove {
    HostMove {
        axis,
        distance,
        speed: Some(0.02),
    }
}

#[test]
fn a_probing_move_finds_where_the_probe_touched_and_says_how_far_it_went_on() {
    let machine = machine("\n[capture]\nedge = \"falling\"\nfilter_s = 1e-6\n");
    let stage = stage(&machine);
    let mut host = open(&machine, &stage, 3000);
    host.switch_on(&[0, 1], false).unwrap();
    host.move_axes(&[way(1, 0.001)]).unwrap();
    let probing = host.probe(way(0, 0.01)).unwrap();
    // 20 mm/s are 0.02 counts per µs: filter and look of the probe take less than two.
    assert!((probing.found.positions[0] - 3000).abs() <= 1, "{probing:?}");
    assert!((probing.found.positions[1] - 1000).abs() <= 2, "{probing:?}");
    assert!(
        !probing.found.rising && probing.overrun > 0 && probing.overrun < 2000,
        "{probing:?}"
    );
    let stands = host.status().unwrap()[0].position;
    assert_eq!(stands, f64::from(probing.found.positions[0] + probing.overrun));

    let error = host.probe(way(0, 0.01)).unwrap_err().to_string();
    assert!(error.contains("the probe touches before the move"), "{error}");
    // Free again, it finds the same place.
    host.move_axes(&[way(0, -0.002)]).unwrap();
    let again = host.probe(way(0, 0.01)).unwrap();
    assert!((again.found.positions[0] - 3000).abs() <= 1, "{again:?}");
}

#[test]
fn a_line_that_is_stuck_at_the_touch_from_the_start_is_refused_and_nothing_moves() {
    let machine = machine("\n[capture]\nedge = \"falling\"\nfilter_s = 1e-6\n");
    let stage = stage(&machine);
    let mut host = open(&machine, &stage, 0);
    host.switch_on(&[0], false).unwrap();
    let error = host.probe(way(0, 0.01)).unwrap_err().to_string();
    assert!(error.contains("the probe touches before the move"), "{error}");
    let status = host.status().unwrap()[0].clone();
    assert!(status.can_start && status.position.abs() <= 1.0, "{status:?}");
}

#[test]
fn a_move_without_an_edge_says_so() {
    let machine = machine("\n[capture]\nedge = \"falling\"\n");
    let stage = stage(&machine);
    let mut host = open(&machine, &stage, 50_000);
    host.switch_on(&[0], false).unwrap();
    let error = host.probe(way(0, 0.002)).unwrap_err().to_string();
    assert_eq!(
        error,
        "axis x found nothing: the move ended without an edge of the capture line"
    );
    let status = host.status().unwrap()[0].clone();
    assert!(
        status.can_start && (status.position - 2000.0).abs() <= 2.0,
        "{status:?}"
    );
}

#[test]
fn a_stage_without_a_capture_cannot_probe() {
    let machine = machine("");
    let stage = stage(&machine);
    let bench = bench(&machine, &stage, &PlantOptions::default());
    let line = LinkedBench::new(bench, &LINK, &machine.clock, address_limit(&stage.component));
    let mut host = HostedStage::open(Link::new(line, LinkOptions::default()), &machine, &stage).unwrap();
    let error = host.probe(way(0, 0.002)).unwrap_err().to_string();
    assert!(error.contains("the machine file has no [capture]"), "{error}");
}
