// Test design: one wire with two drivers.
module conflict (
    input  wire clk,
    input  wire a,
    input  wire b,
    output wire q
);
    reg first;
    reg second;

    always @(posedge clk) first <= a;
    always @(posedge clk) second <= b;
    assign q = first;
    assign q = second;
endmodule
