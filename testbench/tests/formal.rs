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
    proven("axis", 0);
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
fn formal_shaper_small() {
    proven("shaper_small", 0);
}

#[test]
fn formal_channel_sums() {
    proven("channel_sums", 0);
    proven("channel_sums", 1);
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
fn formal_a_result_that_is_cut_instead_of_rounded_is_found() {
    fails("shaper_small", "HALF = 26'sd8", "HALF = 26'sd0", "total");
}

#[test]
fn formal_a_sample_that_is_an_older_one_is_found() {
    fails("shaper_small", "delay >= age", "delay > age", "stage_sample");
}

#[test]
fn formal_an_increment_that_goes_through_both_tables_is_found() {
    fails("shaper_motion", "(old_tap == below)", "(old_tap & below)", "made_");
}

#[test]
fn formal_a_handover_that_ends_a_sample_early_is_found() {
    fails(
        "shaper_motion",
        "next_since > reach",
        "next_since >= reach",
        "handover_",
    );
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
        "addend = wide_product;",
        "addend = finish ? NO_PRODUCT : wide_product;",
        "sum_adds",
    );
}
