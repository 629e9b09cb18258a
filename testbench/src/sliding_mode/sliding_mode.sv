// sliding_mode: the control of a pass, with products left uninterpreted: the multipliers give any value in every clock,
// except for a mantissa of one, whose product is the operand.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. A pass has 17 steps of 39, 16 or 8
// clocks; its clocks are counted here separately, from 1 in the clock after `start` on.
//
//   latency_exact     valid comes PASS_CLOCKS after a start that was taken, and at no other time; busy in between
//   ends_before_valid ends comes in the clock before valid, the last of a pass, and at no other time: what changes with it changes
//                     between two passes
//   setting_of_step   the address of each step's setting, by law
//   operand_of_step   what each step multiplies, by law
//   factor_of_step    by what: its setting's mantissa and shift; or one, or minus one, where words are added as they are
//   sum_only_by_add   the sum changes by an addition or its beginning only
//   product_whole     each product is read, loaded two clocks later, shifted for 31 clocks, and then added: as scaled_product.sv
//                     has it; 8 where the shift is 8; not at all where words are added as they are
//   added_once        each step adds one product, four clocks before its end; no other clock adds; 17 have been added at valid
//   begins_anew       which steps begin a sum
//   six_terms         no sum has more: as accumulator.sv has it
//   words_of_steps    the word is the sum's two clocks before the end of a step, but of that with the limit; of which kind
//   takes_far_apart   the limiter takes once a pass, in clock 1 of step 14, and decides five clocks later; its word holds still
//                     meanwhile: as limiter.sv has it
//   only_in_its_clock s, de, a, command, integral and duty change in the clock of their step alone, after its last product
//   takes_the_word    s, de, a, the sum to be limited and duty are then the sum's word
//   error_at_start    e changes in the clock of a start alone
//   frozen            the integral takes e only in PID, and not while the command is cut on the side to which e pushes it,
//                     and not if it was cleared since its sum began, in step 14 or 15
//   integral_exact    it then takes the whole of e, or stops at an end
//   clears            clear_integral makes it 0
//   flags_held        sticky flags fall by clear_flags or reset only
//   flags_of_words    a cut of de, s, a, integral, command or duty shows, a clock after the word, even when the flags are
//                     cleared in its clock
//   overrun_found     a start in a pass is ignored and flagged
//   known_*           invariants
//
// With accumulator.sv, scaled_product.sv and limiter.sv: a pass is the sums of the datasheet of rounded products, cut once.
// Not proven here: that the multipliers multiply, the meaning of the gains, e itself (lock step).
module sliding_mode_properties (
    `PORTS,
    (* peek = "u_sequencer.step_q" *) input wire [4:0] step,
    (* peek = "u_sequencer.phase" *) input wire [5:0] phase,
    (* peek = "u_sequencer.linear_q" *) input wire linear,
    (* peek = "u_sequencer.integrates_q" *) input wire integrates,
    (* peek = "u_operands.takes_error" *) input wire takes_error,
    (* peek = "u_operands.takes_sliding" *) input wire takes_sliding,
    (* peek = "u_operands.takes_held" *) input wire takes_held,
    (* peek = "u_operands.takes_integral" *) input wire takes_integral,
    (* peek = "u_operands.takes_reference" *) input wire takes_reference,
    (* peek = "u_operands.takes_acceleration" *) input wire takes_acceleration,
    (* peek = "u_operands.takes_velocity" *) input wire takes_velocity,
    (* peek = "u_operands.takes_word" *) input wire takes_word,
    (* peek = "u_operands.operand" *) input wire signed [31:0] operand,
    (* peek = "u_scaled_product.mantissa" *) input wire [17:0] mantissa,
    (* peek = "u_scaled_product.distance" *) input wire [4:0] distance,
    (* peek = "u_scaled_product.u_upper.a_q" *) input wire signed [14:0] upper_operand,
    (* peek = "u_scaled_product.u_lower.a_q" *) input wire signed [17:0] lower_operand,
    (* peek = "u_scaled_product.u_upper.b_q" *) input wire signed [17:0] upper_factor,
    (* peek = "u_scaled_product.u_lower.b_q" *) input wire signed [17:0] lower_factor,
    (* peek = "u_scaled_product.u_upper.product" *) input wire signed [32:0] upper_product,
    (* peek = "u_scaled_product.u_lower.product" *) input wire signed [35:0] lower_product,
    (* peek = "u_scaled_product.shifter" *) input wire signed [50:0] shifter,
    (* peek = "u_scaled_product.left" *) input wire [4:0] left,
    (* peek = "u_scaled_product.read" *) input wire read,
    (* peek = "u_scaled_product.load" *) input wire load,
    (* peek = "u_scaled_product.shift" *) input wire shift,
    (* peek = "u_accumulator.empty" *) input wire empty,
    (* peek = "u_accumulator.add" *) input wire add,
    (* peek = "u_accumulator.check" *) input wire check,
    (* peek = "u_accumulator.as_fraction" *) input wire as_fraction,
    (* peek = "u_accumulator.as_duty" *) input wire as_duty,
    (* peek = "u_accumulator.sum_q" *) input wire signed [51:0] sum,
    (* peek = "u_accumulator.word_q" *) input wire signed [31:0] word,
    (* peek = "u_accumulator.cut_q" *) input wire cut,
    (* peek = "u_accumulator.negative_q" *) input wire negative,
    (* peek = "u_limiter.keep" *) input wire keep,
    (* peek = "u_limiter.take" *) input wire take,
    (* peek = "u_limiter.inverted" *) input wire inverted,
    (* peek = "u_limiter.compares" *) input wire compares,
    (* peek = "u_limiter.returns" *) input wire returns,
    (* peek = "u_limiter.cuts" *) input wire cuts,
    (* peek = "u_limiter.decides" *) input wire decides,
    (* peek = "u_limiter.held_q" *) input wire signed [31:0] held,
    (* peek = "u_integral.integral_q" *) input wire signed [31:0] integral,
    (* peek = "u_integral.cleared" *) input wire cleared,
    (* peek = "opposes" *) input wire opposes
);
    localparam [9:0] LAST_CLOCK = `PASS_CLOCKS - 10'd1;

    // Clock of the pass, 0 if none runs; the step, and the clock of the step.
    reg [9:0] clock = 10'd0;
    reg [4:0] now = 5'd0;
    reg [5:0] at = 6'd0;
    reg       past_reset = 1'b1;
    reg       due = 1'b0;
    reg       is_linear = 1'b0;
    reg       is_pid = 1'b0;
    wire      runs = clock != 10'd0;
    wire      taken = start & !runs;
    wire      is_plain = now < 5'd3 | now == 5'd14;
    wire      is_sum = now == 5'd15;
    wire [5:0] shifting = is_plain ? 6'd0 : is_sum ? 6'd8 : 6'd31;
    wire [5:0] end_of_step = shifting + 6'd7;
    wire      adds = at == shifting + 6'd4;
    wire      checks = at == shifting + 6'd5;
    wire      settles = at == shifting + 6'd6;
    wire      step_ends = at == end_of_step;
    always @(posedge clk) begin
        past_reset <= rst;
        due <= !rst & clock == LAST_CLOCK;
        if (rst) clock <= 10'd0;
        else if (taken) clock <= 10'd1;
        else if (clock == LAST_CLOCK) clock <= 10'd0;
        else if (runs) clock <= clock + 10'd1;
        if (rst) {now, at} <= 11'd0;
        else if (runs) begin
            at <= step_ends ? 6'd0 : at + 6'd1;
            if (step_ends) now <= now == 5'd16 ? 5'd0 : now + 5'd1;
        end
        if (rst) {is_linear, is_pid} <= 2'b00;
        else if (taken) {is_linear, is_pid} <= {law != 2'd0, law == 2'd2};
    end
    wire [9:0] wide_now = {5'd0, now};
    wire [9:0] before = now < 5'd3 ? wide_now * 10'd8 : now <= 5'd14 ? wide_now * 10'd39 - 10'd93 : is_sum ? 10'd461 : 10'd477;
    wire [5:0] phase_of = at < shifting + 6'd4 ? at : at + (6'd31 - shifting);

    // Progress of a step.
    reg       added = 1'b0;
    reg [4:0] products = 5'd0;
    reg [2:0] terms = 3'd0;
    reg [5:0] shifts = 6'd0;
    reg       is_read = 1'b0;
    reg       is_loaded = 1'b0;
    always @(posedge clk) begin
        if (rst) begin
            added <= 1'b0;
            products <= 5'd0;
            terms <= 3'd0;
            shifts <= 6'd0;
            is_read <= 1'b0;
            is_loaded <= 1'b0;
        end else begin
            added <= (added | add) & !step_ends;
            products <= taken ? 5'd0 : products + {4'd0, add};
            if (empty) terms <= 3'd0;
            else if (add) terms <= terms + 3'd1;
            if (load) shifts <= 6'd0;
            else if (shift & shifts != 6'd63) shifts <= shifts + 6'd1;
            is_read <= read | (is_read & !load);
            is_loaded <= (load & is_read) | (is_loaded & !read & !load);
        end
    end
    wire       is_added = at > shifting + 6'd4;
    wire       is_begun = at > 6'd2;
    wire       begins = now == 5'd0 | now == 5'd2 | now == 5'd4 | now == 5'd5 | now == 5'd8 | now == 5'd9 | now == 5'd14 | now == 5'd16;
    wire [2:0] terms_before =
        now == 5'd1 | now == 5'd3 | now == 5'd6 | now == 5'd10 | now == 5'd15 ? 3'd1 : now == 5'd7 | now == 5'd11 ? 3'd2 :
        now == 5'd12 ? 3'd3 : now == 5'd13 ? 3'd4 : 3'd0;

    wire [7:0] takes = {takes_error, takes_sliding, takes_held, takes_integral, takes_reference, takes_acceleration,
        takes_velocity, takes_word};
    wire [7:0] takes_now =
        now == 5'd0 | now == 5'd8 | now == 5'd12 ? 8'h08 : now == 5'd1 | now == 5'd13 ? 8'h02 :
        now == 5'd2 | now == 5'd7 | now == 5'd10 | now == 5'd16 ? 8'h20 : now == 5'd3 | now == 5'd15 ? 8'h80 :
        now == 5'd4 | now == 5'd9 ? 8'h01 : now == 5'd5 ? (is_pid ? 8'h10 : is_linear ? 8'h00 : 8'h01) :
        now == 5'd6 ? (is_linear ? 8'h80 : 8'h40) : now == 5'd11 ? 8'h04 : 8'h10;
    wire signed [31:0] operand_now =
        now == 5'd0 | now == 5'd8 | now == 5'd12 ? velocity_reference : now == 5'd1 | now == 5'd13 ? velocity :
        now == 5'd3 | now == 5'd15 ? error : now == 5'd4 | now == 5'd9 ? word :
        now == 5'd5 ? (is_pid ? integral : is_linear ? 32'sd0 : word) : now == 5'd6 ? (is_linear ? error : sliding) :
        now == 5'd11 ? acceleration_reference : now == 5'd14 ? integral : held;
    wire [3:0] address_now =
        now == 5'd4 ? 4'd1 : now == 5'd5 ? (is_linear ? 4'd15 : 4'd4) : now == 5'd6 ? (is_linear ? 4'd14 : 4'd3) :
        now == 5'd7 ? (is_linear ? 4'd13 : 4'd2) : now == 5'd8 ? 4'd5 : now == 5'd9 ? 4'd10 : now == 5'd10 ? 4'd6 :
        now == 5'd11 ? 4'd7 : now == 5'd12 ? 4'd8 : now == 5'd13 ? 4'd9 : now == 5'd14 ? 4'd11 : now == 5'd16 ? 4'd12 : 4'd0;
    wire       is_unit = is_plain | is_sum;

    // Values of the registers in the previous clock.
    reg signed [31:0] past_error = 32'sd0;
    reg signed [31:0] past_sliding = 32'sd0;
    reg signed [31:0] past_command = 32'sd0;
    reg signed [31:0] past_held = 32'sd0;
    reg signed [31:0] past_integral = 32'sd0;
    reg signed [31:0] past_word = 32'sd0;
    reg signed [17:0] past_duty = 18'sd0;
    reg signed [51:0] past_sum = 52'sd0;
    reg               past_cut = 1'b0;
    reg               past_negative = 1'b0;
    // The step that ended in that clock, 31 for none; and whether it was the limit's.
    reg [4:0]         past_settled = 5'd31;
    reg               past_limits = 1'b0;
    reg               past_taken = 1'b0;
    reg               past_add = 1'b0;
    reg               past_empty = 1'b0;
    reg               past_check = 1'b0;
    reg               past_clear = 1'b0;
    reg               past_clear_integral = 1'b0;
    reg               past_overrun = 1'b0;
    reg               past_collides = 1'b0;
    reg               past_frozen = 1'b0;
    reg [6:0]         past_saturated_high = 7'd0;
    reg [6:0]         past_saturated_low = 7'd0;
    reg               against = 1'b0;
    wire              lowers = error[31] ^ against;
    always @(posedge clk) begin
        past_error <= error;
        past_sliding <= sliding;
        past_command <= command;
        past_held <= held;
        past_integral <= integral;
        past_word <= word;
        past_duty <= duty;
        past_sum <= sum;
        past_cut <= cut;
        past_negative <= negative;
        past_settled <= runs & settles & !rst ? now : 5'd31;
        past_limits <= runs & now == 5'd14;
        past_taken <= taken;
        past_add <= add;
        past_empty <= empty;
        past_check <= check;
        past_clear <= clear_flags;
        past_clear_integral <= clear_integral;
        past_overrun <= overrun;
        past_collides <= start & runs;
        past_frozen <= !is_pid | was_cleared | (lowers ? limited_low : limited_high);
        past_saturated_high <= saturated_high;
        past_saturated_low <= saturated_low;
        // The sign of the integral's gain, and then that of the feedback.
        if (rst) against <= 1'b0;
        else if (now == 5'd5 & at == 6'd1) against <= setting[17];
        else if (now == 5'd10 & at == 6'd1) against <= against ^ setting[17];
    end

    // Both terms of the integral's sum, from the operand to the sum.
    wire signed [32:0] wide_error = {{9{error[31]}}, error[31:8]};
    wire signed [32:0] wide_integral = {integral[31], integral};
    wire signed [32:0] integrated = wide_integral + wide_error;
    wire signed [51:0] wide_integrated = {{19{integrated[32]}}, integrated};
    wire signed [31:0] integrated_word = integrated > 33'sd2147483647 ? 32'sh7fffffff :
        integrated < -33'sd2147483648 ? 32'sh80000000 : integrated[31:0];
    wire               integrated_cut = integrated[32] != integrated[31];
    // The integral has been cleared since its sum began.
    reg                was_cleared = 1'b0;
    always @(posedge clk) was_cleared <= !rst & (now == 5'd14 | is_sum) & (was_cleared | clear_integral);
    wire               sums = (now == 5'd14 | is_sum) & !cleared;
    wire signed [31:0] term = is_sum ? error : integral;
    wire signed [50:0] wide_term = {{18{term[31]}}, term, 1'b0};
    wire [5:0]         moved = at - 6'd4;
    wire signed [50:0] moved_term = wide_term >>> (is_sum & !is_added ? moved : shifting);
    wire signed [51:0] sum_before = is_added ? wide_integrated : {{20{integral[31]}}, integral};
    // Flags that a word of the previous clock sets, a clock later.
    wire [6:0] flag_of = past_settled == 5'd1 ? 7'h02 : past_settled == 5'd3 ? 7'h04 : past_settled == 5'd7 ? 7'h08 :
        past_settled == 5'd15 & !past_frozen & !past_clear_integral ? 7'h10 : past_settled == 5'd14 ? 7'h20 :
        past_settled == 5'd16 ? 7'h40 : 7'h00;
    wire       is_high = past_settled == 5'd14 ? limited_high : cut & !negative;
    wire       is_low = past_settled == 5'd14 ? limited_low : cut & negative;
    reg  [6:0] due_high = 7'h00;
    reg  [6:0] due_low = 7'h00;
    always @(posedge clk) {due_high, due_low} <= rst | past_reset ? 14'd0 : {flag_of & {7{is_high}}, flag_of & {7{is_low}}};

    always @(*) begin
        known_place: assert (busy == runs & step == now & phase == phase_of & clock <= LAST_CLOCK & now <= 5'd16 & at <= end_of_step);
        known_clock: assert (runs ? clock == before + {4'd0, at} + 10'd1 : now == 5'd0 & at == 6'd0);
        known_law: assert (linear == is_linear & integrates == is_pid & opposes == against & (!is_pid | is_linear));
        known_done: assert (!runs | (added == is_added & products == now + {4'd0, is_added}));
        known_rest: assert (runs | (!added & !is_read));
        known_strobes: assert (!runs | (is_read == (at == 6'd2 | at == 6'd3) &
            (at < 6'd4 | (is_loaded & shifts == (is_added ? shifts : at - 6'd4)))));
        known_terms: assert (!runs | (begins & !is_begun) | terms == (begins ? 3'd0 : terms_before) + {2'd0, is_added});
        known_operand: assert (!runs | at == 6'd0 | takes == takes_now);
        known_settled: assert ((past_settled == 5'd31 | (runs & past_settled == now & step_ends)) & (!past_reset | !runs));
        known_frozen: assert (past_settled != 5'd15 | past_clear_integral |
            past_frozen == (!is_pid | was_cleared | (lowers ? limited_low : limited_high)));
        latency_exact: assert (valid == due);
        ends_before_valid: assert (ends == (clock == LAST_CLOCK) & (!ends | busy));
        setting_of_step: assert (setting_address == address_now);
        operand_of_step: assert (!runs | at != 6'd1 | operand == operand_now);
        factor_of_step: assert (!runs | at != 6'd1 | (mantissa == (now == 5'd1 ? 18'h3ffff : is_unit ? 18'd1 : setting[17:0]) &
            distance == (is_unit ? 5'd8 : setting[22:18])));
        product_whole: assert (!(runs & add) | (is_loaded & shifts == shifting));
        added_once: assert (add == (runs & adds) & (!valid | products == 5'd17));
        begins_anew: assert (empty == (runs & begins & at == 6'd2));
        six_terms: assert (terms <= 3'd6);
        sum_only_by_add: assert (past_reset | past_add | past_empty | sum == past_sum);
        words_of_steps: assert (check == (runs & checks & now != 5'd14) & as_fraction == (now == 5'd4 | now == 5'd8) &
            as_duty == (now == 5'd16));
        word_by_check: assert (past_reset | past_check | (word == past_word & cut == past_cut & negative == past_negative));
        takes_far_apart: assert (take == (runs & now == 5'd14 & at == 6'd1) & inverted == (runs & now == 5'd14 & at == 6'd2) &
            compares == (runs & now == 5'd14 & at == 6'd3) & returns == (runs & now == 5'd14 & at == 6'd4) &
            cuts == (runs & now == 5'd14 & at == 6'd5) & decides == (runs & now == 5'd14 & at == 6'd6) &
            keep == (runs & settles & (now == 5'd1 | now == 5'd7 | now == 5'd13)));
        error_at_start: assert (past_reset | past_taken | error == past_error);
        only_in_its_clock: assert (past_reset | (
            (past_settled == 5'd3 | sliding == past_sliding) &
            (past_settled == 5'd1 | past_settled == 5'd7 | past_settled == 5'd13 | past_limits | held == past_held) &
            (past_settled == 5'd14 | command == past_command) &
            (past_settled == 5'd16 | duty == past_duty) &
            (past_settled == 5'd15 | past_clear_integral | integral == past_integral)));
        takes_the_word: assert (past_reset | (
            (past_settled != 5'd3 | sliding == past_word) &
            ((past_settled != 5'd1 & past_settled != 5'd7 & past_settled != 5'd13) | held == past_word) &
            (past_settled != 5'd14 | command == past_held) &
            (past_settled != 5'd16 | duty == past_word[17:0])));
        known_factor: assert (!sums | at != 6'd2 | (upper_factor == 18'sd1 & lower_factor == 18'sd1 &
            {upper_operand, lower_operand} == {term[31:17], 1'b0, term[16:0]}));
        known_product: assert (!sums | at != 6'd3 | (upper_product == {{18{term[31]}}, term[31:17]} &
            lower_product == {19'd0, term[16:0]}));
        known_left: assert (!is_sum | at < 6'd2 | left == (at < 6'd4 ? 5'd8 : is_added ? 5'd0 : 5'd8 - moved[4:0]));
        known_shifted: assert (!sums | at < 6'd4 | is_added | shifter == moved_term);
        known_sum: assert (!sums | (now == 5'd14 & !is_added) | sum == (is_sum ? sum_before : {{20{integral[31]}}, integral}) |
            (is_sum & past_settled == 5'd15));
        known_begun: assert (now != 5'd14 | cleared | !is_begun | is_added | sum == 52'sd0);
        known_word: assert (!(is_sum & settles & !cleared) |
            (word == integrated_word & cut == integrated_cut & (!cut | negative == integrated[32])));
        frozen: assert (past_reset | past_clear_integral | !past_frozen | integral == past_integral);
        integral_exact: assert (past_reset | past_clear_integral | past_settled != 5'd15 | past_frozen |
            integral == past_integrated);
        clears: assert (past_reset | !past_clear_integral | integral == 32'sd0);
        known_cleared: assert (!(now == 5'd14 | is_sum) | !runs | cleared == was_cleared);
        flags_held: assert (past_reset | past_clear |
            ((past_saturated_high & ~saturated_high) == 7'd0 & (past_saturated_low & ~saturated_low) == 7'd0));
        flags_of_words: assert ((saturated_high & due_high) == due_high & (saturated_low & due_low) == due_low);
        overrun_found: assert (past_reset | overrun == (past_collides | (past_overrun & !past_clear)));
    end
    reg signed [31:0] past_integrated = 32'sd0;
    always @(posedge clk) past_integrated <= integrated_word;

    always @(*) begin
        reach_start: cover (clock == 10'd1);
        reach_valid: cover (valid);
        reach_overrun: cover (overrun);
        reach_error: cover (error != 32'sd0 & runs);
    end
endmodule
