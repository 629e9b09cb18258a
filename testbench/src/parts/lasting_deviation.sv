// lasting_deviation: a deviation reaches the supervisor once it has lasted for exactly so many ticks.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. What is beyond the limit is the
// magnitude of the clock before, as the supervisor takes it.
//
//   exact              lasting is the deviation if it is beyond its limit and was so at each of the last `ticks` ticks, else 0
//   never_early        of up to eight ticks, from their history: where lasting is not 0, the deviation was beyond at all of them
//   in_time            and where it was, lasting is the deviation
module lasting_deviation_properties (
    `PORTS,
    (* peek = "beyond" *) input wire beyond,
    (* peek = "count" *) input wire [15:0] count
);
    wire        negative = deviation[31];
    wire [31:0] size = negative ? ~deviation : deviation;
    // Whether it was beyond one clock ago, and at the ticks before: at the last one in bit 0.
    reg         was_beyond = 1'b0;
    reg  [7:0]  history = 8'd0;
    // Ticks in a row, up to the largest number.
    reg  [15:0] row = 16'd0;
    reg  [31:0] expected = 32'd0;
    reg         lasted = 1'b0;
    reg         short_time = 1'b0;
    reg  [31:0] past_deviation = 32'd0;
    wire [8:0]  needed = (9'd1 << ticks) - 9'd1;
    always @(posedge clk) begin
        was_beyond <= !rst & size > limit;
        if (rst) begin
            history <= 8'd0;
            row <= 16'd0;
        end else if (tick) begin
            history <= {history[6:0], was_beyond};
            row <= !was_beyond ? 16'd0 : row == 16'hffff ? row : row + 16'd1;
        end
        expected <= !rst & was_beyond & row >= ticks ? deviation : 32'd0;
        lasted <= !rst & was_beyond & (history & needed[7:0]) == needed[7:0];
        short_time <= !rst & ticks <= 16'd8;
        past_deviation <= deviation;
    end

    always @(*) begin
        exact: assert (lasting == expected);
        never_early: assert (!short_time | lasting == 32'd0 | lasted);
        in_time: assert (!short_time | !lasted | lasting == past_deviation);
    end

    // Invariants of the registers, for the induction.
    wire [7:0] ones = row >= 16'd8 ? 8'hff : (8'd1 << row[2:0]) - 8'd1;
    always @(*) begin
        same_beyond: assert (beyond == was_beyond);
        same_count: assert (count == row);
        history_has_row: assert ((history & ones) == ones);
        row_ends: assert (row >= 16'd8 | !history[row[2:0]]);
        lasted_is_shown: assert (!short_time | lasted == (lasting == past_deviation) | past_deviation == 32'd0);
    end

    always @(*) begin
        reach_lasting: cover (lasting != 32'd0 & ticks == 16'd3);
        reach_excursion: cover (row == 16'd0 & history[1:0] == 2'b10 & ticks == 16'd3);
    end
endmodule
