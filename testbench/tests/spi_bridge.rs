//! The bridge's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_testbench::spi_bridge::SpiBridgeBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn bridge() -> SpiBridgeBlock {
    SpiBridgeBlock::new("", "alone")
}

#[test]
fn lockstep_a_million_random_clocks() {
    for seed in 1..=2 {
        million_random_clocks(&bridge(), seed, 1);
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&bridge());
}

#[test]
fn lockstep_catches_a_frame_that_goes_on_after_a_byte_that_was_cut_off() {
    caught(
        &bridge(),
        "bad_q <= !selected_level & !first",
        "bad_q <= 1'b0",
        1_000_000,
    );
}

#[test]
fn lockstep_catches_an_edge_that_counts_although_the_selection_only_begins() {
    caught(
        &bridge(),
        "is_selected = selected_level & selected_before",
        "is_selected = selected_level",
        1_000_000,
    );
}

#[test]
fn lockstep_catches_a_byte_of_the_reply_that_is_lost_with_its_selection() {
    caught(&bridge(), "busy = full", "busy = full & selected_level", 1_000_000);
}

#[test]
fn lockstep_catches_a_line_to_the_host_that_is_a_bit_late() {
    caught(&bridge(), "spi_miso = given[7]", "spi_miso = given[6]", 300_000);
}

#[test]
fn lockstep_catches_a_time_out_that_never_comes() {
    caught(&bridge(), "| bad | (expired & begun)", "| bad", 1_000_000);
}
