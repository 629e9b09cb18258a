// Test design: a product whose operands are extended to its width first; they still carry 16 and 18 bits.
module product (
    input  wire               clk,
    input  wire signed [15:0] a,
    input  wire signed [17:0] b,
    output reg  signed [33:0] p
);
    wire signed [33:0] a_wide = {{18{a[15]}}, a};
    wire signed [33:0] b_wide = {{16{b[17]}}, b};

    always @(posedge clk) p <= a_wide * b_wide;
endmodule
