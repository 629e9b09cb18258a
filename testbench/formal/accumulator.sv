// accumulator: sums are exact but for one rounding of each product, half up, and never overflow; words are cut at their ends.
//
// Proven for all inputs in every clock, resets included, with all 52 bits. Claimed of sums whose terms are at most 2^49, half
// LSBs, as those of 32 x 18 bits are, and of at most six terms: the sequencer's proof has that none has more. After others,
// nothing until a sum begins anew.
//
//   exact_sum     the register is base + round(term), as numbers of 64 bits say
//   bounded       its size is at most 2^31 + terms * 2^48: 52 bits hold 2^51
//   word_is_cut   the word is the sum, or the end it passes of 32, 26 or 18 bits
//   sides         high and low say which end was passed
module accumulator_properties (
    input wire               clk,
    input wire               rst,
    input wire               add,
    input wire               begin_sum,
    input wire               begin_rate,
    input wire signed [31:0] error_rate,
    input wire signed [50:0] scaled,
    input wire               as_fraction,
    input wire               as_duty,
    input wire signed [31:0] word,
    input wire               high,
    input wire               low,
    (* peek = "sum_q" *) input wire signed [51:0] sum
);
    localparam signed [63:0] LARGEST_TERM = 64'sd1 <<< 49;
    localparam [2:0] MOST_TERMS = 3'd6;

    reg signed [63:0] exact = 64'sd0;
    reg [2:0]         terms = 3'd0;
    reg               claimed = 1'b1;

    wire signed [63:0] wide_rate = {{32{error_rate[31]}}, error_rate};
    wire signed [63:0] wide_term = {{13{scaled[50]}}, scaled};
    wire signed [63:0] base = begin_rate ? wide_rate : begin_sum ? 64'sd0 : exact;
    // Half up, of half LSBs.
    wire signed [63:0] rounded = (wide_term + 64'sd1) >>> 1;
    wire               begins = begin_rate | begin_sum;
    wire               fits = wide_term <= LARGEST_TERM & wide_term >= -LARGEST_TERM;
    always @(posedge clk) begin
        if (rst) begin
            exact <= 64'sd0;
            terms <= 3'd0;
            claimed <= 1'b1;
        end else if (add) begin
            exact <= base + rounded;
            terms <= begins ? 3'd1 : terms + 3'd1;
            claimed <= fits & (begins | (claimed & terms < MOST_TERMS));
        end
    end

    wire signed [63:0] wide_sum = {{12{sum[51]}}, sum};
    wire signed [63:0] bound = (64'sd1 <<< 31) + ($signed({61'd0, terms}) <<< 48);
    wire signed [63:0] end_above = as_duty ? 64'sd131071 : as_fraction ? 64'sd33554431 : 64'sd2147483647;
    wire signed [63:0] end_below = -end_above - 64'sd1;
    wire signed [63:0] wanted = wide_sum > end_above ? end_above : wide_sum < end_below ? end_below : wide_sum;
    wire signed [63:0] wide_word = {{32{word[31]}}, word};
    always @(*) begin
        exact_sum: assert (!claimed | wide_sum == exact);
        bounded: assert (!claimed | (exact <= bound & exact >= -bound & terms <= MOST_TERMS));
        word_is_cut: assert (wide_word == wanted);
        sides: assert (high == (wide_sum > end_above) & low == (wide_sum < end_below));
    end

    always @(*) begin
        reach_six_terms: cover (claimed & terms == MOST_TERMS);
        reach_high: cover (claimed & high & !as_duty & !as_fraction);
        reach_low: cover (claimed & low & as_fraction & !as_duty);
        reach_inside: cover (claimed & as_duty & !high & !low & sum != 52'sd0);
    end
endmodule
