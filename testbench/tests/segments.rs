//! The command FIFO's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_testbench::segments::SegmentsBlock;
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
    caught(
        &segments(),
        "stop_deceleration} << 8",
        "stop_deceleration} << 9",
        300_000,
    );
}

#[test]
fn lockstep_catches_an_addend_that_is_not_sign_extended() {
    caught(
        &segments(),
        "addend_sign        (addend[7])",
        "addend_sign        (addend[6])",
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
fn lockstep_catches_a_batch_that_is_taken_by_parts() {
    caught(&segments(), "stages = entered & more", "stages = 1'd0", 300_000);
}

#[test]
fn lockstep_catches_a_jerk_of_a_cubic_without_its_sign() {
    caught(
        &segments(),
        "invert_q_next = addend_sign",
        "invert_q_next = 1'd0",
        300_000,
    );
}

#[test]
fn lockstep_catches_an_extrapolation_without_an_end() {
    caught(
        &segments(),
        "in_time = integrator_ticks_after < extrapolation",
        "in_time = 1'd1",
        300_000,
    );
}

#[test]
fn lockstep_catches_an_acceleration_that_wraps() {
    caught(
        &segments(),
        "jerk_failed_next = unfit",
        "jerk_failed_next = unfit & points",
        300_000,
    );
}

#[test]
fn lockstep_catches_a_command_that_goes_on_to_the_end_of_its_word() {
    caught(
        &segments(),
        "leaves = past_reach & moving",
        "leaves = stands & moving",
        3_000_000,
    );
}

#[test]
fn lockstep_catches_a_feed_hold_in_motion() {
    caught(&segments(), "& rests_q", "", 300_000);
}

#[test]
fn lockstep_catches_a_feed_hold_that_uses_up_ticks() {
    caught(&segments(), "counts & !held", "counts", 300_000);
}

#[test]
fn lockstep_catches_a_stop_that_slows_down_past_the_end_of_its_word() {
    caught(&segments(), "brakes & stands", "brakes & moves", 300_000);
}
