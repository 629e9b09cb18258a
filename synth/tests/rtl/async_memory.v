// Test design: a memory that is read without a clock, so that no block RAM can hold it.
module async_memory (
    input  wire       clk,
    input  wire [5:0] address,
    input  wire [7:0] in,
    input  wire       write,
    output wire [7:0] out
);
    reg [7:0] words [0:63];

    always @(posedge clk) begin
        if (write) words[address] <= in;
    end

    assign out = words[address];
endmodule
