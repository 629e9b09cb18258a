//! Proofs of encoder, time base, PWM, segments, scale, trace, test signals and the bridge of the host link.

use crate::formal::{fails, is_no_longer_proven};

#[test]
fn formal_a_request_whose_crc_is_wrong_is_found() {
    is_no_longer_proven("uart_bridge", "request_q <= whole", "request_q <= delimiter & begun");
}

#[test]
fn formal_a_byte_that_goes_on_in_the_next_selection_is_found() {
    fails(
        "spi_bridge",
        "place_next = FIRST_PLACE",
        "place_next = place",
        "known_lines",
    );
}

#[test]
fn formal_a_request_that_is_executed_before_all_of_it_is_checked_is_found() {
    fails(
        "uart_sequencer",
        "looks_next = 1'd1",
        "looks_next = 1'd0",
        "known_all_seen",
    );
}

#[test]
fn formal_a_repeated_request_that_is_executed_again_is_found() {
    fails(
        "uart_sequencer",
        "(|sequence_number) & (sequence_number == last_sequence)",
        "1'b0",
        "known_again",
    );
}

#[test]
fn formal_a_bank_that_changes_while_it_counts_is_found() {
    fails("error_table", "if (off) begin", "if (1'b1) begin", "taken_at_0");
}

#[test]
fn formal_an_entry_that_is_too_steep_is_found() {
    fails(
        "error_table",
        "step <= MOST_STEP",
        "step <= MOST_STEP + 20'sd1",
        "neighbours",
    );
}

#[test]
fn formal_an_entry_of_a_bank_in_use_is_found() {
    fails("error_table", "(loaded & !off)", "(1'b0)", "");
}

#[test]
fn formal_a_neighbour_behind_the_table_is_found() {
    is_no_longer_proven("error_lookup", "index < LAST", "index <= LAST");
}

#[test]
fn formal_an_average_that_is_rounded_down_is_found() {
    is_no_longer_proven("error_lookup", "rounded = average + half", "rounded = average");
}

#[test]
fn formal_a_position_that_is_left_a_count_early_is_found() {
    is_no_longer_proven(
        "compare",
        "fell & has_below & (&below_bits)",
        "fell & has_below & !(|below_bits)",
    );
}

#[test]
fn formal_entries_of_a_list_that_are_too_near_are_found() {
    is_no_longer_proven("compare", "LEAST = 33'sd4", "LEAST = 33'sd3");
}

#[test]
fn formal_half_a_dead_time_is_found() {
    fails("pwm", "lasts = dead_time;", "lasts = dead_time >> 1;", "dead_time_");
}

#[test]
fn formal_an_illegal_transition_without_a_flag_is_found() {
    fails(
        "pulse_counter",
        "assign illegal = both & ready",
        "assign illegal = both & ready & swap",
        "illegal_flags",
    );
}

#[test]
fn formal_a_word_behind_the_last_one_that_is_shown_is_found() {
    fails("trace", "read_address} < words", "read_address} <= words", "shown_");
}

#[test]
fn formal_a_start_of_the_other_source_is_found() {
    fails(
        "sample_select",
        "start_q_next = pin_start",
        "start_q_next = pin_start | host_start",
        "exact",
    );
}

#[test]
fn formal_a_control_a_clock_late_is_found() {
    fails("schedule", "LAST = 17'd0", "LAST = 17'd1", "exactly");
}

#[test]
fn formal_a_division_that_starts_with_its_tick_is_found() {
    fails(
        "time_base",
        "divide_q <= tick_q;",
        "divide_q <= tick_q_next;",
        "divide_follows",
    );
}

#[test]
fn formal_a_share_that_begins_with_the_second_channel_is_found() {
    fails(
        "divider_share",
        "FIRST_CHANNEL = 4'd0",
        "FIRST_CHANNEL = 4'd1",
        "next_follows",
    );
}

#[test]
fn formal_a_fifo_that_writes_over_its_oldest_entry_is_found() {
    fails(
        "segments",
        "(({2'd0, slot} << 2)",
        "(({2'd0, head} << 2)",
        "no_overwrite",
    );
}

#[test]
fn formal_a_fifo_that_writes_over_the_entry_that_plays_is_found() {
    fails(
        "segments",
        "slot = (head + behind) + 6'd1",
        "slot = head + behind",
        "pointers",
    );
}

#[test]
fn formal_a_command_that_goes_on_to_the_end_of_its_word_is_found() {
    is_no_longer_proven(
        "segments_range",
        "leaves = past_reach & moving",
        "leaves = stands & moving",
    );
}

#[test]
fn formal_a_stop_that_slows_down_past_the_end_of_its_word_is_found() {
    is_no_longer_proven("segments_range", "brakes & stands", "brakes & moves");
}

#[test]
fn formal_a_division_by_no_clocks_is_found() {
    fails(
        "divider",
        "divisor_next = elapsed | one_tick",
        "divisor_next = elapsed",
        "known_operands",
    );
}

#[test]
fn formal_lines_that_turn_back_at_once_are_found() {
    fails("encoder_generator", "if (!moved) begin", "begin", "every_other_clock");
}

#[test]
fn formal_a_test_signal_that_is_not_allowed_is_found() {
    fails(
        "excitation",
        "enable & allowed & (|kind)",
        "enable & (|kind)",
        "cut_off",
    );
}

#[test]
fn formal_a_tick_over_the_one_that_is_computed_is_found() {
    fails(
        "linear_scale",
        "takes_positions = tick & !positions_wait",
        "takes_positions = tick",
        "known_ahead",
    );
}

#[test]
fn formal_a_ratio_that_is_cut_instead_of_rounded_is_found() {
    fails(
        "serial_ratio",
        "product_bit & (round_up | !begun)",
        "product_bit & round_up",
        "known_round",
    );
}

#[test]
fn formal_a_direction_that_changes_with_the_end_of_a_pulse_is_found() {
    fails(
        "step_generator",
        "may_turn | (!pulsing & (timer == HOLD))",
        "may_turn | !pulsing",
        "known_held",
    );
}

#[test]
fn formal_a_frame_whose_check_is_not_looked_at_is_found() {
    fails(
        "absolute_encoder",
        "right = whole & !word_wrong",
        "right = whole",
        "known_failed",
    );
}

#[test]
fn formal_a_clock_of_the_encoder_that_is_too_fast_is_found() {
    fails("absolute_encoder", "half_timer == HALF", "half_timer != HALF", "");
}

#[test]
fn formal_a_position_that_goes_on_without_bound_is_found() {
    fails(
        "absolute_encoder",
        "last_miss = missed == TOLERATED",
        "last_miss = 1'b0",
        "",
    );
}

#[test]
fn formal_an_edge_of_a_line_that_was_not_steady_is_found() {
    fails(
        "capture",
        "lasts >= filter_clocks",
        "lasts + 16'd1 >= filter_clocks",
        "edge_is_steady",
    );
}

#[test]
fn formal_an_entry_that_is_written_over_is_found() {
    fails(
        "capture",
        "place = oldest + entries_q[3:0]",
        "place = oldest",
        "chosen_in_order",
    );
}

#[test]
fn formal_a_limit_of_the_input_that_is_one_too_high_is_found() {
    fails(
        "inline_axis",
        "biased > MOST",
        "biased > (MOST + 18'd1)",
        "stops_at_once",
    );
}

#[test]
fn formal_steps_out_that_the_axis_does_not_count_are_found() {
    fails("inline_shaper", "(given)", "(32'd0)", "");
}

#[test]
fn formal_steps_in_that_are_read_from_the_wrong_line_are_found() {
    fails(
        "inline_shaper",
        "rise_a = a & edge_a",
        "rise_a = b & edge_a",
        "counts_in",
    );
}

#[test]
fn formal_shaping_that_changes_in_motion_is_found() {
    fails(
        "inline_group",
        "tick & (all_settled | !run_q)",
        "tick",
        "changes_at_rest",
    );
}

#[test]
fn formal_a_deviation_that_is_passed_on_a_tick_late_is_found() {
    fails("lasting_deviation", "count >= ticks", "count > ticks", "");
}

#[test]
fn formal_a_count_that_goes_on_after_an_excursion_is_found() {
    fails("lasting_deviation", "count_next = 16'd0", "count_next = count", "");
}

#[test]
fn formal_a_probe_of_the_other_polarity_is_found() {
    fails("probe_line", "probe ^ active_low", "probe", "");
}

#[test]
fn formal_a_probe_that_is_filtered_from_its_reset_on_is_found() {
    fails("probe_line", "primed[3] & (|filter_clocks)", "(|filter_clocks)", "");
}

#[test]
fn formal_a_correction_after_which_nothing_counts_anew_is_found() {
    fails("realign", "enabled | correct", "enabled", "aligns_after");
}

#[test]
fn formal_steps_of_a_correction_without_their_sign_are_found() {
    fails("realign", "{16{realign_steps[15]}}", "{16{1'b0}}", "counts_the_hosts");
}
