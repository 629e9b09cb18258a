// axis, its causes: which are latched, when they are cleared, what they do, and when.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. The properties are about pins;
// only what the monitors have found comes from inside, and axis_monitors proves that. The bits of causes, and which of them always
// switch off or are harmless, are macros from `posicast_blocks::axis::Cause`.
//
//   exact_causes         each cause has its own line, flag or monitor: it is set in the clock in which that is active, by nothing
//                        else, and stays until it is cleared; several at once are all kept
//   forgets_*            cleared eight clocks after the last clear_faults, not in QUICK_STOP, not in FAULT with outputs on, and
//                        elsewhere not before what follows; set wins
//   known_lines          own emergency stop: the filtered line is low, four clocks after a reset or later
//   trips_pwm            pwm_trip_n is low in the clock after an emergency stop, of this axis or of another
//   clears_sources       clear_sources is clear_faults, a clock later
//   known_range          range: the count at the last tick of an axis that is not modulo is in the last 64th of its word, or shaped command or e
//                        were cut to theirs, as of the clock before; active with the outputs on, and where they are asked for
//   any_*, fault_*, cut_*  what the states are told, in the clock in which it becomes active of emergency stop, PWM trip, drive
//                        and range, and a clock later, when it stands, of all others: any cause; any but the group stop; one that
//                        switches off, a new one by this clock's off_causes, one that stands by those of the clock before
//   off_at_once          outputs off and brake applied in the clock after one that switches off, in every state
//   stop_or_fault        a clock after a cause but the group stop stands, the state is QUICK_STOP, FAULT or OFF
//   tells_others         wants_group_stop is FAULT, or QUICK_STOP with a cause but the group stop
//   homed_until_doubtful homed is what was last written, but is low after a reset and while encoder lost or encoder error
//                        stand, and stays so until it is written again
//   not_by_itself        the axis that wants the stop does not get the group stop of it
//
// Not proven here: what the monitors find (axis_monitors), the filters of the lines (single_line).
module axis_causes_properties (
    `PORTS,
    (* peek = "u_monitors.causes" *) input wire [16:0] found,
    (* peek = "u_monitors.found" *) input wire [16:0] kept,
    (* peek = "out_of_range" *) input wire range_left,
    (* peek = "primed" *) input wire [3:0] primed,
    (* peek = "clear_left" *) input wire [3:0] clear_left,
    (* peek = "clear_due" *) input wire clear_due,
    (* peek = "u_cause_word.had_fault_q" *) input wire had_fault,
    (* peek = "u_cause_word.had_cut_q" *) input wire had_cut,
    (* peek = "u_states.forget" *) input wire states_forget,
    (* peek = "u_states.any_cause" *) input wire states_any_cause,
    (* peek = "u_states.fault" *) input wire states_fault,
    (* peek = "u_states.cut" *) input wire states_cut
);
    // Lines are used from the fifth clock after a reset on.
    reg [3:0] awake = 4'd0;
    // In the previous clock, the count, the shaped command or e was beyond its word, or nearly so.
    reg       left_range = 1'b0;
    // clear_faults of the eight clocks before, the last one in bit 0.
    reg [7:0] cleared = 8'd0;
    always @(posedge clk) begin
        left_range <= !rst & ((!modulo & (captured_position >= `STAND_COUNTS | captured_position < -`STAND_COUNTS))
            | shaper_saturated | saturated_high[0] | saturated_low[0]);
        awake <= rst ? 4'd0 : {awake[2:0], 1'b1};
        cleared <= rst ? 8'd0 : {cleared[6:0], clear_faults};
    end
    wire due = cleared[7] & ~|cleared[6:0];
    wire forgets = due & state != `QUICK_STOP & !(state == `FAULT & drive_enable)
        & !(|(causes & ~`HARMLESS) & state != `OFF & state != `FAULT);

    wire        own_emergency = awake[3] & !level_emergency_stop_n;
    wire        emergency = own_emergency | group_emergency_stop;
    wire        encoder_error = encoder_illegal | encoder_disagreement | scale_illegal | scale_disagreement;
    wire        late = segments_tick_missed | velocity_missed | shaper_overrun | controller_overrun;
    wire [16:0] at_once = (emergency ? `EMERGENCY_STOP : 16'd0)
        | (pwm_tripped ? `PWM_TRIPPED : 16'd0)
        | (drive_enable & !level_drive_ready ? `DRIVE_LOST : 16'd0)
        | (left_range & (drive_enable | enable) ? `RANGE : 17'd0);
    wire [16:0] active = found | at_once
        | (encoder_error ? `ENCODER_ERROR : 16'd0)
        | (segments_underrun | segments_overflow | segments_out_of_range ? `SEGMENTS : 16'd0)
        | (drive_enable & group_stop & !wants_group_stop ? `GROUP_STOP : 16'd0)
        | (late ? `SCHEDULE : 16'd0);
    wire [16:0] standing = forgets ? 16'd0 : causes;
    wire [16:0] now = standing | active;

    wire [16:0] off = ({1'b0, off_causes} | `ALWAYS_OFF) & ~`HARMLESS;
    reg  [15:0] past_off_causes = 16'd0;
    wire [16:0] past_off = ({1'b0, past_off_causes} | `ALWAYS_OFF) & ~`HARMLESS;
    wire        cut = |(at_once & off) | |(causes & past_off);
    wire [16:0] seen = causes | at_once;

    reg         past_reset = 1'b1;
    reg         past_cut = 1'b0;
    reg         past_emergency = 1'b0;
    reg         past_clear = 1'b0;
    reg         past_wants = 1'b0;
    reg  [2:0]  past_state = `OFF;
    reg  [16:0] past_causes = 16'd0;
    reg         just_noted = 1'b0;
    reg  [16:0] expected = 16'd0;
    reg         known = 1'b0;
    always @(posedge clk) begin
        past_reset <= rst;
        past_off_causes <= off_causes;
        past_cut <= cut & !rst;
        past_emergency <= emergency & !rst;
        past_clear <= clear_faults & !rst;
        past_wants <= wants_group_stop;
        past_state <= state;
        past_causes <= causes;
        just_noted <= !rst & (seen & ~`HARMLESS) == 16'd0;
        expected <= rst ? 16'd0 : now;
        known <= !rst & (write_homed ? homed_value : known) & (causes & (`ENCODER_LOST | `ENCODER_ERROR)) == 17'd0;
    end

    wire [16:0] harmful = causes & ~`HARMLESS;
    always @(*) begin
        exact_causes: assert (causes == expected);
        forgets_when_due: assert (clear_due == due);
        forgets_nothing_else: assert (states_forget == forgets);
        known_lines: assert (emergency_stop == own_emergency);
        trips_pwm: assert (pwm_trip_n != past_emergency);
        clears_sources: assert (clear_sources == past_clear);
        any_cause_at_once: assert (states_any_cause == (|seen | (drive_enable & group_stop)));
        fault_at_once: assert (states_fault == |(seen & ~`HARMLESS));
        cut_at_once: assert (states_cut == cut);
        off_at_once: assert (!past_cut | (!drive_enable & !pwm_enable & !brake_release));
        cut_is_a_fault: assert (!past_cut | state == `FAULT | state == `OFF);
        stop_or_fault: assert (harmful == 16'd0 | just_noted | state == `QUICK_STOP | state == `FAULT | state == `OFF);
        tells_others: assert (wants_group_stop == (state == `FAULT | (state == `QUICK_STOP & harmful != 16'd0)));
        homed_until_doubtful: assert (homed == known);
        not_by_itself: assert (past_reset | !past_wants | (causes & ~past_causes & `GROUP_STOP) == 16'd0);
    end

    // Invariants of the registers, for the induction.
    wire [16:0] of_pins = `EMERGENCY_STOP | `PWM_TRIPPED | `DRIVE_LOST | `ENCODER_ERROR | `SEGMENTS | `GROUP_STOP | `SCHEDULE;
    wire [3:0] left = cleared[0] ? 4'd8 : cleared[1] ? 4'd7 : cleared[2] ? 4'd6 : cleared[3] ? 4'd5 :
        cleared[4] ? 4'd4 : cleared[5] ? 4'd3 : cleared[6] ? 4'd2 : cleared[7] ? 4'd1 : 4'd0;
    always @(*) begin
        known_state: assert (state <= `FAULT);
        found_at_ticks: assert ((kept & of_pins) == 16'd0);
        known_range: assert (range_left == left_range);
        lines_wait: assert (primed == awake);
        clear_counts: assert (clear_left == left);
        fault_stands: assert (had_fault == |harmful);
        cut_stands: assert (had_cut == |(causes & past_off));
    end

    always @(*) begin
        reach_new_cut: cover (past_cut & past_causes == 16'd0 & past_state == `RUN);
        reach_cut_of_standing: cover (past_cut & past_causes == causes & past_state == `QUICK_STOP);
        reach_forgotten: cover (past_causes != 16'd0 & causes == 16'd0 & !past_reset);
        reach_set_wins: cover (past_causes != 16'd0 & causes != 16'd0 & states_forget);
        reach_range: cover (causes == `RANGE & past_state == `READY);
        reach_group_stop: cover (causes == `GROUP_STOP);
        reach_several: cover (causes == 17'h1ffff);
    end
endmodule
