// probe_line: `touched` is the line in its polarity, filtered.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. The line is as its synchroniser sees
// it, two clocks late.
//
//   passes_when_due    touched changes exactly after the line has differed from it for so many clocks in a row, and one, as
//                      filter_clocks had when it last did not differ
//   follows_unfiltered with filter_clocks 0, and in the first four clocks after a reset, touched is the line, a clock later
//   idle_after_reset   after a reset it does not touch
module probe_line_properties (
    `PORTS,
    (* peek = "u_line.u_synchroniser.synchroniser_first" *) input wire first,
    (* peek = "u_line.u_synchroniser.synchroniser_second" *) input wire second,
    (* peek = "u_line.u_filter.left" *) input wire [5:0] left,
    (* peek = "primed" *) input wire [3:0] primed
);
    reg       past_reset = 1'b1;
    reg [3:0] awake = 4'd0;
    reg       once = 1'b0, twice = 1'b0;
    reg       past_touched = 1'b0, past_unfiltered = 1'b1, past_line = 1'b0;
    // Clocks for which the line must have differed, and those for which it has.
    reg [6:0] needed = 7'd0, differed = 7'd0;
    reg       due = 1'b0;
    wire      unfiltered = !awake[3] | filter_clocks == 6'd0;
    always @(posedge clk) begin
        past_reset <= rst;
        awake <= rst ? 4'd0 : {awake[2:0], 1'b1};
        once <= !rst & (probe ^ active_low);
        twice <= !rst & once;
        past_touched <= touched;
        past_unfiltered <= unfiltered;
        past_line <= twice;
        due <= !rst & twice != touched & differed == needed;
        if (rst) begin
            differed <= 7'd0;
            needed <= 7'd0;
        end else if (twice == touched | unfiltered | differed == needed) begin
            differed <= 7'd0;
            needed <= {1'b0, filter_clocks};
        end else
            differed <= differed + 7'd1;
    end

    always @(*) begin
        idle_after_reset: assert (!past_reset | !touched);
        follows_unfiltered: assert (past_reset | !past_unfiltered | touched == past_line);
        passes_when_due: assert (past_reset | past_unfiltered | (touched != past_touched) == due);
    end

    // Invariants of the registers, for the induction.
    always @(*) begin
        same_line: assert (first == once & second == twice);
        same_primed: assert (primed == awake);
        left_to_go: assert (needed >= differed & {1'b0, left} == needed - differed);
    end

    always @(*) begin
        reach_touched: cover (touched & !past_touched & awake[3] & needed == 7'd5);
        reach_glitch: cover (twice & !touched & differed == 7'd3);
    end
endmodule
