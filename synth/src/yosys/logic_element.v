// What the logic element of Cyclone II to IV, Cyclone 10 LP and MAX 10 does and Yosys's mapping leaves out: its arithmetic
// mode and the flip-flop's synchronous clear. (Cyclone II Device Handbook, "Logic Elements", "LE Operating Modes".)

// Arithmetic mode: a bit of a sum or difference per element, of two inputs and the carry. Short ones stay in LUTs, and with
// them comparisons of short numbers with constants. The chain begins at the first bit that can make a carry of its own:
// below, one operand is a constant equal to the carry, and the sum is the other operand.
(* techmap_celltype = "$alu" *)
module posicast_map_carry_chain(A, B, CI, BI, X, Y, CO);
    parameter A_SIGNED = 0;
    parameter B_SIGNED = 0;
    parameter A_WIDTH = 1;
    parameter B_WIDTH = 1;
    parameter Y_WIDTH = 1;
    parameter _TECHMAP_CONSTMSK_CI_ = 0;
    parameter _TECHMAP_CONSTVAL_CI_ = 0;
    parameter _TECHMAP_CONSTMSK_BI_ = 0;
    parameter _TECHMAP_CONSTVAL_BI_ = 0;
    parameter [A_WIDTH-1:0] _TECHMAP_CONSTMSK_A_ = 0;
    parameter [A_WIDTH-1:0] _TECHMAP_CONSTVAL_A_ = 0;
    parameter [B_WIDTH-1:0] _TECHMAP_CONSTMSK_B_ = 0;
    parameter [B_WIDTH-1:0] _TECHMAP_CONSTVAL_B_ = 0;
    input [A_WIDTH-1:0] A;
    input [B_WIDTH-1:0] B;
    input CI, BI;
    output [Y_WIDTH-1:0] X, Y, CO;

    wire _TECHMAP_FAIL_ = Y_WIDTH < 8;

    wire [Y_WIDTH-1:0] a, b;
    \$pos #(.A_SIGNED(A_SIGNED), .A_WIDTH(A_WIDTH), .Y_WIDTH(Y_WIDTH)) extend_a (.A(A), .Y(a));
    \$pos #(.A_SIGNED(B_SIGNED), .A_WIDTH(B_WIDTH), .Y_WIDTH(Y_WIDTH)) extend_b (.A(B), .Y(b));

    // A fixed difference is another table in the same element. One that is chosen by a signal inverts in LUTs of its own.
    wire [Y_WIDTH-1:0] inverted_b = b ^ {Y_WIDTH{BI}};
    wire [Y_WIDTH-1:0] added = _TECHMAP_CONSTMSK_BI_ ? b : inverted_b;
    localparam [15:0] TABLE = _TECHMAP_CONSTMSK_BI_ && _TECHMAP_CONSTVAL_BI_ ? 16'h69b2 : 16'h96e8;

    // Bits of the operands that are constants equal to a constant carry, from the lowest on.
    function integer carried(input [31:0] width, input [Y_WIDTH-1:0] known, input [Y_WIDTH-1:0] value, input carry);
        integer i;
        begin
            carried = 0;
            for (i = 0; i < width; i = i + 1)
                if (carried == i && known[i] && value[i] == carry) carried = i + 1;
        end
    endfunction
    localparam [B_WIDTH-1:0] VALUE_B = _TECHMAP_CONSTVAL_B_ ^ {B_WIDTH{_TECHMAP_CONSTVAL_BI_ ? 1'b1 : 1'b0}};
    localparam FIXED = _TECHMAP_CONSTMSK_CI_ && _TECHMAP_CONSTMSK_BI_;
    localparam LOW_A = FIXED ? carried(A_WIDTH < Y_WIDTH ? A_WIDTH : Y_WIDTH,
        _TECHMAP_CONSTMSK_A_, _TECHMAP_CONSTVAL_A_, _TECHMAP_CONSTVAL_CI_) : 0;
    localparam LOW_B = FIXED ? carried(B_WIDTH < Y_WIDTH ? B_WIDTH : Y_WIDTH,
        _TECHMAP_CONSTMSK_B_, VALUE_B, _TECHMAP_CONSTVAL_CI_) : 0;
    localparam FIRST = LOW_A > LOW_B ? LOW_A : LOW_B;

    // A carry into the chain that is a signal takes an element of its own, whose own carry is tied off: left open it is an
    // unknown to whatever reads the netlist, though the table does not look at it,
    wire [Y_WIDTH:0] carry;
    generate
        if (_TECHMAP_CONSTMSK_CI_) begin
            assign carry[FIRST] = CI;
        end else begin
            cycloneive_lcell_comb #(.lut_mask(16'haaaa), .sum_lutc_input("cin")) carry_in (
                .dataa(CI), .datab(1'b1), .datac(1'b1), .datad(1'b1), .cin(1'b0), .cout(carry[0])
            );
        end
    endgenerate

    genvar i;
    generate
        for (i = 0; i < FIRST; i = i + 1) begin : carried_bits
            assign Y[i] = LOW_A > LOW_B ? inverted_b[i] : a[i];
            assign CO[i] = CI;
        end
        for (i = FIRST; i < Y_WIDTH; i = i + 1) begin : bits
            cycloneive_lcell_comb #(.lut_mask(TABLE), .sum_lutc_input("cin")) sum (
                .dataa(a[i]), .datab(added[i]), .datac(1'b1), .datad(1'b1),
                .cin(carry[i]), .combout(Y[i]), .cout(carry[i+1])
            );
            // and one that leaves it for other logic.
            cycloneive_lcell_comb #(.lut_mask(16'hf0f0), .sum_lutc_input("cin")) carry_out (
                .dataa(1'b1), .datab(1'b1), .datac(1'b1), .datad(1'b1), .cin(carry[i+1]), .combout(CO[i])
            );
        end
    endgenerate
    assign X = a ^ b ^ {Y_WIDTH{BI}};
endmodule

// Synchronous clear, of enabled clocks only.
(* techmap_celltype = "$_SDFFCE_PP0P_" *)
module posicast_map_cleared_flip_flop(input D, C, R, E, output Q);
    parameter _TECHMAP_WIREINIT_Q_ = 1'bx;
    localparam POWER_UP = _TECHMAP_WIREINIT_Q_ === 1'b1 ? "high" : "low";
    wire _TECHMAP_REMOVEINIT_Q_ = 1;

    dffeas #(.is_wysiwyg("TRUE"), .power_up(POWER_UP)) _TECHMAP_REPLACE_ (
        .d(D), .q(Q), .clk(C), .clrn(1'b1), .prn(1'b1), .ena(E), .asdata(1'b0), .aload(1'b0), .sclr(R), .sload(1'b0)
    );
endmodule
