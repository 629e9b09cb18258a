// axis: the supervisor reaches only its transition table, and its outputs obey its state.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. ALLOWED(from, to) is written by
// the runner from `posicast_blocks::axis::TRANSITIONS`: there is one table.
//
//   known_state          only the six states occur
//   in_table             a state follows another only as the table says
//   reset_is_off         OFF after a reset
//   same_outputs         drive and PWM are enabled together
//   off_in_off_and_ready outputs off in OFF and READY
//   on_while_moving      outputs on in HOLD, RUN and QUICK_STOP
//   brake_*              released only with outputs on, never in FAULT, always while moving
//   run_is_healthy       no cause stands in RUN for more than a clock
//   plays_in_run         segments play in RUN and nowhere else
//   follows_while_off    the command follows the position exactly while the outputs are off
//   shaper_restarts      the shaper is held at the position while they are off
//   causes_held          causes stay until clear_faults
//
// axis_table proves that the row is the right one for its conditions. axis_causes, axis_monitors and axis_lines are about causes,
// axis_brake about times.
module axis_properties (
    `PORTS
);
    reg        past_reset = 1'b1;
    reg [2:0]  past_state = `OFF;
    reg [16:0] past_causes = 16'd0;
    // Causes are cleared in the eighth, ninth or tenth clock after clear_faults.
    reg [11:0] cleared = 12'd0;
    always @(posedge clk) begin
        past_reset <= rst;
        past_state <= state;
        past_causes <= causes;
        cleared <= {cleared[10:0], clear_faults};
    end

    wire moves = state == `RUN | state == `QUICK_STOP;
    always @(*) begin
        known_state: assert (state <= `FAULT);
        in_table: assert (past_reset | state == past_state | `ALLOWED(past_state, state));
        reset_is_off: assert (!past_reset | state == `OFF);
        same_outputs: assert (drive_enable == pwm_enable);
        off_in_off_and_ready: assert (!(state == `OFF | state == `READY) | !drive_enable);
        on_while_moving: assert (!(moves | state == `HOLD) | drive_enable);
        brake_only_with_outputs: assert (!brake_release | drive_enable);
        brake_never_in_fault: assert (!brake_release | state != `FAULT);
        brake_open_while_moving: assert (!moves | brake_release);
        run_is_healthy: assert (state != `RUN | causes == 16'd0 | past_causes == 16'd0);
        plays_in_run: assert (segments_enable == (state == `RUN));
        follows_while_off: assert (segments_preset != drive_enable);
        shaper_restarts: assert (drive_enable | shaper_start);
        causes_held: assert (past_reset | (|cleared) | (past_causes & ~causes) == 16'd0);
    end

    always @(*) begin
        reach_ready: cover (state == `READY);
        reach_hold: cover (state == `HOLD);
        reach_run: cover (state == `RUN);
        reach_quick_stop: cover (state == `QUICK_STOP);
        reach_fault: cover (state == `FAULT);
        reach_fault_from_run: cover (state == `FAULT & past_state == `RUN);
    end
endmodule
