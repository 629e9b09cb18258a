// scaled_product: after 31 clocks of `shift` the product is shifted by any distance of the gain, and rounds half up.
//
// The properties are proven for all inputs in every clock, including resets, with all 51 bits. The multipliers are left out: a
// product has any value. They are claimed from a `read` on, with a `load` before the first `shift`, until the next `read` or
// `load`: the sequencer's proof has that each step is so.
//
//   shifted           scaled = the doubled product, shifted right with its sign, by what has been done of the distance
//   one_a_clock       a clock of `shift` does one bit of it, until all is done; and then it stays: in 31 clocks any distance
//   half_up           then (scaled + 1) >>> 1 is the product over 2^distance, rounded half up: one rounding, of the whole
//   known_*           invariants: what has come so far, and what is left to do
//
// Not proven here: that the two multipliers' products make the operand's with the mantissa (lock step).
module scaled_product_properties (
    `PORTS,
    (* peek = "product" *) input wire [49:0] product,
    (* peek = "left" *) input wire [4:0] still_left
);
    localparam [5:0] ENOUGH = 6'd31;

    reg               is_read = 1'b0;
    reg               is_loaded = 1'b0;
    reg [4:0]         distance = 5'd0;
    reg [4:0]         moved = 5'd0;
    reg [5:0]         clocks = 6'd0;
    reg signed [51:0] whole = 52'sd0;

    wire [4:0] left = distance - moved;
    always @(posedge clk) begin
        if (rst) begin
            is_read <= 1'b0;
            is_loaded <= 1'b0;
        end else if (read) begin
            is_read <= 1'b1;
            is_loaded <= 1'b0;
            // A word that is added unchanged has its own shift.
            distance <= unit ? 5'd8 : gain[22:18];
            moved <= 5'd0;
        end else if (load) begin
            is_read <= 1'b0;
            is_loaded <= is_read & !shift;
            clocks <= 6'd0;
            whole <= {product[49], product, 1'b0};
        end else if (shift) begin
            is_read <= 1'b0;
            if (clocks != ENOUGH) clocks <= clocks + 6'd1;
            if (left != 5'd0) moved <= moved + 5'd1;
        end
    end

    wire signed [51:0] wide_scaled = {scaled[50], scaled};
    wire signed [51:0] rounded = (wide_scaled + 52'sd1) >>> 1;
    // Half an LSB of the result, doubled as `whole` is.
    wire signed [51:0] half = distance == 5'd0 ? 52'sd0 : 52'sd1 <<< distance;
    wire signed [51:0] wanted = ((whole + half) >>> 1) >>> distance;
    wire signed [51:0] so_far = whole >>> moved;
    always @(*) begin
        known_state: assert (!(is_read & is_loaded));
        known_left: assert (!(is_read | is_loaded) | (still_left == left & moved <= distance & (is_loaded | moved == 5'd0)));
        known_whole: assert (!is_loaded | (whole[51] == whole[50] & !whole[0]));
        known_clocks: assert (!is_loaded | clocks <= ENOUGH);
        shifted: assert (!is_loaded | wide_scaled == so_far);
        one_a_clock: assert (!is_loaded | {1'b0, moved} == (clocks < {1'b0, distance} ? clocks : {1'b0, distance}));
        half_up: assert (!is_loaded | moved != distance | rounded == wanted);
    end

    always @(*) begin
        reach_none: cover (is_loaded & clocks == ENOUGH & distance == 5'd0);
        reach_all: cover (is_loaded & clocks == ENOUGH & distance == 5'd31);
    end
endmodule
