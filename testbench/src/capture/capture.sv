// capture: which edges the line has, which of them are captured, and that each entry is shown as it was written, in order.
//
// Proven for all inputs in every clock, resets and changes of all settings included; nothing is assumed. The memory is part of the
// proof, with any contents after power-up. `steady` is the number of clocks in a row for which the synchronised line has had its
// level since the reset, up to 65535, counted here.
//
//   exact_level        level is that of the line once it was steady for filter_clocks, 1 at the least; it is known from then on
//   edge_is_steady     it never changes otherwise, and so no edge comes from a line that was not steady
//   exact_captured     captured: a clock after an edge that was enabled, wanted and inside the window, with room in the memory
//   only_enabled       so nothing is captured without enable
//   exact_edges        edges: all wanted edges since clear, modulo 2^32
//   exact_entries      entries: one more for each captured edge, one less for each take of a shown entry, none after clear
//   entries_bound      at most 16
//   exact_valid        an entry is shown if one was left behind take and clear in the clock before
//   chosen_in_order    any entry that is written, `chosen`, is in the memory behind those that were written before it, and before
//                      those that came later, until as many entries were taken
//   chosen_is_shown    when it is the oldest, it is shown as it was written: positions and stamp of the clock of the edge
//   first_is_chosen    which is at the latest two clocks after the edge, if no other entry is there
//   hidden             without a shown entry the outputs are 0, whatever the memory holds
//   exact_overflowed   overflowed and outside: from an edge without room, or outside the window, until a clear_flags without one
//   exact_outside
//   known_...          invariants
module capture_properties (
    `PORTS,
    `WORDS
    (* peek = "u_edge_line.primed" *) input wire [1:0] primed,
    (* peek = "u_edge_line.u_pin.level" *) input wire now,
    (* peek = "u_edge_line.u_pin.synchroniser_first" *) input wire first_flip_flop,
    (* peek = "u_edge_line.last" *) input wire last,
    (* peek = "u_edge_line.lasted" *) input wire [15:0] lasted,
    (* peek = "u_edge_line.changed" *) input wire changed,
    (* peek = "u_memory.oldest" *) input wire [3:0] oldest
);
    // The words of the memory.
    function [160:0] word(input [3:0] place);
        reg [1287:0] eight;
        reg [643:0]  four;
        reg [321:0]  two;
        begin
            eight = place[3] ? `UPPER_WORDS : `LOWER_WORDS;
            four = place[2] ? eight[1287:644] : eight[643:0];
            two = place[1] ? four[643:322] : four[321:0];
            word = place[0] ? two[321:161] : two[160:0];
        end
    endfunction

    // The line since the reset.
    reg         line_1 = 1'b0, line_2 = 1'b0, line_3 = 1'b0;
    reg  [1:0]  clocks = 2'd0;
    reg  [15:0] steady_before = 16'd0;
    wire        is_line = clocks == 2'd2;
    wire [15:0] steady = !is_line ? 16'd0 : steady_before == 16'd0 | line_2 != line_3 ? 16'd1
        : steady_before == 16'hffff ? 16'hffff : steady_before + 16'd1;
    wire        is_steady = steady != 16'd0 & steady >= filter_clocks;
    reg         settled = 1'b0, settled_level = 1'b0, edge_now = 1'b0, past_steady = 1'b0;
    reg         past_level = 1'b0, past_known = 1'b0, past_reset = 1'b1;
    always @(posedge clk) begin
        line_1 <= !rst & line;
        line_2 <= !rst & line_1;
        line_3 <= !rst & line_2;
        clocks <= rst ? 2'd0 : is_line ? 2'd2 : clocks + 2'd1;
        steady_before <= rst ? 16'd0 : steady;
        settled <= !rst & (settled | is_steady);
        if (rst) settled_level <= 1'b0;
        else if (is_steady) settled_level <= line_2;
        edge_now <= !rst & settled & is_steady & line_2 != settled_level;
        past_steady <= !rst & is_steady;
        past_level <= !rst & level;
        past_known <= !rst & level_known;
        past_reset <= rst;
    end

    // The edge of this clock.
    wire signed [31:0] position = window_axis == 2'd0 ? count_0 : window_axis == 2'd1 ? count_1 : window_axis == 2'd2 ? count_2
        : count_3;
    wire         wanted = edge_now & enable & (settled_level ? rises : falls);
    wire         inside = !windowed | !(position < window_first | position > window_last);
    reg  [4:0]   number = 5'd0;
    reg          shows = 1'b0;
    wire         taken = take & shows;
    wire [4:0]   rest = clear ? 5'd0 : number - {4'd0, taken};
    wire         room = rest != 5'd16;
    wire         writes = wanted & inside & room;
    wire [160:0] entry = {settled_level, stamp, count_3, count_2, count_1, count_0};
    reg  [31:0]  total = 32'd0;
    reg          is_over = 1'b0, is_outside = 1'b0, has_written = 1'b0, past_enable = 1'b0;
    always @(posedge clk) begin
        number <= rst ? 5'd0 : rest + {4'd0, writes};
        shows <= !rst & rest != 5'd0;
        has_written <= !rst & writes;
        past_enable <= enable;
        total <= rst ? 32'd0 : (clear ? 32'd0 : total) + {31'd0, wanted};
        is_over <= !rst & ((wanted & inside & !room) | (is_over & !clear_flags));
        is_outside <= !rst & ((wanted & !inside) | (is_outside & !clear_flags));
    end

    // Any entry: nothing drives `pick`, so it is free in every clock. `ahead` are the entries before it.
    wire         pick;
    reg          watched = 1'b0;
    reg  [4:0]   ahead = 5'd0;
    reg  [160:0] chosen = 161'd0;
    always @(posedge clk) begin
        if (rst | (watched & (clear | (taken & ahead == 5'd0)))) watched <= 1'b0;
        else if (watched) ahead <= ahead - {4'd0, taken};
        else if (pick & writes) begin
            watched <= 1'b1;
            ahead <= rest;
            chosen <= entry;
        end
    end

    wire [3:0]    chosen_place = oldest + ahead[3:0];
    wire [160:0]  chosen_word = word(chosen_place);
    wire [160:0]  oldest_word = word(oldest);
    wire [160:0]  shown = {entry_rising, entry_stamp, entry_count_3, entry_count_2, entry_count_1, entry_count_0};
    always @(*) begin
        exact_level: assert (level_known == settled & level == settled_level);
        edge_is_steady: assert (past_reset | (level == past_level & level_known == past_known) | past_steady);
        exact_captured: assert (captured == has_written);
        only_enabled: assert (!captured | past_enable);
        exact_edges: assert (edges == total);
        exact_entries: assert (entries == number);
        entries_bound: assert (entries <= 5'd16);
        exact_valid: assert (entry_valid == shows);
        chosen_in_order: assert (!watched | (ahead < entries & chosen_word == chosen));
        chosen_is_shown: assert (!(watched & entry_valid & ahead == 5'd0) | shown == chosen);
        first_is_chosen: assert (entry_valid | entries == 5'd0 | (captured & entries == 5'd1));
        known_valid: assert (!entry_valid | entries != 5'd0);
        hidden: assert (entry_valid | shown == 161'd0);
        exact_overflowed: assert (overflowed == is_over);
        exact_outside: assert (outside == is_outside);
        known_line: assert (now == line_2 & first_flip_flop == line_1 & last == line_3 & changed == edge_now);
        known_clocks: assert (primed == (clocks == 2'd0 ? 2'd0 : clocks == 2'd1 ? 2'd1 : 2'd3) & clocks <= 2'd2);
        known_lasted: assert (lasted == (settled & line_3 == settled_level ? 16'd0 : steady_before));
        known_short: assert ((settled & line_3 == settled_level) | steady_before != 16'hffff);
        known_beginning: assert (is_line | (steady_before == 16'd0 & !settled));
        known_shown: assert (!entry_valid | shown == oldest_word);
    end

    always @(*) begin
        reach_full: cover (overflowed & entries == 5'd16);
        reach_outside: cover (outside & captured);
        reach_chosen: cover (watched & entry_valid & ahead == 5'd0 & oldest == 4'd2 & chosen[31:0] == 32'd5 & !chosen[160]);
        reach_first: cover (level_known & level & edges == 32'd0 & past_known);
    end
endmodule
