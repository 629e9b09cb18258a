module accumulator (
    input             clk, rst, enable,
    input      [23:0] step, origin,
    output reg [23:0] sum,
    output     [23:0] position
);
    assign position = sum - origin;

    always @(posedge clk)
        if (rst) sum <= 24'd0;
        else if (enable) sum <= sum + step;
endmodule
