//! Proofs of the shapers.

use crate::formal::fails;

#[test]
fn formal_a_product_that_is_subtracted_is_found() {
    fails(
        "shaper",
        "accumulator + wide_product",
        "accumulator - wide_product",
        "sum_adds",
    );
}

#[test]
fn formal_a_pass_that_ends_a_tap_early_is_found() {
    fails(
        "shaper",
        "tap_number = {1'd0, tap} + 7'd1",
        "tap_number = {1'd0, tap} + 7'd2",
        "pass_",
    );
}

#[test]
fn formal_a_sample_of_the_wrong_side_is_found() {
    fails("shaper", "= head - delay", "= head + delay", "address");
}

#[test]
fn formal_a_swap_to_a_bank_that_does_not_sum_to_one_is_found() {
    fails(
        "shaper",
        "(swap_bank == 2'd1) & (sum_1 == UNITY)",
        "(swap_bank == 2'd1)",
        "table_to_come",
    );
}

#[test]
fn formal_a_result_clamped_to_the_wrong_end_is_found() {
    fails("shaper", "y_q_next = Y_MAX", "y_q_next = Y_MIN", "result");
}

#[test]
fn formal_halves_that_are_dropped_are_found() {
    fails(
        "cascade",
        "assign rounded = sum + HALF",
        "assign rounded = sum",
        "result",
    );
}

#[test]
fn formal_a_sample_from_before_the_start_is_found() {
    fails("cascade", "delays_data >= age", "delays_data > age", "before_known");
}

#[test]
fn formal_a_result_that_is_cut_instead_of_rounded_is_found() {
    fails("shaper_small", "HALF = 26'sd8", "HALF = 26'sd0", "total");
}

#[test]
fn formal_a_sample_that_is_an_older_one_is_found() {
    fails("shaper_small", "delay > age", "delay >= age", "stage_coefficient");
}

#[test]
fn formal_a_tap_that_is_read_back_in_a_pass_is_found() {
    fails("shaper_small", "& !busy", "", "read_");
}

#[test]
fn formal_a_tap_of_the_other_bank_is_found() {
    fails(
        "shaper_small",
        "read_address = write_address;",
        "read_address = write_address ^ 3'd4;",
        "read_word",
    );
}

#[test]
fn formal_an_increment_that_goes_through_both_tables_is_found() {
    fails("shaper_motion", "(old_tap == below)", "(old_tap & below)", "made_");
}

#[test]
fn formal_a_handover_that_ends_a_sample_early_is_found() {
    fails("shaper_motion", "since_q == reach", "next_since == reach", "handover_");
}

#[test]
fn formal_a_swap_that_does_not_wait_is_found() {
    fails("shaper_motion", "(still >= reach)", "(still >= 6'd1)", "swap_takes");
}

#[test]
fn formal_a_channel_that_gets_the_sample_of_another_is_found() {
    fails("shaper_motion", "if (lasts[4])", "if (lasts[5])", "pass_sample");
}

#[test]
fn formal_a_position_that_clamps_where_it_should_wrap_is_found() {
    fails("channel_sums", "& !wraps", "", "result");
}

#[test]
fn formal_a_product_lost_between_channels_is_found() {
    fails(
        "channel_sums",
        "if (busy_q) begin",
        "if (busy_q & (channel != FIRST_CHANNEL)) begin",
        "sum_adds",
    );
}
