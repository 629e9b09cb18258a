// sliding_mode: the control of a pass, with the product left uninterpreted: what the multipliers say is anything, in every clock.
//
// Proven for all inputs in every clock, resets included; nothing is assumed. A pass has 13 steps of 16 clocks; its clocks are
// counted here on their own, from 1 in the clock after `start` on.
//
//   latency_exact     valid comes PASS_CLOCKS after a start that was taken, and at no other time; busy in between
//   setting_of_step   the address of each step's setting, by law
//   operand_of_step   what each step multiplies, by law
//   sum_only_by_add   the sum changes by an addition only
//   product_whole     each product is read, loaded two clocks later, shifted for ten clocks, and then added: as scaled_product.sv
//                     has it
//   added_once        each step adds one product, in its clock 14; no other clock adds; 13 have been added at valid
//   begins_anew       which steps begin a sum
//   six_terms         no sum has more: as accumulator.sv has it
//   takes_far_apart   the limiter takes once a pass, in clock 1 of step 11, and decides two clocks later: as limiter.sv has it
//   only_in_its_clock s, f, a, command, integral and duty change in the clock of their step alone, after its last product
//   takes_the_word    and are then the sum's word
//   error_at_start    e and de change in the clock of a start alone
//   frozen            the integral takes e only in PID, and not while the command is cut on the side to which e pushes it
//   integral_exact    it then takes the whole of e, or stops at an end
//   clears            clear_integral makes it 0
//   flags_held        sticky flags fall by clear_flags or reset only
//   flags_of_words    a cut of s, a or duty shows, a clock after the word, even when the flags are cleared in its clock
//   overrun_found     a start in a pass is ignored and flagged
//   known_*           invariants
//
// With accumulator.sv, scaled_product.sv and limiter.sv: a pass is the sums of the datasheet of rounded products, cut once.
// Left open: that the multipliers multiply, the meaning of the gains, e and de themselves (lock step).
module sliding_mode_properties (
    input wire        clk,
    input wire        rst,
    input wire        start,
    input wire [1:0]  law,
    input wire signed [31:0] velocity_reference,
    input wire signed [31:0] acceleration_reference,
    input wire signed [31:0] velocity,
    input wire [31:0] setting,
    input wire        clear_integral,
    input wire        clear_flags,
    input wire [3:0]  setting_address,
    input wire signed [31:0] error,
    input wire signed [31:0] sliding,
    input wire signed [31:0] command,
    input wire signed [17:0] duty,
    input wire        valid,
    input wire        busy,
    input wire        limited_high,
    input wire        limited_low,
    input wire [6:0]  saturated_high,
    input wire [6:0]  saturated_low,
    input wire        overrun,
    (* peek = "u_sequencer.step_q" *) input wire [3:0] step,
    (* peek = "u_sequencer.phase" *) input wire [3:0] phase,
    (* peek = "u_sequencer.linear_q" *) input wire linear,
    (* peek = "u_sequencer.integrates_q" *) input wire integrates,
    (* peek = "u_tracking.error_rate_q" *) input wire signed [31:0] error_rate,
    (* peek = "operand_q" *) input wire signed [31:0] operand,
    (* peek = "fraction" *) input wire signed [25:0] fraction,
    (* peek = "feedback" *) input wire signed [31:0] feedback,
    (* peek = "opposes" *) input wire opposes,
    (* peek = "u_scaled_product.read" *) input wire read,
    (* peek = "u_scaled_product.load" *) input wire load,
    (* peek = "u_scaled_product.shift" *) input wire shift,
    (* peek = "u_accumulator.add" *) input wire add,
    (* peek = "u_accumulator.begin_sum" *) input wire begin_sum,
    (* peek = "u_accumulator.begin_rate" *) input wire begin_rate,
    (* peek = "u_accumulator.word" *) input wire signed [31:0] word,
    (* peek = "u_accumulator.sum_q" *) input wire signed [51:0] sum,
    (* peek = "u_accumulator.high" *) input wire word_high,
    (* peek = "u_accumulator.low" *) input wire word_low,
    (* peek = "u_limiter.take" *) input wire take,
    (* peek = "u_limiter.compares_q" *) input wire compares,
    (* peek = "u_limiter.decides_q" *) input wire decides,
    (* peek = "u_integral.integral_q" *) input wire signed [31:0] integral,
    (* peek = "u_cut_high.found" *) input wire [6:0] found_high,
    (* peek = "u_cut_low.found" *) input wire [6:0] found_low
);
    localparam [7:0] LAST_CLOCK = `PASS_CLOCKS - 8'd1;

    // Clock of the pass, 0: none.
    reg [7:0] clock = 8'd0;
    reg       past_reset = 1'b1;
    reg       due = 1'b0;
    reg       is_linear = 1'b0;
    reg       is_pid = 1'b0;
    wire      taken = start & clock == 8'd0;
    always @(posedge clk) begin
        past_reset <= rst;
        due <= !rst & clock == LAST_CLOCK;
        if (rst) clock <= 8'd0;
        else if (taken) clock <= 8'd1;
        else if (clock == LAST_CLOCK) clock <= 8'd0;
        else if (clock != 8'd0) clock <= clock + 8'd1;
        if (rst) {is_linear, is_pid} <= 2'b00;
        else if (taken) {is_linear, is_pid} <= {law != 2'd0, law == 2'd2};
    end
    wire [7:0] place = clock == 8'd0 ? 8'd0 : clock - 8'd1;
    wire       runs = clock != 8'd0;
    wire [3:0] now = place[7:4];
    wire [3:0] at = place[3:0];

    // What has been done of a step.
    reg       added = 1'b0;
    reg [3:0] products = 4'd0;
    reg [2:0] terms = 3'd0;
    reg [3:0] shifts = 4'd0;
    reg       is_read = 1'b0;
    reg       is_loaded = 1'b0;
    always @(posedge clk) begin
        if (rst) begin
            added <= 1'b0;
            products <= 4'd0;
            terms <= 3'd0;
            shifts <= 4'd0;
            is_read <= 1'b0;
            is_loaded <= 1'b0;
        end else begin
            added <= (added | add) & at != 4'd15;
            products <= taken ? 4'd0 : products + {3'd0, add};
            if (add) terms <= begin_sum | begin_rate ? 3'd1 : terms + 3'd1;
            if (load) shifts <= 4'd0;
            else if (shift & shifts != 4'd15) shifts <= shifts + 4'd1;
            is_read <= read | (is_read & !load);
            is_loaded <= (load & is_read) | (is_loaded & !read & !load);
        end
    end
    wire [3:0] done = now + {3'd0, at == 4'd15};
    wire [2:0] terms_before =
        now == 4'd3 | now == 4'd7 ? 3'd1 : now == 4'd4 | now == 4'd8 ? 3'd2 : now == 4'd9 ? 3'd3 :
        now == 4'd10 ? 3'd4 : now == 4'd11 ? 3'd5 : 3'd0;
    wire       begins = now == 4'd0 | now == 4'd1 | now == 4'd2 | now == 4'd5 | now == 4'd6 | now == 4'd12;

    wire signed [31:0] operand_now =
        now == 4'd0 ? error : now == 4'd1 ? sliding : now == 4'd2 ? error_rate :
        now == 4'd3 ? (is_linear ? error : sliding) :
        now == 4'd4 ? (is_pid ? integral : is_linear ? 32'sd0 : {{6{fraction[25]}}, fraction}) :
        now == 4'd5 | now == 4'd8 ? velocity_reference : now == 4'd6 ? feedback :
        now == 4'd7 ? acceleration_reference : now == 4'd9 ? velocity :
        now == 4'd10 ? {{6{fraction[25]}}, fraction} : command;
    wire [3:0] address_now = is_linear & now >= 4'd2 & now <= 4'd4 ? now + 4'd11 : now;

    // The registers a clock earlier.
    reg signed [31:0] past_error = 32'sd0;
    reg signed [31:0] past_rate = 32'sd0;
    reg signed [31:0] past_sliding = 32'sd0;
    reg signed [31:0] past_command = 32'sd0;
    reg signed [31:0] past_feedback = 32'sd0;
    reg signed [31:0] past_integral = 32'sd0;
    reg signed [31:0] past_operand = 32'sd0;
    reg signed [31:0] past_word = 32'sd0;
    reg signed [25:0] past_fraction = 26'sd0;
    reg signed [17:0] past_duty = 18'sd0;
    reg signed [51:0] past_sum = 52'sd0;
    reg [7:0]         past_place = 8'd0;
    reg               past_taken = 1'b0;
    reg               past_add = 1'b0;
    reg               past_clear = 1'b0;
    reg               past_clear_integral = 1'b0;
    reg               past_overrun = 1'b0;
    reg               past_collides = 1'b0;
    reg               past_frozen = 1'b0;
    reg [6:0]         past_saturated_high = 7'd0;
    reg [6:0]         past_saturated_low = 7'd0;
    reg               past_word_high = 1'b0;
    reg               past_word_low = 1'b0;
    reg               against = 1'b0;
    wire              lowers = error[31] ^ against;
    always @(posedge clk) begin
        past_error <= error;
        past_rate <= error_rate;
        past_sliding <= sliding;
        past_command <= command;
        past_feedback <= feedback;
        past_integral <= integral;
        past_operand <= operand_now;
        past_word <= word;
        past_fraction <= fraction;
        past_duty <= duty;
        past_sum <= sum;
        past_place <= place;
        past_taken <= taken;
        past_add <= add;
        past_clear <= clear_flags;
        past_clear_integral <= clear_integral;
        past_overrun <= overrun;
        past_collides <= start & runs;
        past_frozen <= !is_pid | (lowers ? limited_low : limited_high);
        past_saturated_high <= saturated_high;
        past_saturated_low <= saturated_low;
        past_word_high <= word_high;
        past_word_low <= word_low;
        // The sign of the integral's gain, and of the feedback's after it.
        if (rst) against <= 1'b0;
        else if (runs & place == 8'h41) against <= setting[17];
        else if (runs & place == 8'h61) against <= against ^ setting[17];
    end
    wire signed [32:0] wide_error = {{9{past_error[31]}}, past_error[31:8]};
    wire signed [32:0] wide_integral = $signed({past_integral[31], past_integral}) + wide_error;
    wire signed [31:0] integrated =
        wide_integral > 33'sd2147483647 ? 32'sh7fffffff : wide_integral < -33'sd2147483648 ? 32'sh80000000 : wide_integral[31:0];
    // A sum has been taken: s, a and duty. Its flag comes a clock later.
    wire [6:0] flag_of = past_place == 8'h0f ? 7'h04 : past_place == 8'h4f ? 7'h08 : past_place == 8'hcf ? 7'h40 : 7'h00;
    wire [6:0] cut_high = past_word_high & !past_reset ? flag_of : 7'h00;
    wire [6:0] cut_low = past_word_low & !past_reset ? flag_of : 7'h00;
    reg  [6:0] due_high = 7'h00;
    reg  [6:0] due_low = 7'h00;
    always @(posedge clk) {due_high, due_low} <= rst ? 14'd0 : {cut_high, cut_low};

    always @(*) begin
        known_place: assert (busy == runs & {step, phase} == place & clock <= LAST_CLOCK);
        known_law: assert (linear == is_linear & integrates == is_pid & opposes == against);
        known_done: assert (!runs | (added == (at == 4'd15) & products == done));
        known_rest: assert (runs | (!added & !is_read));
        known_strobes: assert (!runs | (is_read == (at == 4'd2 | at == 4'd3) & (at < 4'd4 | (is_loaded & shifts == at - 4'd4))));
        known_terms: assert (!runs | begins & at != 4'd15 | terms == terms_before + {2'd0, at == 4'd15});
        latency_exact: assert (valid == due);
        setting_of_step: assert (setting_address == address_now);
        operand_of_step: assert (!runs | at != 4'd1 | operand == past_operand);
        product_whole: assert (!(runs & add) | (is_loaded & shifts == 4'd10));
        added_once: assert (add == (at == 4'd14) & (!valid | products == 4'd13));
        begins_anew: assert (!(runs & add) | ((begin_sum | begin_rate) == begins & begin_rate == (now == 4'd0)));
        six_terms: assert (terms <= 3'd6);
        sum_only_by_add: assert (past_reset | past_add | sum == past_sum);
        takes_far_apart: assert (take == (runs & place == 8'hb1) & compares == (runs & place == 8'hb2) &
            decides == (runs & place == 8'hb3));
        error_at_start: assert (past_reset | past_taken | (error == past_error & error_rate == past_rate));
        only_in_its_clock: assert (past_reset | (
            (past_place == 8'h0f | sliding == past_sliding) &
            (past_place == 8'h1f | past_place == 8'h5f | fraction == past_fraction) &
            (past_place == 8'h4f | feedback == past_feedback) &
            (past_place == 8'hb3 | command == past_command) &
            (past_place == 8'hcf | duty == past_duty) &
            (past_place == 8'hbf | past_clear_integral | integral == past_integral)));
        takes_the_word: assert (past_reset | (
            (past_place != 8'h0f | sliding == past_word) &
            ((past_place != 8'h1f & past_place != 8'h5f) | fraction == past_word[25:0]) &
            (past_place != 8'h4f | feedback == past_word) &
            (past_place != 8'hcf | duty == past_word[17:0])));
        frozen: assert (past_reset | past_clear_integral | !past_frozen | integral == past_integral);
        integral_exact: assert (past_reset | past_clear_integral | past_place != 8'hbf | past_frozen | integral == integrated);
        clears: assert (past_reset | !past_clear_integral | integral == 32'sd0);
        flags_held: assert (past_reset | past_clear |
            ((past_saturated_high & ~saturated_high) == 7'd0 & (past_saturated_low & ~saturated_low) == 7'd0));
        known_found: assert ((found_high & cut_high) == cut_high & (found_low & cut_low) == cut_low);
        flags_of_words: assert ((saturated_high & due_high) == due_high & (saturated_low & due_low) == due_low);
        overrun_found: assert (past_reset | overrun == (past_collides | (past_overrun & !past_clear)));
    end

    always @(*) begin
        reach_start: cover (clock == 8'd1);
        reach_valid: cover (valid);
        reach_overrun: cover (overrun);
        reach_error: cover (error != 32'sd0 & runs);
        reach_frozen: cover (past_frozen & past_place == 8'hbf & is_pid);
    end
endmodule
