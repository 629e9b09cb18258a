// Test design: a ring of 1024 words, a ROM of 64 coefficients of 18 bits, and their product.
module filter #(
    parameter WIDTH = 16
) (
    input  wire                    clk,
    input  wire                    rst,
    input  wire        [9:0]       tick,
    input  wire signed [WIDTH-1:0] in,
    output wire signed [WIDTH-1:0] out
);
    reg signed [WIDTH-1:0] ring [0:1023];
    reg signed [17:0] coefficients [0:63];
    reg signed [WIDTH-1:0] word;
    reg signed [17:0] coefficient;
    reg signed [WIDTH+17:0] product;
    integer i;

    initial begin
        for (i = 0; i < 64; i = i + 1) coefficients[i] = i * 40503;
    end

    always @(posedge clk) begin
        ring[tick] <= in;
        word <= ring[tick + 10'd1];
        coefficient <= coefficients[tick[5:0]];
    end

    always @(posedge clk) begin
        if (rst) product <= 0;
        else product <= word * coefficient;
    end

    assign out = product[WIDTH+15:16];
endmodule
