//! The divider's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_blocks::divider::DividerConfig;
use posicast_testbench::divider::DividerBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn divider(tick_clocks: u64) -> DividerBlock {
    DividerBlock::new(DividerConfig::new(tick_clocks).unwrap(), "")
}

#[test]
fn lockstep_a_million_random_clocks_of_5000_per_tick() {
    million_random_clocks(&divider(5000), 5000, 101);
}

#[test]
fn lockstep_a_million_random_clocks_of_the_longest_tick() {
    million_random_clocks(&divider(131_071), 131_071, 101);
}

#[test]
fn lockstep_a_million_random_clocks_of_97_per_tick() {
    million_random_clocks(&divider(97), 97, 101);
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&divider(5000));
}

#[test]
fn lockstep_catches_a_quotient_that_is_clamped_a_bit_too_late() {
    caught(&divider(5000), "FITS_PHASE = 7'd65", "FITS_PHASE = 7'd64", 200_000);
}
