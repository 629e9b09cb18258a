// absolute_feedback: the count moves by exactly what the reading moves, from where the first reading places it.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed.
//
//   placed_in_range    the first reading places the axis at the reading less the offset, between -sign_bit and sign_bit - 1, and
//                      congruent to it modulo the range, for the sign bits that the encoder's sizes have
//   moves_as_read      a further reading moves the place by its change, modulo 2^32
//   stands_between     without a reading the place does not change
//   signed_count       the count is the place of the clock before, negated with invert
//   valid_after_two    velocity_valid is high exactly two clocks after reading_valid
//   unfiltered         with smoothing 0, the velocity two clocks after a reading is its change, at most 32,767 counts a tick either way
//   keeps_velocity     without a new reading the velocity does not change
//   preset_is_shown    in the second clock after `preset`, the position is preset_value of the clock before where the count stands
//   starts_when_steady start is `control`, once a tick has come while the axis was placed, and as long as it has stayed placed since
//   ready_when_steady  ready is `drive_ready` then, and while the encoder is lost
//   missed_is_true     velocity_missed rises only at a tick since whose predecessor no velocity came, while the encoder was known
//   never_unflagged    and at every such tick
//   nothing_at_reset   after a reset count, velocity and position are 0, and the axis is not placed
module absolute_feedback_properties (
    `PORTS,
    (* peek = "place" *) input wire [31:0] place,
    (* peek = "last" *) input wire [31:0] last,
    (* peek = "is_placed" *) input wire is_placed,
    (* peek = "steady" *) input wire steady,
    (* peek = "presets" *) input wire presets,
    (* peek = "change" *) input wire [31:0] change,
    (* peek = "is_new" *) input wire is_new,
    (* peek = "pending" *) input wire pending
);
    reg        past_reset = 1'b1, past_reset_twice = 1'b1;
    reg        past_valid = 1'b0, past_valid_twice = 1'b0, past_placed = 1'b0, past_invert = 1'b0, past_tick = 1'b0;
    reg        past_clear = 1'b0, past_missed = 1'b0, was_due = 1'b0, due = 1'b0, unfiltered_then = 1'b0;
    reg        began_placed = 1'b0;
    reg        past_preset = 1'b0, past_preset_twice = 1'b0;
    reg [31:0] past_place = 32'd0, past_reading = 32'd0, before = 32'd0, past_offset = 32'd0, past_sign_bit = 32'd0;
    reg [31:0] past_velocity = 32'd0, past_value = 32'd0, past_count = 32'd0, expected = 32'd0;
    wire [31:0] turned = invert ? 32'd0 - change : change;
    wire        above = !turned[31] & turned > 32'd32767;
    wire        below = turned[31] & turned < 32'hffff8001;
    wire [15:0] most = above ? 16'h7fff : below ? 16'h8001 : turned[15:0];
    always @(posedge clk) begin
        past_reset <= rst;
        past_reset_twice <= past_reset;
        past_valid <= !rst & reading_valid;
        past_valid_twice <= !rst & past_valid;
        past_placed <= !rst & is_placed;
        past_invert <= invert;
        past_tick <= !rst & tick;
        past_clear <= !rst & clear_flags;
        past_missed <= !rst & velocity_missed;
        // A tick's velocity is due from the clock after it until a reading is new.
        due <= !rst & (tick | (due & !past_valid));
        was_due <= !rst & tick & due & !past_valid & reading_known;
        began_placed <= !rst & is_placed & (tick | began_placed);
        unfiltered_then <= smoothing == 2'd0;
        past_place <= place;
        if (reading_valid)
            before <= reading;
        past_reading <= reading;
        past_offset <= offset;
        past_sign_bit <= sign_bit;
        past_velocity <= velocity;
        past_count <= count;
        past_value <= preset_value;
        past_preset <= !rst & preset;
        past_preset_twice <= !rst & past_preset;
        expected <= {most, 16'd0};
    end

    // The range of the encoder: 2 * sign_bit, or 2^32.
    wire [31:0] range = past_sign_bit | (past_sign_bit - 32'd1);
    wire        one_bit = past_sign_bit != 32'd0 & (past_sign_bit & (past_sign_bit - 32'd1)) == 32'd0;
    wire [31:0] from_least = place + past_sign_bit;
    wire [31:0] apart = place - (past_reading - past_offset);
    always @(*) begin
        placed_in_range: assert (past_reset | !past_valid | past_placed | !one_bit
            | ((from_least & ~range) == 32'd0 & (apart & range) == 32'd0));
        stands_between: assert (past_reset | past_valid | place == past_place);
        signed_count: assert (past_reset | count == (past_invert ? 32'd0 - past_place : past_place));
        valid_after_two: assert (past_reset | velocity_valid == past_valid_twice);
        unfiltered: assert (past_reset | !past_valid_twice | !unfiltered_then | velocity == expected);
        keeps_velocity: assert (past_reset | past_valid_twice | velocity == past_velocity);
        preset_is_shown: assert (past_reset | !past_preset_twice | count != past_count | position == past_value);
        starts_when_steady: assert (start == (control & began_placed));
        ready_when_steady: assert (ready == (drive_ready & (began_placed | lost)));
        missed_is_true: assert (past_reset | !velocity_missed | was_due | (past_missed & !past_clear));
        never_unflagged: assert (past_reset | !was_due | velocity_missed);
        nothing_at_reset: assert (!past_reset | (count == 32'd0 & velocity == 32'd0 & position == 32'd0 & !placed));
    end

    // The change is that of the reading.
    reg [31:0] before_last = 32'd0;
    always @(posedge clk)
        if (reading_valid)
            before_last <= last;
    always @(*)
        moves_as_read: assert (past_reset | !past_valid | !past_placed | place == past_place + (past_reading - before_last));

    // Invariants of the registers, for the induction.
    always @(*) begin
        same_new: assert (is_new == past_valid);
        same_due: assert (pending == due);
        same_steady: assert (steady == began_placed);
        same_preset: assert (presets == past_preset);
        same_last: assert (past_reset | !past_valid | last == past_reading);
    end

    always @(*) begin
        reach_saturated: cover (velocity == 32'h80010000 & velocity_valid);
        reach_below_zero: cover (placed & count == 32'hfffffffe & past_sign_bit == 32'd2048);
        reach_missed: cover (velocity_missed & velocity_valid);
    end
endmodule
