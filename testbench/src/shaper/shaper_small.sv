// shaper_small: all of the plain shaper's arithmetic, memories and multiplier included, at sizes that no machine gets: words of
// 6 bits, a ring of 4 samples, tables of 4 taps; coefficients have their 18 bits.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. The kernel is that of every plain
// shaper, with other sizes. What it should give is computed here from the ports alone: a separate history, separate tables and
// products.
//
//   result          y = sum >> F, clamped; the sum is 2^(F-1) and, for each tap of the active table, its coefficient times the
//                   own history's sample at its delay, at each valid; a sum that is clamped sets saturated
//   constant        with all of the history equal and the machine's table active, y is that constant, and nothing is clamped
//   weights         the coefficients of every sum, of any table, are together 2^F
//   ring_*, table_* lemmas: what memories hold is the own history since the start, and the own tables as far as loaded
//   stage_*         lemmas: what each register of the pass holds in each clock of it
//   read_back       a host's read finds the own table's tap of its bank and place, 0 where none is loaded, and keeps it; it waits for
//                   no longer than a pass runs and taps are written
//   read_*          lemmas: it takes the tables only where no pass does
//   total_*         lemmas: the accumulator is the own sum, in the clock in which it has come so far
//
// Not proven here: other sizes; and for loaded tables the step from result and weights to constant, which is the distributive law.
module shaper_small_properties (
    `PORTS,
    (* peek = "u_banks.serves" *) input wire serves,
    (* peek = "u_banks.served" *) input wire served,
    (* peek = "u_banks.served_rom" *) input wire served_rom,
    (* peek = "u_banks.served_tap" *) input wire served_tap,
    (* peek = "tap" *) input wire [1:0] tap,
    (* peek = "running" *) input wire running,
    (* peek = "stages" *) input wire [5:0] stages,
    (* peek = "done" *) input wire done,
    (* peek = "u_banks.taps" *) input wire [2:0] taps,
    (* peek = "u_banks.taps_1" *) input wire [2:0] taps_1,
    (* peek = "u_banks.taps_2" *) input wire [2:0] taps_2,
    (* peek = "u_banks.sum_1" *) input wire signed [19:0] sum_1,
    (* peek = "u_banks.sum_2" *) input wire signed [19:0] sum_2,
    (* peek = "u_banks.upcoming" *) input wire [1:0] upcoming,
    (* peek = "u_banks.loaded_taps_read_data" *) input wire [19:0] loaded_word,
    (* peek = "u_banks.machine_taps_data" *) input wire [19:0] machine_word,
    (* peek = "u_banks.word" *) input wire [19:0] word,
    (* peek = "u_banks.u_loaded_taps.words[0]" *) input wire [19:0] word_0,
    (* peek = "u_banks.u_loaded_taps.words[1]" *) input wire [19:0] word_1,
    (* peek = "u_banks.u_loaded_taps.words[2]" *) input wire [19:0] word_2,
    (* peek = "u_banks.u_loaded_taps.words[3]" *) input wire [19:0] word_3,
    (* peek = "u_banks.u_loaded_taps.words[4]" *) input wire [19:0] word_4,
    (* peek = "u_banks.u_loaded_taps.words[5]" *) input wire [19:0] word_5,
    (* peek = "u_banks.u_loaded_taps.words[6]" *) input wire [19:0] word_6,
    (* peek = "u_banks.u_loaded_taps.words[7]" *) input wire [19:0] word_7,
    (* peek = "u_history.head" *) input wire [1:0] head,
    (* peek = "u_history.age" *) input wire [1:0] age,
    (* peek = "u_history.origin" *) input wire [1:0] origin,
    (* peek = "u_history.begun" *) input wire begun,
    (* peek = "u_history.started" *) input wire started,
    (* peek = "u_history.sample_0" *) input wire signed [5:0] sample,
    (* peek = "u_history.u_ring_0.words[0]" *) input wire [5:0] ring_0,
    (* peek = "u_history.u_ring_0.words[1]" *) input wire [5:0] ring_1,
    (* peek = "u_history.u_ring_0.words[2]" *) input wire [5:0] ring_2,
    (* peek = "u_history.u_ring_0.words[3]" *) input wire [5:0] ring_3,
    (* peek = "u_sum.coefficient_q" *) input wire signed [17:0] coefficient_q,
    (* peek = "u_sum.u_product.u_lower.a_q" *) input wire signed [17:0] a_q,
    (* peek = "u_sum.u_product.u_lower.b_q" *) input wire signed [17:0] b_q,
    (* peek = "u_sum.u_product.u_lower.product" *) input wire signed [35:0] product,
    (* peek = "u_sum.u_product.product_q" *) input wire [23:0] product_q,
    (* peek = "u_sum.accumulator" *) input wire signed [25:0] accumulator
);
    localparam signed [25:0] HALF = 26'sd1 << (`FRACTION - 1);
    localparam signed [19:0] UNITY = 20'sd1 << `FRACTION;

    // The history has the newest sample first, one per delay that a tap can have.
    reg signed [5:0] history_0 = 6'sd0;
    reg signed [5:0] history_1 = 6'sd0;
    reg signed [5:0] history_2 = 6'sd0;
    reg        [1:0] samples = 2'd0;
    reg              own_begun = 1'b0;
    reg              own_started = 1'b0;
    always @(posedge clk) begin
        if (rst) begin
            history_0 <= 6'sd0;
            history_1 <= 6'sd0;
            history_2 <= 6'sd0;
            samples <= 2'd0;
            own_begun <= 1'b0;
            own_started <= 1'b0;
        end else if (start) begin
            history_0 <= x;
            history_1 <= x;
            history_2 <= x;
            samples <= 2'd0;
            own_begun <= 1'b1;
            own_started <= 1'b1;
        end else if (strobe) begin
            history_0 <= x;
            history_1 <= history_0;
            history_2 <= history_1;
            samples <= !own_begun ? 2'd0 : samples == 2'd3 ? 2'd3 : samples + 2'd1;
            own_begun <= 1'b1;
        end
    end
    wire [23:0] ring = {ring_3, ring_2, ring_1, ring_0};
    wire [1:0]  at_1 = head - (samples > 2'd1 ? 2'd1 : samples);
    wire [1:0]  at_2 = head - (samples > 2'd2 ? 2'd2 : samples);
    wire [5:0]  in_ring_0 = ring[6 * head +: 6];
    wire [5:0]  in_ring_1 = ring[6 * at_1 +: 6];
    wire [5:0]  in_ring_2 = ring[6 * at_2 +: 6];
    always @(*) begin
        ring_age: assert (age == samples & begun == own_begun & started == own_started & (begun | (!started & age == 2'd0)));
        ring_origin: assert (age == 2'd3 | origin == head - age);
        ring_newest: assert (history_0 == (begun ? in_ring_0 : 6'd0));
        ring_second: assert (history_1 == (started | samples >= 2'd1 ? in_ring_1 : 6'd0));
        ring_third: assert (history_2 == (started | samples >= 2'd2 ? in_ring_2 : 6'd0));
    end

    // The tables: words {delay, coefficient}, the first lowest, and the sums of those loaded.
    reg        [79:0] table_1 = 80'd0;
    reg        [79:0] table_2 = 80'd0;
    reg        [2:0]  loaded_1 = 3'd0;
    reg        [2:0]  loaded_2 = 3'd0;
    wire              accepts = tap_write & !swap & !swap_pending & tap_bank != bank & tap_delay != 2'd3;
    wire              writes_1 = accepts & tap_bank == 2'd1 & (tap_index == 2'd0 | {1'b0, tap_index} == loaded_1);
    wire              writes_2 = accepts & tap_bank == 2'd2 & (tap_index == 2'd0 | {1'b0, tap_index} == loaded_2);
    always @(posedge clk) begin
        if (rst) begin
            loaded_1 <= 3'd0;
            loaded_2 <= 3'd0;
        end else begin
            if (writes_1) begin
                table_1[20 * tap_index +: 20] <= {tap_delay, tap_coefficient};
                loaded_1 <= {1'b0, tap_index} + 3'd1;
            end
            if (writes_2) begin
                table_2[20 * tap_index +: 20] <= {tap_delay, tap_coefficient};
                loaded_2 <= {1'b0, tap_index} + 3'd1;
            end
        end
    end
    wire [79:0]  own_table = bank == 2'd0 ? `MACHINE_TABLE : bank == 2'd1 ? table_1 : table_2;
    wire [2:0]   n = bank == 2'd0 ? `MACHINE_TAPS : bank == 2'd1 ? loaded_1 : loaded_2;
    wire [159:0] memory = {word_7, word_6, word_5, word_4, word_3, word_2, word_1, word_0};
    wire [3:0]   in_use = {n > 3'd3, n > 3'd2, n > 3'd1, n > 3'd0};

    // Sums of the first k coefficients of a table, and of all that are loaded.
    function signed [19:0] coefficient(input [79:0] of, input [2:0] count, input integer k);
        coefficient = k < count ? {{2{of[20 * k + 17]}}, of[20 * k +: 18]} : 20'd0;
    endfunction
    function signed [19:0] sum_of(input [79:0] of, input [2:0] count);
        sum_of = coefficient(of, count, 0) + coefficient(of, count, 1) + coefficient(of, count, 2)
            + coefficient(of, count, 3);
    endfunction
    genvar k;
    wire [3:0] kept_1, kept_2, allowed_1, allowed_2;
    generate
        for (k = 0; k < 4; k = k + 1) begin : of_table
            assign kept_1[k] = loaded_1 <= k | memory[20 * k +: 20] == table_1[20 * k +: 20];
            assign kept_2[k] = loaded_2 <= k | memory[20 * k + 80 +: 20] == table_2[20 * k +: 20];
            assign allowed_1[k] = loaded_1 <= k | table_1[20 * k + 18 +: 2] != 2'd3;
            assign allowed_2[k] = loaded_2 <= k | table_2[20 * k + 18 +: 2] != 2'd3;
        end
    endgenerate
    wire signed [19:0] own_sum_1 = sum_of(table_1, loaded_1);
    wire signed [19:0] own_sum_2 = sum_of(table_2, loaded_2);
    always @(*) begin
        table_kept: assert (&kept_1 & &kept_2);
        table_delay: assert (&allowed_1 & &allowed_2);
        table_loaded: assert (taps_1 == loaded_1 & taps_2 == loaded_2 & loaded_1 <= 3'd4 & loaded_2 <= 3'd4);
        table_length: assert (taps == n & n != 3'd0);
        table_known: assert (bank != 2'd3 & upcoming != 2'd3);
        table_sum_1: assert (sum_1 == own_sum_1);
        table_sum_2: assert (sum_2 == own_sum_2);
        table_sums_to_one: assert ((bank != 2'd1 | sum_1 == UNITY) & (bank != 2'd2 | sum_2 == UNITY));
        table_to_come: assert (!swap_pending | ((upcoming != 2'd1 | sum_1 == UNITY) & (upcoming != 2'd2 | sum_2 == UNITY)));
    end

    // The clock of the pass, 0 if none runs.
    wire [3:0] last = {1'b0, n} + 4'd8;
    reg  [3:0] pass = 4'd0;
    always @(posedge clk) begin
        if (rst) pass <= 4'd0;
        else if (strobe) pass <= 4'd1;
        else if (start | pass == last) pass <= 4'd0;
        else if (pass != 4'd0) pass <= pass + 4'd1;
    end
    wire [5:0] stages_now = {
        pass >= 4'd7 & pass <= n + 4'd6, pass >= 4'd6 & pass <= n + 4'd5, pass >= 4'd5 & pass <= n + 4'd4,
        pass >= 4'd4 & pass <= n + 4'd3, pass >= 4'd3 & pass <= n + 4'd2, pass >= 4'd2 & pass <= n + 4'd1};
    always @(*) begin
        pass_length: assert (pass <= last);
        pass_begun: assert (pass == 4'd0 | begun);
        pass_running: assert (running == (pass >= 4'd1 & pass <= n));
        pass_tap: assert (!running | {2'd0, tap} == pass - 4'd1);
        pass_stages: assert (stages == stages_now);
        pass_done: assert (done == (pass == n + 4'd7));
        pass_valid: assert (valid == (pass == last));
        pass_busy: assert (busy == (pass != 4'd0 & pass != last));
    end

    // A host's read has been requested, or served; and the tap that it reads.
    reg         waits = 1'b0;
    reg         has_word = 1'b0;
    reg  [19:0] host_word = 20'd0;
    reg  [19:0] found = 20'd0;
    wire        can_serve = waits & !has_word & !busy & !tap_write;
    wire [79:0] host_table = tap_bank == 2'd0 ? `MACHINE_TABLE : tap_bank == 2'd1 ? table_1 : table_2;
    wire [2:0]  host_taps = tap_bank == 2'd0 ? `MACHINE_TAPS : tap_bank == 2'd1 ? loaded_1 : tap_bank == 2'd2 ? loaded_2 : 3'd0;
    always @(posedge clk) begin
        waits <= !rst & (tap_read | (waits & !has_word));
        has_word <= !rst & can_serve;
        host_word <= {1'b0, tap_index} < host_taps ? host_table[20 * tap_index +: 20] : 20'd0;
        if (rst) found <= 20'd0;
        else if (has_word) found <= host_word;
    end
    always @(*) begin
        read_serves: assert (serves == can_serve & served == has_word);
        read_idle: assert (!served | pass <= 4'd1);
        read_word: assert (!served | host_word == (!served_tap ? 20'd0 : served_rom ? machine_word : loaded_word));
        read_back: assert ({loaded_delay, loaded_coefficient} == found & tap_read_waits == waits);
    end

    // Contents of the pass's registers for tap k, in the clock of its stage.
    wire [3:0] read, words, samples_read, coefficients, operands;
    generate
        for (k = 0; k < 4; k = k + 1) begin : of_stage
            wire        [19:0] own = own_table[20 * k +: 20];
            wire signed [17:0] own_coefficient = own[17:0];
            wire signed [5:0]  own_sample = own[19:18] == 2'd0 ? history_0 : own[19:18] == 2'd1 ? history_1 : history_2;
            assign read[k] = pass != k + 2 | (bank == 2'd0 ? machine_word : loaded_word) == own;
            assign words[k] = pass != k + 3 | word == own;
            // For a sample before the first strobe after a reset, without a start, the word differs, but the coefficient is 0.
            wire               blank = !own_started & own[19:18] > samples;
            wire signed [17:0] factor = blank ? 18'sd0 : own_coefficient;
            assign samples_read[k] = pass != k + 4 | blank | sample == own_sample;
            assign coefficients[k] = pass != k + 4 | coefficient_q == factor;
            assign operands[k] = pass != k + 5 | ((blank | a_q == own_sample) & b_q == factor);
        end
    endgenerate
    always @(*) begin
        stage_read: assert (&(read | ~in_use));
        stage_word: assert (&(words | ~in_use));
        stage_sample: assert (&(samples_read | ~in_use));
        stage_coefficient: assert (&(coefficients | ~in_use));
        stage_operands: assert (&(operands | ~in_use));
    end

    // The own product and sum, in the clocks of the multiplier: 26 bits hold four products of at most 2^22, exactly.
    wire [3:0]         place = pass - 4'd5;
    wire               multiplies = pass >= 4'd5 & pass <= n + 4'd4;
    wire [19:0]        own_word = own_table[20 * place[1:0] +: 20];
    wire signed [17:0] own_b = own_word[17:0];
    wire signed [17:0] own_a = own_word[19:18] == 2'd0 ? history_0 : own_word[19:18] == 2'd1 ? history_1 : history_2;
    // In both cases this is the product of the separate words: samples before the first strobe are 0, and equal words have equal
    // products, so no two multipliers need to be compared.
    wire               own_blank = !own_started & own_word[19:18] > samples;
    wire signed [35:0] own_ab = own_blank ? 36'sd0 : own_a == a_q & own_b == b_q ? a_q * b_q : own_a * own_b;
    reg         [23:0] own_product = 24'd0;
    reg  signed [25:0] own_sum = HALF;
    reg  signed [19:0] own_coefficients = 20'sd0;
    always @(posedge clk) begin
        own_product <= own_ab[23:0];
        if (rst | strobe) begin
            own_sum <= HALF;
            own_coefficients <= 20'sd0;
        end else if (multiplies) begin
            own_sum <= own_sum + {{2{own_ab[23]}}, own_ab[23:0]};
            own_coefficients <= own_coefficients + {{2{own_b[17]}}, own_b};
        end
    end
    reg [25:0] own_sum_before = 26'd0;
    reg [25:0] own_sum_then = 26'd0;
    always @(posedge clk) begin
        own_sum_before <= strobe ? HALF : own_sum;
        own_sum_then <= strobe ? HALF : own_sum_before;
    end
    reg [23:0] own_product_before = 24'd0;
    always @(posedge clk) own_product_before <= own_product;
    always @(*) begin
        total_product: assert (!(pass >= 4'd6 & pass <= n + 4'd5) | product[23:0] == own_product);
        total_product_q: assert (!(pass >= 4'd7 & pass <= n + 4'd6) | product_q == own_product_before);
        total_follows: assert (!(pass >= 4'd6 & pass <= n + 4'd5) | own_sum == own_sum_before + {{2{own_product[23]}}, own_product});
        total_follows_before: assert (!(pass >= 4'd7 & pass <= n + 4'd6) |
            own_sum_before == own_sum_then + {{2{own_product_before[23]}}, own_product_before});
        total_begins: assert (!(pass >= 4'd1 & pass <= 4'd5) | own_sum == HALF);
        total_waits: assert (!(pass >= 4'd1 & pass <= 4'd6) | own_sum_before == HALF);
        total_waits_then: assert (!(pass >= 4'd1 & pass <= 4'd7) | own_sum_then == HALF);
        total_waits_end: assert (!(pass >= n + 4'd6 & pass <= last) | own_sum == own_sum_before);
        total_waits_end_then: assert (!(pass >= n + 4'd7 & pass <= last) | own_sum_before == own_sum_then);
        total: assert (pass == 4'd0 | accumulator == own_sum_then);
    end

    // The result.
    wire signed [25:0] shifted = own_sum >>> `FRACTION;
    wire               above = shifted > 26'sd31;
    wire               below = shifted < -26'sd32;
    wire signed [5:0]  rounded = above ? 6'sd31 : below ? -6'sd32 : shifted[5:0];
    always @(*) begin
        result: assert (!valid | y == rounded);
        result_flag: assert (!(valid & (above | below)) | saturated);
    end

    // The coefficients so far, and a constant history.
    wire        [2:0]  taken = pass <= 4'd5 ? 3'd0 : pass - 4'd5 >= n ? n : pass - 4'd5;
    wire signed [19:0] weights_so_far = sum_of(own_table, taken);
    wire               still = history_0 == history_1 & history_0 == history_2;
    wire signed [25:0] of_still = HALF + history_0 * weights_so_far;
    always @(*) begin
        weights_so_far_known: assert (pass == 4'd0 | own_coefficients == weights_so_far);
        weights: assert (!(pass >= n + 4'd5) | own_coefficients == UNITY);
        constant_so_far: assert (pass == 4'd0 | bank != 2'd0 | !still | own_sum == of_still);
        constant: assert (!valid | bank != 2'd0 | !still | (y == history_0 & !above & !below));
    end

    always @(*) begin
        reach_machine: cover (valid & bank == 2'd0 & y != history_0);
        reach_loaded: cover (valid & bank == 2'd1 & loaded_1 == 3'd3 & y != history_0);
        reach_constant: cover (valid & bank == 2'd0 & still & y == -6'sd5);
        reach_read_back: cover (has_word & bank == 2'd1 & host_word == table_1[59:40] & host_word != 20'd0);
        reach_waiting: cover (waits & busy & tap_write);
        reach_above: cover (valid & above);
        reach_below: cover (valid & below);
    end
endmodule
