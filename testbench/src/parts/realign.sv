// realign: the deviation counts anew after either event, and the steps of the host add up.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed.
//
//   aligns_after       align is high in exactly the clock after `enabled` or `correct`
//   counts_the_hosts   corrected_steps changes by realign_steps in the clock after `correct`, and in no other
//   nothing_at_reset   both are 0 after a reset
module realign_properties (
    `PORTS
);
    reg        past_reset = 1'b1, past_enabled = 1'b0, past_correct = 1'b0;
    reg [15:0] past_steps = 16'd0;
    reg [31:0] past_corrected = 32'd0;
    always @(posedge clk) begin
        past_reset <= rst;
        past_enabled <= enabled;
        past_correct <= correct;
        past_steps <= realign_steps;
        past_corrected <= corrected_steps;
    end
    wire [31:0] steps = {{16{past_steps[15]}}, past_steps};

    always @(*) begin
        aligns_after: assert (past_reset | align == (past_enabled | past_correct));
        counts_the_hosts: assert (past_reset | corrected_steps == past_corrected + (past_correct ? steps : 32'd0));
        nothing_at_reset: assert (!past_reset | (!align & corrected_steps == 32'd0));
    end

    always @(*) begin
        reach_corrected: cover (corrected_steps == 32'd64);
        reach_back: cover (corrected_steps == 32'hffffffff & !past_reset & align);
    end
endmodule
