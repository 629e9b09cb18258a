// accumulator: sums are exact except for one rounding of each product, half up, and never overflow; words are clamped at their
// ends.
//
// The properties are proven for all inputs in every clock, including resets, with all 52 bits. They are claimed for sums whose
// terms are at most 2^49, half LSBs, as those of 32 x 18 bits are, and of at most six terms: the sequencer's proof has that none
// has more. After other inputs, nothing is claimed until a new sum begins.
//
//   exact_sum     the register is the terms so far and round(term), as numbers of 64 bits say
//   bounded       its size is at most terms * 2^48: 52 bits hold 2^51
//   word_is_cut   a clock after `check` the word is the sum, or the end it passes of 32, 26 or 18 bits, and changes in that
//                 clock only
//   sides         cut says whether an end was passed, negative which
//   sign          negative is the word's sign
module accumulator_properties (
    `PORTS,
    (* peek = "sum_q" *) input wire signed [51:0] sum
);
    localparam signed [63:0] LARGEST_TERM = 64'sd1 <<< 49;
    localparam [2:0] MOST_TERMS = 3'd6;

    reg signed [63:0] exact = 64'sd0;
    reg [2:0]         terms = 3'd0;
    reg               claimed = 1'b1;

    wire signed [63:0] wide_term = {{13{scaled[50]}}, scaled};
    // This rounds half up; terms are in half LSBs.
    wire signed [63:0] rounded = (wide_term + 64'sd1) >>> 1;
    wire               fits = wide_term <= LARGEST_TERM & wide_term >= -LARGEST_TERM;
    always @(posedge clk) begin
        if (rst) begin
            exact <= 64'sd0;
            terms <= 3'd0;
            claimed <= 1'b1;
        end else if (empty) begin
            exact <= 64'sd0;
            terms <= 3'd0;
            claimed <= 1'b1;
        end else if (add) begin
            exact <= exact + rounded;
            terms <= terms + 3'd1;
            claimed <= fits & claimed & terms < MOST_TERMS;
        end
    end

    wire signed [63:0] wide_sum = {{12{sum[51]}}, sum};
    wire signed [63:0] bound = $signed({61'd0, terms}) <<< 48;
    wire signed [63:0] end_above = as_duty ? 64'sd131071 : as_fraction ? 64'sd33554431 : 64'sd2147483647;
    wire signed [63:0] end_below = -end_above - 64'sd1;
    wire signed [63:0] wanted = wide_sum > end_above ? end_above : wide_sum < end_below ? end_below : wide_sum;
    wire signed [63:0] wide_word = {{32{word[31]}}, word};
    // Result of the last check.
    reg signed [63:0]  due_word = 64'sd0;
    reg                is_above = 1'b0;
    reg                is_below = 1'b0;
    always @(posedge clk) begin
        if (rst) begin
            due_word <= 64'sd0;
            is_above <= 1'b0;
            is_below <= 1'b0;
        end else if (check) begin
            due_word <= wanted;
            is_above <= wide_sum > end_above;
            is_below <= wide_sum < end_below;
        end
    end
    always @(*) begin
        exact_sum: assert (!claimed | wide_sum == exact);
        bounded: assert (!claimed | (exact <= bound & exact >= -bound & terms <= MOST_TERMS));
        word_is_cut: assert (wide_word == due_word);
        sides: assert (cut == (is_above | is_below) & (!is_above | !negative) & (!is_below | negative));
        sign: assert (negative == word[31]);
    end

    always @(*) begin
        reach_six_terms: cover (claimed & terms == MOST_TERMS);
        reach_high: cover (claimed & is_above & due_word == 64'sd2147483647);
        reach_low: cover (claimed & is_below & due_word == -64'sd33554432);
        reach_inside: cover (claimed & as_duty & !cut & word != 32'sd0);
    end
endmodule
