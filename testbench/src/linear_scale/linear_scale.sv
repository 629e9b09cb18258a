// linear_scale: when deviation and velocity are ready, how long they stay, how they are computed, and the effect of align.
//
// The properties are proven for all inputs in every clock, including resets. Assumed, as docs/linear_scale.md says: `use_scale` and
// `ratio_shift` change in reset only; from another change on nothing is claimed until the next reset. Ticks and velocities come at
// any time.
//
//   position_is        position is that of the counter that the loop runs on, a clock late
//   valid_in_time      a tick is taken unless one waits or is being computed; deviation_valid comes 65 clocks after it, or later
//                      by what is left of a velocity's pass, 63 clocks at most; for each such tick once, at no other time
//   velocity_in_time   with use_scale a velocity is new 65 clocks after it is taken, later by the pass of a position that is
//                      under way or starts with it; never later than 129
//   velocity_past      without use_scale the velocity is the motor's, a clock late
//   deviation_stays    deviation changes from its valid to the next tick or align in no clock
//   velocity_stays     velocity changes from the end of its pass to the next velocity_valid in no clock
//   align_at_once      after an align it is 0 in the next clock, unless a tick is taken or computed
//   align_counts       it is 0 with deviation_valid if an align has come since the one before, and in the next one too, if the
//                      align came in the pass
//   align_takes        a pass of a tick before whose start an align has come leaves both references as that tick's positions
//   reference_stays    any other pass leaves them as they were
//   shows_...          the multiplier is shown, bit by bit, the positions of the tick and both references, or the velocity
//   result_...         its 32 bits are then deviation, unless align makes it 0, or velocity; where it says that they overflow, the
//                      end of the word is
//   known_...          invariants
//
// serial_ratio.sv proves what the multiplier computes from the bits.
module linear_scale_properties (
    `PORTS,
    (* peek = "positions_wait" *) input wire positions_wait,
    (* peek = "velocity_waits" *) input wire velocity_waits,
    (* peek = "runs" *) input wire runs,
    (* peek = "of_position" *) input wire of_position,
    (* peek = "asked" *) input wire asked,
    (* peek = "aligning" *) input wire aligning,
    (* peek = "other" *) input wire [31:0] other,
    (* peek = "operand_reference" *) input wire [31:0] operand_reference,
    (* peek = "other_reference" *) input wire [31:0] other_reference,
    (* peek = "u_serial.phase" *) input wire [5:0] phase,
    (* peek = "u_serial.begun_q" *) input wire begun,
    (* peek = "u_serial.ended_q" *) input wire ended,
    (* peek = "u_serial.operand_bit" *) input wire operand_bit,
    (* peek = "u_serial.operand_reference_bit" *) input wire operand_reference_bit,
    (* peek = "u_serial.other_bit" *) input wire other_bit,
    (* peek = "u_serial.other_reference_bit" *) input wire other_reference_bit,
    (* peek = "u_serial.result_bit" *) input wire result_bit,
    (* peek = "u_serial.overflows" *) input wire overflows,
    (* peek = "u_serial.negative" *) input wire negative
);
    // The tied inputs are as in the previous clock, unless that was a reset.
    reg        first = 1'b1;
    reg        past_reset = 1'b1;
    reg        was_tied = 1'b1;
    reg        tied_use = 1'b0;
    reg  [4:0] tied_shift = 5'd0;
    wire       tied = was_tied & (first | past_reset | (use_scale == tied_use & ratio_shift == tied_shift));

    // Clocks until the result of a tick, and of a velocity; 0 if none is being computed.
    reg  [7:0] left = 8'd0;
    reg  [7:0] velocity_left = 8'd0;
    wire       takes = tick & left == 8'd0;
    wire       takes_velocity = velocity_valid & use_scale & velocity_left == 8'd0;
    wire [7:0] velocity_runs = velocity_left == 8'd0 | velocity_left > 8'd64 ? 8'd0 : velocity_left - 8'd1;
    wire [7:0] position_runs = takes ? 8'd64 + velocity_runs : left == 8'd0 ? 8'd0 : left - 8'd1;
    wire [7:0] done = 8'd64 - left;
    wire       works = left != 8'd0 & left <= 8'd64;
    wire       starts = left == 8'd65 | (takes & velocity_runs == 8'd0);

    // Align has come since the last valid or with it; and before the start of this pass.
    reg        since_valid = 1'b0;
    reg        before_start = 1'b0;
    reg        in_pass = 1'b0;
    reg [31:0] operand = 32'd0;
    reg [31:0] beside = 32'd0;
    reg [31:0] zero_operand = 32'd0;
    reg [31:0] zero_beside = 32'd0;

    reg        past_takes = 1'b0;
    reg        past_align = 1'b0;
    reg        past_ends = 1'b0;
    reg        past_silent = 1'b0;
    reg        past_works = 1'b0;
    reg        past_idle = 1'b1;
    reg        past_valid_velocity = 1'b0;
    reg        past_velocity_idle = 1'b1;
    reg [31:0] past_loop = 32'd0;
    reg [31:0] past_motor_velocity = 32'd0;
    reg [31:0] past_deviation = 32'd0;
    reg [31:0] past_velocity = 32'd0;
    always @(posedge clk) begin
        first <= 1'b0;
        past_reset <= rst;
        was_tied <= rst | tied;
        tied_use <= use_scale;
        tied_shift <= ratio_shift;
        left <= rst ? 8'd0 : position_runs;
        velocity_left <= rst ? 8'd0 : takes_velocity ? 8'd64 + position_runs
            : velocity_left == 8'd0 ? 8'd0 : velocity_left - 8'd1;
        // A request before a pass is for this pass; one during a pass is for it and the next one.
        if (rst) begin
            before_start <= 1'b0;
            in_pass <= 1'b0;
        end else if (starts) begin
            before_start <= in_pass | align;
            in_pass <= 1'b0;
        end else in_pass <= in_pass | align;
        since_valid <= !rst & (left == 8'd1 ? 1'b0 : since_valid | align);
        if (takes) begin
            operand <= use_scale ? motor_position : scale_position;
            beside <= use_scale ? scale_position : motor_position;
        end
        if (rst) begin
            zero_operand <= 32'd0;
            zero_beside <= 32'd0;
        end else if (left == 8'd1 & before_start) begin
            zero_operand <= operand;
            zero_beside <= beside;
        end
        past_takes <= takes;
        past_align <= align;
        past_ends <= !rst & left == 8'd1;
        past_silent <= since_valid | align | before_start;
        past_works <= works;
        past_idle <= left == 8'd0;
        past_valid_velocity <= velocity_valid;
        past_velocity_idle <= velocity_left == 8'd0;
        past_loop <= use_scale ? scale_position : motor_position;
        past_motor_velocity <= motor_velocity;
        past_deviation <= deviation;
        past_velocity <= velocity;
    end

    always @(*) begin
        position_is: assert (past_reset | position == past_loop);
        valid_in_time: assert (!tied | deviation_valid == past_ends);
        velocity_past: assert (!tied | past_reset | use_scale | !past_valid_velocity | velocity == past_motor_velocity);
        deviation_stays: assert (!tied | past_reset | !past_idle | past_takes | past_align | deviation == past_deviation);
        velocity_stays: assert (!tied | past_reset | !past_velocity_idle | past_valid_velocity | velocity == past_velocity);
        align_at_once: assert (!tied | past_reset | !past_align | !past_idle | past_takes | deviation == 32'sd0);
        align_counts: assert (!tied | !past_ends | !past_silent | deviation == 32'sd0);
        known_left: assert (!tied | (left <= 8'd127 & positions_wait == (left != 8'd0)));
        velocity_in_time: assert (!tied | (velocity_left <= 8'd128 & velocity_waits == (velocity_left != 8'd0)
            & (use_scale | velocity_left == 8'd0)));
        known_runs: assert (!tied | runs == (left != 8'd0 | velocity_left != 8'd0));
        known_which: assert (!tied | !runs | !use_scale | of_position == works);
        known_first: assert (!tied | left <= 8'd64 | left == velocity_left + 8'd64);
        known_second: assert (!tied | velocity_left <= 8'd64 | velocity_left == left + 8'd64);
        known_order: assert (!tied | left == 8'd0 | velocity_left == 8'd0 | left > 8'd64 | velocity_left > 8'd64);
        known_phase: assert (!tied | {2'd0, phase} == (works ? done : velocity_left != 8'd0 ? 8'd64 - velocity_left : 8'd0));
        known_asked: assert (!tied | (asked == in_pass & (!works | aligning == before_start)));
        known_in_pass: assert (!tied | !works | !in_pass | since_valid);
        known_since: assert (!tied | !since_valid | in_pass | (works & before_start));
    end

    // The references rotate in the pass, the operand's in its first 32 clocks, the other one's in 32 clocks from ratio_shift on.
    wire [5:0]  turned = done[5] ? 6'd32 : done[5:0];
    wire [5:0]  from_shift = done[5:0] - {1'b0, ratio_shift};
    wire [5:0]  other_turned = done < {3'd0, ratio_shift} ? 6'd0 : from_shift[5] ? 6'd32 : from_shift;
    wire [63:0] operands = {before_start ? operand : zero_operand, zero_operand} >> turned;
    wire [63:0] others = {before_start ? beside : zero_beside, zero_beside} >> other_turned;
    always @(*) begin
        align_takes: assert (!tied | works | (operand_reference == zero_operand & other_reference == zero_beside));
        known_operand: assert (!tied | !works | operand_reference == operands[31:0]);
        known_other: assert (!tied | !works | other_reference == others[31:0]);
        known_taken: assert (!tied | left <= 8'd64 | deviation == operand);
        known_ahead: assert (!tied | !works | done >= 8'd32 |
            ((deviation ^ (operand >> done[4:0])) & (32'hffffffff >> done[4:0])) == 32'd0);
        known_beside: assert (!tied | left == 8'd0 | other == beside >> (works ? other_turned : 6'd0));
        known_begun: assert (!tied | !runs | begun == (phase > {1'b0, ratio_shift}));
        known_ended: assert (!tied | !runs | ended == ({1'b0, phase} > 7'd32 + {2'd0, ratio_shift}));
    end

    // Inputs of the multiplier, and the use of its output bits.
    reg  [31:0] bits = 32'd0;
    reg  [31:0] of_velocity = 32'd0;
    reg         past_velocity_ends = 1'b0;
    reg  [31:0] past_result = 32'd0;
    wire        works_velocity = velocity_left != 8'd0 & velocity_left <= 8'd64;
    wire [5:0]  place = phase - {1'b0, ratio_shift};
    wire        in_result = phase >= {1'b0, ratio_shift} & !place[5];
    wire [5:0]  got = phase < {1'b0, ratio_shift} ? 6'd0 : place[5] ? 6'd32 : place;
    wire [31:0] bits_now = bits | (in_result & result_bit ? 32'd1 << place[4:0] : 32'd0);
    wire [63:0] in_deviation = {32'd0, deviation} >> (6'd32 - got);
    wire [63:0] in_velocity = {32'd0, velocity} >> (6'd32 - got);
    always @(posedge clk) begin
        bits <= !rst & runs & phase != 6'd63 ? bits_now : 32'd0;
        if (takes_velocity) of_velocity <= motor_velocity;
        past_velocity_ends <= !rst & velocity_left == 8'd1;
        past_result <= !overflows ? bits_now : negative ? 32'h80000000 : 32'h7fffffff;
    end
    always @(*) begin
        shows_operand: assert (!tied | !works | phase[5] |
            (operand_bit == operand[phase[4:0]] & operand_reference_bit == zero_operand[phase[4:0]]));
        shows_other: assert (!tied | !works | !in_result |
            (other_bit == beside[place[4:0]] & other_reference_bit == zero_beside[place[4:0]]));
        shows_velocity: assert (!tied | !works_velocity | phase[5] | operand_bit == of_velocity[phase[4:0]]);
        result_deviation: assert (!tied | !past_ends | past_silent | deviation == past_result);
        result_velocity: assert (!tied | !past_velocity_ends | velocity == past_result);
        known_deviation: assert (!tied | !works | in_deviation == {32'd0, bits});
        known_speed: assert (!tied | !works_velocity | in_velocity == {32'd0, bits});
        known_rest: assert (!tied | velocity_left <= 8'd64 | velocity == of_velocity);
        known_behind: assert (!tied | !works_velocity | phase[5] |
            ((velocity ^ (of_velocity >> phase[4:0])) & (32'hffffffff >> phase[4:0])) == 32'd0);
    end

    always @(*) begin
        reach_valid: cover (deviation_valid & deviation != 32'sd0);
        reach_late: cover (tied & left == 8'd120);
        reach_velocity: cover (tied & velocity_left == 8'd128);
        reach_aligned: cover (deviation_valid & past_silent & use_scale & operand != 32'd0);
        reach_referenced: cover (zero_operand == 32'd5 & zero_beside == 32'd7);
    end
endmodule
