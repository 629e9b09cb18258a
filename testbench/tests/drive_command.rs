//! The drive command's Verilog against its bit-exact model, every output in every clock.

mod support;

use posicast_testbench::blocks::DriveCommandBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn block() -> DriveCommandBlock {
    DriveCommandBlock::new("", "alone")
}

#[test]
fn lockstep_a_million_random_clocks() {
    for seed in 1..=2 {
        million_random_clocks(&block(), seed, 50);
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&block());
}
