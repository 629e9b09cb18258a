// axis, its lines: what the filter lets through, and how soon the outputs are off after the emergency stop's line went low.
//
// The properties are proven for all inputs in every clock, including resets. A line is as its synchroniser sees it: pin by pin, in
// clocks. Stated of emergency stop and drive ready; the other three lines are of the same module.
//
//   passes_*       a filtered level changes exactly after the line has differed from it for so many clocks in a row, and one, as
//                  filter_clocks had when it last did not differ: shorter pulses leave nothing; the synchroniser's two clocks later.
//                  With filter_clocks 0 it is the line, at once
//   stops_in_time  outputs off and brake applied once the emergency stop's line has been low for
//                  filter_clocks + 4 clocks, and as long as it stays low, whatever else happens; filter_clocks unchanged in them
//   trips_in_time  pwm_trip_n is low in the same time, unless lines are not known yet after a reset
//   drive_lost_*   in the same time, with outputs on, a drive that is no longer ready is a cause; and if off_causes says so in
//                  that clock, the outputs are off
module axis_lines_properties (
    `PORTS,
    (* peek = "primed" *) input wire [3:0] primed,
    (* peek = "u_emergency_stop_line.u_synchroniser.synchroniser_first" *) input wire stop_first,
    (* peek = "u_emergency_stop_line.u_synchroniser.synchroniser_second" *) input wire stop_second,
    (* peek = "u_emergency_stop_line.u_filter.left" *) input wire [5:0] stop_left,
    (* peek = "u_drive_line.u_synchroniser.synchroniser_first" *) input wire drive_first,
    (* peek = "u_drive_line.u_synchroniser.synchroniser_second" *) input wire drive_second,
    (* peek = "u_drive_line.u_filter.left" *) input wire [5:0] drive_left
);
    // Levels follow their lines directly until the fifth clock after a reset.
    reg [3:0] awake = 4'd0;
    always @(posedge clk) awake <= rst ? 4'd0 : {awake[2:0], 1'b1};

    // Per line, bit 0 emergency stop, bit 1 drive: the line two clocks ago, and how long it has differed from its level.
    wire [1:0] pins = {drive_ready, emergency_stop_n};
    wire [1:0] levels = {level_drive_ready, level_emergency_stop_n};
    reg  [1:0] once = 2'd0, twice = 2'd0, past_levels = 2'd0;
    reg  [6:0] stop_differs = 7'd0, drive_differs = 7'd0;
    reg  [5:0] stop_filter = 6'd0, drive_filter = 6'd0;
    reg        past_awake = 1'b0, past_reset = 1'b1;
    reg        stop_due = 1'b0, drive_due = 1'b0;
    wire [1:0] differ = twice ^ levels;
    wire       stop_passes = !awake[3] | filter_clocks == 6'd0 | (differ[0] & stop_differs == {1'b0, stop_filter});
    wire       drive_passes = !awake[3] | filter_clocks == 6'd0 | (differ[1] & drive_differs == {1'b0, drive_filter});
    always @(posedge clk) begin
        past_reset <= rst;
        past_awake <= awake[3];
        past_levels <= levels;
        if (rst) begin
            {once, twice} <= 4'd0;
            {stop_differs, drive_differs} <= 14'd0;
            {stop_filter, drive_filter} <= 12'd0;
            {stop_due, drive_due} <= 2'd0;
        end else begin
            {once, twice} <= {pins, once};
            stop_due <= differ[0] & stop_passes;
            drive_due <= differ[1] & drive_passes;
            stop_differs <= differ[0] & !stop_passes ? stop_differs + 7'd1 : 7'd0;
            drive_differs <= differ[1] & !drive_passes ? drive_differs + 7'd1 : 7'd0;
            if (!differ[0] | stop_passes) stop_filter <= filter_clocks;
            if (!differ[1] | drive_passes) drive_filter <= filter_clocks;
        end
    end

    // Clocks for which the line has been low, and whether filter_clocks is still the one of the first of them.
    reg  [6:0] stop_low = 7'd0, drive_low = 7'd0;
    reg  [5:0] stop_clocks = 6'd0, drive_clocks = 6'd0;
    reg        stop_steady = 1'b1, drive_steady = 1'b1;
    always @(posedge clk) begin
        if (rst | emergency_stop_n) begin
            stop_low <= 7'd0;
            stop_steady <= 1'b1;
        end else begin
            if (stop_low != 7'd127) stop_low <= stop_low + 7'd1;
            if (stop_low == 7'd0) stop_clocks <= filter_clocks;
            else if (stop_clocks != filter_clocks) stop_steady <= 1'b0;
        end
        if (rst | drive_ready) begin
            drive_low <= 7'd0;
            drive_steady <= 1'b1;
        end else begin
            if (drive_low != 7'd127) drive_low <= drive_low + 7'd1;
            if (drive_low == 7'd0) drive_clocks <= filter_clocks;
            else if (drive_clocks != filter_clocks) drive_steady <= 1'b0;
        end
    end
    wire stop_is_over = stop_steady & stop_low >= {1'b0, stop_clocks} + 7'd4;
    wire drive_is_lost = drive_steady & drive_low >= {1'b0, drive_clocks} + 7'd3;
    reg  past_lost = 1'b0, past_lost_off = 1'b0;
    always @(posedge clk) begin
        past_lost <= drive_is_lost & drive_enable & !rst;
        past_lost_off <= drive_is_lost & drive_enable & !rst & (off_causes & `DRIVE_LOST) != 16'd0;
    end

    always @(*) begin
        passes_stop: assert (past_reset | (level_emergency_stop_n != past_levels[0]) == stop_due);
        passes_drive: assert (past_reset | (level_drive_ready != past_levels[1]) == drive_due);
        stops_in_time: assert (!stop_is_over | (!drive_enable & !pwm_enable & !brake_release));
        trips_in_time: assert (!stop_is_over | !past_awake | !pwm_trip_n);
        drive_lost_is_cause: assert (!past_lost | (causes & `DRIVE_LOST) != 16'd0);
        drive_lost_is_off: assert (!past_lost_off | !drive_enable);
    end

    // Invariants of the registers, for the induction.
    always @(*) begin
        off_before_lines: assert (awake[3] | (state == `OFF & !drive_enable & !brake_release));
        stop_begins: assert (stop_low != 7'd0 | once[0] | (!twice[0] & !levels[0]));
        stop_comes: assert (stop_low != 7'd1 | (!once[0] & (twice[0] | !levels[0])));
        stop_counts: assert (stop_low < 7'd2 | (once[0] | twice[0]) == 1'b0);
        stop_differs_for: assert (!stop_steady | stop_low < 7'd2 | !levels[0] |
            (stop_filter == stop_clocks & stop_differs == stop_low - 7'd2));
        drive_begins: assert (drive_low != 7'd0 | once[1] | (!twice[1] & !levels[1]));
        drive_comes: assert (drive_low != 7'd1 | (!once[1] & (twice[1] | !levels[1])));
        drive_counts: assert (drive_low < 7'd2 | (once[1] | twice[1]) == 1'b0);
        drive_differs_for: assert (!drive_steady | drive_low < 7'd2 | !levels[1] |
            (drive_filter == drive_clocks & drive_differs == drive_low - 7'd2));
        lines_wait: assert (primed == awake & (awake & (awake + 4'd1)) == 4'd0);
        synchronised: assert ({drive_first, stop_first, drive_second, stop_second} == {once, twice});
        stop_left_over: assert (stop_left == stop_filter - stop_differs[5:0] & stop_differs <= {1'b0, stop_filter});
        drive_left_over: assert (drive_left == drive_filter - drive_differs[5:0] & drive_differs <= {1'b0, drive_filter});
    end

    always @(*) begin
        reach_stop: cover (stop_is_over & stop_low == 7'd9 & past_awake & stop_clocks == 6'd5);
        reach_drive_lost: cover (past_lost & drive_clocks == 6'd4);
        reach_pulse_ignored: cover (level_emergency_stop_n & stop_differs == 7'd3 & stop_filter == 6'd3 & emergency_stop_n & once[0]);
    end
endmodule
