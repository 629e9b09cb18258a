// axis, its outputs and brake: when they go on and off, and how many ticks lie between.
//
// The properties are proven for all inputs in every clock, including resets. Nothing is assumed, but `in_time`: not_longer holds as
// long as ticks have come at least three clocks apart, as the datasheet asks. The delays may change in any clock: each is the one
// of the clock in which what it belongs to shows at the pins. A cut is a cause that switches off: axis_causes proves which.
//
//   exact_outputs       on at READY to HOLD; off at a cut, at a reset, or at a tick with the brake applied and its time over;
//                       at no other time. PWM and drive together
//   exact_brake         opens with the outputs, and only then; applied at a cut, a reset, QUICK_STOP to FAULT, or in HOLD at a
//                       tick without enable, and at no other time
//   waits_for_brake     outputs go off without a cut or a reset only at a tick that has brake_apply_ticks before it since the
//                       brake was applied: brake_apply_ticks + 1 in all
//   not_longer          and never later: not more than brake_apply_ticks + 1 ticks against the brake
//   run_after_release   in RUN the brake has been released for brake_release_ticks ticks
//   settles_*           HOLD, or FAULT without a cut, after QUICK_STOP only at a tick with stopped segments, and settle_ticks of
//                       such before it since the stop
//   applied_settled     in HOLD the brake is applied only after the time of its release, or settle_ticks ticks since RUN
//   exact_elapsed       the time is over: as many ticks have come since it began as its delay had, a clock ago or earlier
module axis_brake_properties (
    `PORTS,
    (* peek = "u_states.cut" *) input wire cut,
    (* peek = "u_states.fault" *) input wire fault,
    (* peek = "u_states.any_cause" *) input wire any_cause,
    (* peek = "u_states.timer_elapsed" *) input wire elapsed,
    (* peek = "u_states.opening" *) input wire opening,
    (* peek = "u_states.closing" *) input wire closing,
    (* peek = "u_states.ran" *) input wire ran,
    (* peek = "u_states.applies" *) input wire applies,
    (* peek = "u_states.u_timer.left" *) input wire [15:0] left,
    (* peek = "u_states.u_timer.over" *) input wire over,
    (* peek = "u_cause_word.had_fault_q" *) input wire had_fault
);
    wire against = drive_enable & !brake_release;
    wire stopped = segments_state == `SEGMENTS_STOPPED;

    // Values of the previous clock.
    reg       past_reset = 1'b1;
    reg       past_cut = 1'b0;
    reg       past_tick = 1'b0;
    reg       past_enable = 1'b0;
    reg       past_elapsed = 1'b0;
    reg       past_stopped = 1'b0;
    reg       past_on = 1'b0;
    reg       past_released = 1'b0;
    reg [2:0] past_state = `OFF;
    always @(posedge clk) begin
        past_reset <= rst;
        past_cut <= cut;
        past_tick <= tick;
        past_enable <= enable;
        past_elapsed <= elapsed;
        past_stopped <= stopped;
        past_on <= drive_enable & !rst;
        past_released <= brake_release & !rst;
        past_state <= rst ? `OFF : state;
    end
    wire past_against = past_on & !past_released;

    // Events at the pins in this clock; the brake is applied last.
    wire applied = against & past_released;
    wire settling = (past_state == `RUN & !past_reset) | stopping;
    wire begins = enabled | settling | applied;
    // Ticks since then, and the number required; in QUICK_STOP only ticks with stopped segments count.
    reg  [15:0] seen = 16'd0;
    reg  [15:0] needed = 16'd0;
    // All these ticks have come, a clock ago or earlier.
    reg         enough = 1'b0;
    // seen and needed of the previous clock.
    reg  [15:0] past_seen = 16'd0;
    reg  [15:0] past_needed = 16'd0;
    reg         past_begins = 1'b0;
    wire        counts = tick & (state != `QUICK_STOP | stopped);
    always @(posedge clk) begin
        past_seen <= seen;
        past_needed <= needed;
        past_begins <= begins & !rst;
        enough <= !rst & !begins & seen >= needed;
        if (rst) {seen, needed} <= 32'd0;
        else if (begins) begin
            seen <= 16'd0;
            needed <= applied ? brake_apply_ticks : settling ? settle_ticks : brake_release_ticks;
        end else if (counts & seen != 16'hffff) seen <= seen + 16'd1;
    end

    // Ticks since the brake was released, and the number required.
    reg [15:0] open_seen = 16'd0;
    reg [15:0] open_needed = 16'd0;
    wire       opens = brake_release & !past_released;
    always @(posedge clk) begin
        if (rst) {open_seen, open_needed} <= 32'd0;
        else if (opens) {open_seen, open_needed} <= {16'd0, brake_release_ticks};
        else if (tick & open_seen != 16'hffff) open_seen <= open_seen + 16'd1;
    end
    wire is_open = !opens & open_seen >= open_needed;

    // All ticks so far were at least three clocks apart.
    reg in_time = 1'b1;
    reg past_tick_2 = 1'b0;
    always @(posedge clk) begin
        past_tick_2 <= past_tick;
        in_time <= in_time & !(tick & (past_tick | past_tick_2));
    end

    wire timed_out = past_tick & past_elapsed;
    wire went_on = past_state == `READY & state == `HOLD;
    wire went_quiet = past_against & timed_out;
    wire closes = past_state == `HOLD & state == `HOLD & !past_enable & timed_out;
    wire stop_failed = past_state == `QUICK_STOP & state == `FAULT;
    always @(*) begin
        exact_outputs: assert (drive_enable == (!past_reset & !past_cut & (went_on | (past_on & !went_quiet))));
        one_output: assert (pwm_enable == drive_enable);
        exact_brake: assert (brake_release ==
            (drive_enable & (went_on | (past_released & !closes & !stop_failed))));
        waits_for_brake: assert (!past_on | drive_enable | past_cut | past_reset |
            (past_against & past_tick & past_seen >= past_needed));
        not_longer: assert (!in_time | !against | applied | seen <= needed);
        run_after_release: assert (state != `RUN | is_open);
        settles_in_ticks: assert (past_state != `QUICK_STOP | state == `QUICK_STOP | past_cut | past_reset |
            (past_tick & past_stopped & past_seen >= past_needed));
        applied_settled: assert (!applied | past_state != `HOLD | (past_tick & past_seen >= past_needed));
        exact_elapsed: assert (!drive_enable | elapsed == (enough & !begins));
    end

    // Invariants of the registers, for the induction.
    wire        harmful = |(causes & ~`HARMLESS);
    wire [15:0] rest = seen >= needed ? 16'd0 : needed - seen;
    always @(*) begin
        known_state: assert (state <= `FAULT);
        on_by_state: assert (state == `FAULT | drive_enable == (state == `HOLD | state == `RUN | state == `QUICK_STOP));
        closing_against_brake: assert (closing == against);
        brake_by_state: assert (!against | state == `HOLD | state == `FAULT);
        fault_is_applied: assert (state != `FAULT | !brake_release);
        fault_stands: assert (had_fault == harmful);
        cut_is_fault: assert (!cut | fault);
        fault_is_cause: assert (!fault | any_cause);
        pulses: assert (enabled == went_on & stopping == (past_state != `QUICK_STOP & state == `QUICK_STOP));
        past_is_known: assert (past_on | !past_released);
        ran_before: assert (ran == (past_state == `RUN));
        applies_now: assert (!drive_enable | applies == applied);
        tick_before: assert (!(against & begins) | (applied & past_tick));
        tick_before_that: assert (!(past_against & past_begins) | past_tick_2);
        enough_before: assert (enough == (!past_reset & !past_begins & past_seen >= past_needed));
        same_without_tick: assert (past_tick | past_begins | past_reset | (seen == past_seen & needed == past_needed));
        enough_stays: assert (!enough | seen >= needed);
        ticks_left: assert (!drive_enable | begins | left == rest);
        cleared_for_it: assert (!drive_enable | !begins | left == 16'd0);
        over_when_left: assert (!drive_enable | begins | over == enough);
        opening_counts: assert (!opening | (state == `HOLD & !settling & enabled == opens &
            (against | opens | (seen == open_seen & needed == open_needed))));
        open_unless: assert (!brake_release | opening | is_open | (state == `QUICK_STOP & harmful));
    end

    always @(*) begin
        reach_open: cover (state == `RUN & open_needed == 16'd2);
        reach_quiet: cover (past_on & !drive_enable & past_state == `HOLD & past_needed == 16'd2);
        reach_quiet_in_fault: cover (past_on & !drive_enable & past_state == `FAULT & past_needed == 16'd2);
        reach_settled: cover (past_state == `QUICK_STOP & state == `HOLD & past_needed == 16'd2);
        reach_cut: cover (past_on & past_cut & past_state == `RUN);
    end
endmodule
