// shaper_motion: the control of the shaper for motion, three channels. Its arithmetic is in channel_sums.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. The multipliers and the memories
// give any value in every clock. `pass` is the clock of the pass, 0 if none runs; N its products, end_0 to end_2 the last of each
// channel. A handover's products are, channel by channel, those of the old table, of the active one, and, of the position, one
// more.
//
//   pass_*      channel, table, tap, boundaries, valid and busy are those of this clock: a product is asked for in each clock
//               from 1 on, but in one between two channels. Of a product that is asked for in clock i the sample is of its
//               channel in clocks i + 4 and i + 5, and it would be added in clock i + 8. There is a boundary in clock 8 and in that
//               after each channel's last product was added, and in no other; all results are shown in clock N + 12, and in no
//               other
//   read_*      the tables' address is the tap of this product, of the old or the active bank; the word is that bank's,
//               but for a host's read, which takes the tables only in clocks in which no pass does
//   made_*      in a handover, m samples after the last one of the old table alone: of the position an old tap has the delay
//               max(d, m), a new one min(d, m), and the one more is -2^F at m; of the others an old tap counts with d >= m,
//               a new one with d < m, else as 0. Else a tap is what the table says
//   ring_*      as in the plain shaper: address, age, what is blank
//   swap_*      a bank becomes active only by a strobe with a swap pending: at once, or once the position has stood still for
//               as many samples as the longest delay of both tables; none is refused then
//   handover_*  lasts from that strobe to the first with m above that delay, or a start; m counts strobes; swap_pending all
//               the while
//   table_*     the tables of a pass, and one that waits, sum to 2^F by their own count, and none of them is written
//
// Not proven here: that memories keep what is written; other numbers of channels.
module shaper_motion_properties (
    `PORTS,
    (* peek = "tap" *) input wire [5:0] tap,
    (* peek = "running" *) input wire running,
    (* peek = "channel" *) input wire [1:0] channel,
    (* peek = "second" *) input wire second,
    (* peek = "correcting" *) input wire correcting,
    (* peek = "lasts" *) input wire [8:0] lasts,
    (* peek = "sample_channel" *) input wire [1:0] sample_channel,
    (* peek = "u_banks.taps" *) input wire [6:0] taps_read,
    (* peek = "u_banks.previous" *) input wire [1:0] previous,
    (* peek = "u_banks.taps_1" *) input wire [6:0] taps_1,
    (* peek = "u_banks.taps_2" *) input wire [6:0] taps_2,
    (* peek = "u_banks.sum_1" *) input wire signed [23:0] sum_1,
    (* peek = "u_banks.sum_2" *) input wire signed [23:0] sum_2,
    (* peek = "u_banks.longest_1" *) input wire [5:0] longest_1,
    (* peek = "u_banks.longest_2" *) input wire [5:0] longest_2,
    (* peek = "u_banks.reach_q" *) input wire [5:0] reach,
    (* peek = "u_banks.upcoming" *) input wire [1:0] upcoming,
    (* peek = "u_banks.pending" *) input wire pending,
    (* peek = "u_banks.swap_taken" *) input wire swap_taken,
    (* peek = "u_banks.write_taken" *) input wire write_taken,
    (* peek = "u_banks.write_address" *) input wire [6:0] write_address,
    (* peek = "u_banks.read_address" *) input wire [6:0] read_address,
    (* peek = "u_banks.old_q" *) input wire old_q,
    (* peek = "u_banks.loaded_taps_read_data" *) input wire [23:0] loaded_word,
    (* peek = "u_banks.machine_taps_data" *) input wire [23:0] machine_word,
    (* peek = "u_banks.word" *) input wire [23:0] word,
    (* peek = "u_banks.serves" *) input wire serves,
    (* peek = "u_banks.served" *) input wire served,
    (* peek = "u_handover.how" *) input wire [1:0] how,
    (* peek = "u_handover.still" *) input wire [5:0] still,
    (* peek = "u_handover.newest_q" *) input wire signed [23:0] newest,
    (* peek = "u_handover.active_q" *) input wire active,
    (* peek = "u_handover.since_q" *) input wire [5:0] since,
    (* peek = "u_handover.old_read" *) input wire old_read,
    (* peek = "u_handover.old_tap" *) input wire old_tap,
    (* peek = "u_handover.correction_read" *) input wire correction_read,
    (* peek = "u_handover.correction" *) input wire correction,
    (* peek = "u_handover.position_read" *) input wire position_read,
    (* peek = "u_handover.position_tap" *) input wire position_tap,
    (* peek = "u_handover.coefficient_q" *) input wire signed [17:0] made_coefficient,
    (* peek = "u_handover.delay_q" *) input wire [5:0] made_delay,
    (* peek = "u_history.head" *) input wire [5:0] head,
    (* peek = "u_history.age" *) input wire [5:0] age,
    (* peek = "u_history.origin" *) input wire [5:0] origin,
    (* peek = "u_history.begun" *) input wire begun,
    (* peek = "u_history.started" *) input wire started,
    (* peek = "u_history.next_head" *) input wire [5:0] written,
    (* peek = "u_history.writes" *) input wire writes,
    (* peek = "u_history.address" *) input wire [5:0] address,
    (* peek = "u_history.blank" *) input wire blank,
    (* peek = "u_sums.channel" *) input wire [1:0] sum_channel
);
    localparam signed [23:0] UNITY = 24'sd1 << `FRACTION;
    localparam signed [17:0] MINUS_UNITY = -(18'sd1 << `FRACTION);

    // Lengths of the tables of a pass, stored when the tables were taken.
    wire       takes = strobe & pending & (how != 2'd2 | start | still >= reach);
    function [6:0] count(input [1:0] of);
        count = of == 2'd0 ? `MACHINE_TAPS : of == 2'd1 ? taps_1 : taps_2;
    endfunction
    reg  [6:0] taps = `MACHINE_TAPS;
    reg  [6:0] previous_taps = 7'd0;
    always @(posedge clk) begin
        if (rst) taps <= `MACHINE_TAPS;
        else if (takes) begin
            taps <= count(upcoming);
            previous_taps <= taps;
        end
    end

    // The clocks of a pass that ask for the last product of a channel, and which product this clock asks for.
    wire [9:0] old_taps = active ? {3'd0, previous_taps} : 10'd0;
    wire [9:0] both = {3'd0, taps} + old_taps;
    wire [9:0] end_0 = both + {9'd0, active};
    wire [9:0] end_1 = end_0 + 10'd1 + both;
    wire [9:0] end_2 = end_1 + 10'd1 + both;
    reg  [9:0] pass = 10'd0;
    always @(posedge clk) begin
        if (rst) pass <= 10'd0;
        else if (strobe) pass <= 10'd1;
        else if (start | pass == end_2 + 10'd10) pass <= 10'd0;
        else if (pass != 10'd0) pass <= pass + 10'd1;
    end
    wire       pauses = pass == end_0 + 10'd1 | pass == end_1 + 10'd1;
    wire       asks = pass >= 10'd1 & pass <= end_2 & !pauses;
    wire       of_position = pass <= end_0;
    wire [9:0] place = pass - 10'd1 - (of_position ? 10'd0 : pass <= end_1 ? end_0 + 10'd1 : end_1 + 10'd1);
    wire       of_old = place < old_taps;
    wire       one_more = place == both;
    wire [9:0] place_in_table = of_old ? place : place - old_taps;
    wire [8:0] lasts_now;
    reg  [2:0] stages = 3'd0;
    always @(posedge clk) stages <= rst | start | strobe ? 3'd0 : {stages[1:0], asks};
    genvar i;
    generate
        for (i = 0; i < 9; i = i + 1) begin : of_last
            wire [9:0] asked = pass - 10'd1 - i;
            assign lasts_now[i] = pass != 10'd0 & (asked == end_0 | asked == end_1 | asked == end_2 | pass == i);
        end
    endgenerate
    wire [1:0] sample_channel_now = 2'd3 + {1'b0, pass >= 10'd5} +
        {1'b0, pass >= end_0 + 10'd6} + {1'b0, pass >= end_1 + 10'd6} + {1'b0, pass >= end_2 + 10'd6};
    wire [1:0] sum_channel_now = 2'd3 + {1'b0, pass >= 10'd9} +
        {1'b0, pass >= end_0 + 10'd10} + {1'b0, pass >= end_1 + 10'd10} + {1'b0, pass >= end_2 + 10'd10};
    always @(*) begin
        pass_length: assert (pass <= end_2 + 10'd10 & taps != 7'd0 & taps <= 7'd64 & (!active | (previous_taps != 7'd0 & previous_taps <= 7'd64)));
        pass_running: assert (running == (asks | pauses));
        pass_pause: assert (!pauses | (!second & !correcting & tap == 6'd0));
        pass_channel: assert (!running | channel == (of_position ? 2'd0 : pass <= end_1 ? 2'd1 : 2'd2));
        pass_table: assert (!asks | second == (active & !of_old));
        pass_one_more: assert (!asks | correcting == one_more);
        pass_tap: assert (!asks | one_more | {4'd0, tap} == place_in_table);
        pass_lasts: assert (lasts == lasts_now);
        pass_valid: assert (valid == (pass == end_2 + 10'd10));
        pass_busy: assert (busy == (pass >= 10'd1 & pass <= end_2 + 10'd9));
        pass_sample: assert (pass == 10'd0 | sample_channel == sample_channel_now);
        pass_sum: assert (pass == 10'd0 | sum_channel == sum_channel_now);
    end

    // Values of the previous clock.
    reg               past_reset = 1'b1;
    reg               past_strobe = 1'b0;
    reg               past_start = 1'b0;
    reg               past_clear = 1'b0;
    reg               past_busy = 1'b0;
    reg               past_overrun = 1'b0;
    reg               past_active = 1'b0;
    reg               past_takes = 1'b0;
    reg               past_takes_over = 1'b0;
    reg               past_served = 1'b0;
    reg        [1:0]  past_bank = 2'd0;
    reg        [1:0]  past_upcoming = 2'd0;
    reg        [1:0]  past_read_bank = 2'd0;
    reg        [5:0]  past_since = 6'd0;
    reg        [5:0]  past_head = 6'd0;
    reg        [23:0] past_read = 24'd0;
    reg        [23:0] past_word = 24'd0;
    reg        [2:0]  tags_read = 3'd0;
    reg        [2:0]  tags = 3'd0;
    reg        [2:0]  past_tags = 3'd0;
    wire [1:0] read_bank = active & !second ? previous : bank;
    wire [1:0] word_bank = old_q ? previous : bank;
    always @(posedge clk) begin
        past_reset <= rst;
        past_strobe <= strobe;
        past_start <= start;
        past_clear <= clear_flags;
        past_busy <= busy;
        past_overrun <= overrun;
        past_active <= active;
        past_takes <= takes;
        past_takes_over <= takes & how == 2'd1 & !start;
        past_served <= served;
        past_bank <= bank;
        past_upcoming <= upcoming;
        past_read_bank <= read_bank;
        past_since <= since;
        past_head <= head;
        past_read <= word_bank == 2'd0 ? machine_word : loaded_word;
        past_word <= word;
        tags_read <= {one_more, of_position, of_old};
        tags <= tags_read;
        past_tags <= tags;
    end

    function [5:0] longest(input [1:0] of);
        longest = of == 2'd0 ? `MACHINE_LONGEST : of == 2'd1 ? longest_1 : longest_2;
    endfunction
    function sums_to_one(input [1:0] of);
        sums_to_one = of != 2'd3 & (of != 2'd1 | sum_1 == UNITY) & (of != 2'd2 | sum_2 == UNITY);
    endfunction
    wire [1:0] written_bank = {write_address[6], !write_address[6]};
    wire [5:0] reach_active = longest(bank);
    wire [5:0] reach_other = longest(active ? previous : upcoming);
    always @(*) begin
        read_in_order: assert (!asks | one_more | read_address == {read_bank != 2'd1, place_in_table[5:0]});
        read_old: assert (!asks | one_more | read_bank == (of_old ? previous : bank));
        read_word: assert (past_reset | past_served | word == past_read);
        read_back_serves: assert (!serves | pass == 10'd0 | valid);
        read_back_idle: assert (!served | pass <= 10'd1);
        read_bank_of_word: assert (!stages[0] | word_bank == past_read_bank);
        table_length: assert (taps == count(bank) & taps_1 <= 7'd64 & taps_2 <= 7'd64);
        table_length_old: assert (!active | previous_taps == count(previous));
        table_length_read: assert (taps_read == count(read_bank));
        table_empty: assert ((taps_1 != 7'd0 | sum_1 == 24'sd0) & (taps_2 != 7'd0 | sum_2 == 24'sd0));
        table_sums_to_one: assert (sums_to_one(bank) & (!active | sums_to_one(previous)));
        table_to_come: assert (!pending | sums_to_one(upcoming));
        table_not_written: assert (!write_taken | (bank != written_bank & !pending & !active));
    end

    // An arbitrary loaded tap: one that was written while x_2 was odd, and that is still in its table.
    reg       watches = 1'b0;
    reg [1:0] watched_bank = 2'd0;
    reg [5:0] watched_delay = 6'd0;
    always @(posedge clk) begin
        if (rst) watches <= 1'b0;
        else if (write_taken & x_2[0]) begin
            watches <= 1'b1;
            watched_bank <= written_bank;
            watched_delay <= tap_delay;
        end else if (write_taken & tap_index == 6'd0 & watched_bank == written_bank) watches <= 1'b0;
    end
    always @(*) begin
        table_longest: assert (!watches | watched_delay <= (watched_bank == 2'd1 ? longest_1 : longest_2));
        table_watched: assert (!watches | watched_bank == 2'd1 | watched_bank == 2'd2);
        table_delay: assert (longest_1 != 6'd63 & longest_2 != 6'd63);
        table_reach: assert (!(pending | active) | reach == (reach_active > reach_other ? reach_active : reach_other));
    end

    // The time at which a swap takes effect.
    reg        [1:0]  wanted_how = 2'd0;
    reg        [5:0]  stood = 6'd63;
    reg signed [23:0] position = 24'sd0;
    reg               hands_over = 1'b0;
    reg        [6:0]  m = 7'd0;
    wire       [6:0]  next_m = m + 7'd1;
    always @(posedge clk) begin
        if (rst) begin
            wanted_how <= 2'd0;
            stood <= 6'd63;
            position <= 24'sd0;
            hands_over <= 1'b0;
            m <= 7'd0;
        end else begin
            if (swap_taken) wanted_how <= swap_how;
            if (start) stood <= 6'd63;
            else if (strobe) stood <= x_0 != position ? 6'd0 : stood == 6'd63 ? 6'd63 : stood + 6'd1;
            if (strobe | start) position <= x_0;
            if (start) hands_over <= 1'b0;
            else if (takes & how == 2'd1) hands_over <= reach != 6'd0;
            else if (strobe & next_m > {1'b0, reach}) hands_over <= 1'b0;
            if (takes) m <= 7'd1;
            else if (strobe & hands_over) m <= next_m;
        end
    end
    always @(*) begin
        swap_how_kept: assert (how == wanted_how & how != 2'd3);
        swap_still: assert (still == stood & newest == position);
        swap_takes: assert (past_reset | bank == (past_takes ? past_upcoming : past_bank));
        swap_old: assert (past_reset | !past_takes | previous == past_bank);
        swap_shown: assert (swap_pending == (pending | active));
        handover_begins: assert (past_reset | !past_takes_over | active == (reach != 6'd0));
        handover_lasts: assert (active == hands_over & !(active & pending));
        handover_m: assert (!active | ({1'b0, since} == m & m >= 7'd1 & m <= {1'b0, reach}));
        handover_alone: assert (past_reset | past_active | !active | past_takes_over);
    end

    // The effect of a handover on a tap.
    wire        [5:0]  d = past_word[23:18];
    wire signed [17:0] c = past_word[17:0];
    wire        [5:0]  farther = d > past_since ? d : past_since;
    wire        [5:0]  nearer = d < past_since ? d : past_since;
    wire               counts = past_tags[0] ? d >= past_since : d < past_since;
    always @(*) begin
        made_read: assert (!stages[0] |
            (correction_read == tags_read[2] & position_read == tags_read[1] & old_read == tags_read[0] & (!tags_read[2] | (active & tags_read[1]))));
        made_tap: assert (!stages[1] |
            (correction == tags[2] & position_tap == tags[1] & old_tap == tags[0] & (!tags[2] | (active & tags[1]))));
        made_alone: assert (!stages[2] | past_active | (made_delay == d & made_coefficient == c));
        made_position: assert (!stages[2] | !past_active | !past_tags[1] | past_tags[2] |
            (made_delay == (past_tags[0] ? farther : nearer) & made_coefficient == c));
        made_others: assert (!stages[2] | !past_active | past_tags[1] | past_tags[2] |
            (counts ? made_delay == d & made_coefficient == c : made_coefficient == 18'sd0));
        made_one_more: assert (!stages[2] | !past_tags[2] |
            (past_active & made_delay == past_since & made_coefficient == MINUS_UNITY));
    end

    // After the start's word there is a sample for each strobe.
    reg         [5:0] samples = 6'd0;
    reg               own_started = 1'b0;
    reg               own_begun = 1'b0;
    always @(posedge clk) begin
        if (rst | start) samples <= 6'd0;
        else if (strobe & own_begun & samples != 6'd63) samples <= samples + 6'd1;
        if (rst) own_begun <= 1'b0;
        else if (strobe | start) own_begun <= 1'b1;
        if (rst | start) own_started <= !rst;
    end
    wire              from_start = made_delay > samples;
    wire        [5:0] asked_for = head - (from_start ? samples : made_delay);
    wire        [5:0] head_moved = head - past_head;
    wire        [5:0] next_head = head + 6'd1;
    always @(*) begin
        ring_address: assert (address == asked_for);
        ring_not_written: assert (asked_for != next_head | made_delay == 6'd63);
        ring_written: assert (written == next_head & writes == (strobe | start));
        ring_age: assert (age == samples & started == own_started & begun == own_begun & (begun | (!started & age == 6'd0)));
        ring_origin: assert (age == 6'd63 | origin == head - age);
        ring_head: assert (past_reset | head_moved == {5'd0, past_strobe | past_start});
        ring_blank: assert (blank == (from_start & !own_started));
    end

    // The sums show the results; the control decides whether a strobe came too early.
    always @(*) begin
        pass_overrun: assert (past_reset |
            overrun == ((past_strobe & past_busy & !past_start) | (past_overrun & !past_clear)));
    end

    always @(*) begin
        reach_valid: cover (valid & !active);
        reach_handover: cover (valid & active & since == 6'd2);
        reach_two_tables: cover (valid & active & bank == 2'd1 & previous == 2'd0);
        reach_handed_over: cover (past_active & !active & !past_start & !past_reset);
        reach_settled: cover (past_takes & how == 2'd2 & !past_start & stood >= 6'd8 & stood != 6'd63);
        reach_watched: cover (watches & pending & upcoming == watched_bank);
        reach_read_back: cover (served & active);
        reach_overrun: cover (overrun);
    end
endmodule
