//! The proofs that are quick, and each property file seen to fail on a block that was broken on purpose.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use std::time::Duration;

use posicast_testbench::formal::{Outcome, Task, Verdict, named, run};

const LIMIT: Duration = Duration::from_secs(120);

fn tried(task: &Task) -> Outcome {
    let folder = tempfile::tempdir().unwrap();
    let outcome = run(task, folder.path(), LIMIT).unwrap();
    if let Verdict::Counterexample { waveform, .. } = &outcome.verdict {
        assert!(std::fs::metadata(waveform).unwrap().len() > 1000, "no waveform");
    }
    outcome
}

#[track_caller]
fn proven(name: &str, size: usize) {
    let outcome = tried(&named(name).unwrap()[size]);
    assert!(outcome.is_good(), "{outcome:?}");
    assert!(outcome.assertions > 1 && !outcome.covers.is_empty(), "{outcome:?}");
}

/// Replaces the first `from` in the block's Verilog by `to`, and insists on a counterexample to a property that begins so.
#[track_caller]
fn fails(name: &str, from: &str, to: &str, expected: &str) {
    let mut task = named(name).unwrap().swap_remove(0);
    let found = task.modules.iter_mut().find(|module| module.text.contains(from));
    let module = found.unwrap_or_else(|| panic!("the Verilog no longer has `{from}`: adapt the test"));
    module.text = module.text.replacen(from, to, 1);
    match tried(&task).verdict {
        Verdict::Counterexample { property, .. } => assert!(property.starts_with(expected), "`{to}`: {property}"),
        other => panic!("`{to}` is not found: {other:?}"),
    }
}

#[test]
fn formal_pulse_counter() {
    proven("pulse_counter", 0);
}

#[test]
fn formal_axis() {
    for subject in [
        "axis",
        "axis_table",
        "axis_causes",
        "axis_brake",
        "axis_monitors",
        "axis_lines",
    ] {
        proven(subject, 0);
    }
}

#[test]
fn formal_drive_command() {
    proven("drive_command", 0);
}

#[test]
fn formal_axes_of_a_stage() {
    for axis in [0, 1] {
        proven("stage_axis", axis);
    }
}

#[test]
fn formal_trace() {
    proven("trace", 0);
}

#[test]
fn formal_sample_select() {
    proven("sample_select", 1);
}

#[test]
fn formal_registers() {
    proven("registers", 0);
}

#[test]
fn formal_group() {
    proven("group", 0);
}

#[test]
fn formal_schedule() {
    proven("schedule", 1);
}

#[test]
fn formal_time_base() {
    proven("time_base", 0);
}

#[test]
fn formal_divider_share() {
    proven("divider_share", 0);
}

#[test]
fn formal_segments() {
    proven("segments", 0);
}

#[test]
fn formal_sliding_mode_with_any_products() {
    proven("sliding_mode", 0);
}

#[test]
fn formal_arithmetic_of_the_controller() {
    for part in ["scaled_product", "accumulator", "limiter"] {
        proven(part, 0);
    }
}

#[test]
fn formal_shaper() {
    proven("shaper", 0);
}

#[test]
fn formal_half_a_dead_time_is_found() {
    fails("pwm", "pause = dead_time;", "pause = dead_time >> 1;", "known_pause");
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
fn formal_a_brake_that_opens_with_the_outputs_off_is_found() {
    fails("axis", "= next_on & !next_closing", "= next_on", "brake_never_in_fault");
}

#[test]
fn formal_a_row_of_less_priority_that_is_taken_is_found() {
    fails(
        "axis_table",
        "if (cut | closing) begin",
        "if (closing) begin",
        "exact_state",
    );
}

#[test]
fn formal_a_cause_that_is_cleared_while_it_is_active_is_found() {
    fails(
        "axis_causes",
        "now = kept | active",
        "now = forget ? kept : kept | active",
        "exact_causes",
    );
}

#[test]
fn formal_a_brake_with_a_tick_too_little_is_found() {
    fails(
        "axis_brake",
        "at_zero = left == NO_TICKS",
        "at_zero = left <= ONE_TICK",
        "exact_",
    );
}

#[test]
fn formal_a_limit_that_trips_where_it_is_reached_is_found() {
    fails(
        "axis_monitors",
        "(error_size > following_error_limit)",
        "(error_size >= following_error_limit)",
        "following_error",
    );
}

#[test]
fn formal_an_emergency_stop_that_is_only_told_to_others_is_found() {
    fails(
        "axis_lines",
        "emergency = own_emergency | group_emergency_stop",
        "emergency = group_emergency_stop",
        "trips_in_time",
    );
}

#[test]
fn formal_a_mask_that_goes_with_the_self_test_is_found() {
    fails(
        "drive_command",
        "masked_next = next_test | tested",
        "masked_next = next_test",
        "mask_",
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
fn formal_an_emergency_stop_of_another_axis_on_no_wire_is_found() {
    let wired = ".group_emergency_stop   (group_emergency_stop)";
    fails("stage_axis", wired, ".group_emergency_stop   (1'd0)", "group_stop_");
}

#[test]
fn formal_a_byte_that_nobody_wrote_is_found() {
    fails(
        "registers",
        "(phase & ~mask[15:0])",
        "(phase & ~mask[31:16])",
        "holds_what_was_written",
    );
}

#[test]
fn formal_an_axis_that_starts_alone_is_found() {
    fails(
        "group",
        "start_q_0_next = (start & !blocked)",
        "start_q_0_next = start",
        "all_or_none",
    );
}

#[test]
fn formal_a_control_a_clock_late_is_found() {
    fails("schedule", "LAST = 17'd1", "LAST = 17'd2", "exactly");
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
        "memory_write_address = ({2'd0, tail} << 2)",
        "memory_write_address = ({2'd0, head} << 2)",
        "no_overwrite",
    );
}

#[test]
fn formal_a_sum_that_goes_on_from_the_last_one_is_found() {
    let boundary = "accumulator_begin_sum = ((((sequencer_step == BOUNDARY)";
    fails(
        "sliding_mode",
        boundary,
        &boundary.replace("BOUNDARY", "COULOMB"),
        "begins_anew",
    );
}

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
fn formal_a_shift_that_loses_the_sign_is_found() {
    fails(
        "scaled_product",
        "by_one = $signed(shifter[50:1])",
        "by_one = $signed({1'b0, shifter[49:1]})",
        "shifted",
    );
}

#[test]
fn formal_a_pass_that_ends_a_tap_early_is_found() {
    fails("shaper", "ONE_MORE = 7'd1", "ONE_MORE = 7'd2", "pass_");
}

#[test]
fn formal_a_sample_of_the_wrong_side_is_found() {
    fails("shaper", "= head - delay", "= head + delay", "address");
}

#[test]
fn formal_a_swap_to_a_bank_that_does_not_sum_to_one_is_found() {
    fails(
        "shaper",
        "(swap_bank == BANK_1) & (sum_1 == UNITY)",
        "(swap_bank == BANK_1)",
        "table_to_come",
    );
}

#[test]
fn formal_a_product_that_is_cut_instead_of_rounded_is_found() {
    fails("accumulator", "HALF = 53'd1", "HALF = 53'd0", "exact_sum");
}

#[test]
fn formal_a_limit_that_is_passed_by_an_lsb_is_found() {
    fails("limiter", "(kept ^ sign) + carry", "kept ^ sign", "command_is_cut");
}

#[test]
fn formal_a_result_clamped_to_the_wrong_end_is_found() {
    fails("shaper", "y_q_next = Y_MAX", "y_q_next = Y_MIN", "result");
}

#[test]
fn formal_commit() {
    proven("commit", 0);
    proven("commit", 1);
}

#[test]
fn formal_setting_banks() {
    proven("setting_banks", 0);
}

#[test]
fn formal_divider() {
    proven("divider", 0);
}

#[test]
fn formal_encoder_generator() {
    proven("encoder_generator", 0);
}

#[test]
fn formal_a_write_after_its_commit_is_found() {
    fails(
        "commit",
        "if (write_law && !waits) begin",
        "if (write_law) begin",
        "all_at_once",
    );
}

#[test]
fn formal_a_setting_that_changes_in_use_is_found() {
    fails("setting_banks", " & (setting_bank != bank)", "", "active_stays");
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
fn formal_cascade() {
    proven("cascade", 0);
    proven("cascade", 1);
}

#[test]
fn formal_excitation() {
    proven("excitation", 0);
}

#[test]
fn formal_linear_scale() {
    proven("linear_scale", 0);
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
fn formal_a_test_signal_that_is_not_allowed_is_found() {
    fails(
        "excitation",
        "(enable & allowed) & (|kind)",
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
fn formal_serial_ratio() {
    proven("serial_ratio", 2);
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
