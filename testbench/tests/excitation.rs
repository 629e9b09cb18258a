//! The excitation's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_testbench::excitation::ExcitationBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn excitation() -> ExcitationBlock {
    ExcitationBlock::new("", "alone")
}

#[test]
fn lockstep_a_million_random_clocks() {
    for seed in 1..=2 {
        million_random_clocks(&excitation(), seed, 10);
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&excitation());
}

#[test]
fn lockstep_catches_another_polynomial() {
    caught(
        &excitation(),
        "noise[14] ^ noise[13]",
        "noise[14] ^ noise[12]",
        1_000_000,
    );
}

#[test]
fn lockstep_catches_a_position_that_wraps() {
    caught(&excitation(), "sum_bits[32] ^ sum_bits[31]", "1'b0", 300_000);
}

#[test]
fn lockstep_catches_an_amplitude_beyond_its_limit() {
    caught(&excitation(), "amplitude > amplitude_limit", "1'b0", 300_000);
}

#[test]
fn lockstep_catches_a_signal_that_starts_twice() {
    caught(&excitation(), "if (starts) begin", "if (1'b0) begin", 300_000);
}

#[test]
fn lockstep_catches_a_value_rounded_toward_zero() {
    caught(
        &excitation(),
        "complement = ~subtrahend",
        "complement = -subtrahend",
        300_000,
    );
}

#[test]
fn lockstep_catches_a_chirp_without_end() {
    caught(&excitation(), "too_fast = turned", "too_fast = 1'b0", 1_000_000);
}
