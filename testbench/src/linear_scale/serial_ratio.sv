// serial_ratio, of linear_scale: ratio times one difference, rounded, minus the other one, a bit per clock, lowest first.
//
// Proven for ratio_shift SHIFT, all mantissas and all bits that come in, resets included. Assumed, as linear_scale does it:
// `runs` stays for a pass of 64 clocks, and with it use_scale, of_position, mantissa and shift; where they do not, nothing is
// claimed of that pass. The bits of the operand and its reference are those of its first 32 clocks, the other one's those of 32
// clocks from ratio_shift on; a velocity has no reference and no other one.
//
//   result_is          each of the 32 bits from ratio_shift on is that of round(mantissa * operand * 2^-shift) - other, or of its
//                      opposite without use_scale; operand and other are differences modulo 2^32, and signed; half up, once
//   overflow_is        with last, overflows says whether that has more than 32 bits, and negative its sign
//   taken_is, last_is  which clocks take the operand, the other one, and are the last one
//   known_...          invariants
//
// No product is written with `*`: it is the sum of the mantissa * 2^k over the operand's bits, the highest one subtracted.
module serial_ratio_properties (
    `PORTS,
    (* peek = "phase" *) input wire [5:0] phase,
    (* peek = "partial" *) input wire signed [17:0] partial,
    (* peek = "operand_borrow" *) input wire operand_borrow,
    (* peek = "held_operand" *) input wire held_operand,
    (* peek = "other_borrow" *) input wire other_borrow,
    (* peek = "held_other" *) input wire held_other,
    (* peek = "round_up" *) input wire round_up,
    (* peek = "borrow" *) input wire borrow,
    (* peek = "begun_q" *) input wire begun,
    (* peek = "ended_q" *) input wire ended,
    (* peek = "overflow" *) input wire overflow,
    (* peek = "highest" *) input wire highest
);
    // The properties apply to a pass in which the inputs that must be constant are constant.
    reg               was_fair = 1'b1;
    reg               kept_use = 1'b0;
    reg               kept_position = 1'b0;
    reg  signed [17:0] mantissa = 18'sd0;
    wire              begins = phase == 6'd0;
    localparam [4:0]   s = `SHIFT;
    wire              fair = ratio_shift == s & (begins | (was_fair & use_scale == kept_use & of_position == kept_position
        & ratio_mantissa == mantissa));
    always @(posedge clk) begin
        was_fair <= rst | !runs | fair;
        kept_use <= use_scale;
        kept_position <= of_position;
        mantissa <= ratio_mantissa;
    end

    // The bits so far, and the product so far; before this clock, and including its bits.
    reg         [31:0] operand = 32'd0;
    reg         [31:0] operand_reference = 32'd0;
    reg         [31:0] other = 32'd0;
    reg         [31:0] other_reference = 32'd0;
    reg  signed [63:0] product = 64'sd0;
    wire        [6:0]  place = {1'b0, phase} - {2'd0, s};
    wire               is_begun = phase >= {1'b0, s};
    wire               is_moving = is_begun & place < 7'd32;
    wire        [31:0] bit_of_operand = phase[5] ? 32'd0 : 32'd1 << phase[4:0];
    wire        [31:0] bit_of_other = is_moving ? 32'd1 << place[4:0] : 32'd0;
    wire        [31:0] operand_now = operand | (operand_bit ? bit_of_operand : 32'd0);
    wire        [31:0] operand_reference_now = operand_reference | (operand_reference_bit & of_position ? bit_of_operand : 32'd0);
    wire        [31:0] other_now = other | (other_bit & of_position ? bit_of_other : 32'd0);
    wire        [31:0] other_reference_now = other_reference | (other_reference_bit & of_position ? bit_of_other : 32'd0);
    wire        [31:0] difference = operand - operand_reference;
    wire        [31:0] difference_now = operand_now - operand_reference_now;
    wire signed [63:0] weight = $signed({{46{ratio_mantissa[17]}}, ratio_mantissa}) <<< phase;
    wire               adds = (difference_now & bit_of_operand) != 32'd0;
    wire signed [63:0] product_now = !adds ? product : phase == 6'd31 ? product - weight : product + weight;
    wire               goes_on = runs & phase != 6'd63 & !rst;
    always @(posedge clk) begin
        operand <= goes_on ? operand_now : 32'd0;
        operand_reference <= goes_on ? operand_reference_now : 32'd0;
        other <= goes_on ? other_now : 32'd0;
        other_reference <= goes_on ? other_reference_now : 32'd0;
        product <= goes_on ? product_now : 64'sd0;
    end

    // The result has the lowest `place` bits before this clock, and one more with this clock's bit.
    wire signed [63:0] halved = s == 5'd0 ? 64'sd0 : product >>> (s - 5'd1);
    wire signed [63:0] halved_now = s == 5'd0 ? 64'sd0 : product_now >>> (s - 5'd1);
    wire signed [63:0] shifted = product >>> s;
    wire signed [63:0] shifted_now = product_now >>> s;
    wire        [63:0] rounded = shifted + {63'd0, halved[0]};
    wire        [63:0] rounded_now = shifted_now + {63'd0, halved_now[0]};
    wire        [31:0] beside = other - other_reference;
    wire        [31:0] beside_now = other_now - other_reference_now;
    wire        [63:0] wide_beside = {{32{beside[31]}}, beside};
    wire        [63:0] wide_beside_now = {{32{beside_now[31]}}, beside_now};
    wire        [63:0] minuend = use_scale ? rounded : wide_beside;
    wire        [63:0] subtrahend = use_scale ? wide_beside : rounded;
    wire        [63:0] exact = minuend - subtrahend;
    wire        [63:0] exact_now = use_scale ? rounded_now - wide_beside_now : wide_beside_now - rounded_now;
    wire        [63:0] below = is_begun ? (64'd1 << place) - 64'd1 : 64'd0;
    wire        [63:0] bit_now = exact_now >> place;
    wire        [63:0] unlike = (exact ^ {64{exact[31]}}) & below & 64'hffffffff00000000;
    wire               in_32_bits = exact_now[63:31] == {33{exact_now[31]}};
    always @(*) begin
        result_is: assert (!(fair & runs & is_moving) | result_bit == bit_now[0]);
        result_is_nothing: assert (!(fair & !is_begun) | !result_bit);
        overflow_is: assert (!(fair & last) | (overflows == !in_32_bits & negative == exact_now[63]));
        taken_is: assert (!fair | (takes_operand == !phase[5] & takes_other == is_moving & moves == (!is_begun | is_moving)));
        last_is: assert (last == (runs & phase == 6'd63));
    end

    // Invariants of the registers.
    wire        [31:0] below_operand = phase[5] ? 32'hffffffff : (32'd1 << phase[4:0]) - 32'd1;
    wire        [31:0] below_other = !is_begun ? 32'd0 : place >= 7'd32 ? 32'hffffffff : (32'd1 << place[4:0]) - 32'd1;
    wire signed [63:0] done = product >>> phase;
    wire signed [19:0] ahead = phase[5] & difference[31] ? ratio_mantissa : 20'sd0;
    wire signed [19:0] without_sign = {{2{partial[17]}}, partial} - ahead;
    wire        [63:0] below_phase = (64'd1 << phase) - 64'd1;
    wire        [63:0] below_half = s == 5'd0 ? 64'd0 : (64'd1 << (s - 5'd1)) - 64'd1;
    wire               all_ones = (~product & below_phase & ~below_half) == 64'd0;
    wire               bit_before = phase != 6'd0 & ((product >> (phase - 6'd1)) & 64'd1) == 64'd1;
    always @(*) begin
        known_words: assert (((operand | operand_reference) & ~below_operand) == 32'd0);
        known_others: assert (!fair | ((other | other_reference) & ~below_other) == 32'd0);
        known_velocity: assert (!fair | of_position | (operand_reference | other | other_reference) == 32'd0);
        known_borrow: assert (!fair | phase[5] | operand_borrow == (operand < operand_reference));
        known_sign: assert (!fair | !phase[5] | held_operand == difference[31]);
        known_product: assert (!fair | done == {{44{without_sign[19]}}, without_sign});
        known_size: assert (!fair | product[63:50] == {14{product[63]}});
        known_partial: assert (!fair | (ratio_mantissa < 18'sd0 ? partial <= 18'sd0 & partial >= ratio_mantissa
            : partial >= 18'sd0 & partial <= ratio_mantissa));
        known_round: assert (!fair | round_up == (s == 5'd0 | begins ? 1'b0 : phase < {1'b0, s} ? bit_before : all_ones));
        known_part: assert (!fair | (begun == (is_begun & place != 7'd0) & ended == (is_begun & place > 7'd32)));
        known_other_borrow: assert (!fair | (is_begun & place >= 7'd32) | other_borrow == (other < other_reference));
        known_other_sign: assert (!fair | !is_begun | place < 7'd32 | held_other == beside[31]);
        known_carry: assert (!fair | borrow == ((minuend & below) < (subtrahend & below)));
        known_highest: assert (!fair | !is_begun | place < 7'd32 | highest == exact[31]);
        known_overflow: assert (!fair | overflow == (unlike != 64'd0));
    end

    always @(*) begin
        reach_result: cover (last & fair & !overflows & exact_now[31:0] == 32'd3);
        reach_negative: cover (last & fair & negative & !overflows);
        reach_overflow: cover (last & fair & overflows);
    end
endmodule
