// divider_share: one quotient_valid per division, in the order of the channels.
//
// The properties are proven for all inputs but one, including resets. Assumed, as docs/divider.md says of the divider: `done` comes
// only while a division is on its way, and not in the clock of its start.
//
//   one_at_a_time     at most one channel gets a quotient
//   one_per_division  a quotient comes one clock after each `done`, and at no other time
//   in_order          channel 0 first, then 1, and so on; after the last, 0 again
//   one_division      no division starts while one is on its way
//   next_follows      after each but the last, the next one starts in the clock of the quotient
//   begins            idle, `divide` starts the first in the next clock
//   rests             after the last one nothing starts without `divide`
module divider_share_properties (
    `PORTS
);
    wire [7:0] valid = `VALID;

    reg       in_flight = 1'b0;
    reg       past_done = 1'b0;
    reg       past_divide = 1'b0;
    reg       past_idle = 1'b1;
    reg [3:0] expected = 4'd0;
    wire      is_last = expected == `CHANNELS - 4'd1;
    always @(posedge clk) begin
        in_flight <= !rst & (start | (in_flight & !done));
        past_done <= !rst & done;
        past_divide <= !rst & divide;
        past_idle <= rst | (!start & !in_flight);
        if (rst) expected <= 4'd0;
        else if (|valid) expected <= is_last ? 4'd0 : expected + 4'd1;
    end

    // After an unexpected `done`, nothing is claimed.
    reg  out_of_turn = 1'b0;
    wire fair = !out_of_turn & (!done | in_flight);
    always @(posedge clk) out_of_turn <= !rst & !fair;

    always @(*) begin
        one_at_a_time: assert (out_of_turn | ((valid & (valid - 8'd1)) == 8'd0));
        one_per_division: assert (out_of_turn | ((|valid) == past_done));
        in_order: assert (out_of_turn | (!(|valid) | valid == 8'd1 << expected));
        one_division: assert (out_of_turn | (!start | !in_flight));
        next_follows: assert (out_of_turn | (!past_done | start == !is_last));
        begins: assert (out_of_turn | (!past_idle | start == past_divide));
        rests: assert (out_of_turn | (!start | past_divide | past_done));
    end

    always @(*) begin
        reach_first: cover (valid[0]);
        reach_last: cover ((|valid) & is_last);
    end
endmodule
