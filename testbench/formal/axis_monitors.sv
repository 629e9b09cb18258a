// axis, what it watches at ticks: each cause is found two clocks after a tick that shows it, and by nothing else.
//
// Proven for all inputs in every clock, resets included; nothing is assumed. All is said of pins. The values are those of the
// tick; e, deviation, lost encoder and watchdog are compared with their limits a clock later. |x| is as in the datasheet: x, or
// -x - 1 below 0.
//
//   only_at_ticks        causes are found two clocks after a tick with the outputs on, and in no other clock
//   only_monitored       none but those below
//   limit_*              on the switch, and the command goes towards it; or newly on it, and the shaped command does
//   soft_limit_*         the shaped position is past it, newly or with a command that goes on; never with both limits 0
//   following_error, deviation_, saturation_, encoder_lost, watchdog_
//                        exactly when above the limit, or there for as many ticks in a row; never with a limit of 0
//   captured             captured_position is the position of the last tick
//   still_for, unkicked_for  lemma: so many ticks in a row with a command and the same position; so many since the last kick
//
// Left open: that levels are those of the switches (single_line), and where e comes from.
module axis_monitors_properties (
    input wire               clk,
    input wire               rst,
    input wire               tick,
    input wire               kick,
    input wire [31:0]        kick_word,
    input wire signed [31:0] soft_limit_plus,
    input wire signed [31:0] soft_limit_minus,
    input wire [31:0]        following_error_limit,
    input wire [31:0]        deviation_limit,
    input wire [15:0]        saturation_ticks,
    input wire [31:0]        lost_command,
    input wire [15:0]        lost_ticks,
    input wire [15:0]        watchdog_ticks,
    input wire signed [31:0] position,
    input wire signed [31:0] deviation,
    input wire signed [31:0] command_velocity,
    input wire signed [31:0] reference_position,
    input wire signed [31:0] reference_velocity,
    input wire signed [31:0] error,
    input wire signed [31:0] command,
    input wire [15:0]        limited_ticks,
    input wire               drive_enable,
    input wire signed [31:0] captured_position,
    input wire               level_limit_plus_n,
    input wire               level_limit_minus_n,
    (* peek = "u_monitors.found" *) input wire [15:0] found,
    (* peek = "u_monitors.still_ticks" *) input wire [15:0] still_ticks,
    (* peek = "u_monitors.unkicked_ticks" *) input wire [15:0] unkicked_ticks,
    (* peek = "u_monitors.looks" *) input wire looks,
    (* peek = "u_monitors.was_on" *) input wire was_on,
    (* peek = "u_monitors.counts" *) input wire counts,
    (* peek = "u_monitors.counts_on" *) input wire counts_on,
    (* peek = "u_monitors.stands" *) input wire stands,
    (* peek = "u_monitors.same_position" *) input wire same_position,
    (* peek = "u_monitors.on_plus" *) input wire on_plus,
    (* peek = "u_monitors.on_minus" *) input wire on_minus,
    (* peek = "u_monitors.was_on_plus" *) input wire was_on_plus,
    (* peek = "u_monitors.was_on_minus" *) input wire was_on_minus,
    (* peek = "u_monitors.past_plus" *) input wire past_plus,
    (* peek = "u_monitors.past_minus" *) input wire past_minus,
    (* peek = "u_monitors.was_past_plus" *) input wire was_past_plus,
    (* peek = "u_monitors.was_past_minus" *) input wire was_past_minus,
    (* peek = "u_monitors.forward" *) input wire forward,
    (* peek = "u_monitors.backward" *) input wire backward,
    (* peek = "u_monitors.shaped_forward" *) input wire shaped_forward,
    (* peek = "u_monitors.shaped_backward" *) input wire shaped_backward,
    (* peek = "u_monitors.saturated" *) input wire saturated,
    (* peek = "u_monitors.error_size" *) input wire [31:0] error_size,
    (* peek = "u_monitors.deviation_size" *) input wire [31:0] deviation_size,
    (* peek = "u_monitors.command_size" *) input wire [31:0] command_size
);
    // What the last tick showed, and the one before it.
    reg               shown = 1'b0;
    reg               shown_on = 1'b0;
    reg               at_plus = 1'b0, at_minus = 1'b0, was_at_plus = 1'b0, was_at_minus = 1'b0;
    reg               beyond_plus = 1'b0, beyond_minus = 1'b0, was_beyond_plus = 1'b0, was_beyond_minus = 1'b0;
    reg signed [31:0] velocity = 32'sd0, shaped = 32'sd0, e = 32'sd0, apart = 32'sd0, drive = 32'sd0, place = 32'sd0;
    reg               same = 1'b0, too_long = 1'b0;
    // A clock after it: a command above its threshold at the same place.
    reg               judged = 1'b0, judged_on = 1'b0, still = 1'b0;
    reg        [15:0] still_for = 16'd0, unkicked_for = 16'd0;
    wire              soft = soft_limit_plus != 32'sd0 | soft_limit_minus != 32'sd0;
    wire              kicked = kick & kick_word == `KICK;

    // x > limit, or x < -limit - 1, in numbers wide enough for both.
    wire signed [33:0] wide_error = e, wide_apart = apart, wide_drive = drive;
    wire signed [33:0] error_most = $signed({2'b0, following_error_limit});
    wire signed [33:0] apart_most = $signed({2'b0, deviation_limit});
    wire signed [33:0] drive_most = $signed({2'b0, lost_command});
    wire error_is_large = wide_error > error_most | wide_error < -error_most - 34'sd1;
    wire apart_is_large = wide_apart > apart_most | wide_apart < -apart_most - 34'sd1;
    wire drive_is_large = wide_drive > drive_most | wide_drive < -drive_most - 34'sd1;
    wire looking = shown & shown_on;

    reg [15:0] expected = 16'd0;
    always @(posedge clk) begin
        shown <= tick & !rst;
        judged <= shown & !rst;
        judged_on <= shown_on & !rst;
        still <= shown_on & same & drive_is_large & !rst;
        if (rst) begin
            {shown_on, at_plus, at_minus, was_at_plus, was_at_minus, same, too_long} <= 7'd0;
            {beyond_plus, beyond_minus, was_beyond_plus, was_beyond_minus} <= 4'd0;
            {velocity, shaped, e, apart, drive, place} <= 192'd0;
            {still_for, unkicked_for} <= 32'd0;
        end else begin
            if (shown) begin
                {was_at_plus, was_at_minus} <= {at_plus, at_minus};
                {was_beyond_plus, was_beyond_minus} <= {beyond_plus, beyond_minus};
            end
            if (tick) begin
                {shown_on, at_plus, at_minus} <= {drive_enable, !level_limit_plus_n, !level_limit_minus_n};
                beyond_plus <= soft & reference_position > soft_limit_plus;
                beyond_minus <= soft & reference_position < soft_limit_minus;
                {velocity, shaped, e, apart, drive, place} <=
                    {command_velocity, reference_velocity, error, deviation, command, position};
                same <= position == place;
                too_long <= saturation_ticks != 16'd0 & limited_ticks >= saturation_ticks;
            end
            if (judged & !still) still_for <= 16'd0;
            else if (judged & still_for != 16'hffff) still_for <= still_for + 16'd1;
            if (kicked | (judged & !judged_on)) unkicked_for <= 16'd0;
            else if (judged & unkicked_for != 16'hffff) unkicked_for <= unkicked_for + 16'd1;
        end
        expected <= rst | !looking ? 16'd0 :
            (at_plus & (velocity > 32'sd0 | (!was_at_plus & shaped > 32'sd0)) ? `LIMIT_PLUS : 16'd0)
            | (at_minus & (velocity < 32'sd0 | (!was_at_minus & shaped < 32'sd0)) ? `LIMIT_MINUS : 16'd0)
            | (beyond_plus & (velocity > 32'sd0 | !was_beyond_plus) ? `SOFT_LIMIT_PLUS : 16'd0)
            | (beyond_minus & (velocity < 32'sd0 | !was_beyond_minus) ? `SOFT_LIMIT_MINUS : 16'd0)
            | (following_error_limit != 32'd0 & error_is_large ? `FOLLOWING_ERROR : 16'd0)
            | (deviation_limit != 32'd0 & apart_is_large ? `DEVIATION : 16'd0)
            | (too_long ? `SATURATION : 16'd0)
            | (lost_ticks != 16'd0 & still_for >= lost_ticks ? `ENCODER_LOST : 16'd0)
            | (watchdog_ticks != 16'd0 & unkicked_for >= watchdog_ticks ? `WATCHDOG : 16'd0);
    end

    wire [15:0] wrong = found ^ expected;
    reg         past_looking = 1'b0;
    always @(posedge clk) past_looking <= looking & !rst;
    wire [15:0] monitored = `LIMIT_PLUS | `LIMIT_MINUS | `SOFT_LIMIT_PLUS | `SOFT_LIMIT_MINUS | `FOLLOWING_ERROR | `DEVIATION
        | `SATURATION | `ENCODER_LOST | `WATCHDOG;
    always @(*) begin
        only_at_ticks: assert (found == 16'd0 | past_looking);
        only_monitored: assert ((found & ~monitored) == 16'd0);
        limit_plus: assert ((wrong & `LIMIT_PLUS) == 16'd0);
        limit_minus: assert ((wrong & `LIMIT_MINUS) == 16'd0);
        soft_limit_plus_passed: assert ((wrong & `SOFT_LIMIT_PLUS) == 16'd0);
        soft_limit_minus_passed: assert ((wrong & `SOFT_LIMIT_MINUS) == 16'd0);
        following_error: assert ((wrong & `FOLLOWING_ERROR) == 16'd0);
        deviation_too_large: assert ((wrong & `DEVIATION) == 16'd0);
        saturation_too_long: assert ((wrong & `SATURATION) == 16'd0);
        encoder_lost: assert ((wrong & `ENCODER_LOST) == 16'd0);
        watchdog_not_kicked: assert ((wrong & `WATCHDOG) == 16'd0);
        captured: assert (captured_position == place);
    end

    // What registers hold, for the induction.
    always @(*) begin
        clocks_of_tick: assert (looks == shown & counts == judged);
        on_at_tick: assert (was_on == shown_on & counts_on == judged_on);
        switches: assert ({on_plus, on_minus, was_on_plus, was_on_minus} == {at_plus, at_minus, was_at_plus, was_at_minus});
        soft_limits: assert ({past_plus, past_minus} == {beyond_plus, beyond_minus});
        soft_limits_before: assert ({was_past_plus, was_past_minus} == {was_beyond_plus, was_beyond_minus});
        ways: assert ({forward, backward} == {velocity > 32'sd0, velocity < 32'sd0});
        shaped_ways: assert ({shaped_forward, shaped_backward} == {shaped > 32'sd0, shaped < 32'sd0});
        sizes_of_error: assert (error_size == (e < 32'sd0 ? ~e : e));
        sizes_of_deviation: assert (deviation_size == (apart < 32'sd0 ? ~apart : apart));
        sizes_of_command: assert (command_size == (drive < 32'sd0 ? ~drive : drive));
        flags: assert (same_position == same & saturated == too_long & stands == still);
        still_for_ticks: assert (still_ticks == still_for);
        unkicked_for_ticks: assert (unkicked_ticks == unkicked_for);
    end

    always @(*) begin
        reach_limit: cover ((found & `LIMIT_PLUS) != 16'd0);
        reach_soft_limit: cover ((found & `SOFT_LIMIT_MINUS) != 16'd0);
        reach_error: cover (found == `FOLLOWING_ERROR);
        reach_lost: cover (found == `ENCODER_LOST & still_for == 16'd2);
        reach_watchdog: cover (found == `WATCHDOG & unkicked_for == 16'd3);
        reach_all_but_one_side: cover ((found & ~`LIMIT_MINUS) == (monitored & ~`LIMIT_MINUS));
    end
endmodule
