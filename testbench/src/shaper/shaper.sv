// shaper: its control with the product left open, and rounding, saturation and width of the accumulator as lemmas.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. The multipliers and the memories
// give any value in every clock. `pass` is the clock of the pass, 0 if none runs; n the taps of the active table.
//
//   pass_*          running, tap, stages, done, valid and busy are those of this clock: tap i is read in clock i + 1 and no
//                   other, its product added in clock i + 7 and no other, the result shown in clock n + 8 and no other
//   read_in_order   the tables' address is tap i of the active bank
//   word_of_table   the word is what the active table gave a clock before, but for a host's read
//   read_back_*     a host's read takes the tables only in clocks in which no pass does
//   address         the ring's address is head - delay, but no farther back than the start's word; never the word that is
//                   written
//   age_known       head moves by one per strobe or start, which writes before it; age counts strobes since the start, or the
//                   first strobe since the reset, and stays full
//   before_known    without a start since the reset, a delay above that age is blank
//   operands        the multipliers take the sample and the coefficient of the same tap, 0 of a blank one; their products are
//                   added up
//   sum_*           the sum begins with half, and changes by a product of the pass only
//   fits            lemma: with products of at most 2^(W+16) in size the sum is exact: after k it lies within k such of half
//   result          lemma: y = sum >> F, clamped to the word; only by a pass that ended, or by a start; flags stay
//   table_*         the active table, and one that waits, sums to 2^F by its own count, and is not written
//
// So y is the rounded, clamped sum of exactly n products, one per tap of one table that sums to one. Left open: that the two
// partial products make coefficient times sample (their sum is shown), that memories keep what is written: at small sizes both are
// in shaper_small.
module shaper_properties (
    `PORTS,
    (* peek = "tap" *) input wire [5:0] tap,
    (* peek = "running" *) input wire running,
    (* peek = "stages" *) input wire [5:0] stages,
    (* peek = "done" *) input wire done,
    (* peek = "u_banks.taps" *) input wire [6:0] taps,
    (* peek = "u_banks.taps_1" *) input wire [6:0] taps_1,
    (* peek = "u_banks.taps_2" *) input wire [6:0] taps_2,
    (* peek = "u_banks.sum_1" *) input wire signed [23:0] sum_1,
    (* peek = "u_banks.sum_2" *) input wire signed [23:0] sum_2,
    (* peek = "u_banks.upcoming" *) input wire [1:0] upcoming,
    (* peek = "u_banks.pending" *) input wire pending,
    (* peek = "u_banks.write_taken" *) input wire write_taken,
    (* peek = "u_banks.write_address" *) input wire [6:0] write_address,
    (* peek = "u_banks.loaded_taps_write_data" *) input wire [23:0] write_data,
    (* peek = "u_banks.read_address" *) input wire [6:0] read_address,
    (* peek = "u_banks.loaded_taps_read_data" *) input wire [23:0] loaded_word,
    (* peek = "u_banks.machine_taps_data" *) input wire [23:0] machine_word,
    (* peek = "u_banks.word" *) input wire [23:0] word,
    (* peek = "u_banks.serves" *) input wire serves,
    (* peek = "u_banks.served" *) input wire served,
    (* peek = "u_history.head" *) input wire [5:0] head,
    (* peek = "u_history.age" *) input wire [5:0] age,
    (* peek = "u_history.origin" *) input wire [5:0] origin,
    (* peek = "u_history.next_head" *) input wire [5:0] ring_write_address,
    (* peek = "u_history.begun" *) input wire begun,
    (* peek = "u_history.started" *) input wire started,
    (* peek = "u_history.writes" *) input wire ring_writes,
    (* peek = "u_history.address" *) input wire [5:0] ring_read_address,
    (* peek = "u_history.blank" *) input wire blank,
    (* peek = "u_history.sample_0" *) input wire [31:0] sample,
    (* peek = "u_sum.coefficient_q" *) input wire signed [17:0] coefficient,
    (* peek = "u_sum.u_product.u_lower.a_q" *) input wire signed [17:0] lower_sample,
    (* peek = "u_sum.u_product.u_lower.b_q" *) input wire signed [17:0] lower_coefficient,
    (* peek = "u_sum.u_product.u_lower.product" *) input wire signed [35:0] lower_product,
    (* peek = "u_sum.u_product.u_upper_0.a_q" *) input wire signed [14:0] upper_sample,
    (* peek = "u_sum.u_product.u_upper_0.b_q" *) input wire signed [17:0] upper_coefficient,
    (* peek = "u_sum.u_product.u_upper_0.product" *) input wire signed [32:0] upper_product,
    (* peek = "u_sum.u_product.product_q" *) input wire [49:0] product,
    (* peek = "u_sum.accumulator" *) input wire signed [55:0] accumulator
);
    localparam signed [55:0] HALF = 56'sd1 << (`FRACTION - 1);
    localparam signed [23:0] UNITY = 24'sd1 << `FRACTION;

    wire [7:0] n = {1'b0, taps};
    reg  [7:0] pass = 8'd0;
    always @(posedge clk) begin
        if (rst) pass <= 8'd0;
        else if (strobe) pass <= 8'd1;
        else if (start) pass <= 8'd0;
        else if (pass == n + 8'd8) pass <= 8'd0;
        else if (pass != 8'd0) pass <= pass + 8'd1;
    end
    wire [5:0] stages_now = {
        pass >= 8'd7 & pass <= n + 8'd6, pass >= 8'd6 & pass <= n + 8'd5, pass >= 8'd5 & pass <= n + 8'd4,
        pass >= 8'd4 & pass <= n + 8'd3, pass >= 8'd3 & pass <= n + 8'd2, pass >= 8'd2 & pass <= n + 8'd1};
    wire [7:0] tap_now = pass - 8'd1;
    wire       adds = stages_now[5];
    always @(*) begin
        pass_length: assert (pass <= n + 8'd8 & n >= 8'd1 & n <= 8'd64);
        pass_running: assert (running == (pass >= 8'd1 & pass <= n));
        pass_tap: assert (!running | {2'd0, tap} == tap_now);
        pass_stages: assert (stages == stages_now);
        pass_done: assert (done == (pass == n + 8'd7));
        pass_valid: assert (valid == (pass == n + 8'd8));
        pass_busy: assert (busy == (pass >= 8'd1 & pass <= n + 8'd7));
    end

    // Values of the previous clock.
    reg               past_reset = 1'b1;
    reg               past_strobe = 1'b0;
    reg               past_start = 1'b0;
    reg               past_clear = 1'b0;
    reg               past_finish = 1'b0;
    reg               past_adds = 1'b0;
    reg               past_busy = 1'b0;
    reg               past_saturated = 1'b0;
    reg               past_overrun = 1'b0;
    reg signed [31:0] past_x = 32'sd0;
    reg signed [31:0] past_y = 32'sd0;
    reg signed [55:0] past_accumulator = 56'sd0;
    reg        [49:0] past_product = 50'd0;
    reg               past_served = 1'b0;
    reg        [1:0]  past_bank = 2'd0;
    reg        [23:0] past_loaded = 24'd0;
    reg        [23:0] past_machine = 24'd0;
    reg        [23:0] past_word = 24'd0;
    reg        [17:0] past_coefficient = 18'd0;
    reg        [5:0]  past_head = 6'd0;
    reg               past_blank = 1'b0;
    reg        [31:0] past_sample = 32'd0;
    reg signed [35:0] past_lower = 36'sd0;
    reg signed [32:0] past_upper = 33'sd0;
    wire       [5:0]  delay = word[23:18];
    always @(posedge clk) begin
        past_reset <= rst;
        past_strobe <= strobe;
        past_start <= start;
        past_clear <= clear_flags;
        past_finish <= done & !start & !strobe;
        past_adds <= adds;
        past_busy <= busy;
        past_saturated <= saturated;
        past_overrun <= overrun;
        past_x <= x;
        past_y <= y;
        past_accumulator <= accumulator;
        past_product <= product;
        past_served <= served;
        past_bank <= bank;
        past_loaded <= loaded_word;
        past_machine <= machine_word;
        past_word <= rst ? 24'd0 : word;
        past_coefficient <= coefficient;
        past_head <= head;
        past_blank <= blank;
        past_sample <= sample;
        past_lower <= lower_product;
        past_upper <= upper_product;
    end

    // Properties of the tables.
    always @(*) begin
        read_in_order: assert (!running | read_address == {bank != 2'd1, tap_now[5:0]});
        word_of_table: assert (past_reset | past_served | word == (past_bank == 2'd0 ? past_machine : past_loaded));
        read_back_serves: assert (!serves | pass == 8'd0 | valid);
        read_back_idle: assert (!served | pass <= 8'd1);
        table_known: assert (bank != 2'd3 & upcoming != 2'd3);
        table_length: assert (taps == (bank == 2'd0 ? `MACHINE_TAPS : bank == 2'd1 ? taps_1 : taps_2));
        table_bound: assert (taps_1 <= 7'd64 & taps_2 <= 7'd64);
        table_empty: assert ((taps_1 != 7'd0 | sum_1 == 24'sd0) & (taps_2 != 7'd0 | sum_2 == 24'sd0));
        table_sums_to_one: assert ((bank != 2'd1 | sum_1 == UNITY) & (bank != 2'd2 | sum_2 == UNITY));
        table_to_come: assert (!pending | ((upcoming != 2'd1 | sum_1 == UNITY) & (upcoming != 2'd2 | sum_2 == UNITY)));
        table_not_written: assert (!write_taken | (bank != {write_address[6], !write_address[6]} & !pending));
        table_delay: assert (!write_taken | write_data[23:18] != 6'd63);
        table_stays: assert (past_reset | past_strobe | bank == past_bank);
    end

    // Properties of the samples.
    reg [5:0] samples = 6'd0;
    reg       own_started = 1'b0;
    reg       own_begun = 1'b0;
    always @(posedge clk) begin
        if (rst | start) samples <= 6'd0;
        else if (strobe & own_begun & samples != 6'd63) samples <= samples + 6'd1;
        if (rst) own_begun <= 1'b0;
        else if (strobe | start) own_begun <= 1'b1;
        if (rst | start) own_started <= !rst;
    end
    wire       from_start = delay > samples;
    wire [5:0] head_moved = head - past_head;
    always @(*) begin
        address: assert (ring_read_address == head - (from_start ? samples : delay));
        address_not_written: assert (ring_read_address != ring_write_address | delay == 6'd63);
        before_known: assert (blank == (from_start & !own_started));
        age_known: assert (age == samples & started == own_started & begun == own_begun & (begun | (!started & age == 6'd0)));
        origin_known: assert (age == 6'd63 | origin == head - age);
        age_head: assert (past_reset | head_moved == {5'd0, past_strobe | past_start});
        age_written: assert (ring_write_address == head + 6'd1 & ring_writes == (strobe | start));
    end

    // The products. Registers of multipliers have no reset, and any value at power-up.
    reg [1:0] clocks = 2'd0;
    reg [1:0] clocks_of_product = 2'd0;
    always @(posedge clk) begin
        if (rst) clocks <= 2'd0;
        else if (clocks != 2'd3) clocks <= clocks + 2'd1;
        clocks_of_product <= rst ? 2'd0 : 2'd1;
    end
    wire signed [49:0] parts = {{14{past_lower[35]}}, past_lower} + {past_upper, 17'd0};
    always @(*) begin
        operands_known: assert (coefficient == (past_blank ? 18'd0 : past_word[17:0]));
        operands_sample: assert (clocks == 2'd0 | {upper_sample, lower_sample[16:0]} == past_sample);
        operands_whole: assert (clocks == 2'd0 | !lower_sample[17]);
        operands_coefficient: assert (clocks == 2'd0 | (lower_coefficient == past_coefficient & upper_coefficient == past_coefficient));
        operands_products: assert (clocks_of_product == 2'd0 | product == parts);
    end

    // Properties of the sum.
    wire signed [55:0] added = past_adds ? {{6{past_product[49]}}, past_product} : 56'sd0;
    always @(*) begin
        sum_begins: assert (past_reset | !past_strobe | accumulator == HALF);
        sum_adds: assert (past_reset | past_strobe | accumulator == past_accumulator + added);
    end

    // The width of the sum is enough for 64 products of at most 2^48 in size.
    reg within = 1'b1;
    wire signed [49:0] signed_product = product;
    wire small = signed_product <= (50'sd1 << 48) & signed_product >= -(50'sd1 << 48);
    always @(posedge clk) within <= rst | strobe | (within & (!adds | small));
    wire        [7:0]  products = pass < 8'd8 ? 8'd0 : pass > n + 8'd7 ? n : pass - 8'd7;
    wire signed [63:0] bound = {8'd0, products, 48'd0};
    wire signed [63:0] distance = {{8{accumulator[55]}}, accumulator} - {{8{HALF[55]}}, HALF};
    always @(*) begin
        fits: assert (pass == 8'd0 | !within | (distance <= bound & distance >= -bound));
    end

    // Properties of the result.
    wire signed [55:0] shifted = past_accumulator >>> `FRACTION;
    wire               above = shifted > 56'sd2147483647;
    wire               below = shifted < -56'sd2147483648;
    wire signed [31:0] rounded = above ? 32'sh7fffffff : below ? 32'sh80000000 : shifted[31:0];
    wire               clamps = past_finish & (above | below);
    always @(*) begin
        result: assert (past_reset | !past_finish | y == rounded);
        result_of_start: assert (past_reset | !past_start | y == past_x);
        result_holds: assert (past_reset | past_finish | past_start | y == past_y);
        result_clamped: assert (past_reset | saturated == (clamps | (past_saturated & !past_clear)));
        result_overrun: assert (past_reset |
            overrun == ((past_strobe & past_busy & !past_start) | (past_overrun & !past_clear)));
    end

    always @(*) begin
        reach_valid: cover (valid);
        reach_all_machine_taps: cover (done & taps == `MACHINE_TAPS);
        reach_loaded: cover (valid & bank == 2'd1 & taps_1 == 7'd2);
        reach_read_back: cover (served & past_word != word);
        reach_overrun: cover (overrun);
        reach_clamped: cover (saturated);
    end
endmodule
