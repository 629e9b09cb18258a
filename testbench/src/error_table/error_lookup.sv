// error_lookup, of error_table: the entries of a position, and its error times the weight, a bit per clock.
//
// Proven for FRACTION bits below the index and LAST as the index of the last entry, for all places and all entries, resets
// included. A memory gives any value in every clock. Assumed, as error_table does it: the weight stays from the clock after `valid`
// on until the next `valid`; where it does not, nothing is claimed of that pass.
//
//   address_is         first E_n, then for each bit of the fraction E_n+1 if it is set, else E_n; n is the index of the position, 0 below the
//                      first entry and LAST above the last one, where the bits count as 0
//   in_table           none of these is above the last entry
//   exact_whole        with `total` = E_n plus what was read for bit k times 2^k, for all bits of the fraction: the error is
//                      total / 2^FRACTION, rounded half up. So it is E_n + (E_n+1 - E_n) * fraction, and a place further by one part of
//                      2^FRACTION changes it by (E_n+1 - E_n) / 2^FRACTION, with at most one unit by the rounding
//   between            it is not below the smallest and not above the largest of the entries read: between both neighbours
//   exact_weighted     the result: error * weight / 1024, rounded half up; all of the error at 1024, 0 at 0
//   no_larger          it is between 0 and the error
//   kept               it changes in one clock of a pass only
//   ends_is            which is two clocks before `ends`; busy from the clock after `valid` to `ends`
//   known_...          invariants
//
// No product is written with `*`: it is the sum of the word * 2^k over the bits of the other one.
module error_lookup_properties (
    `PORTS,
    (* peek = "step" *)       input wire [6:0] step,
    (* peek = "place_low" *)  input wire [7:0] place_low,
    (* peek = "place_high" *) input wire [31:0] place_high,
    (* peek = "index" *)      input wire [7:0] index,
    (* peek = "beyond" *)     input wire beyond,
    (* peek = "below" *)      input wire below,
    (* peek = "in_table" *)     input wire is_in_table,
    (* peek = "u_average.average" *)  input wire signed [17:0] average,
    (* peek = "u_average.dropped" *)  input wire dropped,
    (* peek = "whole" *)      input wire signed [17:0] whole
);
    localparam [6:0] k = `FRACTION;
    localparam [6:0] found = k + 7'd44;
    localparam [6:0] over = k + 7'd55;

    // The weight of the pass, and whether it has been constant.
    reg         [10:0] kept_weight = 11'd0;
    reg                was_fair = 1'b1;
    wire               begins = step == 7'd0;
    wire               fair = begins | (was_fair & weight == kept_weight & weight <= 11'd1024);
    always @(posedge clk) begin
        kept_weight <= weight;
        was_fair <= rst | !busy | (fair & weight <= 11'd1024);
    end

    // The position, its index and its fraction.
    reg         [39:0] place = 40'd0;
    always @(posedge clk) begin
        if (rst) place <= 40'd0;
        else if (begins) place <= {counts, fraction};
    end
    wire        [39:0] entries = place >> k;
    wire               is_below = place[39];
    wire               is_behind = !is_below & entries >= `LAST;
    wire               is_inside = !is_below & !is_behind;
    wire        [7:0]  n = is_below ? 8'd0 : is_behind ? `LAST : entries[7:0];

    // Sum, smallest and largest of the entries read in a pass.
    wire               reads = step >= 7'd43 & step < found;
    wire               fades = step > found & step < over;
    wire        [6:0]  bit_read = step - 7'd44;
    wire        [6:0]  bit_faded = step - found - 7'd1;
    wire signed [17:0] used = weight == 11'd0 ? 18'sd0 : entry;
    wire signed [51:0] wide = $signed({{34{used[17]}}, used});
    wire signed [51:0] wide_whole = $signed({{34{whole[17]}}, whole});
    wire               counts_now = |((weight >> bit_faded) & 11'd1);
    reg  signed [51:0] total = 52'sd0;
    reg  signed [17:0] smallest = 18'sd0;
    reg  signed [17:0] largest = 18'sd0;
    always @(posedge clk) begin
        if (rst) begin
            total <= 52'sd0;
            smallest <= 18'sd0;
            largest <= 18'sd0;
        end else if (step == 7'd43) begin
            total <= wide;
            smallest <= used;
            largest <= used;
        end else if (reads) begin
            total <= total + (wide <<< bit_read);
            smallest <= used < smallest ? used : smallest;
            largest <= used > largest ? used : largest;
        end else if (step == found) begin
            total <= 52'sd0;
        end else if (fades & counts_now) begin
            total <= total + (wide_whole <<< bit_faded);
        end
    end
    wire        [6:0]  bits_done = step > found ? bit_faded : bit_read;
    wire signed [51:0] above = total >>> bits_done;
    wire signed [51:0] halved = total >>> (bits_done - 7'd1);
    wire signed [51:0] rounded = above + $signed({51'd0, halved[0]});
    wire signed [51:0] wide_average = $signed({{34{average[17]}}, average});
    wire signed [17:0] no_less = whole < 18'sd0 ? whole : 18'sd0;
    wire signed [17:0] no_more = whole > 18'sd0 ? whole : 18'sd0;

    // Results at the end of the pass.
    reg  signed [51:0] exact = 52'sd0;
    reg  signed [51:0] exact_part = 52'sd0;
    reg                part_is_fair = 1'b0;
    reg  signed [17:0] past_error = 18'sd0;
    reg                past_over = 1'b0;
    reg                past_valid = 1'b0;
    reg                past_busy = 1'b0;
    reg                past_ends = 1'b0;
    reg                past_reset = 1'b1;
    always @(posedge clk) begin
        if (rst) exact <= 52'sd0;
        else if (step == found) exact <= rounded;
        exact_part <= weight == 11'd1024 ? exact : rounded;
        part_is_fair <= !rst & fair & busy & step == over;
        past_error <= rst ? 18'sd0 : error;
        past_over <= !rst & step == over;
        past_valid <= valid;
        past_busy <= busy;
        past_ends <= ends;
        past_reset <= rst;
    end

    always @(*) begin
        address_first: assert (!(step == 7'd42) | address == n);
        address_is: assert (!(step >= 7'd43 & step < found - 7'd1) | address == n + {7'd0, is_inside & |((place >> (step - 7'd43)) & 40'd1)});
        in_table: assert (!(step >= 7'd42 & step < found - 7'd1) | address <= `LAST);
        exact_whole: assert (!(fair & step > found) | wide_whole == exact);
        between: assert (!(fair & step > found) | (whole >= smallest & whole <= largest));
        exact_weighted: assert (!part_is_fair | $signed({{34{error[17]}}, error}) == exact_part);
        nothing_at_0: assert (!(part_is_fair & kept_weight == 11'd0) | error == 18'sd0);
        no_larger: assert (!part_is_fair | (error >= no_less & error <= no_more));
        kept: assert (past_over | error == past_error);
        ends_is: assert (ends == (busy & step == over + 7'd1));
        busy_is: assert (busy == (!past_reset & (past_valid | (past_busy & !past_ends))));
    end

    // Invariants of the registers.
    wire        [6:0]  turned = step <= 7'd41 ? step - 7'd1 : step <= 7'd43 ? 7'd40 : step - 7'd3;
    wire        [79:0] round = {place, place} >> turned;
    wire        [79:0] round_again = {place, place} >> (step - 7'd43);
    wire        [39:0] come = (40'd1 << (step - 7'd1)) - 40'd1;
    wire        [39:0] indexed = step <= 7'd9 ? place & come : place >> (step - 7'd9);
    wire        [7:0]  shown_index = step <= 7'd9 ? index >> (7'd9 - step) : index;
    wire        [39:0] upper = (place & come) >> (k + 7'd8);
    wire        [79:0] faded = {30'd0, kept_weight[9:0], 30'd0, kept_weight[9:0]} >> bit_faded;
    always @(*) begin
        known_step: assert (step <= over + 7'd1 & (busy | step == 7'd0));
        known_place: assert (!(step >= 7'd1 & step <= 7'd41) | {place_high, place_low} == round[39:0]);
        known_place_waits: assert (!(step == 7'd42 | step == 7'd43) | {place_high, place_low} == place);
        known_place_read: assert (!(step > 7'd43 & step <= found) | {place_high, place_low} == round_again[39:0]);
        known_weight: assert (!(fair & fades) | {place_high, place_low} == faded[39:0]);
        known_index: assert (!(step >= 7'd2 & step <= k + 7'd9) | shown_index == indexed[7:0]);
        known_index_stays: assert (!(step > k + 7'd9 & step <= 7'd41) | index == entries[7:0]);
        known_beyond: assert (!(step >= 7'd1 & step <= 7'd41) | beyond == (upper != 40'd0));
        known_below: assert (!(step >= 7'd41) | below == is_below);
        known_n: assert (!(step >= 7'd42) | (index == n & is_in_table == is_inside));
        known_average: assert (!(fair & (step > 7'd43 & step <= found | step > found & step <= over)) | wide_average == above);
        known_dropped: assert (!(fair & (step > 7'd44 & step <= found | step > found + 7'd1 & step <= over)) | dropped == halved[0]);
        known_hull: assert (!(fair & step > 7'd43 & step <= found) | (smallest <= average & average <= largest));
        known_round: assert (!(fair & step > 7'd44 & step <= found & dropped) | average < largest);
        known_order: assert (smallest <= largest);
        known_fade: assert (!(fair & step > found & step <= over) | (no_less <= average & average <= no_more));
        known_fade_round: assert (!(fair & step > found + 7'd1 & step <= over & dropped) | average < no_more);
        known_nothing: assert (!(fair & weight == 11'd0 & step > 7'd43 & step <= found) | (average == 18'sd0 & smallest == 18'sd0 & largest == 18'sd0));
        known_nothing_dropped: assert (!(fair & weight == 11'd0 & step > 7'd44 & step <= found) | !dropped);
        known_nothing_whole: assert (!(fair & weight == 11'd0 & step > found) | whole == 18'sd0);
    end

    always @(*) begin
        reach_partial: cover (part_is_fair & error > 18'sd0 & error < whole);
        reach_full: cover (part_is_fair & kept_weight == 11'd1024 & error < 18'sd0);
        reach_behind: cover (ends & is_behind);
        reach_below: cover (ends & is_below);
        reach_inside: cover (ends & is_inside & smallest < largest);
    end
endmodule
