//! The drive command's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_testbench::drive_command::DriveCommandBlock;
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

#[test]
fn lockstep_catches_outputs_that_stay_on_beyond_ready() {
    caught(
        &block(),
        "(axis_state == READY_STATE) & direct_enable",
        "direct_enable",
        100_000,
    );
}

#[test]
fn lockstep_catches_a_limit_that_is_an_lsb_too_wide() {
    caught(&block(), "odd = 17'd1", "odd = 17'd0", 300_000);
}

#[test]
fn lockstep_catches_a_duty_that_is_cut() {
    caught(
        &block(),
        "saturates = controller_bits[17] ^ controller_bits[16]",
        "saturates = 1'd0",
        100_000,
    );
}

#[test]
fn lockstep_catches_limit_switches_that_are_swapped() {
    caught(&block(), "if (backward) begin", "if (!backward) begin", 100_000);
}

#[test]
fn lockstep_catches_a_manual_duty_that_the_supervisor_inherits() {
    caught(&block(), " | (next_active ^ active)", "", 300_000);
}

#[test]
fn lockstep_catches_a_mask_that_ends_with_the_pwm() {
    caught(&block(), "masked <= next_test | tested", "masked <= next_test", 100_000);
}

#[test]
fn lockstep_catches_a_drive_that_a_self_test_switches_on() {
    caught(
        &block(),
        "drive_enable_q <= (axis_drive_enable | next_active) & !next_test",
        "drive_enable_q <= axis_drive_enable | next_active",
        100_000,
    );
}
