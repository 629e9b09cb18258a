// limiter: the command is the sum, cut at the limit on the side it passes.
//
// Proven for all inputs in every clock, resets included, with all 32 bits. Claimed for a `take` that comes at least three
// clocks after the one before it and whose word is as the accumulator gives it: positive if cut above, negative if cut
// below. The sequencer's proof has the former, the accumulator's the latter; after another `take`, nothing until the next.
//
//   command_is_cut    three clocks after `take`: the word, or the limit with its sign
//   within            -limit <= command <= limit
//   sides             limited_high and limited_low say which side was passed, never both
//   only_decided      command, limited_high and limited_low change in that clock only
//   in_a_row          limited_ticks: so many `count` in a row found a cut; stays at its end
//   known_*           invariants
module limiter_properties (
    input wire               clk,
    input wire               rst,
    input wire               take,
    input wire               count,
    input wire [30:0]        limit,
    input wire signed [31:0] word,
    input wire               word_high,
    input wire               word_low,
    input wire signed [31:0] command,
    input wire               limited_high,
    input wire               limited_low,
    input wire [15:0]        limited_ticks,
    input wire               decides,
    (* peek = "compares_q" *) input wire compares,
    (* peek = "limit_q" *) input wire [30:0] limit_taken,
    (* peek = "size" *) input wire [31:0] size,
    (* peek = "negative" *) input wire negative,
    (* peek = "beyond" *) input wire beyond,
    (* peek = "cut" *) input wire cut
);
    // Clocks since the last `take`, 0 from the third on; and whether it is one that something is claimed of.
    reg [1:0]         age = 2'd0;
    reg               claimed = 1'b1;
    reg signed [32:0] bound = 33'sd0;
    reg signed [32:0] sum = 33'sd0;
    reg               is_above = 1'b0;
    reg               is_below = 1'b0;
    reg               past_reset = 1'b1;
    reg               past_decides = 1'b0;
    reg               past_high = 1'b0;
    reg               past_low = 1'b0;
    reg signed [31:0] past_command = 32'sd0;
    reg [15:0]        ticks = 16'd0;

    wire signed [32:0] wide_word = {word[31], word};
    wire signed [32:0] wide_limit = {2'b00, limit};
    wire               possible = !(word_high & word[31]) & !(word_low & !word[31]);
    always @(posedge clk) begin
        past_reset <= rst;
        past_decides <= decides;
        past_high <= limited_high;
        past_low <= limited_low;
        past_command <= command;
        if (rst) begin
            age <= 2'd0;
            claimed <= 1'b1;
            bound <= 33'sd0;
            sum <= 33'sd0;
            is_above <= 1'b0;
            is_below <= 1'b0;
        end else if (take) begin
            age <= 2'd1;
            claimed <= age == 2'd0 & possible;
            bound <= wide_limit;
            sum <= wide_word;
            is_above <= word_high | wide_word > wide_limit;
            is_below <= word_low | wide_word < -wide_limit;
        end else if (age != 2'd0) begin
            age <= age == 2'd2 ? 2'd0 : age + 2'd1;
        end
        if (rst) ticks <= 16'd0;
        else if (count) ticks <= !(limited_high | limited_low) ? 16'd0 : ticks == 16'hffff ? ticks : ticks + 16'd1;
    end

    wire signed [32:0] wide_command = {command[31], command};
    wire signed [32:0] wanted = is_above ? bound : is_below ? -bound : sum;
    always @(*) begin
        known_clock: assert (compares == (age == 2'd1) & ((!claimed & age == 2'd1) | decides == (age == 2'd2)) & age != 2'd3);
        known_take: assert (!claimed | age == 2'd0 |
            (bound == {2'b00, limit_taken} & negative == sum[32] & size == (sum[31:0] ^ {32{sum[32]}})));
        known_bound: assert (!bound[32] & !bound[31] & sum[32] == sum[31]);
        known_side: assert (!claimed | !(is_above & is_below) & (!is_above | !sum[32]) & (!is_below | sum[32]));
        known_beyond: assert (!claimed | age != 2'd1 | (beyond | sum > bound | sum < -bound) == (is_above | is_below));
        known_cut: assert (!claimed | age != 2'd2 | cut == (is_above | is_below));
        known_within: assert (!claimed | is_above | is_below | (sum <= bound & sum >= -bound));
        command_is_cut: assert (!claimed | age != 2'd0 | wide_command == wanted);
        within: assert (!claimed | age != 2'd0 | (wide_command <= bound & wide_command >= -bound));
        sides: assert (!claimed | age != 2'd0 | (limited_high == is_above & limited_low == is_below));
        only_decided: assert (past_reset | past_decides |
            (command == past_command & limited_high == past_high & limited_low == past_low));
        in_a_row: assert (limited_ticks == ticks);
    end

    always @(*) begin
        reach_high: cover (claimed & age == 2'd0 & limited_high);
        reach_low: cover (claimed & age == 2'd0 & limited_low);
        reach_uncut: cover (claimed & age == 2'd0 & !limited_high & !limited_low & command != 32'sd0);
        reach_again: cover (!claimed);
    end
endmodule
