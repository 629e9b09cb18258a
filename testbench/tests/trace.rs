//! The trace memory's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_blocks::trace::TraceConfig;
use posicast_testbench::trace::TraceBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn trace(samples: u64) -> TraceBlock {
    TraceBlock::new(TraceConfig::new(samples).unwrap(), "")
}

#[test]
fn lockstep_a_million_random_clocks_of_256_samples() {
    for seed in 1..=2 {
        million_random_clocks(&trace(256), seed, 10);
    }
}

#[test]
fn lockstep_a_million_random_clocks_of_2048_samples() {
    million_random_clocks(&trace(2048), 3, 1);
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&trace(256));
}

#[test]
fn lockstep_catches_a_level_that_is_reached_and_does_not_count() {
    caught(
        &trace(256),
        "wide_value - wide_level",
        "wide_value + ~wide_level",
        300_000,
    );
}

#[test]
fn lockstep_catches_a_first_row_that_triggers() {
    caught(&trace(256), "has_row_next = 1'd0", "has_row_next = 1'd1", 300_000);
}

#[test]
fn lockstep_catches_an_event_that_is_not_kept() {
    caught(&trace(256), "happens | (kept_event & !compare)", "happens", 300_000);
}

#[test]
fn lockstep_catches_words_that_were_not_written() {
    caught(&trace(256), "} < words", "} <= words", 300_000);
}

#[test]
fn lockstep_catches_rows_that_are_not_dropped_while_waiting() {
    caught(
        &trace(256),
        "oldest_next = oldest + 8'd1",
        "oldest_next = oldest",
        300_000,
    );
}

#[test]
fn lockstep_catches_a_halt_that_cuts_a_row() {
    caught(
        &trace(256),
        "if (active & ready)",
        "if (active & (ready | halting))",
        300_000,
    );
}
