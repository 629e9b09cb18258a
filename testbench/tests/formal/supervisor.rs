//! Proofs of the supervisor of an axis, its command to the drive, and the group.

use crate::formal::fails;

#[test]
fn formal_a_brake_that_opens_with_the_outputs_off_is_found() {
    fails("axis", "= next_on & !next_closing", "= next_on", "brake_never_in_fault");
}

#[test]
fn formal_a_row_of_less_priority_that_is_taken_is_found() {
    fails(
        "axis_table",
        "hold_to_fault = in_hold & fault & (cut | closing)",
        "hold_to_fault = (in_hold & fault) & closing",
        "exact_state",
    );
}

#[test]
fn formal_a_cause_that_is_cleared_while_it_is_active_is_found() {
    fails(
        "axis_causes",
        "| watched;",
        "| (forget ? 16'd0 : watched);",
        "exact_causes",
    );
}

#[test]
fn formal_an_axis_that_is_homed_with_a_lost_encoder_is_found() {
    fails(
        "axis_causes",
        "homed_q <= is_homed & ",
        "homed_q <= is_homed | ",
        "homed_until_doubtful",
    );
}

#[test]
fn formal_soft_limits_that_wait_for_nothing_are_found() {
    fails(
        "axis_monitors",
        "(plus_limited_nonzero | minus_limited_nonzero) & !waits",
        "(plus_limited_nonzero | minus_limited_nonzero) & waits",
        "",
    );
}

#[test]
fn formal_a_range_that_a_rotary_axis_leaves_is_found() {
    fails("axis_causes", "far & !modulo", "far", "any_cause_at_once");
}

#[test]
fn formal_a_motion_from_elsewhere_is_found() {
    fails(
        "axis_monitors",
        "motion <= captured - still_since",
        "motion <= still_since - captured",
        "motions",
    );
}

#[test]
fn formal_a_watch_that_does_not_follow_a_motion_against_the_command_is_found() {
    fails(
        "axis_monitors",
        "over & (!stands | moves)",
        "over & !stands",
        "since_when",
    );
}

#[test]
fn formal_a_brake_with_a_tick_too_little_is_found() {
    fails("axis_brake", "at_zero = !sum[16]", "at_zero = left <= 16'd1", "exact_");
}

#[test]
fn formal_a_limit_that_trips_where_it_is_reached_is_found() {
    fails(
        "axis_monitors",
        "if (!compares) begin\n            larger_q_next = 1'd0",
        "if (!compares) begin\n            larger_q_next = 1'd1",
        "sizes",
    );
}

#[test]
fn formal_an_emergency_stop_that_only_stops_the_other_axes_is_found() {
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
        "masked <= next_test | tested",
        "masked <= next_test",
        "mask_",
    );
}

#[test]
fn formal_an_emergency_stop_of_another_axis_on_no_wire_is_found() {
    let wired = ".group_emergency_stop   (group_emergency_stop)";
    fails("stage_axis", wired, ".group_emergency_stop   (1'd0)", "group_stop_");
}

#[test]
fn formal_steps_without_the_supervisors_enable_are_found() {
    let wired = ".enable        (steps_enable)";
    fails("stage_steps", wired, ".enable        (1'd1)", "group_stop_steps");
}

#[test]
fn formal_a_trip_of_the_steps_on_no_wire_is_found() {
    let wired = ".pwm_tripped            (steps_tripped)";
    fails("stage_steps", wired, ".pwm_tripped            (1'd0)", "trip_is_off");
}

#[test]
fn formal_an_axis_that_starts_alone_is_found() {
    fails(
        "group",
        "start_q_0 <= start & !blocked",
        "start_q_0_next = start",
        "all_or_none",
    );
}
