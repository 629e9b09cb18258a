// Test design: a latch, which no synchronous design has.
module latch (
    input  wire open,
    input  wire d,
    output reg  q
);
    always @(*) begin
        if (open) q = d;
    end
endmodule
