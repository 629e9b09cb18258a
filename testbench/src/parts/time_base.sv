// time_base: counters of clocks and of ticks, and a tick every TICK_CLOCKS clocks.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. The counters begin with BEGIN: 0,
// as after a reset, or a few clocks before they wrap, which no search would reach from 0.
//
//   tick_after_all     a tick comes TICK_CLOCKS clocks after the one before or a reset, and at no other time
//   divide_follows     divide is the tick, a clock later
//   stamp_counts       the time stamp is one more in every clock, modulo 2^32, and 0 after a reset
//   edge_stamp_is_part the stamp of edges is its lower 24 bits
//   ticks_count        the tick count is one more with every tick, in its clock, and 0 after a reset
//   known_phase        an invariant
module time_base_properties (
    `PORTS,
    (* peek = "phase" *) input wire [16:0] phase
);
    // Clocks since the last tick or reset.
    reg [16:0] since = 17'd0;
    reg        due = 1'b0;
    reg        past_tick = 1'b0;
    reg        past_reset = `BEGIN == 32'd0;
    reg [31:0] past_stamp = `BEGIN - 32'd1;
    reg [31:0] past_count = `BEGIN;
    always @(posedge clk) begin
        since <= rst | since == `TICK_CLOCKS - 17'd1 ? 17'd0 : since + 17'd1;
        due <= !rst & since == `TICK_CLOCKS - 17'd1;
        past_tick <= !rst & tick;
        past_reset <= rst;
        past_stamp <= time_stamp;
        past_count <= tick_count;
    end

    always @(*) begin
        known_phase: assert (phase == since & since < `TICK_CLOCKS);
        tick_after_all: assert (tick == due);
        divide_follows: assert (divide == past_tick);
        stamp_counts: assert (time_stamp == (past_reset ? 32'd0 : past_stamp + 32'd1));
        edge_stamp_is_part: assert (edge_stamp == time_stamp[23:0]);
        ticks_count: assert (tick_count == (past_reset ? 32'd0 : past_count + {31'd0, tick}));
    end

    always @(*) begin
        reach_tick: cover (tick);
        reach_divide: cover (divide);
    end
endmodule
