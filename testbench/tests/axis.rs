//! Compares the supervisor's Verilog with its bit-exact model, every output in every clock, and checks what must never
//! happen.

use crate::support;

use posicast_blocks::axis::Axis;
use posicast_blocks::{ClockedBlock, axis};
use posicast_testbench::axis::AxisBlock;
use posicast_testbench::axis::{AxisRandom, AxisSafety};
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::lockstep::{self, Instance, LockstepOptions};
use support::{assert_match, broken};

/// Changes that make the Verilog unsafe, each with the rule that it violates.
const MUTANTS: [(&str, &str, &str); 6] = [
    ("if (goes_quiet | cut)", "if (goes_quiet)", "outputs on a clock after"),
    (
        "if (goes_quiet | cut)",
        "if ((goes_quiet & enable) | cut)",
        "against the brake for too long",
    ),
    ("= next_on & !next_closing", "= next_on", "brake released in FAULT"),
    ("in_run & (fault | asked)", "in_run & asked", "RUN with a cause"),
    (
        "= ready & !emergency",
        "= ready & home & !emergency",
        "after an emergency stop",
    ),
    (
        "if (hold_to_run) begin",
        "if (hold_to_run | stop_to_hold) begin",
        "is not in the table",
    ),
];

fn block() -> AxisBlock {
    AxisBlock::new("", "alone")
}

/// Runs the Verilog, with `from` replaced by `to`, and returns the violated rules.
fn violations(from: &str, to: &str, cycles: u64) -> Vec<String> {
    let sources = Sources::of_modules(&broken(&block().modules().unwrap(), from, to)).unwrap();
    let mut device = sources.verilated(&block(), 3).unwrap();
    let mut model = Axis::new();
    let mut safety = AxisSafety::default();
    let instances = [Instance::whole("axis", "alone", &axis::ports())];
    let report = lockstep::run(
        &mut model as &mut dyn ClockedBlock,
        &mut device,
        &mut AxisRandom::new(3),
        &instances,
        &LockstepOptions::cycles(cycles),
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
    assert_eq!(violations("", "", 300_000), [""; 0]);
}

fn sees(mutants: &[(&str, &str, &str)]) {
    for (from, to, rule) in mutants {
        let found = violations(from, to, 200_000);
        assert!(found.iter().any(|found| found.contains(rule)), "`{to}`: {found:?}");
    }
}

#[test]
fn lockstep_sees_what_is_not_safe() {
    sees(&MUTANTS[..2]);
}

#[test]
fn long_lockstep_sees_all_that_is_not_safe() {
    sees(&MUTANTS[2..]);
}
