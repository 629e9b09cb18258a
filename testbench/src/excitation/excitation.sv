// excitation: a test signal stays within its amplitude, and is added only while it is allowed.
//
// Proven for all inputs in every clock, resets and changes of settings included; nothing is assumed. The limit of a signal is
// the largest min(amplitude, amplitude_limit) while it ran; with constant settings, that of its start.
//
//   never_beyond       neither excitation_value nor what is added to the position is larger in size than that limit
//   added_at_a_tick    a clock after each valid position_reference is y_0 plus excitation_value, at the end of its word where the
//                      sum is beyond it (modulo 2^32 with modulo), velocity and acceleration are y_1 and y_2; else nothing
//                      changes
//   off_is_zero        excitation_value is 0 after each valid in which no signal ran: then position_reference is y_0
//   starts_...         a signal starts at a valid alone, with enable, allowed, a kind and a duration, and enable low since the
//                      reset and the last start; then always
//   cut_off            it runs in no clock after one in which enable, allowed or kind were 0
//   ends_after_all     a kept duration_ticks is the number of references with a signal when it ends by itself, unless too fast;
//   never_longer       it never gets more
//   done_...           excitation_done is one clock, the first after the end by itself, and never for a signal that is cut off
//   square             PRBS and square are exactly + or - the amplitude of the signal when its value is finished, with settings
//                      that are kept
//   known_...          invariants
//
// Not proven here: angle, frequency and bits of the signals.
module excitation_properties (
    `PORTS,
    (* peek = "ticks" *) input wire [23:0] ticks,
    (* peek = "armed" *) input wire armed,
    (* peek = "value_q" *) input wire signed [16:0] shown,
    (* peek = "u_wave.value_q" *) input wire signed [16:0] wave,
    (* peek = "u_wave.phase" *) input wire [1:0] phase,
    (* peek = "u_wave.clocks" *) input wire [3:0] clocks,
    (* peek = "u_wave.negative" *) input wire negative,
    (* peek = "u_wave.too_fast" *) input wire too_fast
);
    localparam [1:0] SCALES = 2'd3;
    wire wanted = enable & allowed & kind != 2'd0;

    // The limit now, and its largest value while the signal has run.
    wire [15:0] bounded = amplitude > amplitude_limit ? amplitude_limit : amplitude;
    reg  [15:0] most = 16'd0;
    reg  [15:0] most_shown = 16'd0;
    reg         past_valid = 1'b0;
    reg         past_active = 1'b0;
    reg         past_wanted = 1'b0;
    reg         past_reset = 1'b1;
    reg         past_modulo = 1'b0;
    reg         past_fast = 1'b0;
    reg         past_may_start = 1'b0;
    reg         past_ended = 1'b0;
    reg         past_rests = 1'b1;
    reg         rested = 1'b0;
    reg  [23:0] references = 24'd0;
    reg  [23:0] past_references = 24'd0;
    reg  [23:0] duration = 24'd0;
    reg         kept = 1'b0;
    reg  signed [31:0] past_y_0 = 32'sd0;
    reg  signed [31:0] past_y_1 = 32'sd0;
    reg  signed [31:0] past_y_2 = 32'sd0;
    reg  signed [31:0] past_position = 32'sd0;
    reg  signed [31:0] past_velocity = 32'sd0;
    reg  signed [31:0] past_acceleration = 32'sd0;
    reg  signed [31:0] past_value = 32'sd0;
    wire        may_start = valid & wanted & rested & !excitation_active & duration_ticks != 24'd0;
    wire        lasts = kept & duration_ticks == duration;
    always @(posedge clk) begin
        if (rst | !excitation_active) most <= 16'd0;
        else if (bounded > most) most <= bounded;
        if (rst) most_shown <= 16'd0;
        else if (valid) most_shown <= excitation_active ? most : 16'd0;
        past_valid <= !rst & valid;
        past_active <= !rst & excitation_active;
        past_wanted <= wanted;
        past_reset <= rst;
        past_modulo <= modulo;
        past_fast <= too_fast;
        past_may_start <= !rst & may_start;
        past_ended <= references == duration_ticks;
        past_rests <= rst | !excitation_active;
        // Enable was low after the reset and after the last start.
        rested <= !rst & (!enable | (rested & !may_start));
        references <= rst | !excitation_active ? 24'd0 : references + {23'd0, valid};
        past_references <= references;
        if (!excitation_active) duration <= duration_ticks;
        kept <= !excitation_active | lasts;
        past_y_0 <= y_0;
        past_y_1 <= y_1;
        past_y_2 <= y_2;
        past_position <= position_reference;
        past_velocity <= velocity_reference;
        past_acceleration <= acceleration_reference;
        past_value <= excitation_value;
    end

    wire signed [32:0] sum = past_y_0 + excitation_value;
    wire               beyond = !past_modulo & sum[32] != sum[31];
    wire signed [31:0] expected = beyond ? (sum[32] ? 32'sh80000000 : 32'sh7fffffff) : sum[31:0];
    wire        [16:0] wave_size = wave < 17'sd0 ? -wave : wave;
    wire        [31:0] value_size = excitation_value < 32'sd0 ? -excitation_value : excitation_value;
    always @(*) begin
        never_beyond: assert (value_size <= {16'd0, most_shown});
        added_at_a_tick: assert (!past_valid | (position_reference == expected & velocity_reference == past_y_1
            & acceleration_reference == past_y_2));
        added_only_then: assert (past_reset | past_valid | (position_reference == past_position
            & velocity_reference == past_velocity & acceleration_reference == past_acceleration
            & excitation_value == past_value));
        added_known: assert (reference_valid == past_valid);
        off_is_zero: assert (!(past_valid & past_rests) | (excitation_value == 32'sd0 & position_reference == past_y_0));
        starts_only_so: assert (!(excitation_active & !past_active) | past_may_start);
        starts_always: assert (!past_may_start | excitation_active);
        cut_off: assert (!excitation_active | past_wanted);
        ends_after_all: assert (!excitation_done | past_fast | past_ended);
        never_longer: assert (!(excitation_active & lasts) | references <= duration_ticks);
        done_at_end: assert (!excitation_done | (!excitation_active & past_active & past_wanted));
        done_always: assert (excitation_done == (past_active & !excitation_active & past_wanted & !past_reset));
        known_wave: assert (wave_size <= {1'b0, most} & (excitation_active | wave == 17'sd0));
        known_shown: assert (excitation_value == shown);
        known_ticks: assert (ticks == (excitation_active ? references : 24'd0));
        known_armed: assert (armed == rested);
    end

    // For a square or a PRBS with constant settings since the start of a value: the amplitude minus what is still missing.
    reg         exact = 1'b0;
    reg  [15:0] of = 16'd0;
    reg         is_negative = 1'b0;
    wire        levels = kind == 2'd1 | kind == 2'd3;
    wire        stays = exact & bounded == of & negative == is_negative;
    wire        begins = phase == SCALES & clocks == 4'd0 & wave == 17'sd0;
    wire [16:0] missing = {1'b0, of} - (is_negative ? -wave : wave);
    reg         finished = 1'b0;
    always @(posedge clk) begin
        exact <= !rst & excitation_active & levels & !valid & (begins | stays);
        if (begins) begin
            of <= bounded;
            is_negative <= negative;
        end
        finished <= !rst & phase == SCALES & &clocks & stays & levels & !valid & excitation_active;
    end
    always @(*) begin
        square: assert (!finished | !excitation_active | wave == (is_negative ? -{1'b0, of} : {1'b0, of}));
        known_missing: assert (!(exact & phase == SCALES & excitation_active) | missing == {1'b0, of >> clocks});
    end

    always @(*) begin
        reach_value: cover (past_valid & excitation_value > 32'sd256);
        reach_below: cover (past_valid & excitation_value < -32'sd256 & y_0 == 32'sd0);
        reach_done: cover (excitation_done & references == 24'd2);
        reach_cut_off: cover (past_active & !excitation_active & !excitation_done & !past_reset);
        reach_finished: cover (finished & of == 16'd1000);
    end
endmodule
