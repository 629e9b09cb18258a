//! The pulse counter's Verilog against its bit-exact model, every output in every clock.

mod support;

use posicast_testbench::blocks::PulseCounterBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn pulse_counter() -> PulseCounterBlock {
    PulseCounterBlock::new("", "alone")
}

#[test]
fn lockstep_a_million_random_clocks() {
    for seed in 1..=2 {
        million_random_clocks(&pulse_counter(), seed, 21);
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&pulse_counter());
}

#[test]
fn lockstep_catches_a_filter_a_clock_too_short() {
    caught(&pulse_counter(), "left == NO_CLOCKS", "left <= ONE_CLOCK", 200_000);
}

#[test]
fn lockstep_catches_an_index_that_latches_before_the_step() {
    caught(
        &pulse_counter(),
        "index_count_q_next = counted",
        "index_count_q_next = count_q",
        200_000,
    );
}
