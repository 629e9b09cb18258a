// absolute_encoder: what the encoder sees at its clock line, and what moves the count.
//
// Proven for all inputs in every clock, whatever is on the line, resets and ticks at any distance included; nothing is assumed. The
// bits are those behind the synchroniser at the moments at which the block takes them; frame, check and count are computed again.
//
//   low, high          clock_out is low for half a period, and high for half a period at the least; a reset ends a low at once
//   pause              before the first falling edge of a reading it has been high for the pause, unless there was none since the
//                      reset
//   frame_guards       a count is read (not extrapolated) only from a frame that is whole, whose check holds, and whose error bit
//                      is off: a frame with a wrong check never moves the count
//   reads              then count is the position of the frame, modulo the range; Gray code is decoded
//   moves_bounded      and it is at most as many times the limit from the last one read as there were readings
//   only_valid         count changes only where `valid` says so
//   continues          an extrapolated count is the last one read and, for each failed reading since, the last change of one reading
//   bounded            it is at most the tolerated number times the limit from the last one read
//   lost_stands        while `lost`, count does not change, and is not `known`; `lost` comes with one more failed reading in a row
//                      than tolerated, and goes with clear_flags alone
//   reports            a whole frame with a wrong check sets check_failed, one with a right check its status bits
//   known_...          invariants
//
// Not proven here: at which clocks the bits are taken, and the delay of the line (encoders in cocotb, lock step).
module absolute_encoder_properties (
    `PORTS,
    (* peek = "u_line.runs" *) input wire runs,
    (* peek = "u_line.half_timer" *) input wire [11:0] half_timer,
    (* peek = "u_line.state" *) input wire [2:0] state,
    (* peek = "u_line.elapsed" *) input wire [15:0] elapsed,
    (* peek = "u_line.place_q" *) input wire [6:0] place,
    (* peek = "u_line.ended_q" *) input wire ended,
    (* peek = "u_line.silent_q" *) input wire ends_silent,
    (* peek = "u_line.stuck_q" *) input wire ends_stuck,
    (* peek = "u_line.takes_bit" *) input wire takes,
    (* peek = "u_line.u_pin.synchroniser_second" *) input wire level,
    (* peek = "u_word.position_q" *) input wire [39:0] word,
    (* peek = "u_word.crc" *) input wire [5:0] crc,
    (* peek = "u_word.odd" *) input wire odd,
    (* peek = "u_word.error_q" *) input wire error,
    (* peek = "u_word.warning_q" *) input wire warning,
    (* peek = "differs" *) input wire differs,
    (* peek = "decides" *) input wire decides,
    (* peek = "failed" *) input wire failed,
    (* peek = "good" *) input wire good,
    (* peek = "difference" *) input wire [39:0] difference,
    (* peek = "position" *) input wire [39:0] position,
    (* peek = "change" *) input wire [31:0] change,
    (* peek = "missed" *) input wire [7:0] missed,
    (* peek = "allowed" *) input wire [31:0] allowed
);
    localparam [2:0] REST = 3'd0;
    localparam [2:0] BITS = 3'd5;
    localparam [2:0] LOW = 3'd6;
    localparam [2:0] PAUSE = 3'd7;

    // Clocks since the last edge of the line, which is high in reset.
    reg         past_line = 1'b1;
    reg         past_reset = 1'b1;
    reg         past_busy = 1'b0;
    reg         has_run = 1'b0;
    reg  [16:0] since_before = 17'd0;
    wire        edge_of_line = clock_out ^ past_line;
    wire [16:0] since = edge_of_line ? 17'd1 : (&since_before) ? since_before : since_before + 17'd1;
    wire        starts = tick & !busy;
    always @(posedge clk) begin
        past_line <= rst | clock_out;
        past_reset <= rst;
        past_busy <= !rst & busy;
        has_run <= !rst & (has_run | !clock_out);
        since_before <= rst ? 17'd0 : since;
    end
    wire falls = !clock_out & past_line;
    wire rises = clock_out & !past_line;
    always @(*) begin
        low: assert (!rises | since_before == `HALF);
        high: assert (!falls | since_before >= `HALF | !has_run);
        pause: assert (!falls | past_busy | since_before >= `PAUSE | !has_run);
        at_rest: assert (!past_reset | (clock_out & !busy));
        known_timer: assert (!runs | (since == {5'd0, half_timer} & half_timer <= `HALF));
        known_halt: assert (runs | clock_out);
        known_rest: assert (state != REST | (!runs & (since > `PAUSE | !has_run)));
        known_pause: assert (state != PAUSE | (elapsed != 16'd0 & elapsed <= `PAUSE & (runs | since >= {1'b0, elapsed})));
        known_paused: assert (state != PAUSE | !runs | elapsed == 16'd1);
    end

    // The frame, taken again.
    reg  [6:0]  taken = 7'd0;
    reg  [5:0]  rest = 6'd0;
    reg         ones = 1'b0;
    reg  [39:0] raw = 40'd0;
    reg         error_seen = 1'b0;
    reg         warning_seen = 1'b0;
    wire        is_crc = taken >= `BITS - 7'd6;
    wire        next_term = rest[5] ^ level ^ is_crc;
    always @(posedge clk) begin
        if (rst | starts) begin
            taken <= 7'd0;
            rest <= 6'd0;
            ones <= 1'b0;
            raw <= 40'd0;
            error_seen <= 1'b0;
            warning_seen <= 1'b0;
        end else if (takes) begin
            taken <= taken + 7'd1;
            rest <= {rest[4:1], rest[0] ^ next_term, next_term};
            ones <= ones ^ level;
            if (taken >= `LEADING & taken < `LEADING + `POSITION) raw <= {raw[38:0], level};
            if (`HAS_ERROR & taken == `ERROR_AT) error_seen <= level ^ `ERROR_LOW;
            if (`HAS_WARNING & taken == `WARNING_AT) warning_seen <= level ^ `WARNING_LOW;
        end
    end
    // Each bit of Gray code and all above it.
    reg  [39:0] decoded;
    integer k;
    always @(*) begin
        decoded = raw;
        if (`GRAY)
            for (k = 38; k >= 0; k = k - 1)
                decoded[k] = decoded[k + 1] ^ raw[k];
    end
    wire        check_holds = `CRC6 ? rest == 6'd0 : `EVEN ? !ones : `ODD ? ones : 1'b1;
    wire        whole = taken == `BITS;
    wire        frame_good = whole & check_holds & !error_seen;
    wire        judged = ended | differs | decides;
    wire        in_frame = state == BITS | state == LOW;
    wire [6:0]  of_position = taken <= `LEADING ? 7'd0 : taken < `LEADING + `POSITION ? taken - `LEADING : `POSITION;
    always @(*) begin
        known_taken: assert (taken <= `BITS & (raw >> of_position) == 40'd0);
        known_before: assert (in_frame | state == REST | state == PAUSE | taken == 7'd0);
        known_place: assert (state == REST | state == PAUSE | place + `LEADING == taken);
        known_frame: assert (state != BITS | taken < `BITS);
        known_whole: assert (state != LOW | whole);
        known_word: assert (word == decoded & `CHECK_KNOWN);
        known_status: assert (error == error_seen & warning == warning_seen);
        known_judged: assert (!judged | state == REST | state == PAUSE);
        known_ended: assert (!ended | ends_silent | ends_stuck | whole);
        known_failed: assert (!differs | failed | frame_good);
        known_good: assert (!decides | !good | frame_good);
        known_one: assert ({1'b0, ended} + {1'b0, differs} + {1'b0, decides} <= 2'd1);
        known_read: assert (!valid | (!judged & (state == REST | state == PAUSE)));
    end

    // The count.
    reg  [31:0] last_read = 32'd0;
    reg  [31:0] past_count = 32'd0;
    reg  [7:0]  past_missed = 8'd0;
    reg         past_known = 1'b0;
    reg         past_lost = 1'b0;
    reg         past_clear = 1'b0;
    reg  [7:0]  failures = 8'd0;
    reg  [31:0] read_before = 32'd0;
    wire        read = valid & !extrapolated;
    wire        is_read = decides & good & !lost;
    wire        is_missed = decides & !good & !lost;
    wire [39:0] position_next = known ? position + difference : word;
    always @(posedge clk) begin
        past_count <= rst ? 32'd0 : count;
        past_missed <= missed;
        past_known <= !rst & known;
        past_lost <= !rst & lost;
        past_clear <= clear_flags;
        read_before <= last_read;
        if (rst) begin
            failures <= 8'd0;
            last_read <= 32'd0;
        end else if (is_read) begin
            failures <= 8'd0;
            last_read <= position_next[31:0];
        end else if (lost & clear_flags) failures <= 8'd0;
        else if (is_missed) failures <= failures + 8'd1;
    end
    // The difference to the last position that was read, modulo the range, and its sign.
    wire signed [39:0] apart = (word - position) << (40 - `POSITION);
    wire signed [39:0] apart_extended = apart >>> (40 - `POSITION);
    wire [39:0] range = {40{1'b1}} >> (40 - `POSITION);
    wire [31:0] low_range = range[31:0];
    wire signed [31:0] step = count - read_before;
    wire signed [31:0] largest = `LARGEST;
    wire signed [31:0] change_of_one = change;
    wire signed [31:0] continued = count - last_read;
    wire signed [31:0] farthest = `LARGEST * (past_missed + 32'd1);
    wire signed [39:0] signed_difference = difference;
    wire signed [39:0] signed_allowed = {8'd0, allowed};
    always @(*) begin
        frame_guards: assert (!read | frame_good);
        reads: assert (!read | ((count ^ decoded[31:0]) & low_range) == 32'd0);
        moves_bounded: assert (!read | !past_known | (step <= farthest & step >= -farthest));
        only_valid: assert (past_reset | valid | count == past_count);
        continues: assert (!known | count == last_read + (missed >= 8'd1 ? change : 32'd0) + (missed >= 8'd2 ? change : 32'd0)
            + (missed >= 8'd3 ? change : 32'd0));
        extrapolates: assert (!known | extrapolated == (missed != 8'd0));
        bounded: assert (!known | (continued <= `MOST & continued >= -`MOST));
        lost_stands: assert (!lost | (!known & !valid & missed == `TOLERATED));
        lost_by_failures: assert (lost == (failures > `TOLERATED));
        lost_until_clear: assert (!past_lost | lost | past_clear);
        known_missed: assert (missed <= `TOLERATED & allowed == `LARGEST * ({24'd0, missed} + 32'd1));
        known_failures: assert (lost ? failures == `TOLERATED + 8'd1 : failures == missed);
        known_change: assert (!known | (change_of_one <= largest & change_of_one >= -largest));
        known_last: assert (!known | position[31:0] == last_read);
        known_difference: assert (!(differs | decides) | difference == apart_extended);
        known_within: assert (!decides | !good | !known | (signed_difference <= signed_allowed & signed_difference >= -signed_allowed));
    end

    // Flags: a whole frame that has ended.
    reg  past_wrong = 1'b0;
    reg  past_error = 1'b0;
    reg  past_warning = 1'b0;
    reg  past_silent = 1'b0;
    reg  past_stuck = 1'b0;
    wire ends_whole = ended & !ends_silent & !ends_stuck;
    always @(posedge clk) begin
        past_wrong <= !rst & ends_whole & !check_holds;
        past_error <= !rst & ends_whole & check_holds & error_seen;
        past_warning <= !rst & ends_whole & check_holds & warning_seen;
        past_silent <= !rst & ended & ends_silent;
        past_stuck <= !rst & ended & ends_stuck;
    end
    always @(*) begin
        reports: assert ((!past_wrong | check_failed) & (!past_error | error_bit) & (!past_warning | warning_bit));
        reports_line: assert ((!past_silent | silent) & (!past_stuck | stuck));
    end

    always @(*) begin
        reach_bits: cover (takes & taken == 7'd3);
        reach_lost: cover (lost);
        reach_end: cover (`SHORT ? read : state == BITS);
    end
endmodule
