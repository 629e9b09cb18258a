//! The fault campaign: a share of its cases on the model, a few with the RTL beside it, and stages that are slower than stated.
//!
//! All of them: `scripts/verify-all`, which runs the example of the same name.
#![allow(clippy::unwrap_used)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use std::thread;

use posicast_model::control::Supervision;
use posicast_model::rtl::component::Component;
use posicast_testbench::Error;
use posicast_testbench::blocks::{ComponentBlock, Sources};
use posicast_testbench::fault_campaign::{Bed, Kind, Report, TABLE, run, run_with_rtl};
use posicast_testbench::lockstep::Device;

/// Cases of every kind.
const ROUNDS: u64 = 8;
const SEED: u64 = 7;

fn threads() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// The first case of a kind.
fn number(kind: Kind) -> u64 {
    TABLE.iter().position(|row| row.kind == kind).unwrap() as u64
}

/// One case of that kind, on a machine whose stage has another supervision than is demanded.
fn on_a_changed_stage(kind: Kind, change: fn(&mut Supervision)) -> Report {
    let mut bed = Bed::new().unwrap();
    // What is demanded stays as it is.
    let mut config = bed.stage.config.clone();
    for axis in &mut config.axes {
        change(&mut axis.supervision);
    }
    bed.component = Component::stage(&config).unwrap();
    let first = number(kind);
    run(&bed, first..first + 1, SEED, 1).unwrap()
}

#[track_caller]
fn assert_says(report: &Report, what: &str) {
    let failures = report.failures();
    assert!(failures.iter().any(|failure| failure.contains(what)), "{failures:#?}");
}

#[test]
fn unit_every_fault_is_handled_as_stated() {
    let bed = Bed::new().unwrap();
    let report = run(&bed, 0..ROUNDS * TABLE.len() as u64, SEED, threads()).unwrap();
    assert_eq!(report.failures(), [""; 0], "{report}");
    assert!(report.kinds().iter().all(|kind| kind.cases == ROUNDS));
}

#[test]
fn lockstep_faults_with_the_rtl_beside_the_model() {
    let bed = Bed::new().unwrap();
    let block = ComponentBlock::new(bed.component.clone(), "xy_stage", "xy");
    let sources = Sources::write(&block).unwrap();
    let device = || -> Result<Box<dyn Device>, Error> { Ok(Box::new(sources.verilated(&block, 1)?)) };
    let first = number(Kind::RawFaultOneClock);
    let report = run_with_rtl(&bed, first..first + 3, SEED, device).unwrap();
    assert_eq!(report.failures(), [""; 0], "{report}");
}

#[test]
fn mutate_a_slower_filter_is_late() {
    let report = on_a_changed_stage(Kind::EmergencyStop, |watched| watched.filter_clocks += 1);
    assert_says(&report, "1 clocks late");
}

#[test]
fn mutate_a_longer_stop_is_late() {
    let report = on_a_changed_stage(Kind::Stop, |watched| watched.settle_ticks += 40);
    assert_says(&report, "a quick stop of");
}
