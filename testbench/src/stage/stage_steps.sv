// An axis of a stage whose drive takes steps, as its blocks are wired: drive, brake and step lines at an emergency stop and at a trip
// of the step generator, and the conditions under which a step comes.
//
// The properties are proven for all inputs in every clock, including resets: whatever a host, the other axes and the switches do,
// and whatever the shaped position says. Nothing is assumed. Memories and products are left out. FILTER_CLOCKS is what the stage
// ties. A line that is active low is read inverted.
//
//   stop_*            drive off and brake applied once the emergency stop's line has been low for FILTER_CLOCKS + 4 clocks, and
//                     as long as it stays low; from the clock after that no step begins and no direction changes
//   group_stop_*      the same one clock after the emergency stop of another axis, and from the clock after that
//   trip_is_off       the same a clock after one in which the step generator stands tripped with the drive enabled
//   steps_with_drive  a step begins, or the direction changes, only after a clock with the drive enabled
//   brake_with_drive  the brake is open only with the drive enabled
//   off_is_off        a clock after one in OFF drive and brake are off
//   ready_is_off      there is no direct mode: in READY they are off, too
//
// step_generator.sv proves the times of the lines, and that a pulse that has begun is finished.
module stage_steps_properties (
    `PORTS,
    (* peek = "u_axis.primed" *) input wire [3:0] primed,
    (* peek = "u_axis.u_emergency_stop_line.u_synchroniser.synchroniser_first" *) input wire first,
    (* peek = "u_axis.u_emergency_stop_line.u_synchroniser.synchroniser_second" *) input wire second,
    (* peek = "u_axis.u_emergency_stop_line.u_filter.left" *) input wire [5:0] left,
    (* peek = "u_axis.u_states.on_q" *) input wire axis_on,
    (* peek = "u_axis.u_states.released_q" *) input wire axis_released,
    (* peek = "u_axis.u_states.closing" *) input wire axis_closing,
    (* peek = "u_axis.u_cause_word.had_fault_q" *) input wire had_fault,
    (* peek = "u_axis.u_cause_word.had_cut_q" *) input wire had_cut,
    (* peek = "u_step_generator.u_pulser.pulsing" *) input wire pulsing,
    (* peek = "u_step_generator.u_pulser.up_q" *) input wire up
);
    localparam [1:0] STEP_DIRECTION = 2'd0;
    localparam [1:0] UP_DOWN = 2'd1;

    // Lines are used from the fifth clock after a reset on.
    reg [3:0] awake = 4'd0;
    // Clocks for which the line has been low.
    reg [6:0] low = 7'd0;
    always @(posedge clk) begin
        awake <= rst ? 4'd0 : {awake[2:0], 1'b1};
        low <= rst | emergency_stop_n ? 7'd0 : low == 7'd127 ? low : low + 7'd1;
    end
    localparam [6:0] FILTER = `FILTER_CLOCKS;

    // What the drive reads: a step, or another direction.
    wire on_a = `LINE_A ^ `A_OFF;
    wire on_b = `LINE_B ^ `B_OFF;
    reg  past_a = 1'b0, past_b = 1'b0, past_reset = 1'b1;
    wire begins_a = on_a & !past_a;
    wire begins = `MODE == STEP_DIRECTION ? begins_a | (on_b ^ past_b)
        : `MODE == UP_DOWN ? begins_a | (on_b & !past_b) : (on_a ^ past_a) | (on_b ^ past_b);

    // Values of the previous clocks, the last one in bit 0.
    reg [1:0] group = 2'd0;
    reg       tripped = 1'b0;
    reg       off = 1'b1;
    reg       past_drive = 1'b0;
    always @(posedge clk) begin
        past_reset <= rst;
        past_a <= on_a & !rst;
        past_b <= on_b & !rst;
        group <= {group[0], group_emergency_stop & !rst};
        tripped <= (steps_too_fast | steps_owed_exceeded) & drive_enable & !rst;
        off <= state == `OFF | rst;
        past_drive <= drive_enable & !rst;
    end
    wire moves = begins & !past_reset;

    always @(*) begin
        stop_drive: assert (low < FILTER + 7'd4 | (!drive_enable & !brake_release));
        stop_steps: assert (low < FILTER + 7'd5 | !moves);
        group_stop_drive: assert (!group[0] | (!drive_enable & !brake_release));
        group_stop_steps: assert (!group[1] | !moves);
        trip_is_off: assert (!tripped | (!drive_enable & !brake_release));
        steps_with_drive: assert (!moves | past_drive);
        brake_with_drive: assert (!brake_release | drive_enable);
        off_is_off: assert (!off | (!drive_enable & !brake_release));
        ready_is_off: assert (state != `READY | (!drive_enable & !brake_release));
        reset_is_off: assert (!past_reset | (!on_a & !on_b));
    end

    // Invariants of the registers, for the induction.
    wire axis_is_off = !axis_on & (state == `OFF | state == `FAULT);
    wire harmful = |(causes & ~`HARMLESS);
    wire [1:0] code = {on_b, on_b ^ on_a};
    always @(*) begin
        lines_wait: assert (primed == awake & (awake & (awake + 4'd1)) == 4'd0);
        off_before_lines: assert (awake[3] | (state == `OFF & !axis_on));
        line_begins: assert (low != 7'd0 | first | (!second & !level_emergency_stop_n));
        line_comes: assert (low != 7'd1 | (!first & (second | !level_emergency_stop_n)));
        line_counts: assert (low < 7'd2 | (!first & !second));
        filter_counts: assert (low < 7'd2 | !level_emergency_stop_n | {1'b0, left} == FILTER + 7'd2 - low);
        filter_bound: assert ({1'b0, left} <= FILTER);
        filter_passes: assert (low < FILTER + 7'd3 | !level_emergency_stop_n);
        known_state: assert (state <= `FAULT);
        on_by_state: assert (state == `FAULT | axis_on == (state == `HOLD | state == `RUN | state == `QUICK_STOP));
        closing_against_brake: assert (axis_closing == (axis_on & !axis_released) & (axis_on | !axis_released));
        brake_by_state: assert (!axis_closing | state == `HOLD | state == `FAULT);
        cause_stands: assert (had_fault == harmful & (!had_cut | had_fault));
        stop_in_axis: assert (low < FILTER + 7'd4 | axis_is_off);
        group_stop_in_axis: assert (!group[0] | axis_is_off);
        known_lines: assert (`MODE == STEP_DIRECTION ? (on_a == pulsing & on_b == up)
            : `MODE == UP_DOWN ? (on_a == (pulsing & up) & on_b == (pulsing & !up)) : code == given_steps[1:0]);
    end

    always @(*) begin
        reach_on: cover (axis_on & drive_enable & brake_release);
        reach_off: cover (low == FILTER + 7'd4 & past_drive);
        reach_trip: cover (tripped);
        reach_step: cover (moves);
    end
endmodule
