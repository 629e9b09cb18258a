// limiter: the command is the sum, clamped at the limit that it exceeds; and the kept word is the command.
//
// The properties are proven for all inputs in every clock, including resets, with all 32 bits. They are claimed for a `take` that
// comes at least six clocks after the one before it, with the word kept and held still, a limit that holds still, and no `keep`,
// for these clocks. The word is as the accumulator gives it: of its sign, and if cut at the end of it. The sequencer's proof has
// the former, the accumulator's the latter; after another `take`, nothing until the next.
//
//   command_is_cut    six clocks after `take`: the word, or the limit with its sign
//   held_is_command   so is what is kept
//   within            -limit <= command <= limit
//   sides             limited_high and limited_low say which side was passed, never both
//   only_decided      command, limited_high and limited_low change in that clock only
//   kept              a clock after `keep` what is kept is the word
//   only_kept         and changes in the clocks of a `take` and with `keep` only
//   in_a_row          limited_ticks: so many `count` in a row found a cut; stays at its end
//   known_*           invariants
module limiter_properties (
    `PORTS,
    (* peek = "inverted" *) input wire inverted,
    (* peek = "compares" *) input wire compares,
    (* peek = "returns" *) input wire returns,
    (* peek = "cuts" *) input wire cuts,
    (* peek = "decides" *) input wire decides,
    (* peek = "over" *) input wire over
);
    // Clocks since the last `take`, 0 from the sixth on; and whether the properties apply to it.
    reg [2:0]         age = 3'd0;
    reg               claimed = 1'b0;
    reg [30:0]        bound = 31'd0;
    reg signed [31:0] sum = 32'sd0;
    reg               was_cut = 1'b0;
    reg               was_negative = 1'b0;
    reg               past_reset = 1'b1;
    reg               past_decides = 1'b0;
    reg               past_keep = 1'b0;
    reg               past_works = 1'b0;
    reg               past_high = 1'b0;
    reg               past_low = 1'b0;
    reg signed [31:0] past_command = 32'sd0;
    reg signed [31:0] past_held = 32'sd0;
    reg signed [31:0] past_word = 32'sd0;
    reg [15:0]        ticks = 16'd0;

    wire possible = negative == word[31] & (!cut | word == (negative ? 32'sh80000000 : 32'sh7fffffff)) & held == word;
    wire same = word == sum & cut == was_cut & negative == was_negative & limit == bound;
    wire rests = age == 3'd0 & !inverted & !compares & !returns & !cuts & !decides;
    always @(posedge clk) begin
        past_reset <= rst;
        past_decides <= decides;
        past_keep <= keep;
        past_works <= take | inverted | compares | returns | cuts;
        past_high <= limited_high;
        past_low <= limited_low;
        past_command <= command;
        past_held <= held;
        past_word <= word;
        if (rst) begin
            age <= 3'd0;
            claimed <= 1'b0;
        end else if (take) begin
            age <= 3'd1;
            claimed <= rests & possible & !keep;
            bound <= limit;
            sum <= word;
            was_cut <= cut;
            was_negative <= negative;
        end else begin
            if (age != 3'd0) age <= age == 3'd5 ? 3'd0 : age + 3'd1;
            claimed <= claimed & !keep & (age == 3'd0 | same);
        end
        if (rst) ticks <= 16'd0;
        else if (count) ticks <= !(limited_high | limited_low) ? 16'd0 : ticks == 16'hffff ? ticks : ticks + 16'd1;
    end

    wire signed [32:0] wide_sum = {sum[31], sum};
    wire signed [32:0] wide_limit = {2'b00, bound};
    wire signed [32:0] wide_command = {command[31], command};
    wire signed [32:0] wide_held = {held[31], held};
    wire               is_above = (was_cut & !was_negative) | wide_sum > wide_limit;
    wire               is_below = (was_cut & was_negative) | wide_sum < -wide_limit;
    wire               passes = is_above | is_below;
    wire signed [32:0] wanted = is_above ? wide_limit : is_below ? -wide_limit : wide_sum;
    // Intermediate values: the limit minus the sum, and an LSB; the size; nothing, or the sum again.
    wire signed [31:0] between = {1'b0, bound} - sum - 32'd1;
    wire signed [31:0] size = sum ^ {32{was_negative}};
    always @(*) begin
        known_clock: assert (!claimed | ({inverted, compares, returns, cuts, decides} ==
            {age == 3'd1, age == 3'd2, age == 3'd3, age == 3'd4, age == 3'd5}) & age <= 3'd5);
        known_word: assert (!claimed | (was_negative == sum[31] & (!was_cut | sum == (was_negative ? 32'sh80000000 : 32'sh7fffffff))));
        known_inverted: assert (!claimed | age != 3'd1 | held == (was_negative ? between : sum));
        known_size: assert (!claimed | (age != 3'd2 & age != 3'd3) | held == size);
        known_over: assert (!claimed | (age != 3'd3 & age != 3'd4 & age != 3'd5) | over == passes);
        known_returned: assert (!claimed | age != 3'd4 | held == (passes ? 32'sd0 : sum));
        known_cut: assert (!claimed | age != 3'd5 | wide_held == wanted);
        command_is_cut: assert (!claimed | age != 3'd0 | wide_command == wanted);
        held_is_command: assert (!claimed | age != 3'd0 | held == command);
        within: assert (!claimed | age != 3'd0 | (wide_command <= wide_limit & wide_command >= -wide_limit));
        sides: assert (!claimed | age != 3'd0 | (limited_high == is_above & limited_low == is_below & !(is_above & is_below)));
        only_decided: assert (past_reset | past_decides |
            (command == past_command & limited_high == past_high & limited_low == past_low));
        kept: assert (past_reset | past_works | !past_keep | held == past_word);
        only_kept: assert (past_reset | past_works | past_keep | held == past_held);
        in_a_row: assert (limited_ticks == ticks);
    end

    always @(*) begin
        reach_high: cover (claimed & age == 3'd0 & limited_high);
        reach_low: cover (claimed & age == 3'd0 & limited_low);
        reach_uncut: cover (claimed & age == 3'd0 & !limited_high & !limited_low & command != 32'sd0);
        reach_again: cover (!claimed & age != 3'd0);
    end
endmodule
