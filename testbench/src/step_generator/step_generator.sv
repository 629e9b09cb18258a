// step_generator: what a drive sees at its inputs, and that no step is lost.
//
// Proven for all inputs in every clock, resets and ticks at any distance included; nothing is assumed. The lines are read here as
// a drive reads them: a rising edge of a is a step in the direction of b; or an edge of a up, of b down; or a change of Gray code.
//
//   counts             count is the sum of the edges on the lines since the reset, modulo 2^32
//   pulse, space       a pulse lasts PULSE clocks, and SPACE clocks are between two; in quadrature both are between two edges.
//                      A reset ends a pulse at once; after it these times hold as if all lines had just changed
//   setup, hold        the direction changes HOLD clocks after a pulse or later, and SETUP clocks before the next or earlier; up and
//                      down, or both ways in quadrature, are apart by their sum
//   disabled_rests     no pulse begins, and no direction changes, one clock after enable was low
//   stopped_rests      nor while a cause stands, or while the block is not active; `tripped` says that a cause stands (trips)
//   owed_bounded       at most one step more than the limit is ever owed, and that is a cause in the next clock
//   nothing_lost       the steps given and owed are those demanded since the block is active
//   exact              the demanded steps are the position of the last tick, rounded half up, when its clocks are over; proven at
//                      4 clocks per tick, because the product is multiplied out
//
// Not proven here: the clock in which an edge comes (model/blocks/tests/step_generator.rs); exact at longer ticks, which only
// constants distinguish. `known_...` are invariants.
module step_generator_properties (
    `PORTS,
    (* peek = "owed_q" *) input wire [15:0] owed_word,
    (* peek = "u_interpolation.taken" *) input wire [31:0] taken,
    (* peek = "u_interpolation.difference" *) input wire [31:0] difference,
    (* peek = "u_interpolation.fresh" *) input wire fresh,
    (* peek = "u_interpolation.moving" *) input wire moving,
    (* peek = "u_interpolation.phase" *) input wire [16:0] phase,
    (* peek = "u_interpolation.sum" *) input wire [`SUM_BITS-1:0] sum,
    (* peek = "u_interpolation.downwards" *) input wire downwards,
    (* peek = "u_interpolation.halfway" *) input wire halfway,
    (* peek = "u_interpolation.moved" *) input wire moved,
    (* peek = "u_pulser.up_q" *) input wire up,
    (* peek = "u_pulser.pulsing" *) input wire pulsing,
    (* peek = "u_pulser.turned" *) input wire turned,
    (* peek = "u_pulser.may_step" *) input wire may_step,
    (* peek = "u_pulser.may_turn" *) input wire may_turn,
    (* peek = "u_pulser.timer" *) input wire [15:0] timer
);
    localparam [1:0] STEP_DIRECTION = 2'd0;
    localparam [1:0] UP_DOWN = 2'd1;
    localparam [1:0] QUADRATURE = 2'd2;

    // The lines, and the steps that a drive reads.
    wire       on_a = a ^ `A_OFF;
    wire       on_b = b ^ `B_OFF;
    reg        past_a = 1'b0;
    reg        past_b = 1'b0;
    reg        past_reset = 1'b1;
    reg        past_enable = 1'b0;
    reg        past_active = 1'b0;
    wire [1:0] code = {on_b, on_b ^ on_a};
    wire [1:0] past_code = {past_b, past_b ^ past_a};
    wire [1:0] advance = code - past_code;
    wire       steps_up = !past_reset & (`MODE == STEP_DIRECTION ? on_a & !past_a & on_b
        : `MODE == UP_DOWN ? on_a & !past_a : advance == 2'd1);
    wire       steps_down = !past_reset & (`MODE == STEP_DIRECTION ? on_a & !past_a & !on_b
        : `MODE == UP_DOWN ? on_b & !past_b : advance == 2'd3);
    wire       step = steps_up | steps_down;
    reg [31:0] counted_before = 32'd0;
    wire [31:0] counted = past_reset ? 32'd0 : counted_before + {32{steps_down}} + {31'd0, steps_up};
    always @(posedge clk) begin
        past_a <= !rst & on_a;
        past_b <= !rst & on_b;
        past_reset <= rst;
        past_enable <= enable & !rst;
        past_active <= active & !rst;
        counted_before <= rst ? 32'd0 : counted;
    end

    // Clocks of the pulse, clocks since it ended, and clocks since the direction changed. In quadrature a step takes the place of
    // a pulse's beginning, and the pulse is not seen on the lines.
    wire        pulse_on = `MODE == STEP_DIRECTION ? on_a : `MODE == UP_DOWN ? on_a | on_b : pulsing;
    reg         past_on = 1'b0;
    reg  [16:0] on_for = 17'd0;
    reg  [16:0] off_for = 17'd0;
    reg  [16:0] turned_before = 17'd0;
    reg         past_up = 1'b0;
    wire        now_up = `MODE == STEP_DIRECTION ? on_b : up;
    wire        changed = !past_reset & (now_up ^ past_up);
    wire [16:0] turned_for = changed ? 17'd0 : turned_before;
    always @(posedge clk) begin
        past_on <= !rst & pulse_on;
        past_up <= !rst & now_up;
        on_for <= rst | !pulse_on ? 17'd0 : on_for + 17'd1;
        off_for <= rst | pulse_on ? 17'd0 : (&off_for) ? off_for : off_for + 17'd1;
        turned_before <= rst ? 17'd0 : (&turned_for) ? turned_for : turned_for + 17'd1;
    end
    wire begins = pulse_on & !past_on;
    wire ends = !pulse_on & past_on & !past_reset;
    always @(*) begin
        counts: assert (count == counted);
        one_line: assert (past_reset | `MODE == STEP_DIRECTION | !((on_a ^ past_a) & (on_b ^ past_b)));
        never_both: assert (`MODE != UP_DOWN | !(on_a & on_b));
        pulse: assert (!ends | on_for == `PULSE);
        space: assert (!begins | off_for >= `SPACE);
        setup: assert (!begins | turned_for >= `SETUP);
        hold: assert (!changed | (!pulse_on & off_for >= `HOLD));
        opposite_apart: assert (!(steps_up | steps_down) | begins);
        pulse_is_step: assert (!begins | step);
        direction_shown: assert (!step | (steps_up ? up : !up));
        disabled_rests: assert (past_enable | !(begins | changed));
        stopped_rests: assert (past_active | !(begins | changed));
        reset_is_off: assert (!past_reset | (!on_a & !on_b));
        known_pulse: assert (pulsing == pulse_on & up == now_up);
        known_lines: assert (`MODE == STEP_DIRECTION ? (on_a == pulsing & on_b == up)
            : `MODE == UP_DOWN ? (on_a == (pulsing & up) & on_b == (pulsing & !up)) : code == count[1:0]);
        known_on: assert (!pulsing | ({1'b0, timer} == on_for + 17'd1 & on_for < `PULSE & !turned & !may_step & !may_turn));
        known_past: assert (past_on == (on_for != 17'd0));
        known_off: assert (pulsing | past_on == (off_for == 17'd0 & past_on));
        known_timer: assert (pulsing | {2'b0, timer} <= {1'b0, turned ? turned_for : off_for} + 18'd1);
        known_turned: assert (!turned | turned_for <= off_for);
        known_rested: assert (!may_step | (turned ? turned_for >= `TURNED : off_for >= `SPACE));
        known_held: assert (!may_turn | off_for >= `HOLD);
        known_setup: assert (turned | turned_for >= `SETUP);
    end

    // Steps owed.
    wire signed [15:0] owed_steps = owed;
    reg                past_too_many = 1'b0;
    always @(posedge clk) past_too_many <= !rst & (owed_steps > `OWED_LIMIT | owed_steps < -`OWED_LIMIT);
    always @(*) begin
        owed_bounded_up: assert (owed_steps <= `OWED_LIMIT + 16'sd1);
        owed_bounded_down: assert (owed_steps >= -`OWED_LIMIT - 16'sd1);
        owed_is_a_cause: assert (!past_too_many | (owed_exceeded & !active));
        known_owed: assert ((owed_word & ~`USED_OWED) == 16'd0);
        owed_only_while_active: assert (active | owed == 16'd0);
        cause_stops: assert (!active | !(too_fast | owed_exceeded));
        trips: assert (tripped == (too_fast | owed_exceeded));
    end

    // Steps demanded. While the block is active, `demanded` is their sum, beginning at the rounded position.
    wire               passed = downwards ~^ sum[`SUM_BITS-1];
    wire               demands = moved & passed;
    wire               stands = tick & enable & !active & !too_fast & !owed_exceeded;
    reg         [31:0] demanded = 32'd0;
    reg         [31:0] given_before = 32'd0;
    always @(posedge clk) begin
        if (stands) begin
            demanded <= rounded(position);
            given_before <= rounded(position) - count;
        end else begin
            demanded <= demanded + (demands ? (downwards ? 32'hffffffff : 32'd1) : 32'd0);
        end
    end
    function [31:0] rounded(input [31:0] word);
        reg signed [33:0] more;
        begin
            more = $signed({word[31], word[31], word}) + $signed((34'd1 << `FRACTION) >> 1);
            rounded = more >>> `FRACTION;
        end
    endfunction
    always @(*) begin
        nothing_lost: assert (!active | count + given_before + {{16{owed[15]}}, owed} == demanded);
    end

    // The line from sample to sample, in units, modulo 2^34: 4 clocks of 32-bit positions.
    wire signed [33:0] sum_units = {{(34-`SUM_BITS){sum[`SUM_BITS-1]}}, sum};
    wire signed [33:0] units = `STEP_UNITS;
    wire signed [33:0] largest = `LARGEST;
    wire signed [33:0] above_units = halfway ? units / 34'sd2 : sum_units + (downwards == passed ? units : 34'sd0);
    wire signed [33:0] moves = {{2{difference[31]}}, difference};
    wire        [33:0] left = moving ? 34'd`TICK_CLOCKS - {17'd0, phase} : 34'd0;
    wire        [33:0] line = {2'b00, taken} * 34'd`TICK_CLOCKS - (left[0] ? moves : 34'd0) - (left[1] ? moves * 34'sd2 : 34'sd0)
        - (left[2] ? moves * 34'sd4 : 34'sd0);
    wire        [31:0] with_pending = demanded + (demands ? (downwards ? 32'hffffffff : 32'd1) : 32'd0);
    wire        [31:0] off_by = with_pending - rounded(taken);
    always @(*) begin
        exact: assert (!`EXACT | !active | moving | (off_by << `FRACTION) == 32'd0);
        known_line: assert (!`EXACT | !active | line == with_pending * units + above_units - units / 34'sd2);
        known_sum: assert (!`EXACT | !active | (moving & fresh) | (moves <= largest & moves >= -largest) | !moving);
        known_below: assert (!`EXACT | !active | sum_units >= (downwards ? -largest : -units));
        known_above: assert (!`EXACT | !active | sum_units < (downwards ? units : largest));
        known_halfway: assert (!`EXACT | !active | !halfway | (sum_units == 34'sd0 & !downwards & !moved));
    end

    always @(*) begin
        known_moving: assert (active | !moving);
        known_fresh: assert (!fresh | moving);
        known_phase: assert (phase < `TICK_CLOCKS & (moving | !active | phase == 17'd0) & (!fresh | phase == 17'd0));
    end

    always @(*) begin
        reach_up: cover (steps_up & count == 32'd2);
        reach_down: cover (steps_down & count == 32'hfffffffe);
    end
endmodule
