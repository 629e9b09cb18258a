//! The linear scale's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_testbench::linear_scale::LinearScaleBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn block() -> LinearScaleBlock {
    LinearScaleBlock::new("", "alone")
}

#[test]
fn lockstep_a_million_random_clocks() {
    for seed in 1..=2 {
        million_random_clocks(&block(), seed, 20);
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&block());
}

#[test]
fn lockstep_catches_a_product_that_is_not_rounded() {
    caught(
        &block(),
        "rounded_bit = product_bit ^ round_up",
        "rounded_bit = product_bit",
        200_000,
    );
}

#[test]
fn lockstep_catches_an_overflow_that_wraps() {
    caught(
        &block(),
        "fills_velocity = ends_velocity & serial_overflows",
        "fills_velocity = ends_velocity & rst",
        300_000,
    );
}

#[test]
fn lockstep_catches_an_align_in_a_pass_that_is_lost() {
    caught(&block(), "silent = asked_now | aligning", "silent = aligning", 300_000);
}

#[test]
fn lockstep_catches_a_reference_that_does_not_come_back() {
    caught(
        &block(),
        "other_entering = other_reference << 31",
        "other_entering = 32'd0",
        300_000,
    );
}
