// channel_sums, of the shaper for motion: its arithmetic, with the product left open; rounding, saturation and width of the
// accumulator as lemmas. This part is proven alone, so all its inputs are free; shaper_motion proves when the control sets them.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. The multipliers give any value.
//
//   operands_*  the multipliers take the sample of sample_channel, or 0 where it was blank a clock before, and the coefficient
//               that came a clock before the sample; of a position that wraps, the sample's difference to the newest one; their
//               products are added up
//   sum_*       after a `boundary` the sum is half, and of the first channel where that wraps, the position times 2^F and half;
//               from then to the next boundary it changes by the product of each clock while `busy`, and misses none
//   fits        lemma: of a channel that does not wrap, with up to 129 products of at most 2^(W+16), the sum is exact
//   result_*    lemma: each channel's word is its sum >> F, clamped, or modulo 2^W where it wraps; all are shown in one clock,
//               after the last channel's, and only by a pass that ended, or by a start; flags stay
//
// Not proven here: that the two partial products make coefficient times sample.
module channel_sums_properties (
    `PORTS,
    (* peek = "u_product.u_lower.a_q" *) input wire signed [17:0] lower_sample,
    (* peek = "u_product.u_lower.b_q" *) input wire signed [17:0] lower_coefficient,
    (* peek = "u_product.u_lower.product" *) input wire signed [35:0] lower_product,
    (* peek = "u_product.u_upper_0.a_q" *) input wire signed [14:0] upper_sample,
    (* peek = "u_product.u_upper_0.b_q" *) input wire signed [17:0] upper_coefficient,
    (* peek = "u_product.u_upper_0.product" *) input wire signed [32:0] upper_product,
    (* peek = "u_product.product_q" *) input wire signed [41:0] product,
    (* peek = "blank_read" *) input wire blank_read,
    (* peek = "sample_q" *) input wire signed [23:0] taken,
    (* peek = "coefficient_read" *) input wire signed [17:0] coefficient_read,
    (* peek = "coefficient_q" *) input wire signed [17:0] coefficient_q,
    (* peek = "accumulator" *) input wire signed [48:0] accumulator,
    (* peek = "channel" *) input wire [1:0] channel,
    (* peek = "held_0" *) input wire signed [23:0] held_0,
    (* peek = "held_1" *) input wire signed [23:0] held_1,
    (* peek = "held_above_0" *) input wire above_0,
    (* peek = "held_above_1" *) input wire above_1,
    (* peek = "held_below_0" *) input wire below_0,
    (* peek = "held_below_1" *) input wire below_1,
    (* peek = "clamped" *) input wire clamped
);
    localparam signed [48:0] HALF = 49'sd1 << (`FRACTION - 1);

    // Values of the previous clock.
    reg               runs = 1'b0;
    reg               past_reset = 1'b1;
    reg               past_boundary = 1'b0;
    reg               past_busy = 1'b0;
    reg               past_blank = 1'b0;
    reg        [1:0]  past_channel = 2'd0;
    reg signed [23:0] past_sample = 24'sd0;
    reg signed [23:0] past_newest = 24'sd0;
    reg signed [23:0] past_operand = 24'sd0;
    reg signed [17:0] past_given = 18'sd0;
    reg signed [17:0] past_read = 18'sd0;
    reg signed [17:0] past_coefficient = 18'sd0;
    reg signed [35:0] past_lower = 36'sd0;
    reg signed [32:0] past_upper = 33'sd0;
    reg signed [41:0] past_product = 42'sd0;
    reg signed [48:0] past_accumulator = 49'sd0;
    wire signed [23:0] way = taken - newest;
    always @(posedge clk) begin
        runs <= 1'b1;
        past_reset <= rst;
        past_boundary <= boundary;
        past_busy <= busy;
        past_blank <= blank;
        past_channel <= channel;
        past_sample <= blank_read ? 24'sd0 : sample_channel == 2'd1 ? sample_1 : sample_channel == 2'd2 ? sample_2 : sample_0;
        past_newest <= newest;
        past_operand <= `MODULO & sample_channel == 2'd0 ? way : taken;
        past_given <= coefficient;
        past_read <= coefficient_read;
        past_coefficient <= coefficient_q;
        past_lower <= lower_product;
        past_upper <= upper_product;
        past_product <= product;
        past_accumulator <= accumulator;
    end

    // The products. Registers of multipliers have no reset, and any value at power-up.
    wire signed [31:0] wide_operand = past_operand;
    wire signed [41:0] parts = {{6{past_lower[35]}}, past_lower} + {past_upper[24:0], 17'd0};
    always @(*) begin
        operands_taken: assert (past_reset | (taken == past_sample & blank_read == past_blank));
        operands_known: assert (past_reset | (coefficient_read == past_given & coefficient_q == past_read));
        operands_sample: assert (!runs | ({upper_sample, lower_sample[16:0]} == wide_operand & !lower_sample[17]));
        operands_coefficient: assert (!runs | (lower_coefficient == past_coefficient & upper_coefficient == past_coefficient));
        operands_products: assert (past_reset | product == parts);
    end

    // The sums.
    wire signed [48:0] begin_position = {25'd0, past_newest} << `FRACTION;
    wire signed [48:0] begins = `MODULO & past_channel == 2'd3 ? begin_position + HALF : HALF;
    wire signed [48:0] added = past_busy ? {{7{past_product[41]}}, past_product} : 49'sd0;
    always @(*) begin
        sum_begins: assert (past_reset | !past_boundary | accumulator == begins);
        sum_adds: assert (past_reset | past_boundary | accumulator == past_accumulator + added);
    end

    // The width of the sums is enough for 129 products of at most 2^40 in size.
    reg        within = 1'b0;
    reg  [7:0] so_far = 8'd0;
    wire       small = product <= (42'sd1 << 40) & product >= -(42'sd1 << 40);
    wire       wraps = `MODULO & channel == 2'd0;
    always @(posedge clk) begin
        if (rst) within <= 1'b0;
        else if (boundary) within <= !(`MODULO & channel == 2'd3);
        else within <= within & !(busy & (!small | so_far == 8'd129));
        if (rst | boundary) so_far <= 8'd0;
        else so_far <= so_far + {7'd0, busy};
    end
    wire signed [50:0] bound = {3'd0, so_far, 40'd0};
    wire signed [50:0] distance = {{2{accumulator[48]}}, accumulator} - {2'b00, HALF};
    always @(*) begin
        fits: assert (!within | (distance <= bound & distance >= -bound & so_far <= 8'd129));
    end

    // The results.
    wire signed [48:0] shifted = accumulator >>> `FRACTION;
    wire               above = !wraps & shifted > 49'sd8388607;
    wire               below = !wraps & shifted < -49'sd8388608;
    wire signed [23:0] rounded = above ? 24'sh7fffff : below ? 24'sh800000 : shifted[23:0];
    reg         [1:0]  own_channel = 2'd0;
    reg  signed [23:0] own_0 = 24'sd0;
    reg  signed [23:0] own_1 = 24'sd0;
    reg                own_clamped = 1'b0;
    reg                own_busy = 1'b0;
    reg                own_saturated = 1'b0;
    reg                past_shows = 1'b0;
    reg  signed [23:0] shown_0 = 24'sd0;
    reg  signed [23:0] shown_1 = 24'sd0;
    reg  signed [23:0] shown_2 = 24'sd0;
    wire               shows = boundary & own_channel == 2'd2 & !start & !begin_pass;
    always @(posedge clk) begin
        if (rst) {own_0, own_1} <= 48'd0;
        else if (boundary) begin
            if (own_channel == 2'd0) own_0 <= rounded;
            if (own_channel == 2'd1) own_1 <= rounded;
        end
        if (rst) own_channel <= 2'd0;
        else if (start | begin_pass) own_channel <= 2'd3;
        else if (boundary) own_channel <= own_channel + 2'd1;
        if (rst) own_clamped <= 1'b0;
        else if (boundary) own_clamped <= own_channel != 2'd3 & (own_clamped | above | below);
        if (rst | start | begin_pass) own_busy <= begin_pass & !rst;
        else if (shows) own_busy <= 1'b0;
        own_saturated <= !rst & ((shows & (own_clamped | above | below)) | (own_saturated & !clear_flags));
        past_shows <= shows & !rst;
        shown_0 <= rst ? 24'sd0 : start ? x_0 : shows ? own_0 : y_0;
        shown_1 <= rst ? 24'sd0 : start ? x_1 : shows ? own_1 : y_1;
        shown_2 <= rst ? 24'sd0 : start ? x_2 : shows ? rounded : y_2;
    end
    always @(*) begin
        result_channel: assert (channel == own_channel & clamped == own_clamped);
        result_held: assert (own_0 == (above_0 ? 24'sh7fffff : below_0 ? 24'sh800000 : held_0) &
            own_1 == (above_1 ? 24'sh7fffff : below_1 ? 24'sh800000 : held_1));
        result_cleared: assert ((!(above_0 | below_0) | held_0 == 24'sd0) & (!(above_1 | below_1) | held_1 == 24'sd0) &
            !(above_0 & below_0) & !(above_1 & below_1));
        result: assert (y_0 == shown_0 & y_1 == shown_1 & y_2 == shown_2);
        result_valid: assert (valid == past_shows & busy == own_busy);
        result_clamped: assert (saturated == own_saturated);
    end

    always @(*) begin
        reach_valid: cover (valid & busy == 1'b0 & y_0 != 24'sd0 & y_2 != 24'sd0);
        reach_second_sum: cover (busy & channel == 2'd1 & past_busy & !past_boundary & past_product != 42'sd0);
        reach_exact: cover (within & so_far == 8'd5 & distance < 51'sd0);
        reach_clamped: cover (saturated);
    end
endmodule
