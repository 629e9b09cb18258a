//! The controller's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_blocks::sliding_mode::{CONTROL_CLOCKS, Inputs};
use posicast_testbench::blocks;
use posicast_testbench::blocks::Sources;
use posicast_testbench::sliding_mode::SlidingModeBlock;
use support::{assert_match, icarus_agrees, million_random_clocks};

fn sliding_mode() -> SlidingModeBlock {
    SlidingModeBlock::new("", "alone")
}

/// Requires that an error is found within 750,000 clocks.
#[track_caller]
fn caught(from: &str, to: &str) {
    support::caught(&sliding_mode(), from, to, 750_000);
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

/// Returns the count of limited ticks after this many ticks, each of which limits.
fn limited_ticks(ticks: u64) -> u64 {
    let block = sliding_mode();
    let mut clock = 0;
    let mut stimuli = |seen: &[u64], inputs: &mut [u64]| {
        clock += 1;
        // Every gain is 1/2 and the limit 1: every reference velocity exceeds it.
        let setting = if seen[0] == 11 { 1 } else { 0x1_0000 };
        let now = Inputs {
            rst: clock < 3,
            start: seen[6] == 0,
            velocity_reference: 1 << 20,
            setting,
            ..Inputs::default()
        };
        inputs.copy_from_slice(&now.to_raw());
    };
    let mut device = Sources::write(&block).unwrap().verilated(&block, 1).unwrap();
    let run = blocks::compare_with(
        &block,
        &mut device,
        &mut stimuli,
        ticks * (u64::from(CONTROL_CLOCKS) + 1),
        1,
        &mut |_| {},
    )
    .unwrap();
    assert_match(&run.report, "cut for ever");
    let counted = run.coverage.into_iter().find(|(name, _)| name == "limited_ticks");
    counted.unwrap().1
}

#[test]
fn lockstep_a_command_that_is_cut_is_counted() {
    assert_eq!(limited_ticks(1000), 1000);
}

#[test]
fn long_lockstep_a_command_that_is_cut_until_its_count_stops() {
    assert_eq!(limited_ticks(65_545), 65_535);
}

#[test]
fn lockstep_catches_upper_ends_that_are_an_lsb_too_low() {
    caught("LARGEST = 24'sd8388607", "LARGEST = 24'sd8388606");
    caught("LARGEST_WORD = 32'd2147483647", "LARGEST_WORD = 32'd2147483646");
    caught("LARGEST_FRACTION = 32'd33554431", "LARGEST_FRACTION = 32'd33554430");
    caught("LARGEST_DUTY = 32'd131071", "LARGEST_DUTY = 32'd131070");
}

#[test]
fn lockstep_catches_lower_ends_that_are_an_lsb_too_high() {
    caught("LEAST = 24'sh800000", "LEAST = 24'sh800001");
    caught("$signed(~largest)", "$signed(~largest + 32'd1)");
    caught("as_fraction | as_duty", "as_fraction");
}

#[test]
fn lockstep_catches_an_integral_of_twice_the_error() {
    support::caught(&sliding_mode(), "EIGHT = 5'd8", "EIGHT = 5'd7", 1_000_000);
}

#[test]
fn lockstep_catches_a_clear_that_a_sum_under_way_undoes() {
    let (from, to) = ("cleared_next = 1'd1", "cleared_next = cleared");
    support::caught(&sliding_mode(), from, to, 3_000_000);
}

#[test]
fn lockstep_catches_an_integral_that_winds_up() {
    caught("enable & !cleared & !limited_high", "enable & !cleared");
    caught("enable & !cleared & !limited_low", "enable & !cleared");
    caught("opposes ^ setting[17]", "opposes");
}

#[test]
fn lockstep_catches_flags_that_a_clear_swallows() {
    caught(
        "flags_q <= kept | by_error | by_sum",
        "flags_q <= clear_flags ? 7'd0 : kept | by_error | by_sum",
    );
}

#[test]
fn lockstep_catches_products_that_are_cut_instead_of_rounded() {
    caught("HALF = 53'd1", "HALF = 53'd0");
}

#[test]
fn lockstep_catches_a_limit_that_is_passed_by_an_lsb() {
    caught("({2'd0, limit} << 1)", "(({2'd0, limit} << 1) + 33'd2)");
    caught("| borrow)", ")");
}

#[test]
fn lockstep_catches_a_rotary_axis_that_does_not_wrap() {
    caught("difference[31] & modulo", "difference[39] & modulo");
}
