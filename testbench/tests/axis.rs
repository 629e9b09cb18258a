//! Compares the supervisor's Verilog with its bit-exact model, every output in every clock, and checks what must never
//! happen.

use crate::support;

use posicast_blocks::axis::Axis;
use posicast_blocks::{ClockedBlock, axis};
use posicast_testbench::axis::AxisBlock;
use posicast_testbench::axis::{AxisRandom, AxisSafety};
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::lockstep::{self, Instance, LockstepOptions};
use support::{assert_match, broken, caught, icarus_agrees, million_random_clocks};

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
    assert_eq!(violations("", "", 1_000_000), [""; 0]);
}

#[test]
fn lockstep_sees_what_is_not_safe() {
    for (from, to, rule) in MUTANTS {
        let found = violations(from, to, 200_000);
        assert!(found.iter().any(|found| found.contains(rule)), "`{to}`: {found:?}");
    }
}

#[test]
fn lockstep_catches_a_limit_that_blocks_the_way_back() {
    caught(&block(), "on_minus & (backward", "on_minus & (forward", 200_000);
}

#[test]
fn lockstep_catches_a_clear_that_forgets_what_is_active() {
    caught(&block(), "| watched", "| (forget ? 16'd0 : watched)", 200_000);
}

#[test]
fn lockstep_catches_a_limit_that_is_passed_by_an_lsb() {
    caught(
        &block(),
        "if (!compares) begin\n            larger_q_next = 1'd0",
        "if (!compares) begin\n            larger_q_next = 1'd1",
        300_000,
    );
}

#[test]
fn lockstep_catches_a_shaper_that_is_let_go_before_its_first_sample() {
    caught(
        &block(),
        "!next_on | (starting_q & !segments_valid)",
        "!next_on",
        100_000,
    );
}

#[test]
fn lockstep_catches_a_rotary_axis_that_is_held_in_a_range() {
    caught(&block(), "far & !modulo", "far & modulo", 300_000);
}

#[test]
fn lockstep_catches_a_motion_of_the_wrong_sign() {
    caught(
        &block(),
        "motion <= captured - still_since",
        "motion <= still_since - captured",
        300_000,
    );
}
