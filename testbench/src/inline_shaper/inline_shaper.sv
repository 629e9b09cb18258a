// inline_shaper: an axis as its blocks are wired: what has come out of a settled axis is what went in, whatever the shaper says.
//
// The properties are proven for all inputs in every clock, including resets and ticks at any distance; nothing is assumed. Pulse
// counter, inline axis and step generator are there; the shaper is left out, so the position that it gives is any, in every clock.
// Steps in are read here from the filtered lines, steps out from the pins of the drive, as a drive reads them.
//
//   counts_in          the pulse counter's count is the sum of the steps on the filtered lines, modulo 2^32
//   counts_out         the step generator's count is the sum of the steps on the pins of the drive, modulo 2^32
//   settled_exact      settled: up to the clock before, as many steps have come out as went in since the axis began to follow
//   settled_follows    settled: the axis has followed since then
//   idle_rests         no step comes out one clock after the axis did not follow
//   known_...          invariants
//
// Not proven here: that an axis at rest is settled in bounded time, and stays; that is the shaper's: see docs/inline.md.
module inline_shaper_properties (
    `PORTS,
    (* peek = "follow" *) input wire follow,
    (* peek = "count" *) input wire [31:0] count,
    (* peek = "given" *) input wire [31:0] given,
    (* peek = "u_inline_axis.offset" *) input wire [31:0] offset,
    (* peek = "u_pulse_counter.level_a" *) input wire level_a,
    (* peek = "u_pulse_counter.level_b" *) input wire level_b,
    (* peek = "u_pulse_counter.ready" *) input wire ready,
    (* peek = "u_pulse_counter.u_decoder.a_before" *) input wire a_before,
    (* peek = "u_pulse_counter.u_decoder.b_before" *) input wire b_before,
    (* peek = "u_step_generator.u_pulser.up_q" *) input wire up,
    (* peek = "u_step_generator.u_pulser.pulsing" *) input wire pulsing,
    (* peek = "u_step_generator.u_pulser.may_step" *) input wire may_step,
    (* peek = "u_step_generator.u_pulser.may_turn" *) input wire may_turn
);
    localparam [1:0] STEP_DIRECTION = 2'd0;
    localparam [1:0] UP_DOWN = 2'd1;
    localparam [1:0] QUADRATURE = 2'd2;

    // Steps in, by the levels of this clock and of the one before.
    reg         in_a = 1'b0;
    reg         in_b = 1'b0;
    wire [1:0]  in_advance = {level_b, level_b ^ level_a} - {in_b, in_b ^ in_a};
    wire        in_up = `IN_MODE == STEP_DIRECTION ? level_a & !in_a & level_b
        : `IN_MODE == UP_DOWN ? level_a & !in_a & !(level_b & !in_b) : in_advance == 2'd1;
    wire        in_down = `IN_MODE == STEP_DIRECTION ? level_a & !in_a & !level_b
        : `IN_MODE == UP_DOWN ? level_b & !in_b & !(level_a & !in_a) : in_advance == 2'd3;
    reg  [31:0] came_in = 32'd0;
    always @(posedge clk) begin
        in_a <= !rst & level_a;
        in_b <= !rst & level_b;
        came_in <= rst ? 32'd0 : came_in + (ready & in_up ? 32'd1 : 32'd0) - (ready & in_down ? 32'd1 : 32'd0);
    end

    // Steps out, by the pins of this clock and of the one before.
    wire        on_a = `LINE_A ^ `A_OFF;
    wire        on_b = `LINE_B ^ `B_OFF;
    reg         out_a = 1'b0;
    reg         out_b = 1'b0;
    reg         past_reset = 1'b1;
    wire [1:0]  code = {on_b, on_b ^ on_a};
    wire [1:0]  out_advance = code - {out_b, out_b ^ out_a};
    wire        out_up = !past_reset & (`OUT_MODE == STEP_DIRECTION ? on_a & !out_a & on_b
        : `OUT_MODE == UP_DOWN ? on_a & !out_a : out_advance == 2'd1);
    wire        out_down = !past_reset & (`OUT_MODE == STEP_DIRECTION ? on_a & !out_a & !on_b
        : `OUT_MODE == UP_DOWN ? on_b & !out_b : out_advance == 2'd3);
    reg  [31:0] came_out_before = 32'd0;
    wire [31:0] came_out = past_reset ? 32'd0 : came_out_before + {31'd0, out_up} - {31'd0, out_down};
    always @(posedge clk) begin
        out_a <= !rst & on_a;
        out_b <= !rst & on_b;
        past_reset <= rst;
        came_out_before <= rst ? 32'd0 : came_out;
    end

    // Both sums when the axis began to follow, and in the clock before.
    reg  [31:0] in_at_start = 32'd0;
    reg  [31:0] out_at_start = 32'd0;
    reg  [31:0] past_in = 32'd0;
    reg  [31:0] past_out = 32'd0;
    reg         followed = 1'b0;
    always @(posedge clk) begin
        past_in <= came_in;
        past_out <= came_out;
        followed <= !rst & follow;
        if (rst) begin
            in_at_start <= 32'd0;
            out_at_start <= 32'd0;
        end else if (tick & !follow) begin
            in_at_start <= came_in;
            out_at_start <= came_out;
        end
    end

    always @(*) begin
        counts_in: assert (count == came_in);
        counts_out: assert (given == came_out);
        settled_exact: assert (!settled | past_in - in_at_start == past_out - out_at_start);
        settled_follows: assert (!settled | (followed & follow));
        idle_rests: assert (followed | !(out_up | out_down));
        known_offset: assert (offset == in_at_start - out_at_start);
        known_levels: assert (in_a == a_before & in_b == b_before);
        known_pulse: assert (!pulsing | (!may_step & !may_turn));
        known_lines: assert (`OUT_MODE == STEP_DIRECTION ? (on_a == pulsing & on_b == up)
            : `OUT_MODE == UP_DOWN ? (on_a == (pulsing & up) & on_b == (pulsing & !up)) : code == given[1:0]);
        known_reset: assert (!past_reset | (!on_a & !on_b));
    end

    always @(*) begin
        reach_follow: cover (follow & came_in != 32'd0);
        reach_step: cover (out_up | out_down);
    end
endmodule
