//! The bridge's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_testbench::uart_bridge::UartBridgeBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn bridge() -> UartBridgeBlock {
    UartBridgeBlock::new("", "alone")
}

#[test]
fn lockstep_a_million_random_clocks() {
    for seed in 1..=2 {
        million_random_clocks(&bridge(), seed, 3);
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&bridge());
}

#[test]
fn lockstep_catches_a_checksum_that_is_not_looked_at() {
    caught(&bridge(), "holds = sum == RESIDUE", "holds = 1'b1", 300_000);
}

#[test]
fn lockstep_catches_a_repeated_request_that_is_executed_again() {
    caught(&bridge(), "(sequence_number == last_sequence)", "1'b0", 300_000);
}

#[test]
fn lockstep_catches_an_address_one_beyond_the_registers() {
    caught(
        &bridge(),
        "exists = address_q < address_limit",
        "exists = address_q <= address_limit",
        1_000_000,
    );
}

#[test]
fn lockstep_catches_a_frame_that_goes_on_after_a_byte_without_a_stop_bit() {
    caught(
        &bridge(),
        "spoilt = skips | bad | (expired & begun)",
        "spoilt = skips | (expired & begun)",
        1_000_000,
    );
}

#[test]
fn lockstep_catches_a_time_out_that_never_comes() {
    caught(&bridge(), "| bad | (expired & begun)", "| bad", 1_000_000);
}

#[test]
fn lockstep_catches_a_bit_that_is_taken_an_eighth_late() {
    caught(&bridge(), "MIDDLE = 3'd3", "MIDDLE = 3'd4", 300_000);
}

/// A mutant that was not found while the host's numbers seldom went beyond 63.
#[test]
fn lockstep_catches_a_sequence_number_that_loses_a_bit_on_the_way() {
    caught(
        &bridge(),
        "if (place == THIRD) begin",
        "if (|place) sequence_q_next = sequence_q & 8'hbf;\n            if (place == THIRD) begin",
        300_000,
    );
}

/// With these the requests at the borders begin: random numbers take long to come upon them.
#[test]
fn lockstep_catches_a_sequence_number_that_is_compared_on_six_bits_among_the_first_requests() {
    caught(
        &bridge(),
        "(sequence_number == last_sequence)",
        "(sequence_number[5:0] == last_sequence[5:0])",
        20_000,
    );
}

#[test]
fn lockstep_catches_a_number_0_that_repeats_among_the_first_requests() {
    caught(&bridge(), "(|sequence_number)", "1'b1", 20_000);
}
