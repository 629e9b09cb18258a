//! The supervisor's Verilog against its bit-exact model, every output in every clock, and what must never happen.

mod support;

use posicast_model::rtl::axis::Axis;
use posicast_model::rtl::{ClockedBlock, axis};
use posicast_testbench::blocks::{AxisBlock, Block, Sources};
use posicast_testbench::lockstep::{self, Instance, Options};
use posicast_testbench::stimuli::{AxisRandom, AxisSafety};
use support::{assert_match, broken, caught, icarus_agrees, million_random_clocks};

fn block() -> AxisBlock {
    AxisBlock::new("", "alone")
}

#[test]
fn lockstep_a_million_random_clocks() {
    for seed in 1..=2 {
        million_random_clocks(&block(), seed, 10);
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&block());
}

/// Runs the Verilog, with `from` replaced by `to`, and gives what was violated.
fn violations(from: &str, to: &str, cycles: u64) -> Vec<String> {
    let sources = Sources::of_modules(&broken(&block(), from, to)).unwrap();
    let mut device = sources.verilated(&block(), 3).unwrap();
    let mut model = Axis::new();
    let mut safety = AxisSafety::default();
    let instances = [Instance::whole("axis", "alone", &axis::ports())];
    let report = lockstep::run(
        &mut model as &mut dyn ClockedBlock,
        &mut device,
        &mut AxisRandom::new(3),
        &instances,
        &Options::cycles(cycles),
        &mut |clock| safety.observe(clock.inputs, clock.actual),
        &mut |_| {},
    )
    .unwrap();
    if to == from {
        assert_match(&report, "unbroken");
    }
    safety.violations().to_vec()
}

#[test]
fn lockstep_is_safe_in_every_clock() {
    assert_eq!(violations("", "", 1_000_000), [""; 0]);
}

#[test]
fn lockstep_sees_what_is_not_safe() {
    for (from, to, rule) in MUTANTS {
        let found = violations(from, to, 200_000);
        assert!(found.iter().any(|found| found.contains(rule)), "`{to}`: {found:?}");
    }
}
