// drive_command: PWM, drive and brake get only what the supervisor or direct mode requests.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed, except that in duty_steps
// direct_limit has not changed since direct mode began (a stage ties it). "Direct mode" is the port direct_active; a request shows
// in the next clock.
//
//   exact_direct         direct mode: from a kick on with READY and direct_enable, in which all stay; fewer than the kick's
//                        direct_hold_ticks ticks since the last one; self_test unchanged. It begins with a kick only
//   never_longer         so many ticks have not come since the last kick
//   exact_expired        direct_expired: one clock, where the time alone ended it
//   exact_enables        PWM, drive and brake: the supervisor's, or on by direct mode; drive and brake off in a self-test;
//                        PWM off for a clock after it; nothing else switches them on
//   mask_*               pins masked in all of a self-test, in no other direct mode, and in the clock after it, not longer;
//                        never off in the clock after one with the PWM on; a change of self_test ends direct mode
//   zero_when_off        duty 0 while the PWM is off, after a reset, and in the first clock of direct mode and after it
//   exact_controller     without direct mode the controller's duty, saturated to 17 bits, when it is valid, and held in between
//   exact_manual         in direct mode direct_duty at ticks, limited to direct_limit in size, and held in between
//   manual_limit         never above the direct_limit of the last tick, in either direction
//   no_way_to_switch     never towards a limit switch that the clock before showed
//   turns_through_zero   no duty has the other sign than the one before it
//   duty_steps           no step in direct mode larger than direct_limit
//   exact_feed           feed with each tick in direct mode, else with each controller_valid, and at no other time
//   exact_faults         both bits are their inputs of the clock before; no reset touches the drive's
//   counts_*             the self-test's results: at a valley, while masked, the clocks that a gate was on since the valley
//                        before it, or since the mask came; up to 65,535; unchanged in all other clocks
module drive_command_properties (
    `PORTS,
    (* peek = "counted" *) input wire [15:0] ticks_counted,
    (* peek = "hold_ticks" *) input wire [15:0] hold_kept,
    (* peek = "backward" *) input wire backward,
    (* peek = "high_sum" *) input wire [15:0] high_sum,
    (* peek = "low_sum" *) input wire [15:0] low_sum
);
    // Values of the previous clock.
    reg               past_reset = 1'b1;
    reg               past_tick = 1'b0, past_valid = 1'b0, past_kick = 1'b0, past_permits = 1'b0, past_in_time = 1'b0;
    reg               past_pwm_wanted = 1'b0, past_drive_wanted = 1'b0, past_brake_wanted = 1'b0;
    reg               past_plus_ok = 1'b0, past_minus_ok = 1'b0, past_test = 1'b0, past_hold = 1'b0;
    reg               past_active = 1'b0, past_mask = 1'b0, past_pwm = 1'b0, past_valley = 1'b0, past_turns = 1'b0;
    reg        [1:0]  past_faults = 2'b01;
    reg signed [16:0] past_duty = 17'sd0, past_wanted = 17'sd0;
    reg signed [17:0] past_controller = 18'sd0;
    reg        [15:0] past_limit = 16'd0, past_high = 16'd0, past_low = 16'd0, past_result_high = 16'd0, past_result_low = 16'd0;

    // Ticks since the last kick, and its direct_hold_ticks.
    reg        [15:0] ticks = 16'd0, hold = 16'd0;
    // Requested sign and limit of the last tick.
    reg               negative = 1'b0;
    reg        [15:0] limit_then = 16'd0;
    // direct_limit has been constant since direct mode began.
    reg               steady = 1'b1;
    // Clocks in which the gates were on since the last valley, or since the mask.
    reg        [15:0] high = 16'd0, low = 16'd0;
    wire              ready = axis_state == `READY & direct_enable;
    wire              permits = ready & !(direct_active & self_test != mask_pins);
    wire       [16:0] ticks_more = {1'b0, ticks} + 17'd1;
    wire              in_time = !tick | ticks_more < {1'b0, hold};

    always @(posedge clk) begin
        past_reset <= rst;
        past_faults <= {drive_fault_n, axis_pwm_trip_n | rst};
        {past_tick, past_valid, past_kick, past_permits, past_in_time} <= {tick, controller_valid, direct_kick, permits, in_time};
        {past_pwm_wanted, past_drive_wanted, past_brake_wanted} <= {axis_pwm_enable, axis_drive_enable, axis_brake_release};
        {past_plus_ok, past_minus_ok, past_test, past_valley} <= {limit_plus_ok, limit_minus_ok, self_test, valley};
        past_hold <= direct_hold_ticks != 16'd0;
        {past_active, past_mask, past_pwm} <= {direct_active, mask_pins, pwm_enable};
        past_turns <= (direct_duty < 17'sd0) != negative;
        {past_duty, past_wanted, past_controller, past_limit} <= {duty, direct_duty, controller_duty, direct_limit};
        {past_high, past_low, past_result_high, past_result_low} <= {high, low, self_test_high, self_test_low};
        if (rst) begin
            {ticks, hold, negative, limit_then} <= 49'd0;
            {high, low} <= 32'd0;
        end else begin
            if (direct_kick) {ticks, hold} <= {16'd0, direct_hold_ticks};
            else if (tick) ticks <= ticks + 16'd1;
            if (tick) {negative, limit_then} <= {direct_duty < 17'sd0, direct_limit};
            if (!mask_pins) {high, low} <= 32'd0;
            else begin
                high <= (valley ? 16'd0 : high) + {15'd0, gates[0] & (valley | high != 16'hffff)};
                low <= (valley ? 16'd0 : low) + {15'd0, gates[1] & (valley | low != 16'hffff)};
            end
        end
        steady <= !direct_active | (steady & direct_limit == past_limit);
    end

    // These numbers are wide enough for the largest of both signs.
    wire signed [17:0] limit = $signed({2'b0, past_limit}), limit_of_tick = $signed({2'b0, limit_then});
    wire signed [17:0] wanted = past_wanted, shown = duty, before = past_duty;
    wire signed [17:0] manual = wanted > limit ? limit : wanted < -limit ? -limit : wanted;
    wire signed [17:0] of_controller = past_controller > 18'sd65535 ? 18'sd65535 :
        past_controller < -18'sd65536 ? -18'sd65536 : past_controller;
    wire signed [17:0] step = shown - before;
    wire blocked = negative ? !past_minus_ok : !past_plus_ok;
    wire was_test = past_active & past_mask;
    wire same = !past_reset & direct_active == past_active;

    always @(*) begin
        exact_direct: assert (direct_active == (!past_reset & past_permits & (past_kick ? past_hold : past_active & past_in_time)));
        never_longer: assert (!direct_active | ticks < hold);
        exact_expired: assert (direct_expired ==
            (!past_reset & past_active & past_permits & !past_kick & !past_in_time));
        exact_enables: assert (past_reset ? {pwm_enable, drive_enable, brake_release} == 3'd0 :
            pwm_enable == ((past_pwm_wanted & !was_test) | direct_active) &
            drive_enable == (direct_active ? !mask_pins : past_drive_wanted) &
            brake_release == (direct_active ? !mask_pins : past_brake_wanted));
        mask_of_test: assert (mask_pins == (!past_reset & ((direct_active & past_test) | was_test)));
        mask_all_or_none: assert (!direct_active | !past_active | past_reset | mask_pins == past_mask);
        mask_until_off: assert (past_reset | mask_pins | !past_mask | !past_pwm);
        zero_when_off: assert (pwm_enable | duty == 17'sd0);
        zero_at_change: assert (same | duty == 17'sd0);
        exact_controller: assert (!same | direct_active | !past_pwm_wanted | shown == (past_valid ? of_controller : before));
        exact_manual: assert (!same | !direct_active |
            shown == (blocked | (past_tick & past_turns) ? 18'sd0 : past_tick ? manual : before));
        manual_limit: assert (!direct_active | (shown <= limit_of_tick & shown >= -limit_of_tick));
        no_way_to_switch: assert (!direct_active | ((past_plus_ok | shown <= 18'sd0) & (past_minus_ok | shown >= 18'sd0)));
        turns_through_zero: assert (!direct_active | !((shown < 18'sd0 & before > 18'sd0) | (shown > 18'sd0 & before < 18'sd0)));
        duty_steps: assert (!same | !direct_active | !steady | (step <= limit & step >= -limit));
        exact_feed: assert (feed == (!past_reset & (past_active ? past_tick : past_valid)));
        exact_faults: assert (filtered_fault_n == past_faults);
        counts_high: assert (past_reset ? self_test_high == 16'd0 :
            self_test_high == (past_valley & past_mask ? past_high : past_result_high));
        counts_low: assert (past_reset ? self_test_low == 16'd0 :
            self_test_low == (past_valley & past_mask ? past_low : past_result_low));
    end

    // Invariants of the registers, for the induction.
    always @(*) begin
        time_since: assert (ticks_counted == ticks + 16'd1 & hold_kept == hold);
        sign_wanted: assert (backward == negative);
        sign_of_duty: assert (!direct_active | (negative ? shown <= 18'sd0 : shown >= 18'sd0));
        gates_counted: assert (high_sum == high & low_sum == low);
        limit_kept: assert (!direct_active | !steady | !past_active | limit_then == past_limit | shown == 18'sd0);
    end

    always @(*) begin
        reach_manual: cover (direct_active & duty == -17'sd5 & past_wanted == -17'sd9);
        reach_expired: cover (direct_expired & hold == 16'd3);
        reach_test: cover (mask_pins & pwm_enable & self_test_high == 16'd2 & self_test_low == 16'd1);
        reach_saturated: cover (duty == -17'sd65536);
        reach_blocked: cover (same & direct_active & past_duty != 17'sd0 & duty == 17'sd0 & !past_tick);
        reach_after_test: cover (mask_pins & !direct_active & past_pwm_wanted);
    end
endmodule
