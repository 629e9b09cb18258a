//! The internal encoder's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_testbench::encoder_generator::EncoderGeneratorBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn encoder_generator() -> EncoderGeneratorBlock {
    EncoderGeneratorBlock::new("", "alone")
}

#[test]
fn lockstep_a_million_random_clocks() {
    for seed in 1..=2 {
        million_random_clocks(&encoder_generator(), seed, 20);
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&encoder_generator());
}

#[test]
fn lockstep_catches_lines_that_change_in_successive_clocks() {
    caught(&encoder_generator(), "if (!moved) begin", "if (1'b1) begin", 300_000);
}

#[test]
fn lockstep_catches_a_turn_that_is_a_period_too_long() {
    caught(
        &encoder_generator(),
        "next_period >= index_periods",
        "next_period > index_periods",
        300_000,
    );
}

#[test]
fn lockstep_catches_an_index_that_is_lost_going_down() {
    caught(
        &encoder_generator(),
        "from_period = index_periods",
        "from_period = period",
        300_000,
    );
}

#[test]
fn lockstep_catches_lines_that_outlive_a_reset() {
    caught(
        &encoder_generator(),
        "generated_a = line_a & !rst",
        "generated_a = line_a",
        300_000,
    );
}

#[test]
fn lockstep_catches_a_rate_without_its_sign() {
    caught(&encoder_generator(), "{{32{rate[31]}}, rate}", "{32'd0, rate}", 300_000);
}
