// compare: each position that the count passes gives one pulse, two clocks later; none is missed, doubled or invented.
//
// Proven for all inputs in every clock, resets, jumps, `arm` and `disarm` at any time included; of rows, those whose spacing is
// SPACING. `count_1` and `count_2` are the count of the clock before and of the one before that.
//
//   exact_row          while ready: any chosen position of a row is passed, up or down, exactly when the count passes it, and index
//                      says whether it was
//   between            while ready, the count is between the position below and the one above; while one of them is being read from
//                      the list, the count cannot reach it
//   *_is_at_*          nothing else is passed than these two, each where the count becomes it, or leaves it
//   seen_*             a passage gives `passed` and its direction in the next clock, if its direction is wanted, and if the same
//                      position has not just given one within the hysteresis; nothing else gives `passed`
//   exact_passes       passes counts them since arm
//   exact_pulse        pulse is high for the set number of clocks from each of them; merged says that one began within another
//   neighbours         the positions of a row are a spacing apart
//   not_armed_*        without arm, and after disarm, nothing is passed
//   jump_*             a change of more than one count while ready sets jumped, passes nothing and ends ready
//   list_*             an entry is taken or refused; of any two entries, the later one is the least distance or more above the other
//   known_settings     settings are those of the last arm, a spacing and a width of 0 as 1
//
// Assumed: what list_increases says of any two entries holds for the word that the memory shows and the position on the other side
// of the count, which is the entry beside it. Not proven here: that the memory shows the word at its address, and so which entry of
// a list is the next one (lock step, model/blocks/tests/compare.rs). `known_...` are invariants.
module compare_properties (
    `PORTS,
    (* peek = "counted" *) input wire [31:0] count_1,
    (* peek = "earlier" *) input wire [31:0] count_2,
    (* peek = "by_list" *) input wire by_list,
    (* peek = "on_rise" *) input wire on_rise,
    (* peek = "on_fall" *) input wire on_fall,
    (* peek = "distance" *) input wire [34:0] distance,
    (* peek = "total" *) input wire [31:0] total,
    (* peek = "margin" *) input wire [15:0] margin,
    (* peek = "width_clocks" *) input wire [23:0] width_clocks,
    (* peek = "index" *) input wire [31:0] index,
    (* peek = "above" *) input wire [34:0] above_word,
    (* peek = "above_known" *) input wire above_known,
    (* peek = "below" *) input wire [34:0] below_word,
    (* peek = "below_known" *) input wire below_known,
    (* peek = "fetches" *) input wire fetches,
    (* peek = "fetches_above" *) input wire fetches_above,
    (* peek = "word_shown" *) input wire word_shown,
    (* peek = "list_read_address" *) input wire [7:0] read_address,
    (* peek = "list_word" *) input wire [31:0] list_word,
    (* peek = "upward" *) input wire upward,
    (* peek = "downward" *) input wire downward,
    (* peek = "last" *) input wire [31:0] last,
    (* peek = "near" *) input wire near,
    (* peek = "u_list.newest" *) input wire [31:0] newest,
    (* peek = "u_timer.left" *) input wire [23:0] left
);
    localparam signed [47:0] LARGEST = 48'sd2147483647;
    localparam signed [47:0] SMALLEST = -48'sd2147483648;
    localparam signed [47:0] LEAST = 48'sd4;
    localparam [8:0] ENTRIES = 9'd256;

    wire signed [47:0] c1 = {{16{count_1[31]}}, count_1};
    wire signed [47:0] c2 = {{16{count_2[31]}}, count_2};
    wire signed [47:0] above = {{13{above_word[34]}}, above_word};
    wire signed [47:0] below = {{13{below_word[34]}}, below_word};
    wire signed [47:0] word = {{16{list_word[31]}}, list_word};
    wire               has_above = index != total & above <= LARGEST;
    wire               has_below = index != 32'd0;

    // Settings of the last arm.
    reg               is_armed = 1'b0, from_list = 1'b0, rises_set = 1'b0, falls_set = 1'b0;
    reg signed [31:0] first_set = 32'sd0;
    reg        [31:0] number_set = 32'd0, spacing_set = 32'd0;
    reg        [23:0] width_set = 24'd0;
    reg        [15:0] margin_set = 16'd0;
    always @(posedge clk) begin
        is_armed <= !rst & !disarm & (arm | is_armed);
        if (rst) begin
            {from_list, rises_set, falls_set} <= 3'd0;
            {first_set, number_set, spacing_set, width_set, margin_set} <= 136'd0;
        end else if (arm) begin
            {from_list, rises_set, falls_set} <= {use_list, rises, falls};
            first_set <= first;
            number_set <= use_list ? {23'd0, entries} : positions;
            spacing_set <= spacing == 32'd0 ? 32'd1 : spacing;
            width_set <= pulse_clocks == 24'd0 ? 24'd1 : pulse_clocks;
            margin_set <= hysteresis;
        end
    end
    always @(*) begin
        known_settings: assert (by_list == from_list & on_rise == rises_set & on_fall == falls_set & total == number_set
            & margin == margin_set & distance == {3'd0, spacing_set} & width_clocks == width_set);
        known_armed: assert (armed == is_armed & (armed | !ready));
    end

    // The chosen position of the row.
    wire        [31:0] chosen_row = $anyconst;
    wire signed [47:0] first_wide = {{16{first_set[31]}}, first_set};
    wire signed [47:0] row_position = first_wide + $signed({16'd0, chosen_row} * 48'd`SPACING);
    wire               row_exists = !from_list & chosen_row < number_set & row_position <= LARGEST;
    always @(*) begin
        row_spacing: assume (!arm | (spacing == 32'd0 ? 32'd1 : spacing) == 32'd`SPACING);
        known_row: assert (from_list | !is_armed | above == first_wide + $signed({16'd0, index} * 48'd`SPACING));
        neighbours: assert (from_list | !is_armed | (above_known & below_known & above - below == $signed({13'd0, distance})));
        known_no_fetch: assert (from_list | !is_armed | !fetches);
        known_spacing: assert (!is_armed | spacing_set == 32'd`SPACING);
        known_reach: assert (from_list | !is_armed | (above <= LARGEST + $signed({13'd0, distance}) & index <= number_set));
        exact_row: assert (!(ready & row_exists) | (index <= chosen_row) == (c2 < row_position));
        exact_row_up: assert (!(ready & row_exists & c2 == row_position - 48'sd1 & c1 == row_position) | upward);
        exact_row_down: assert (!(ready & row_exists & c2 == row_position & c1 == row_position - 48'sd1) | downward);
    end

    // The chosen entry of the list, and another.
    wire        [7:0]  chosen = $anyconst;
    wire        [7:0]  other = $anyconst;
    reg signed [31:0]  chosen_word = 32'sd0, other_word = 32'sd0;
    reg                past_write = 1'b0, past_clear = 1'b0, past_armed = 1'b0, past_reset = 1'b1;
    reg         [8:0]  past_entries = 9'd0;
    reg signed [31:0]  past_entry = 32'sd0, past_newest = 32'sd0;
    wire               is_other_above = past_entries == 9'd0 | $signed({past_entry[31], past_entry})
        - $signed({past_newest[31], past_newest}) >= 33'sd4;
    wire               past_taken = past_write & !past_clear & !past_armed & past_entries != ENTRIES & is_other_above;
    wire signed [31:0] now_chosen = past_taken & !past_reset & past_entries == {1'b0, chosen} ? past_entry : chosen_word;
    wire signed [31:0] now_other = past_taken & !past_reset & past_entries == {1'b0, other} ? past_entry : other_word;
    always @(posedge clk) begin
        {past_write, past_clear, past_armed, past_reset} <= {entry_write, entries_clear, armed | arm, rst};
        {past_entries, past_entry, past_newest} <= {entries, entry, newest};
        chosen_word <= now_chosen;
        other_word <= now_other;
    end
    wire signed [47:0] c = {{16{now_chosen[31]}}, now_chosen};
    wire signed [47:0] o = {{16{now_other[31]}}, now_other};
    wire signed [47:0] newest_wide = {{16{newest[31]}}, newest};
    wire               has_chosen = {1'b0, chosen} < entries;
    wire               has_other = {1'b0, other} < entries;
    always @(*) begin
        list_at_most: assert (entries <= ENTRIES);
        list_taken: assert (past_reset ? entries == 9'd0 : past_clear & !past_armed ? entries == 9'd0
            : entries == past_entries + {8'd0, past_taken});
        list_refused: assert (past_reset | refused | !((past_write & !past_clear & !past_taken) | (past_clear & past_armed)));
        list_increases: assert (!(has_chosen & has_other & other > chosen) | o >= c + LEAST);
        known_newest: assert (!has_chosen | (entries == {1'b0, chosen} + 9'd1 ? newest_wide == c : newest_wide >= c + LEAST));
        known_newest_other: assert (!has_other
            | (entries == {1'b0, other} + 9'd1 ? newest_wide == o : newest_wide >= o + LEAST));
    end

    wire               lists = is_armed & from_list;

    // The word that the memory shows.
    reg         [7:0]  shown_address = 8'd0;
    always @(posedge clk) shown_address <= read_address;
    wire               shows_entry = {1'b0, shown_address} < entries;
    always @(*) begin
        memory_beside_below: assume (!(lists & fetches & word_shown & fetches_above & has_below & below_known & shows_entry)
            | word >= below + LEAST);
        memory_beside_above: assume (!(lists & fetches & word_shown & !fetches_above & index != total & above_known & shows_entry)
            | word <= above - LEAST);
    end

    // Where the count is in the list.
    wire        [31:0] place_below = index - 32'd1;
    wire        [7:0]  address = fetches_above ? index[7:0] : place_below[7:0];
    always @(*) begin
        known_total: assert (!lists | (number_set == {23'd0, entries} & index <= number_set));
        known_read: assert (!(lists & fetches & word_shown) | shown_address == address);
        known_shown: assert (!word_shown | fetches);
        known_fetch: assert (!lists | (above_known | (fetches & fetches_above)) & (below_known | (fetches & !fetches_above)));
        known_beside: assert (!lists | below_known | index < total);
        known_unknown: assert (!lists | !fetches | (fetches_above ? !above_known : !below_known));
        known_behind: assert (!lists | !ready | above_known | has_below);
        known_words: assert (!lists | !above_known | index == total | (above <= LARGEST & above >= SMALLEST));
        known_words_below: assert (!lists | !below_known | !has_below | (below <= LARGEST & below >= SMALLEST));
    end

    // Between the neighbours; an unknown one is not reached before it is read.
    always @(*) begin
        between_above: assert (!ready | (above_known ? !has_above | c2 < above
            : index == total | c2 <= below + (word_shown ? 48'sd1 : 48'sd0)));
        between_below: assert (!ready | !has_below | (below_known ? c2 >= below
            : c2 >= above - (word_shown ? 48'sd2 : 48'sd1)));
        up_is_at_above: assert (!upward | (ready & above_known & has_above & c1 == above & c2 == above - 48'sd1));
        down_is_at_below: assert (!downward | (ready & below_known & has_below & c2 == below & c1 == below - 48'sd1));
        never_both: assert (!(upward & downward));
    end

    // Passages, seen at the ports.
    reg                has_last = 1'b0, was_jump = 1'b0, was_disarmed = 1'b0, was_pulse = 1'b0;
    reg  signed [31:0] last_edge = 32'sd0;
    reg         [31:0] passes_before = 32'd0;
    wire signed [47:0] last_wide = {{16{last_edge[31]}}, last_edge};
    wire signed [47:0] from_last = c1 - last_wide;
    wire signed [47:0] from_edge = from_last < 48'sd0 ? -48'sd1 - from_last : from_last;
    wire               is_near = has_last & from_edge < $signed({32'd0, margin_set});
    wire        [31:0] edge_passed = upward ? count_1 : count_2;
    wire               gives = ((upward & rises_set) | (downward & falls_set)) & !(is_near & edge_passed == last_edge);
    reg                gave = 1'b0, gave_up = 1'b0, past_arm = 1'b0;
    always @(posedge clk) begin
        gave <= !rst & gives;
        gave_up <= upward;
        past_arm <= arm & !rst;
        was_jump <= !rst & ready & (c1 - c2 > 48'sd1 | c2 - c1 > 48'sd1);
        was_disarmed <= disarm;
        was_pulse <= pulse;
        passes_before <= rst ? 32'd0 : passes;
        if (rst | arm) has_last <= 1'b0;
        else has_last <= is_near | gives;
        if (rst) last_edge <= 32'sd0;
        else if (gives) last_edge <= edge_passed;
    end
    always @(*) begin
        known_last: assert (last == last_edge & near == has_last);
        seen_passed: assert (passed == gave);
        seen_upward: assert (!passed | passed_upward == gave_up);
        exact_passes: assert (past_arm ? passes == 32'd0 : past_reset | passes == passes_before + {31'd0, gave});
        not_armed_rests: assert (armed | !(upward | downward));
        not_armed_ready: assert (past_reset | !was_disarmed | !(armed | ready));
        jump_shows: assert (!was_jump | jumped);
        jump_ends: assert (!was_jump | !ready);
        jump_gives_nothing: assert (!was_jump | !passed);
    end

    // The pulse.
    reg         [23:0] width_left = 24'd0;
    reg         [23:0] width_before = 24'd0;
    wire        [23:0] width_now = gave ? width_before : width_left;
    always @(posedge clk) begin
        width_before <= width_set;
        width_left <= rst | width_now == 24'd0 ? 24'd0 : width_now - 24'd1;
    end
    always @(*) begin
        exact_pulse: assert (pulse == (width_now != 24'd0));
        known_left: assert (left == width_now);
        exact_merged: assert (!(gave & was_pulse & !past_reset) | merged);
        known_width: assert (!gave | width_before != 24'd0);
        known_set: assert (!is_armed | width_set != 24'd0);
    end
    always @(posedge clk) begin
        passes_up: cover (passed & passed_upward & passes == 32'd2);
        passes_down: cover (passed & !passed_upward & from_list);
    end
endmodule
