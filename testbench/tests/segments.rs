//! The command FIFO's Verilog against its bit-exact model, every output in every clock.

mod support;

use posicast_testbench::blocks::SegmentsBlock;
use support::{caught, icarus_agrees, million_random_clocks};

fn segments() -> SegmentsBlock {
    SegmentsBlock::new("", "alone")
}

#[test]
fn lockstep_a_million_random_clocks() {
    for seed in 1..=2 {
        million_random_clocks(&segments(), seed, 50);
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&segments());
}

#[test]
fn lockstep_catches_a_stop_that_is_too_strong() {
    caught(&segments(), "reverse > asked", "reverse < asked", 300_000);
}

#[test]
fn lockstep_catches_a_velocity_that_is_not_sign_extended() {
    caught(
        &segments(),
        "velocity_step = $signed({{16{exact_velocity[47]}}",
        "velocity_step = $signed({{16{exact_velocity[46]}}",
        300_000,
    );
}

#[test]
fn lockstep_catches_an_entry_that_is_taken_without_its_words() {
    caught(
        &segments(),
        "written[0] & written[1]",
        "written[0] | written[1]",
        300_000,
    );
}

#[test]
fn lockstep_catches_an_underrun_that_holds_its_speed() {
    caught(
        &segments(),
        "state_q_next = STOP_STATE",
        "state_q_next = HOLD_STATE",
        300_000,
    );
}

#[test]
fn lockstep_catches_an_acceleration_that_wraps() {
    caught(
        &segments(),
        "next_acceleration_bits[40] == next_acceleration_bits[39]",
        "next_acceleration_bits[40] == next_acceleration_bits[40]",
        300_000,
    );
}
