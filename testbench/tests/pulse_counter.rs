//! The pulse counter's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_testbench::pulse_counter::PulseCounterBlock;
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
    caught(&pulse_counter(), "left == 6'd0", "left <= 6'd1", 200_000);
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

#[test]
fn lockstep_catches_a_count_of_illegal_steps_that_ends_too_early() {
    let from = "(&illegal_high)";
    caught(&pulse_counter(), from, "illegal_high[2:0] == 3'd7", 300_000);
    caught(
        &pulse_counter(),
        "low_full & (&illegal_high)",
        "(&illegal_high)",
        300_000,
    );
}

#[test]
fn lockstep_catches_a_velocity_that_rests_a_step_of_the_timeout_late() {
    caught(
        &pulse_counter(),
        "interval[23:16] < timeout",
        "interval[23:16] <= timeout",
        300_000,
    );
}

#[test]
fn lockstep_catches_an_edge_that_stays_known_after_the_timeout() {
    caught(
        &pulse_counter(),
        "known_next = moved | fresh",
        "known_next = moved | known",
        300_000,
    );
}
