// axis, its transitions: in every state the row is taken whose conditions hold, the first of several; without one it stays.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. NEXT(from) is written by the
// runner from `posicast_blocks::axis::TRANSITIONS`, row by row in its order, with the conditions by their names in the model:
// if_tick and so on, which are stated here. All of them are pins but these: that causes stand, which axis_causes proves, and that
// the time of brake or shaper is over, which axis_brake proves.
//
//   exact_state          the state is the one that the table says, for the state and the conditions of the clock before
//   known_state          only the six states occur
//   start_waits          a start is kept up to the next tick, and forgotten at a stop
//   exact_can_start      can_start: with a start and a tick the table would have led to RUN in the clock before
//   starts_as_shown      RUN begins at a tick only, with a start since the tick before, after a clock that could
//   refused_start        refused: at a tick a start was there, and RUN did not begin; each start begins RUN or is refused
//   exact_pulses         enabled, started, stopping, halted, disabled, faulted: one clock, each at its transition and no other
//   quick_stop_*         segments_quick_stop at every way into QUICK_STOP and until they stop; never outside of QUICK_STOP
//   restart_in_hold      segments_restart in the clock after one in HOLD with stopped segments, and no other
//   plays_in_run         segments play in RUN and nowhere else
//   exact_shaper_start   held while the outputs are off, and from then on until the first sample
//   integral_restarts    the integral is cleared as the shaper is held
module axis_table_properties (
    `PORTS,
    (* peek = "u_states.cut" *) input wire if_cut,
    (* peek = "u_states.fault" *) input wire if_fault,
    (* peek = "u_states.any_cause" *) input wire if_cause,
    (* peek = "u_states.timer_elapsed" *) input wire if_elapsed,
    (* peek = "u_states.opening" *) input wire opening,
    (* peek = "u_states.closing" *) input wire closing,
    (* peek = "u_states.start_waits" *) input wire start_waits,
    (* peek = "u_cause_word.had_fault_q" *) input wire had_fault,
    (* peek = "primed" *) input wire [3:0] primed,
    (* peek = "clear_left" *) input wire [3:0] clear_left,
    (* peek = "u_states.cleared" *) input wire forgotten,
    (* peek = "clear_due" *) input wire clear_due
);
    // Lines are used from the fifth clock after a reset on.
    reg [3:0] awake = 4'd0;
    // clear_faults of the eight clocks before, the last one in bit 0.
    reg [7:0] cleared = 8'd0;
    // A start since the last tick, and no stop since.
    reg       waits = 1'b0;
    // The axis has been in HOLD since READY, so the brake may still be opening.
    reg       since_ready = 1'b0;
    wire      wants_start = (start | waits) & !stop;
    wire      just_on = state == `HOLD & (enabled | since_ready);
    always @(posedge clk) begin
        awake <= rst ? 4'd0 : {awake[2:0], 1'b1};
        cleared <= rst ? 8'd0 : {cleared[6:0], clear_faults};
        waits <= !rst & wants_start & !tick;
        since_ready <= !rst & just_on;
    end

    // The conditions, by the names of the model.
    wire if_drive_ready = awake[3] & level_drive_ready;
    wire if_enable = enable;
    wire if_tick = tick;
    wire if_group_stop = group_stop & !wants_group_stop;
    wire if_stop = stop;
    wire if_closing = drive_enable & !brake_release;
    wire brake_is_open = !if_closing & (!just_on | if_elapsed);
    wire able = state == `HOLD & brake_is_open & segments_state == `SEGMENTS_HOLD;
    wire if_start = wants_start & able;
    wire if_done = segments_state == `SEGMENTS_HOLD & segments_empty;
    wire if_stopped = segments_state == `SEGMENTS_STOPPED;
    wire forgets = cleared[7] & ~|cleared[6:0] & state != `QUICK_STOP & !(state == `FAULT & drive_enable)
        & !(|(causes & ~`HARMLESS) & state != `OFF & state != `FAULT);
    wire if_cleared = past_forgets & !drive_enable & !if_cause;

    reg       past_reset = 1'b1;
    reg       past_tick = 1'b0;
    reg       past_forgets = 1'b0;
    reg       past_wants = 1'b0;
    reg       past_able = 1'b0;
    reg       past_quick = 1'b0;
    reg       past_stopped = 1'b0;
    reg       past_start = 1'b0;
    reg       past_valid = 1'b0;
    reg [2:0] past_state = `OFF;
    reg [2:0] expected = `OFF;
    always @(posedge clk) begin
        past_reset <= rst;
        past_tick <= tick & !rst;
        past_forgets <= forgets & !rst;
        past_wants <= wants_start & !rst;
        past_able <= able & enable & !if_group_stop & !if_cause & !rst;
        past_quick <= segments_state != 2'd2 & segments_state != `SEGMENTS_STOPPED & !rst;
        past_stopped <= segments_state == `SEGMENTS_STOPPED & !rst;
        past_start <= shaper_start;
        past_valid <= segments_valid;
        past_state <= rst ? `OFF : state;
        expected <= rst ? `OFF : `NEXT(state);
    end

    always @(*) begin
        exact_state: assert (state == expected);
        known_state: assert (state <= `FAULT);
        exact_can_start: assert (can_start == past_able);
        starts_as_shown: assert (!started | (past_tick & past_wants & can_start));
        refused_start: assert (refused == (past_tick & past_wants & !started));
        exact_pulses: assert ({enabled, started, stopping, halted, disabled, faulted} == {
            past_state == `READY & state == `HOLD, past_state == `HOLD & state == `RUN,
            past_state != `QUICK_STOP & state == `QUICK_STOP,
            (past_state == `RUN | past_state == `QUICK_STOP) & state == `HOLD,
            past_state == `HOLD & state == `OFF, past_state != `FAULT & state == `FAULT});
        quick_stop_slows: assert (segments_quick_stop == (state == `QUICK_STOP & past_quick));
        restart_in_hold: assert (segments_restart == (past_state == `HOLD & past_stopped));
        plays_in_run: assert (segments_enable == (state == `RUN));
        exact_shaper_start: assert (shaper_start == (!drive_enable | (past_start & !past_valid)));
        integral_restarts: assert (clear_integral == shaper_start);
    end

    // Invariants of the registers, for the induction.
    wire [3:0] left = cleared[0] ? 4'd8 : cleared[1] ? 4'd7 : cleared[2] ? 4'd6 : cleared[3] ? 4'd5 :
        cleared[4] ? 4'd4 : cleared[5] ? 4'd3 : cleared[6] ? 4'd2 : cleared[7] ? 4'd1 : 4'd0;
    always @(*) begin
        lines_wait: assert (primed == awake);
        forgotten_known: assert (forgotten == past_forgets);
        clear_counts: assert (clear_left == left & clear_due == (cleared[7] & ~|cleared[6:0]));
        on_by_state: assert (state == `FAULT | drive_enable == (state == `HOLD | state == `RUN | state == `QUICK_STOP));
        brake_by_state: assert (!if_closing | state == `HOLD | state == `FAULT);
        fault_stands: assert (had_fault == |(causes & ~`HARMLESS));
        cut_is_fault: assert (!if_cut | if_fault);
        fault_is_cause: assert (!if_fault | if_cause);
        start_is_kept: assert (start_waits == waits);
        opening_since_ready: assert (opening == just_on);
        closing_against_brake: assert (closing == if_closing);
    end

    // Every row of the table.
    always @(*) begin
        reach_off_to_ready: cover (past_state == `OFF & state == `READY);
        reach_ready_to_off: cover (past_state == `READY & state == `OFF & !past_reset);
        reach_ready_to_fault: cover (past_state == `READY & state == `FAULT);
        reach_ready_to_hold: cover (enabled);
        reach_hold_to_off: cover (disabled);
        reach_hold_to_run: cover (started);
        reach_hold_to_stop: cover (past_state == `HOLD & stopping);
        reach_hold_to_fault: cover (past_state == `HOLD & faulted);
        reach_run_to_hold: cover (past_state == `RUN & halted);
        reach_run_to_stop: cover (past_state == `RUN & stopping);
        reach_run_to_fault: cover (past_state == `RUN & faulted);
        reach_stop_to_hold: cover (past_state == `QUICK_STOP & halted);
        reach_stop_to_fault: cover (past_state == `QUICK_STOP & faulted);
        reach_fault_to_off: cover (past_state == `FAULT & state == `OFF & !past_reset);
        reach_refused: cover (refused);
    end
endmodule
