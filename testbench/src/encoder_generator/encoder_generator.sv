// encoder_generator: a pulse counter can follow the lines at any rate.
//
// Proven for all inputs in every clock, resets and changes of `rate` included; nothing is assumed. Lines are those inside,
// a clock before the outputs; a count of the lines is one step of Gray code, up or down.
//
//   counts             generated_count is the sum of all rates since the reset, rounded down, modulo 2^32
//   one_line           at most one of A and B changes in a clock
//   every_other_clock  and none in two successive clocks
//   follows            the lines are never more than one count from generated_count; they are at it two clocks after it has stood
//   stands             still, and where the rate is 0 for three clocks they stand still
//   direction          they step up only after a rate above 0 in one of the three clocks before, down after one below 0
//   z_with_a_b_low     Z is high only with A and B low
//   index_each_turn    with index_every as it was at the reset: Z is at count 0, and then each index_every counts (less the
//                      remainder by 4), in both directions, at no other count; none for 0 to 3
//   looped             with loop_back the outputs are the lines, complements as well, all low in reset
//   not_looped         without, they are the pins of the clock before
//   known_...          invariants
//
// Not proven here: the position of the index after a change of index_every.
module encoder_generator_properties (
    `PORTS,
    (* peek = "sum" *) input wire signed [63:0] sum,
    (* peek = "period" *) input wire [13:0] period,
    (* peek = "line_a" *) input wire line_a,
    (* peek = "line_b" *) input wire line_b,
    (* peek = "line_z" *) input wire line_z,
    (* peek = "moved" *) input wire moved
);
    // The sum of the rates, and the counts of the last three clocks.
    reg  [63:0] total = 64'd0;
    reg  [31:0] count_1 = 32'd0;
    reg  [31:0] count_2 = 32'd0;
    reg  [2:0]  up = 3'd0;
    reg  [2:0]  down = 3'd0;
    always @(posedge clk) begin
        total <= rst ? 64'd0 : total + {{32{rate[31]}}, rate};
        count_1 <= rst ? 32'd0 : generated_count;
        count_2 <= rst ? 32'd0 : count_1;
        up <= rst ? 3'd0 : {up[1:0], rate > 32'sd0};
        down <= rst ? 3'd0 : {down[1:0], rate < 32'sd0};
    end

    // The lines, and their count. Their code is 00, 01, 11, 10 for 0 to 3.
    reg         past_a = 1'b0;
    reg         past_b = 1'b0;
    reg         past_z = 1'b0;
    reg         past_step = 1'b0;
    reg         past_reset = 1'b1;
    reg  [31:0] counted_before = 32'd0;
    wire [1:0]  code = {line_b, line_b ^ line_a};
    wire [1:0]  past_code = {past_b, past_b ^ past_a};
    wire [1:0]  turned = code - past_code;
    wire        step = !past_reset & turned != 2'd0;
    wire [31:0] counted = past_reset ? 32'd0 : counted_before + {{30{turned[1]}}, turned};
    always @(posedge clk) begin
        past_a <= !rst & line_a;
        past_b <= !rst & line_b;
        past_z <= !rst & line_z;
        past_step <= !rst & step;
        past_reset <= rst;
        counted_before <= rst ? 32'd0 : counted;
    end

    wire signed [63:0] ahead = total - {counted, 32'd0};
    wire        [31:0] distance = generated_count - counted;
    always @(*) begin
        counts: assert (generated_count == total[63:32] & sum == total);
        one_line: assert (past_reset | !((line_a ^ past_a) & (line_b ^ past_b)));
        every_other_clock: assert (!(step & past_step));
        follows: assert (distance == 32'd0 | distance == 32'd1 | distance == 32'hffffffff);
        stands_at_count: assert (generated_count != count_1 | count_1 != count_2 | counted == generated_count);
        stands_still: assert (!step | (|up) | (|down));
        direction_up: assert (!(step & turned == 2'd1) | (|up));
        direction_down: assert (!(step & turned == 2'd3) | (|down));
        known_step: assert (moved == step);
        known_code: assert (code == counted[1:0]);
        known_ahead: assert (ahead >= (past_step ? -(64'sd1 << 32) : -(64'sd1 << 31))
            & ahead < (past_step ? 64'sd2 << 32 : 64'sd3 << 31));
        known_counted: assert (past_step ? counted == count_2 : counted == count_1);
        known_up: assert (count_1 == generated_count | (generated_count - count_1 == 32'd1 ? up[0]
            : generated_count - count_1 == 32'hffffffff & down[0]));
        known_up_before: assert (count_2 == count_1 | (count_1 - count_2 == 32'd1 ? up[1]
            : count_1 - count_2 == 32'hffffffff & down[1]));
    end

    // Counts since the last index, in periods of four, while index_every is constant.
    reg                stays = 1'b1;
    reg         [15:0] every = 16'd0;
    reg                begun = 1'b0;
    reg  signed [14:0] since = 15'sd0;
    reg                past_index = 1'b0;
    wire        [13:0] periods = index_every[15:2];
    wire        [63:0] total_next = total + {{32{rate[31]}}, rate};
    wire        [31:0] moves = total_next[63:34] - total[63:34];
    wire signed [14:0] since_next = since + (moves[29:0] == 30'd1 ? 15'sd1 : moves[29:0] == 30'h3fffffff ? -15'sd1 : 15'sd0);
    wire               whole_turn = since_next == $signed({1'b0, periods}) | since_next == -$signed({1'b0, periods});
    wire               index = periods != 14'd0 & since == 15'sd0 & generated_count[1:0] == 2'd0;
    wire               constant = stays & (!begun | index_every == every);
    always @(posedge clk) begin
        begun <= !rst;
        every <= index_every;
        stays <= rst | constant;
        since <= rst | periods == 14'd0 | whole_turn ? 15'sd0 : since_next;
        past_index <= !rst & index;
    end
    always @(*) begin
        z_with_a_b_low: assert (!line_z | (!line_a & !line_b));
        index_each_turn: assert (past_reset | !stays | line_z == (past_step ? past_z : past_index));
        known_period: assert (!constant | {1'b0, period} == (since < 15'sd0 ? since + $signed({1'b0, periods}) : since));
        known_turn: assert (!constant | periods == 14'd0 ? !constant | since == 15'sd0
            : since < $signed({1'b0, periods}) & since > -$signed({1'b0, periods}));
    end

    // The outputs.
    reg       past_loop = 1'b0;
    reg [5:0] past_pins = 6'd0;
    reg [2:0] past_lines = 3'd0;
    reg       past_clock = 1'b0;
    always @(posedge clk) begin
        past_clock <= 1'b1;
        past_loop <= loop_back;
        past_pins <= {pin_z_n, pin_b_n, pin_a_n, pin_z, pin_b, pin_a};
        past_lines <= {line_z, line_b, line_a} & {3{!rst}};
    end
    always @(*) begin
        looped: assert (!(past_clock & past_loop) | {z_n, b_n, a_n, z, b, a} == {~past_lines, past_lines});
        not_looped: assert (!(past_clock & !past_loop) | {z_n, b_n, a_n, z, b, a} == past_pins);
    end

    always @(*) begin
        reach_up: cover (step & turned == 2'd1);
        reach_down: cover (step & turned == 2'd3);
        reach_left_out: cover (past_step & distance == 32'hffffffff);
        reach_index: cover (past_loop & z & counted == 32'd8);
        reach_index_below: cover (past_loop & z & counted == -32'd8);
    end
endmodule
