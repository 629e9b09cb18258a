// inline_axis: what is settled is exact, an axis begins where its input stands, and stops at once.
//
// Proven for all inputs in every clock, resets and ticks at any distance included; nothing is assumed, so count and given may
// change in any way.
//
//   settled_exact      settled: in the clock before, the steps of the output since the axis began to follow were those of the input
//   settled_stands     and no tick has brought a step for SETTLE ticks
//   settled_follows    and the axis followed
//   begins_at_tick     an axis begins to follow at a tick only, with run and without a cause
//   begins_at_input    the sample of that tick is the input's count, and the shaper restarts there
//   restarts           the shaper restarts exactly at the ticks at which the axis did not follow
//   stops_at_once      one clock after run was low, or a cause came, it does not follow
//   samples            one clock after a tick, x is the count of the tick, with a strobe; between ticks it stands
//   too_fast           a tick with more than LIMIT steps is a cause exactly while the axis follows
//   causes_last        a cause lasts until it is cleared; a fault is one of the causes
//   chosen             position is x or the shaped position of the clock before, as `unshaped` says
//   lines              the lines are the pins of the clock before, high if they are active
//   known_...          invariants
//
// Not proven here: that the step generator's count is that of its pulses, and the pulse counter's that of its edges: see theirs.
module inline_axis_properties (
    `PORTS,
    (* peek = "sampled" *) input wire [23:0] sampled,
    (* peek = "stood" *) input wire [13:0] stood,
    (* peek = "offset" *) input wire [31:0] offset
);
    reg         past_reset = 1'b1;
    reg         past_tick = 1'b0;
    reg         past_run = 1'b0;
    reg         past_follow = 1'b0;
    reg         past_clear = 1'b0;
    reg         past_unshaped = 1'b0;
    reg         past_cause = 1'b0;
    reg         past_stops = 1'b0;
    reg         past_illegal = 1'b0;
    reg         past_pin_a = 1'b0;
    reg         past_pin_b = 1'b0;
    reg         pins_known = 1'b0;
    reg  [2:0]  past_causes = 3'd0;
    reg  [31:0] past_count = 32'd0;
    reg  [31:0] past_given = 32'd0;
    reg  [31:0] past_shaped = 32'd0;
    reg  [31:0] past_x = 32'd0;
    // Counts of both sides when the axis began to follow, and ticks since the last step.
    reg  [31:0] count_at_start = 32'd0;
    reg  [31:0] given_at_start = 32'd0;
    reg  [13:0] quiet_ticks = 14'd0;
    wire [17:0] steps = count[17:0] - sampled[17:0];
    wire [17:0] size = steps[17] ? -steps : steps;
    wire        exceeds = tick & follow & size > `LIMIT;
    wire        stops = follow & (too_fast | owed_exceeded);
    always @(posedge clk) begin
        past_reset <= rst;
        past_tick <= tick & !rst;
        past_run <= run & !rst;
        past_follow <= follow & !rst;
        past_clear <= clear;
        past_unshaped <= unshaped;
        past_cause <= !rst & exceeds;
        past_stops <= !rst & stops;
        past_illegal <= !rst & follow & illegal;
        past_pin_a <= pin_a;
        past_pin_b <= pin_b;
        pins_known <= 1'b1;
        past_causes <= rst ? 3'd0 : {input_illegal, steps_stopped, input_too_fast};
        past_count <= count;
        past_given <= given;
        past_shaped <= shaped;
        past_x <= rst ? 32'd0 : x;
        if (rst) begin
            count_at_start <= 32'd0;
            given_at_start <= 32'd0;
            quiet_ticks <= 14'd0;
        end else if (tick & !follow) begin
            count_at_start <= count;
            given_at_start <= given;
            quiet_ticks <= 14'd0;
        end else if (tick) begin
            quiet_ticks <= steps != 18'd0 ? 14'd0 : quiet_ticks == `SETTLE ? `SETTLE : quiet_ticks + 14'd1;
        end
    end

    // quiet_ticks of the clock before.
    reg [13:0] past_quiet = 14'd0;
    always @(posedge clk) past_quiet <= rst ? 14'd0 : quiet_ticks;

    always @(*) begin
        settled_exact: assert (!settled | past_count - count_at_start == past_given - given_at_start);
        settled_stands: assert (!settled | past_quiet == `SETTLE);
        settled_follows: assert (!settled | (past_follow & follow));
        begins_at_tick: assert (!(follow & !past_follow) | (past_tick & past_run & past_causes == 3'd0));
        begins_at_input: assert (!(follow & !past_follow) | (start & strobe & x == past_count << 8));
        restarts: assert (start == (past_tick & !past_follow));
        stops_at_once: assert (!follow | (past_run & past_causes == 3'd0 & !past_cause & !past_stops & !past_illegal));
        samples: assert (strobe == past_tick & x == (past_tick ? past_count << 8 : past_x));
        too_fast_is_a_cause: assert (!past_cause | input_too_fast);
        only_too_fast: assert (!input_too_fast | past_causes[0] | past_cause);
        stopped_is_a_cause: assert (!past_stops | steps_stopped);
        illegal_is_a_cause: assert (!past_illegal | input_illegal);
        causes_last: assert (past_reset | past_clear | (past_causes & ~{input_illegal, steps_stopped, input_too_fast}) == 3'd0);
        fault_is_cause: assert (fault == (input_illegal | steps_stopped | input_too_fast));
        chosen: assert (past_reset | position == (past_unshaped ? past_x : past_shaped));
        lines: assert (!pins_known | (a == (past_pin_a ^ `A_LOW) & b == (past_pin_b ^ `B_LOW)));
        known_x: assert (x == {sampled, 8'd0});
        known_stood: assert (stood == quiet_ticks);
        known_offset: assert (offset == count_at_start - given_at_start);
        known_fault: assert (!follow | !fault);
        known_strobe: assert (!past_reset | !(strobe | start | follow | settled));
    end

    always @(*) begin
        reach_follow: cover (follow & x != 32'd0);
        reach_fault: cover (input_too_fast);
    end
endmodule
