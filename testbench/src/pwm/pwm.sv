// pwm: what its pins never do, whatever the inputs are.
//
// The properties are proven for every input in every clock, including resets, with 16-bit periods, 10-bit times and all modes.
// Assumed: mask_pins is low; while it is high all pins are off, whatever the gates do. The raw fault lines count as in a cycle
// simulation: as they are in this clock.
//
//   never_both_*        a leg's two sides are never on together
//   dead_time_*         a side comes on only after the other has been off for dead_time_used clocks, in every mode
//   minimum_pulse_*     a side that goes off while running, in the same mode and without a fault, was on for
//                       minimum_pulse_used clocks (mode 0: the PWM pin only; b_high is a direction)
//   fault_is_off        a raw fault or a lost PLL: all off in the same clock
//   latched_is_off      all off until clear_trip, however short the fault was
//   stopped_is_off      all off one clock after running has fallen, and so two after enable has
//   floor               the times in use are never below their floors
//   has_slack           while running the period is not 2 (dead_time_used + minimum_pulse_used): a leg that is late catches up
//   starts_in_phase     with a time base (built for one, or after the first sync) it starts only after a sync that found the
//                       carrier at its phase, with the period that is in use since
//
// Not proven here: where in the period an edge is, and pulses shorter than a clock (testbench/tests/pwm_pins.rs, pwm_fault.rs).
// The invariants (`known_*`) tie the monitors below to the leg's timer. They are proven with the rest, not assumed.

`ifndef PINS_OFF
`define PINS_OFF 4'b0000
`endif
`ifndef ON_TIME_BASE
`define ON_TIME_BASE 1'b0
`endif
`ifndef DEAD_TIME_FLOOR
`define DEAD_TIME_FLOOR 10'd2
`endif
`ifndef MINIMUM_PULSE_FLOOR
`define MINIMUM_PULSE_FLOOR 10'd1
`endif

module pwm_properties (
    `PORTS,
    (* peek = "mode_q" *) input wire [1:0] mode_used,
    (* peek = "negative_q" *) input wire negative_used,
    (* peek = "off_q" *) input wire mode_turns,
    (* peek = "wanted" *) input wire wanted,
    (* peek = "u_leg.awake_q" *) input wire leg_awake,
    (* peek = "u_leg.lit_q" *) input wire leg_lit,
    (* peek = "u_leg.high_q" *) input wire leg_high,
    (* peek = "u_leg.timer" *) input wire [9:0] leg_count,
    (* peek = "u_pin_gates.masked" *) input wire masked,
    (* peek = "u_carrier.position" *) input wire [15:0] position,
    (* peek = "u_carrier.period_q" *) input wire [16:0] period_used,
    (* peek = "u_carrier.synced" *) input wire synced,
    (* peek = "u_carrier.astray" *) input wire astray,
    (* peek = "u_carrier.timed" *) input wire timed,
    (* peek = "u_guard.fault_latch_armed" *) input wire latch_armed
);
    // Order of the bits: b_low, b_high, a_low, a_high; a side's other side is its neighbour.
    wire [3:0] on = {b_low, b_high, a_low, a_high} ^ `PINS_OFF;
    wire       gate_a_high = gates[0];
    wire       gate_a_low = gates[1];
    wire       gate_b_high = gates[2];
    wire       gate_b_low = gates[3];
    wire       raw_fault = !fault_n | !pll_locked;

    // Clocks that a side's other side must still stay off, and clocks that a side must still stay on.
    reg  [3:0] was_on = 4'd0;
    reg  [9:0] pause_left [0:3];
    reg  [9:0] pulse_left [0:3];
    integer    side;
    initial for (side = 0; side < 4; side = side + 1) begin
        pause_left[side] = 10'd0;
        pulse_left[side] = 10'd0;
    end
    always @(posedge clk) begin
        was_on <= on;
        for (side = 0; side < 4; side = side + 1) begin
            if (on[side] | !running) pause_left[side] <= dead_time_used;
            else if (|pause_left[side]) pause_left[side] <= pause_left[side] - 10'd1;
            if (on[side] & !was_on[side]) pulse_left[side] <= minimum_pulse_used - 10'd1;
            else if (|pulse_left[side]) pulse_left[side] <= pulse_left[side] - 10'd1;
        end
    end

    always @(*) assume (!mask_pins);

    // Values of the previous clock.
    reg       past_running = 1'b0;
    reg       past_reset = 1'b1;
    reg       past_enable = 1'b0;
    reg       past_raw_fault = 1'b1;
    reg       past_clear = 1'b0;
    reg       past_latched = 1'b1;
    reg       past_wanted = 1'b0;
    reg       past_negative = 1'b0;
    reg [1:0] past_mode = 2'd0;
    reg       latched = 1'b1;
    always @(posedge clk) begin
        past_running <= running & !rst;
        past_reset <= rst;
        past_enable <= enable;
        past_wanted <= wanted & !rst;
        past_negative <= negative_used;
        past_mode <= mode_used;
        // A latch of the properties, set by any raw fault or a reset, and cleared only by clear_trip.
        latched <= raw_fault | rst | (latched & !clear_trip);
    end

    always @(*) begin
        never_both_a: assert (!(on[0] & on[1]));
        never_both_b: assert (!(on[2] & on[3]));
        dead_time_a_high: assert (!on[0] | pause_left[1] == 10'd0);
        dead_time_a_low: assert (!on[1] | pause_left[0] == 10'd0);
        dead_time_b_high: assert (!on[2] | pause_left[3] == 10'd0);
        dead_time_b_low: assert (!on[3] | pause_left[2] == 10'd0);
        fault_is_off: assert (!raw_fault | on == 4'd0);
        latched_is_off: assert (!latched | on == 4'd0);
        reset_is_off: assert (!past_reset | on == 4'd0);
        stopped_is_off: assert (running | on == 4'd0);
        disabled_is_off: assert (past_enable | on == 4'd0);
        has_slack: assert (!running | period_used != {6'd0, {1'b0, dead_time_used} + {1'b0, minimum_pulse_used}} << 1);
        starts_in_phase: assert (!running | past_running | !timed_for[1] | past_in_phase);
        known_timed: assert (timed == has_time_base & synced == past_sync & (!timed | timed_for[0] | synced));
        known_phase: assert (!timed_for[0] | astray | in_phase);
        known_period: assert (period_used[16] == (period_used[15:0] == 16'd0));
        floor: assert (dead_time_used >= `DEAD_TIME_FLOOR & minimum_pulse_used >= `MINIMUM_PULSE_FLOOR);
    end

    // In phase: the last sync found the carrier at its phase, or it waited there for this sync; and the period is still the same.
    // `timed_for`: a time base has been present for one clock, or for two.
    reg        has_time_base = `ON_TIME_BASE;
    reg  [1:0] timed_for = {2{`ON_TIME_BASE}};
    reg        found = 1'b0;
    reg        past_in_phase = 1'b0;
    reg        past_sync = 1'b0;
    reg [16:0] past_period = 17'd32;
    wire       in_phase = found & period_used == past_period;
    wire       at_phase = position == phase;
    always @(posedge clk) begin
        has_time_base <= rst ? `ON_TIME_BASE : has_time_base | sync;
        timed_for <= rst ? {2{`ON_TIME_BASE}} : {timed_for[0], has_time_base};
        found <= !rst & (synced ? at_phase : in_phase) | (!rst & sync & astray & at_phase & !running & (!synced | at_phase));
        past_in_phase <= !rst & in_phase;
        past_sync <= !rst & sync;
        past_period <= period_used;
    end

    // A pulse ends by itself.
    wire [3:0] ended = was_on & ~on;
    wire       by_itself = running & past_wanted & !raw_fault & latch_armed;
    always @(*) begin
        minimum_pulse_a_high: assert (!(ended[0] & by_itself) | pulse_left[0] == 10'd0);
        minimum_pulse_a_low: assert (!(ended[1] & by_itself) | pulse_left[1] == 10'd0);
        minimum_pulse_b_high: assert (!(ended[2] & by_itself & past_mode != 2'd0) | pulse_left[2] == 10'd0);
        minimum_pulse_b_low: assert (!(ended[3] & by_itself) | pulse_left[3] == 10'd0);
    end

    // Invariants between pins, monitors and the leg's registers: the gates are the leg's, by mode and direction of the previous
    // clock.
    wire a_leads = past_mode != 2'd2 | !past_negative;
    wire b_leads = past_mode == 2'd2 & past_negative;
    wire b_holds = past_mode == 2'd2 & !past_negative;
    wire opposed = past_mode == 2'd3;
    wire leg_is_high = leg_lit & leg_high;
    wire leg_is_low = leg_lit & !leg_high;
    always @(*) begin
        known_unmasked: assert (!masked);
        known_a_high: assert (gate_a_high == (a_leads & leg_is_high));
        known_a_low: assert (gate_a_low == (a_leads ? past_mode != 2'd0 & leg_is_low : leg_awake));
        known_b_low: assert (gate_b_low == (b_leads ? leg_is_low : b_holds ? leg_awake : opposed & leg_is_high));
        known_b_high: assert (gate_b_high == (b_leads ? leg_is_high : opposed ? leg_is_low : past_mode == 2'd0 & past_negative & leg_awake));
        known_awake: assert (!leg_lit | leg_awake);
        known_wanted: assert (!leg_awake | past_wanted);
        known_running: assert (!past_wanted | running);
        known_mode: assert (past_mode == mode_used | mode_turns | !past_wanted);
        known_direction: assert (past_negative == negative_used | !leg_awake | leg_is_low);
        known_latched: assert (!latched | !latch_armed);
    end

    // The leg counts up to the duration of its state; this is the remaining time.
    wire [9:0] leg_lasts = leg_lit ? minimum_pulse_used : dead_time_used;
    wire [9:0] leg_timer = leg_lasts - leg_count;
    always @(*) begin
        known_timer: assert (leg_count <= leg_lasts | !past_wanted);
        known_timer_rests: assert (past_wanted | leg_count == 10'd0);
    end

    // When a side can come on next, the other one will have been off for the dead time.
    wire [3:0] ready;
    wire [3:0] long_enough;
    wire [3:0] in_range;
    genvar n;
    generate
        for (n = 0; n < 4; n = n + 1) begin : times
            assign ready[n] = {1'b0, pause_left[n]} <= {1'b0, leg_timer} + 11'd1;
            assign in_range[n] = pause_left[n] <= dead_time_used;
            assign long_enough[n] = {1'b0, was_on[n] ? pulse_left[n] : minimum_pulse_used} <= {1'b0, leg_timer} + 11'd1;
        end
    endgenerate
    wire asleep = running & !mode_turns & !leg_awake;
    wire pauses = !mode_turns & leg_awake & !leg_lit;
    wire next_high = leg_high;
    always @(*) begin
        known_range: assert (!running | (&in_range));
        known_start_a: assert (!asleep | (ready[0] & ready[1]));
        known_start_b: assert (!asleep | (ready[2] & ready[3]));
        known_direction_rested: assert (!(leg_awake & past_mode == 2'd0) | pause_left[3] == 10'd0);
        known_pause_a: assert (!(pauses & a_leads) | ready[next_high ? 1 : 0]);
        known_pause_b: assert (!(pauses & b_leads) | ready[next_high ? 3 : 2]);
        known_pause_opposed: assert (!(pauses & opposed) | ready[next_high ? 2 : 3]);
    end

    // A side that is on stays on for the minimum pulse.
    always @(*) begin
        known_a_high_time: assert (!(latch_armed & gate_a_high) | long_enough[0]);
        known_a_low_time: assert (!(latch_armed & gate_a_low) | (leg_lit ? long_enough[1] : (was_on[1] & pulse_left[1] == 10'd0)));
        known_b_high_time: assert (!(latch_armed & gate_b_high & past_mode != 2'd0) | long_enough[2]);
        known_b_low_time: assert (!(latch_armed & gate_b_low) | (leg_lit ? long_enough[3] : (was_on[3] & pulse_left[3] == 10'd0)));
    end

    // The properties are not empty: each side comes on, and its pulse ends by itself.
    always @(*) begin
        reach_a_high: cover (on[0] & past_mode == 2'd1);
        reach_a_low: cover (on[1] & past_mode == 2'd1);
        reach_direction: cover (on[2] & past_mode == 2'd0);
        reach_opposed: cover (on == 4'b1001 & past_mode == 2'd3);
        reach_b_leads: cover (on[2] & past_mode == 2'd2);
        reach_end: cover (ended[0] & by_itself);
        reach_fault_while_on: cover (raw_fault & was_on[0]);
        reach_cleared: cover (!latched & on != 4'd0);
    end
endmodule
