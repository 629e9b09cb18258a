// axis, its monitors at ticks: each cause is found eleven clocks after a tick that shows it, and by nothing else.
//
// The properties are proven for all inputs in every clock, including resets. Nothing is assumed, but `in_time`: all holds as long
// as ticks have come at least ten clocks apart, as the datasheet asks. The properties are about pins. Levels, velocities and the
// position are those of the tick. Numbers and limits are taken by bytes, those of 16 bits by nibbles, in the four clocks from the
// tick on, and once more five clocks later; what both rounds show is found. |x| is as in the datasheet: x, or -x - 1 below 0.
//
//   only_at_ticks        causes are found eleven clocks after a tick with the outputs on, and in no other clock
//   only_monitored       none but those below
//   limit_*              on the switch, and the command goes towards it; or newly on it, and the shaped command does
//   soft_limit_*         the shaped position is past it, newly or with a command that goes on; never with both limits 0, nor with
//                        limits_after_homing and without homed
//   following_error, deviation_, saturation_, encoder_lost, watchdog_
//                        exactly when above the limit, or there for as many ticks in a row; never with a limit of 0
//   captured             captured_position is the position of the last tick
//   counted_*            lemma: so many ticks in a row with a command to one side and no motion (of 4 counts backwards, or more than
//                        3 forwards; with watches_direction the other way is as none, but distances count from there on); so many
//                        since the last kick
//
// Not proven here: that levels are those of the switches (single_line), and where e comes from.
module axis_monitors_properties (
    `PORTS,
    (* peek = "u_monitors.found" *) input wire [16:0] found,
    (* peek = "u_monitors.tells" *) input wire tells,
    (* peek = "u_monitors.turn" *) input wire [1:0] turn,
    (* peek = "u_monitors.compares" *) input wire compares,
    (* peek = "u_monitors.looks" *) input wire looks,
    (* peek = "u_monitors.again" *) input wire again,
    (* peek = "u_monitors.kick_waits" *) input wire kick_waits,
    (* peek = "u_monitors.was_on" *) input wire was_on,
    (* peek = "u_monitors.still_since" *) input wire signed [31:0] still_since,
    (* peek = "u_monitors.still_backward" *) input wire still_backward,
    (* peek = "u_monitors.drive_backward" *) input wire drive_backward,
    (* peek = "u_monitors.motion" *) input wire signed [31:0] motion,
    (* peek = "u_monitors.not_forward" *) input wire not_forward,
    (* peek = "u_monitors.not_backward" *) input wire not_backward,
    (* peek = "u_monitors.on_plus" *) input wire on_plus,
    (* peek = "u_monitors.on_minus" *) input wire on_minus,
    (* peek = "u_monitors.was_on_plus" *) input wire was_on_plus,
    (* peek = "u_monitors.was_on_minus" *) input wire was_on_minus,
    (* peek = "u_monitors.was_past_plus" *) input wire was_past_plus,
    (* peek = "u_monitors.was_past_minus" *) input wire was_past_minus,
    (* peek = "u_monitors.forward" *) input wire forward,
    (* peek = "u_monitors.backward" *) input wire backward,
    (* peek = "u_monitors.shaped_forward" *) input wire shaped_forward,
    (* peek = "u_monitors.shaped_backward" *) input wire shaped_backward,
    (* peek = "u_monitors.u_soft_limits.u_reference_bytes.part_q" *) input wire [7:0] reference_part,
    (* peek = "u_monitors.u_soft_limits.u_plus_bytes.part_q" *) input wire [7:0] plus_part,
    (* peek = "u_monitors.u_soft_limits.u_minus_bytes.part_q" *) input wire [7:0] minus_part,
    (* peek = "u_monitors.u_soft_limits.u_above.larger_q" *) input wire is_above,
    (* peek = "u_monitors.u_soft_limits.u_below.larger_q" *) input wire is_below,
    (* peek = "u_monitors.u_soft_limits.u_plus_limited.nonzero_q" *) input wire plus_limited,
    (* peek = "u_monitors.u_soft_limits.u_minus_limited.nonzero_q" *) input wire minus_limited,
    (* peek = "u_monitors.u_error_limit.negative" *) input wire error_negative,
    (* peek = "u_monitors.u_error_limit.u_number_bytes.part_q" *) input wire [7:0] error_part,
    (* peek = "u_monitors.u_error_limit.u_limit_bytes.part_q" *) input wire [7:0] error_limit_part,
    (* peek = "u_monitors.u_error_limit.u_larger.larger_q" *) input wire error_larger,
    (* peek = "u_monitors.u_error_limit.u_limited.nonzero_q" *) input wire error_limited,
    (* peek = "u_monitors.u_deviation_at_tick.word_q" *) input wire [31:0] apart_kept,
    (* peek = "u_monitors.u_deviations.negative" *) input wire apart_negative,
    (* peek = "u_monitors.u_deviations.u_number_bytes.part_q" *) input wire [7:0] apart_part,
    (* peek = "u_monitors.u_deviations.u_limit_bytes.part_q" *) input wire [7:0] apart_limit_part,
    (* peek = "u_monitors.u_deviations.u_larger.larger_q" *) input wire apart_larger,
    (* peek = "u_monitors.u_deviations.u_limited.nonzero_q" *) input wire apart_limited,
    (* peek = "u_monitors.u_commands.negative" *) input wire drive_negative,
    (* peek = "u_monitors.u_commands.u_number_bytes.part_q" *) input wire [7:0] drive_part,
    (* peek = "u_monitors.u_commands.u_limit_bytes.part_q" *) input wire [7:0] drive_limit_part,
    (* peek = "u_monitors.u_commands.u_larger.larger_q" *) input wire drive_larger,
    (* peek = "u_monitors.u_limited_nibbles.part_q" *) input wire [3:0] limited_part,
    (* peek = "u_monitors.u_saturating.u_limit_nibbles.part_q" *) input wire [3:0] saturating_limit_part,
    (* peek = "u_monitors.u_saturating.fewer" *) input wire saturating_fewer,
    (* peek = "u_monitors.u_saturating.limited" *) input wire saturating_limited,
    (* peek = "u_monitors.u_still.u_against.u_limit_nibbles.part_q" *) input wire [3:0] still_limit_part,
    (* peek = "u_monitors.u_still.u_against.fewer" *) input wire still_fewer,
    (* peek = "u_monitors.u_still.u_against.limited" *) input wire still_limited,
    (* peek = "u_monitors.u_unkicked.u_against.u_limit_nibbles.part_q" *) input wire [3:0] unkicked_limit_part,
    (* peek = "u_monitors.u_unkicked.u_against.fewer" *) input wire unkicked_fewer,
    (* peek = "u_monitors.u_unkicked.u_against.limited" *) input wire unkicked_limited,
    (* peek = "u_monitors.u_still.count" *) input wire [15:0] still_count,
    (* peek = "u_monitors.u_still.carry" *) input wire still_carry,
    (* peek = "u_monitors.u_still.endless" *) input wire still_endless,
    (* peek = "u_monitors.u_unkicked.count" *) input wire [15:0] unkicked_count,
    (* peek = "u_monitors.u_unkicked.carry" *) input wire unkicked_carry,
    (* peek = "u_monitors.u_unkicked.endless" *) input wire unkicked_endless
);
    // Clocks since the tick, 0 once both rounds are over; and whether ticks have come far enough apart so far.
    reg        [3:0]  clocks = 4'd0;
    reg               in_time = 1'b1;
    wire              first = clocks == 4'd5, second = clocks == 4'd10;
    wire              comparing = (clocks >= 4'd1 & clocks <= 4'd4) | (clocks >= 4'd6 & clocks <= 4'd9);
    wire              takes = tick | (clocks >= 4'd1 & clocks <= 4'd3) | (clocks >= 4'd5 & clocks <= 4'd8);
    wire       [3:0]  later = clocks - 4'd5;
    wire       [1:0]  part = tick ? 2'd0 : clocks < 4'd5 ? clocks[1:0] : later[1:0];
    wire       [31:0] byte_mask = 32'hff << {part, 3'd0};
    wire       [15:0] nibble_mask = 16'hf << {part, 2'd0};

    // Values at the last tick, and at the tick before it.
    reg               shown_on = 1'b0;
    reg               at_plus = 1'b0, at_minus = 1'b0, was_at_plus = 1'b0, was_at_minus = 1'b0;
    reg               was_beyond_plus = 1'b0, was_beyond_minus = 1'b0;
    reg signed [31:0] velocity = 32'sd0, shaped = 32'sd0, place = 32'sd0;
    // Where the position was last seen to move, either way, or the command to change sides; how far it is from there, a clock later
    // each.
    reg signed [31:0] since = 32'sd0, moved = 32'sd0;
    reg               since_below = 1'b0, up_little = 1'b0, down_little = 1'b0;
    wire signed [31:0] distance = place - since;
    reg               e_below = 1'b0, apart_below = 1'b0, drive_below = 1'b0;
    // Bytes that the rounds have taken so far.
    reg signed [31:0] reference = 32'sd0, plus = 32'sd0, minus = 32'sd0;
    reg        [31:0] apart_at_tick = 32'd0;
    wire       [31:0] apart_now = tick ? deviation : apart_at_tick;
    reg        [31:0] e = 32'd0, e_most = 32'd0, apart = 32'd0, apart_most = 32'd0, drive = 32'd0, drive_most = 32'd0;
    reg        [15:0] cut = 16'd0, cut_most = 16'd0, still_most = 16'd0, unkicked_most = 16'd0;
    // Number of ticks, with one more bit for numbers above any limit.
    reg        [15:0] still_for = 16'd0, unkicked_for = 16'd0;
    reg               still_long = 1'b0, unkicked_long = 1'b0, waiting = 1'b0;
    wire              kicked = (kick & kick_word == `KICK) | waiting;

    wire [31:0] e_size = e ^ {32{e_below}}, apart_size = apart ^ {32{apart_below}}, drive_size = drive ^ {32{drive_below}};
    wire        soft = (plus != 32'sd0 | minus != 32'sd0) & (homed | !limits_after_homing);
    wire        beyond_plus = soft & reference > plus, beyond_minus = soft & reference < minus;
    wire        stays = shown_on & since_below == drive_below & drive_size > drive_most
        & (distance >= -32'sd4 | (watches_direction & !drive_below))
        & (distance <= 32'sd3 | (watches_direction & drive_below));
    wire [16:0] round =
        (at_plus & (velocity > 32'sd0 | (!was_at_plus & shaped > 32'sd0)) ? `LIMIT_PLUS : 16'd0)
        | (at_minus & (velocity < 32'sd0 | (!was_at_minus & shaped < 32'sd0)) ? `LIMIT_MINUS : 16'd0)
        | (beyond_plus & (velocity > 32'sd0 | !was_beyond_plus) ? `SOFT_LIMIT_PLUS : 16'd0)
        | (beyond_minus & (velocity < 32'sd0 | !was_beyond_minus) ? `SOFT_LIMIT_MINUS : 16'd0)
        | (e_most != 32'd0 & e_size > e_most ? `FOLLOWING_ERROR : 16'd0)
        | (apart_most != 32'd0 & apart_size > apart_most ? `DEVIATION : 16'd0)
        | (cut_most != 16'd0 & cut >= cut_most ? `SATURATION : 16'd0)
        | (still_most != 16'd0 & (still_long | still_for >= still_most) ? `ENCODER_LOST : 16'd0)
        | (unkicked_most != 16'd0 & (unkicked_long | unkicked_for >= unkicked_most) ? `WATCHDOG : 16'd0);

    reg [16:0] suspected = 16'd0, expected = 16'd0;
    always @(posedge clk) begin
        expected <= !rst & second & shown_on ? round & suspected : 16'd0;
        waiting <= !rst & kicked & comparing;
        apart_at_tick <= rst ? 32'd0 : apart_now;
        in_time <= in_time & !(tick & clocks != 4'd0 & !second & !rst);
        if (rst) begin
            clocks <= 4'd0;
            {shown_on, at_plus, at_minus, was_at_plus, was_at_minus, was_beyond_plus, was_beyond_minus} <= 7'd0;
            {since_below, up_little, down_little, e_below, apart_below, drive_below, still_long, unkicked_long} <= 8'd0;
            {velocity, shaped, place, since, moved} <= 160'd0;
            {still_for, unkicked_for, suspected} <= 48'd0;
        end else begin
            moved <= distance;
            up_little <= moved <= 32'sd3;
            down_little <= moved >= -32'sd4;
            clocks <= tick ? 4'd1 : clocks == 4'd0 | second ? 4'd0 : clocks + 4'd1;
            if (tick) begin
                {shown_on, at_plus, at_minus} <= {drive_enable, !level_limit_plus_n, !level_limit_minus_n};
                {velocity, shaped, place} <= {command_velocity, reference_velocity, position};
                {e_below, apart_below, drive_below} <= {error[31], deviation[31], command[31]};
            end
            if (first) begin
                suspected <= round;
                {still_for, unkicked_for} <= {still_for + 16'd1, unkicked_for + 16'd1};
                {still_long, unkicked_long} <= {still_long | (&still_for), unkicked_long | (&unkicked_for)};
            end
            if (second) begin
                {was_at_plus, was_at_minus} <= {at_plus, at_minus};
                {was_beyond_plus, was_beyond_minus} <= {beyond_plus, beyond_minus};
                if (!stays) {still_long, still_for} <= 17'd0;
                if (!stays | distance < -32'sd4 | distance > 32'sd3) {since, since_below} <= {place, drive_below};
            end
            if (!comparing & (kicked | !shown_on)) {unkicked_long, unkicked_for} <= 17'd0;
        end
        if (takes) begin
            reference <= (reference & ~byte_mask) | (reference_position & byte_mask);
            plus <= (plus & ~byte_mask) | (soft_limit_plus & byte_mask);
            minus <= (minus & ~byte_mask) | (soft_limit_minus & byte_mask);
            e <= (e & ~byte_mask) | (error & byte_mask);
            e_most <= (e_most & ~byte_mask) | (following_error_limit & byte_mask);
            apart <= (apart & ~byte_mask) | (apart_now & byte_mask);
            apart_most <= (apart_most & ~byte_mask) | (deviation_limit & byte_mask);
            drive <= (drive & ~byte_mask) | (command & byte_mask);
            drive_most <= (drive_most & ~byte_mask) | (lost_command & byte_mask);
            cut <= (cut & ~nibble_mask) | (limited_ticks & nibble_mask);
            cut_most <= (cut_most & ~nibble_mask) | (saturation_ticks & nibble_mask);
            still_most <= (still_most & ~nibble_mask) | (lost_ticks & nibble_mask);
            unkicked_most <= (unkicked_most & ~nibble_mask) | (watchdog_ticks & nibble_mask);
        end
    end

    wire [16:0] told = tells ? found : 16'd0;
    wire [16:0] wrong = in_time ? told ^ expected : 16'd0;
    reg         past_second = 1'b0;
    always @(posedge clk) past_second <= second & shown_on & !rst;
    wire [16:0] monitored = `LIMIT_PLUS | `LIMIT_MINUS | `SOFT_LIMIT_PLUS | `SOFT_LIMIT_MINUS | `FOLLOWING_ERROR | `DEVIATION
        | `SATURATION | `ENCODER_LOST | `WATCHDOG;
    always @(*) begin
        only_at_ticks: assert (!in_time | told == 16'd0 | past_second);
        only_monitored: assert ((found & ~monitored) == 16'd0);
        limit_plus: assert ((wrong & `LIMIT_PLUS) == 16'd0);
        limit_minus: assert ((wrong & `LIMIT_MINUS) == 16'd0);
        soft_limit_plus_passed: assert ((wrong & `SOFT_LIMIT_PLUS) == 16'd0);
        soft_limit_minus_passed: assert ((wrong & `SOFT_LIMIT_MINUS) == 16'd0);
        following_error: assert ((wrong & `FOLLOWING_ERROR) == 16'd0);
        deviation_too_large: assert ((wrong & `DEVIATION) == 16'd0);
        saturation_too_long: assert ((wrong & `SATURATION) == 16'd0);
        encoder_lost: assert ((wrong & `ENCODER_LOST) == 16'd0);
        watchdog_not_kicked: assert ((wrong & `WATCHDOG) == 16'd0);
        captured: assert (captured_position == place);
        known_apart: assert (apart_kept == apart_at_tick);
    end

    // Invariants of the registers, for the induction: the bytes compared so far, and the next one in its register.
    wire [2:0]  done = clocks == 4'd0 ? 3'd0 : clocks <= 4'd5 ? clocks[2:0] - 3'd1 : later[2:0] - 3'd1;
    wire        all = done[2];
    wire [31:0] low = ~(32'hffffffff << {done, 3'd0});
    wire [15:0] low_ticks = ~(16'hffff << {done, 2'd0});
    wire [4:0]  byte_at = {done[1:0], 3'd0};
    wire [3:0]  nibble_at = {done[1:0], 2'd0};
    wire        is_above_so_far = all ? reference > plus : (reference & low) > (plus & low);
    wire        is_below_so_far = all ? minus > reference : (minus & low) > (reference & low);
    wire [31:0] reference_next = reference >> byte_at, plus_next = plus >> byte_at, minus_next = minus >> byte_at;
    wire [31:0] e_next = e >> byte_at, e_most_next = e_most >> byte_at;
    wire [31:0] apart_next = apart >> byte_at, apart_most_next = apart_most >> byte_at;
    wire [31:0] drive_next = drive >> byte_at, drive_most_next = drive_most >> byte_at;
    wire [15:0] cut_next = cut >> nibble_at, cut_most_next = cut_most >> nibble_at;
    wire [15:0] still_most_next = still_most >> nibble_at, unkicked_most_next = unkicked_most >> nibble_at;
    // Counts rotate: the lower nibbles are still to come, the upper ones include the tick.
    wire        counting = clocks >= 4'd1 & clocks <= 4'd5;
    wire [15:0] still_after = still_for + {15'd0, counting}, unkicked_after = unkicked_for + {15'd0, counting};
    wire [31:0] still_round = {still_after, still_for} >> {done, 2'd0};
    wire [31:0] unkicked_round = {unkicked_after, unkicked_for} >> {done, 2'd0};
    wire        was_second = clocks == 4'd0 | second;
    always @(*) begin
        clocks_of_tick: assert (!in_time | (turn == (clocks == 4'd5 | was_second | clocks == 4'd4 | clocks == 4'd9 ? 2'd0 :
            clocks < 4'd5 ? clocks[1:0] : later[1:0]) & compares == comparing & looks == (first | second)
            & again == (clocks >= 4'd6)));
        known_clock: assert (clocks <= 4'd10);
        told_when: assert (!in_time | tells == past_second);
        on_at_tick: assert (was_on == shown_on);
        switches: assert ({on_plus, on_minus} == {at_plus, at_minus});
        ways: assert ({forward, backward} == {velocity > 32'sd0, velocity < 32'sd0});
        shaped_ways: assert ({shaped_forward, shaped_backward} == {shaped > 32'sd0, shaped < 32'sd0});
        signs: assert ({error_negative, apart_negative, drive_negative, drive_backward}
            == {e_below, apart_below, drive_below, drive_below});
        since_when: assert (!in_time | {still_since, still_backward} == {since, since_below});
        motions: assert (!in_time | {motion, not_forward, not_backward} == {moved, up_little, down_little});
        motion_in_time: assert (!in_time | clocks < 4'd2 | moved == distance);
        still_in_time: assert (!in_time | clocks < 4'd3 | {up_little, down_little} == {distance <= 32'sd3, distance >= -32'sd4});
        passed_before: assert (!in_time | {was_on_plus, was_on_minus, was_past_plus, was_past_minus}
            == {was_at_plus, was_at_minus, was_beyond_plus, was_beyond_minus});
        found_before: assert (!in_time | clocks < 4'd6 | found == suspected);
        kick_is_kept: assert (!in_time | kick_waits == waiting);
        next_bytes: assert (!in_time | !comparing | ({reference_part, plus_part, minus_part, error_part, error_limit_part}
            == {reference_next[7:0], plus_next[7:0], minus_next[7:0], e_next[7:0], e_most_next[7:0]}
            & {apart_part, apart_limit_part, drive_part, drive_limit_part}
            == {apart_next[7:0], apart_most_next[7:0], drive_next[7:0], drive_most_next[7:0]}));
        next_nibbles: assert (!in_time | !comparing | {limited_part, saturating_limit_part, still_limit_part, unkicked_limit_part}
            == {cut_next[3:0], cut_most_next[3:0], still_most_next[3:0], unkicked_most_next[3:0]});
        soft_limits: assert (!in_time | {is_above, is_below, plus_limited, minus_limited} == (clocks == 4'd0 ? 4'd0 :
            {is_above_so_far, is_below_so_far, (plus & low) != 32'd0, (minus & low) != 32'd0}));
        sizes: assert (!in_time | {error_larger, error_limited, apart_larger, apart_limited, drive_larger} ==
            (clocks == 4'd0 ? 5'd0 : {(e_size & low) > (e_most & low), (e_most & low) != 32'd0,
            (apart_size & low) > (apart_most & low), (apart_most & low) != 32'd0, (drive_size & low) > (drive_most & low)}));
        too_many: assert (!in_time |
            {saturating_fewer, saturating_limited, still_fewer, still_limited, unkicked_fewer, unkicked_limited} == (clocks == 4'd0 ? 6'd0 : {(cut & low_ticks) < (cut_most & low_ticks), (cut_most & low_ticks) != 16'd0,
            (still_for & low_ticks) < (still_most & low_ticks), (still_most & low_ticks) != 16'd0,
            (unkicked_for & low_ticks) < (unkicked_most & low_ticks), (unkicked_most & low_ticks) != 16'd0}));
        counted_still: assert (!in_time | still_count == (clocks == 4'd0 ? still_for : still_round[15:0]));
        counted_unkicked: assert (!in_time | unkicked_count == (clocks == 4'd0 ? unkicked_for : unkicked_round[15:0]));
        carries: assert (!in_time | {still_carry, unkicked_carry} == (counting ?
            {(still_for | ~low_ticks) == 16'hffff, (unkicked_for | ~low_ticks) == 16'hffff} : 2'd0));
        more_than_any: assert (!in_time | {still_endless, unkicked_endless} == {still_long, unkicked_long});
    end

    always @(*) begin
        reach_limit: cover ((told & `LIMIT_PLUS) != 16'd0);
        reach_soft_limit: cover ((told & `SOFT_LIMIT_MINUS) != 16'd0);
        reach_error: cover (told == `FOLLOWING_ERROR);
        reach_lost: cover (told == `ENCODER_LOST & still_for == 16'd2);
        reach_watchdog: cover (told == `WATCHDOG & unkicked_for == 16'd3);
        reach_all_but_one_side: cover ((told & ~`LIMIT_MINUS) == (monitored & ~`LIMIT_MINUS));
    end
endmodule
