//! Homing by a probe, on the model of the stage with its simulated machine.
#![cfg(test)]

use std::time::Duration;

use crate::stage::stage;
use posicast_blocks::linked_stage::address_limit;
use posicast_closed_loop::linked_bench::LinkedBench;
use posicast_closed_loop::stage_bench::StageBench;
use posicast_host::{HostError, HostMove, HostedStage, Link, LinkOptions};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::{self, LinkLine, LinkSection, Machine};
use posicast_machine::plant::axis::{AxisPlant, PlantOptions};

const OPTIONS: LinkOptions = LinkOptions {
    timeout: Duration::from_millis(20),
    attempts: 2,
};
/// The line between host and stage.
pub(crate) const LINK: LinkSection = LinkSection {
    line: LinkLine::Uart { baud: 3_000_000 },
    timeout_s: 0.01,
    machine_crc: 0,
};
/// Steps per m of the axes.
const STEPS: f64 = 80_000.0;

/// The printer with more tables on its first axis.
fn with(tables: &str, motor: &str) -> Machine {
    let text = include_str!("../../examples/printer.toml");
    let text = text.replacen("[axis.limits]", &format!("{tables}\n[axis.limits]"), 1);
    let text = text.replacen("resonance_hz = 120.0", &format!("resonance_hz = {motor}"), 1);
    machine_file::parse("printer.toml", &text).unwrap()
}

/// The printer with a probe on its first axis.
fn machine(probe: &str) -> Machine {
    with(
        &format!("[axis.probe]\nvelocity = 0.01\nwithin = 0.02\nretract = 0.002\n{probe}"),
        "120.0",
    )
}

/// The stage with its machine.
pub(crate) fn bench(machine: &Machine, stage: &StageHardware, options: &PlantOptions) -> StageBench {
    let plant = |axis| AxisPlant::new(axis, &machine.clock, options).unwrap();
    let plants = machine.axes.iter().map(plant).collect();
    StageBench::new(&stage.of_machine.config, &stage.component, plants, None, 1).unwrap()
}

/// The stage with its machine, whose probe touches from a position on.
fn open<'m>(machine: &'m Machine, stage: &'m StageHardware, contact_at: f64) -> HostedStage<'m, LinkedBench> {
    let options = PlantOptions {
        contact_at,
        ..PlantOptions::default()
    };
    let bench = bench(machine, stage, &options);
    let line = LinkedBench::new(bench, &LINK, &machine.clock, address_limit(&stage.component));
    HostedStage::open(Link::new(line, OPTIONS), machine, stage).unwrap()
}

#[test]
fn an_axis_knows_its_position_after_touching_its_probe() {
    // Both polarities, both sides, and once a start on the contact.
    for (keys, contact_at, from) in [
        ("active_low = true\nfilter_s = 1e-6\nposition = 0.001", -0.008, 0.0),
        ("side = \"plus\"\nposition = 0.25", 0.008, 0.0),
        ("position = 0.001", -0.001, -0.002),
    ] {
        let machine = machine(keys);
        let stage = stage(&machine);
        let mut host = open(&machine, &stage, contact_at);
        host.switch_on(&[0], false).unwrap();
        if from != 0.0 {
            let onto = HostMove {
                axis: 0,
                distance: from,
                speed: Some(0.01),
            };
            host.move_axes(&[onto]).unwrap();
        }
        let probe = machine.axes[0].probe.unwrap();
        let count = host.home(0).unwrap();
        let status = host.status().unwrap()[0].clone();
        assert!(status.homed && status.can_start, "{status:?}");
        // The motor lags behind its steps by less than one.
        assert!((f64::from(count) - contact_at * STEPS).abs() <= 1.0, "{count}");
        let away = probe.position - probe.side.sign() * probe.retract;
        let slack = 0.001 * STEPS;
        assert!((status.position - away * STEPS).abs() <= slack, "{status:?}");
        // Where it says it is, it is.
        let line = host.into_link().into_line();
        let at = line.bench.plant(0).motion().position - contact_at + probe.position;
        assert!((at * STEPS - status.position).abs() <= 1.0, "{at} {status:?}");
        // The soft limits are those of the file, from the new origin.
        let mut bench = line.bench;
        let origin = bench.read("x_origin").unwrap() as i32;
        let limits = ["x_soft_limit_minus", "x_soft_limit_plus"].map(|name| bench.read(name).unwrap() as i32);
        assert_eq!(limits.map(|limit| (limit >> 8) - origin), [0, 20_000]);
        assert_eq!(bench.read("x_index").unwrap(), 0);
    }
}

#[test]
fn an_axis_is_homed_again_where_its_travel_ends_at_the_contact() {
    let machine = machine("active_low = true");
    let stage = stage(&machine);
    let mut host = open(&machine, &stage, -0.008);
    host.switch_on(&[0], false).unwrap();
    let first = host.home(0).unwrap();
    let again = host.home(0).unwrap();
    assert!((first - again).abs() <= 1, "{first} {again}");
    let status = host.status().unwrap()[0].clone();
    assert!(status.homed && status.can_start && status.causes == 0, "{status:?}");
}

#[test]
fn an_axis_without_a_contact_is_not_homed() {
    let machine = machine("");
    let stage = stage(&machine);
    let mut host = open(&machine, &stage, -0.05);
    host.switch_on(&[0], false).unwrap();
    let error = host.home(0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "axis x was not homed: there was no contact within `within`"
    );
    assert!(!host.status().unwrap()[0].homed);
    // A broken wire of a contact that opens looks as if it touched.
    let mut host = open(&machine, &stage, 0.05);
    host.switch_on(&[0], false).unwrap();
    assert!(matches!(host.home(0), Err(HostError::Probe { what, .. }) if what.contains("still touches")));
    assert!(matches!(host.home(1), Err(HostError::Probe { what, .. }) if what.contains("no [axis.probe]")));
}

#[test]
fn a_motor_that_lost_pitches_is_brought_back() {
    // Its largest acceleration is 2 m/s², and the move has 5: it is pulled over.
    let tables = |most: &str| {
        format!(
            "[axis.scale]\ncounts_per_unit = 800_000\n[axis.correction]\nfrom = 0.0001\nmost = {most}\nvelocity = 0.02\nrest_s = 0.6"
        )
    };
    let machine = with(&tables("0.2"), "20.0");
    let stage = stage(&machine);
    let mut host = open(&machine, &stage, 0.0);
    host.switch_on(&[0], false).unwrap();
    let there = HostMove {
        axis: 0,
        distance: 0.05,
        speed: None,
    };
    host.move_axes(&[there]).unwrap();
    let before = host.status().unwrap()[0].clone();
    let corrected = host.correct(0).unwrap();
    // Whole pitches of 64 steps.
    assert!(
        corrected.steps != 0 && (f64::from(corrected.steps) / 64.0).fract().abs() < 0.02,
        "{corrected:?}"
    );
    // Nothing is given twice.
    let again = host.correct(0).unwrap();
    assert!(again.steps == 0 && again.left.abs() <= 1, "{again:?}");
    let after = host.status().unwrap()[0].clone();
    assert_eq!((after.position, after.causes), (before.position, 0));
    let mut bench = host.into_link().into_line().bench;
    assert_eq!(bench.read("x_corrected").unwrap() as i32, corrected.steps);
    let at = bench.plant(0).motion().position * STEPS;
    assert!((at - after.position).abs() <= 1.0, "{at} {after:?}");

    // An axis that is farther off than the file allows stays as it is.
    let machine = with(&tables("0.0005"), "20.0");
    let stage = self::stage(&machine);
    let mut host = open(&machine, &stage, 0.0);
    host.switch_on(&[0], false).unwrap();
    host.move_axes(&[there]).unwrap();
    assert!(matches!(host.correct(0), Err(HostError::Deviates { most: 40, .. })));
}
