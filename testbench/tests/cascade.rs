//! The cascade's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_blocks::cascade::CascadeConfig;
use posicast_testbench::cascade::CascadeBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn cascade(word_bits: u32, delays: Vec<u32>) -> CascadeBlock {
    CascadeBlock::new(CascadeConfig::new(word_bits, delays).unwrap(), "")
}

#[test]
fn lockstep_a_million_random_clocks_of_one_stage() {
    let run = million_random_clocks(&cascade(16, vec![1]), 1, 11);
    assert!(run.report.samples > 3_000);
}

#[test]
fn lockstep_a_million_random_clocks_of_5_stages() {
    let run = million_random_clocks(&cascade(32, vec![38, 31, 26, 62, 1]), 2, 11);
    assert!(run.report.samples > 3_000);
}

#[test]
fn lockstep_a_million_random_clocks_of_16_stages() {
    let delays = (1..=16).map(|stage| 7 * stage).collect();
    let run = million_random_clocks(&cascade(24, delays), 3, 11);
    assert!(run.report.samples > 3_000);
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&cascade(32, vec![5, 3, 62]));
}

#[test]
fn lockstep_catches_a_history_that_ages_a_sample_late() {
    caught(&cascade(32, vec![38, 31, 26, 62]), ">= age", "> age", 100_000);
}

#[test]
fn lockstep_catches_rounding_down() {
    caught(
        &cascade(32, vec![38, 31, 26, 62]),
        "HALF = 36'sd8",
        "HALF = 36'sd7",
        100_000,
    );
}
