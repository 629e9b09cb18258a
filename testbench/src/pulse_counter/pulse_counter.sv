// pulse_counter: the count of a closed loop never jumps.
//
// The properties are proven for all inputs in every clock, including resets, with 32-bit counts; nothing is assumed. A and B are
// taken after synchroniser and filter, as the ports level_a and level_b show them.
//
//   count_by_one         the count moves by one or stays; only a reset makes it 0
//   position             position = count - origin, modulo 2^32
//   illegal_flags        A and B changed together, in a quadrature mode: flagged, and counted
//   illegal_counts_not   ... and the count stays
//   step_counts          times 4: one of A and B changed: the count moves, up if A leads (unless swapped or inverted)
//   rest_stays           times 4: no change, no count
//   *_held               flags stay until clear_flags
//   illegal_saturates    the count of illegal transitions never wraps
//   index_latches        the index latches the count after a step of the same clock
//   seen_once            index_seen is high for the clock after it, and for no other
//   origin_stays         only preset, or an index that presets, moves the origin, in the clock after it
//
// Not proven here: synchroniser and filter (their delay is in the lock step), and the velocity.
module pulse_counter_properties (
    `PORTS,
    (* peek = "ready" *) input wire ready,
    (* peek = "index" *) input wire index,
    (* peek = "presets" *) input wire presets,
    (* peek = "u_decoder.a_before" *) input wire a_before,
    (* peek = "u_decoder.b_before" *) input wire b_before
);
    reg               past_reset = 1'b1;
    reg               past_ready = 1'b0;
    reg               past_clear = 1'b0;
    reg               past_preset = 1'b0;
    reg               past_index = 1'b0;
    // Values of the clock before that.
    reg               last_preset = 1'b0;
    reg               past_illegal = 1'b0;
    reg               past_disagreement = 1'b0;
    reg               past_up = 1'b0;
    reg [2:0]         past_mode = 3'd0;
    reg [7:0]         past_illegal_count = 8'd0;
    reg signed [31:0] past_count = 32'sd0;
    reg signed [31:0] past_plus_one = 32'sd1;
    reg signed [31:0] past_minus_one = -32'sd1;
    reg signed [31:0] past_origin = 32'sd0;
    // The levels of the clock before that, and what has changed since.
    reg               last_a = 1'b0;
    reg               last_b = 1'b0;
    reg               moved_a = 1'b0;
    reg               moved_b = 1'b0;
    always @(posedge clk) begin
        past_reset <= rst;
        past_ready <= ready;
        past_clear <= clear_flags;
        past_preset <= preset & !rst;
        past_index <= index & index_presets & !rst;
        last_preset <= past_preset | past_index;
        past_illegal <= illegal;
        past_disagreement <= disagreement;
        past_mode <= mode;
        past_illegal_count <= illegal_count;
        past_count <= count;
        past_plus_one <= count + 32'sd1;
        past_minus_one <= count - 32'sd1;
        past_origin <= origin;
        last_a <= level_a & !rst;
        last_b <= level_b & !rst;
        moved_a <= level_a != last_a;
        moved_b <= level_b != last_b;
        // A leads if A now differs from B before; with swapped lines, if B now differs from A before.
        past_up <= (swap ? level_b != last_a : level_a != last_b) != invert;
    end

    reg  past_index_alone = 1'b0;
    always @(posedge clk) past_index_alone <= index;

    wire               live = !past_reset & past_ready;
    wire               both = live & moved_a & moved_b & past_mode < 3'd3;
    wire               rests = count == past_count;
    wire               rises = count == past_plus_one;
    wire               falls = count == past_minus_one;
    always @(*) begin
        known_presets: assert (presets == (past_preset | past_index));
        known_levels: assert (last_a == a_before & last_b == b_before);
        count_by_one: assert (past_reset ? count == 32'sd0 : rests | rises | falls);
        position_is_difference: assert (position == count - origin);
        illegal_flags: assert (!both | (illegal & illegal_count != 8'd0));
        illegal_counts_not: assert (!both | rests);
        step_counts: assert (!(live & past_mode == 3'd0 & moved_a != moved_b) | (past_up ? rises : falls));
        rest_stays: assert (!(live & past_mode == 3'd0 & !moved_a & !moved_b) | rests);
        illegal_held: assert (!(past_illegal & !past_clear & !past_reset) | illegal);
        seen_once: assert (index_seen == (past_index_alone & !past_reset));
        disagreement_held: assert (!(past_disagreement & !past_clear & !past_reset) | disagreement);
        illegal_saturates: assert (past_clear | past_reset | illegal_count >= past_illegal_count);
        index_latches: assert (!(past_index_alone & !past_reset) | index_count == count);
        origin_stays: assert (past_reset | last_preset | origin == past_origin);
    end

    always @(*) begin
        reach_up: cover (live & rises);
        reach_down: cover (live & falls);
        reach_illegal: cover (both);
        reach_index: cover (past_index_alone & !past_reset);
        reach_preset: cover (last_preset & origin != past_origin);
    end
endmodule
