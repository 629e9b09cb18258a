//! The controller's Verilog against its bit-exact model, every output in every clock.

mod support;

use posicast_model::rtl::sliding_mode::{Inputs, Motion};
use posicast_testbench::blocks::{self, SlidingModeBlock, Sources};
use support::{assert_match, icarus_agrees, million_random_clocks};

fn sliding_mode() -> SlidingModeBlock {
    SlidingModeBlock::new("", "alone")
}

/// Insists that a break is found within 300,000 clocks.
#[track_caller]
fn caught(from: &str, to: &str) {
    support::caught(&sliding_mode(), from, to, 300_000);
}

#[test]
fn lockstep_a_million_random_clocks() {
    for seed in 1..=2 {
        million_random_clocks(&sliding_mode(), seed, 1);
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    icarus_agrees(&sliding_mode());
}

#[test]
fn lockstep_a_command_that_is_cut_until_its_count_stops() {
    let block = sliding_mode();
    let mut clock = 0;
    let mut stimuli = |seen: &[u64], inputs: &mut [u64]| {
        clock += 1;
        // Every gain is 1/2 and the limit 1: every reference velocity is too much.
        let setting = if seen[0] == 11 { 1 } else { 0x1_0000 };
        let now = Inputs {
            rst: clock < 3,
            start: seen[6] == 0,
            motion: Motion {
                velocity_reference: 1 << 20,
                ..Motion::default()
            },
            setting,
            ..Inputs::default()
        };
        inputs.copy_from_slice(&now.to_raw());
    };
    let mut device = Sources::write(&block).unwrap().verilated(&block, 1).unwrap();
    let run = blocks::compare_with(&block, &mut device, &mut stimuli, 65_545 * 210, 1, &mut |_| {}).unwrap();
    assert_match(&run.report, "cut for ever");
    let ticks = run.coverage.into_iter().find(|(name, _)| name == "limited_ticks");
    assert_eq!(ticks.unwrap().1, 65_535);
}

#[test]
fn lockstep_catches_upper_ends_that_are_an_lsb_too_low() {
    caught("LARGEST_ERROR = 24'sd8388607", "LARGEST_ERROR = 24'sd8388606");
    caught("LARGEST_RATE = 32'sd2147483647", "LARGEST_RATE = 32'sd2147483646");
    caught("LARGEST_WORD = 32'd2147483647", "LARGEST_WORD = 32'd2147483646");
    caught("LARGEST_FRACTION = 32'd33554431", "LARGEST_FRACTION = 32'd33554430");
    caught("LARGEST_DUTY = 32'd131071", "LARGEST_DUTY = 32'd131070");
}

#[test]
fn lockstep_catches_lower_ends_that_are_an_lsb_too_high() {
    caught("LEAST_ERROR = 24'sh800000", "LEAST_ERROR = 24'sh800001");
    caught("LEAST_RATE = 32'sh80000000", "LEAST_RATE = 32'sh80000001");
    caught("$signed(~largest)", "$signed(~largest + 32'd1)");
    caught("as_fraction | as_duty", "as_fraction");
}

#[test]
fn lockstep_catches_an_integral_that_passes_its_ends() {
    for (from, to) in [
        (" LARGEST = 32'sd2147483647", " LARGEST = 32'sd2147483646"),
        (" LEAST = 32'sh80000000", " LEAST = 32'sh80000001"),
    ] {
        support::caught(&sliding_mode(), from, to, 1_000_000);
    }
}

#[test]
fn lockstep_catches_an_integral_that_winds_up() {
    caught("takes = update & !limited_high", "takes = update");
    caught("takes = update & !limited_low", "takes = update");
    caught("opposes ^ setting[17]", "opposes");
}

#[test]
fn lockstep_catches_flags_that_a_clear_swallows() {
    caught(
        "flags_q_next = kept | found",
        "flags_q_next = clear_flags ? 7'd0 : kept | found",
    );
}

#[test]
fn lockstep_catches_products_that_are_cut_instead_of_rounded() {
    caught("HALF = 53'd1", "HALF = 53'd0");
}

#[test]
fn lockstep_catches_a_limit_that_is_passed_by_an_lsb() {
    caught("({2'd0, limit_q} << 1) -", "({2'd0, limit_q} << 1) + 33'd2 -");
    caught("| borrow)", ")");
}

#[test]
fn lockstep_catches_a_rotary_axis_that_does_not_wrap() {
    caught("difference[31] & modulo", "difference[39] & modulo");
}
