// sample_select: strobe, start and words come from one source together, a clock later.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. from_pins may change in any clock.
//
//   exact          all outputs are what the source that from_pins chose showed in the clock before: never words of one source
//                  with the strobe of the other
//   other_unheard  a strobe or start of the other source has no effect
//   reset_is_quiet all outputs are 0 after a reset, including words
module sample_select_properties (
    `PORTS
);
    localparam BITS = `WORD_BITS * `CHANNELS;

    reg              past_reset = 1'b1, past_from_pins = 1'b0;
    reg [1:0]        past_host = 2'd0, past_pins = 2'd0;
    reg [BITS-1:0]   past_host_words = {BITS{1'b0}}, past_pin_words = {BITS{1'b0}};
    always @(posedge clk) begin
        {past_reset, past_from_pins} <= {rst, from_pins};
        {past_host, past_pins} <= {host_strobe, host_start, pin_strobe, pin_start};
        {past_host_words, past_pin_words} <= {`HOST_WORDS, `PIN_WORDS};
    end

    wire [1:0]      heard = past_from_pins ? past_pins : past_host;
    wire [BITS-1:0] words = past_from_pins ? past_pin_words : past_host_words;
    always @(*) begin
        exact: assert (past_reset | ({strobe, start} == heard & `WORDS == words));
        other_unheard: assert (({strobe, start} & ~heard) == 2'd0);
        reset_is_quiet: assert (!past_reset | ({strobe, start} == 2'd0 & `WORDS == {BITS{1'b0}}));
    end

    always @(*) begin
        reach_pins: cover (strobe & past_from_pins & past_host_words != past_pin_words);
        reach_host: cover (strobe & start & !past_from_pins);
        reach_unheard: cover (past_pins == 2'd3 & !strobe & !past_from_pins & !past_reset);
    end
endmodule
