// Test design: two filters of different word width, and a tick counter between them.
module stage (
    input  wire               clk,
    input  wire               rst,
    input  wire signed [15:0] x,
    input  wire signed [31:0] y,
    output wire signed [15:0] fx,
    output wire signed [31:0] fy
);
    reg [9:0] tick;

    always @(posedge clk) begin
        if (rst) tick <= 10'd0;
        else tick <= tick + 10'd1;
    end

    filter #(.WIDTH(16)) x_filter (.clk(clk), .rst(rst), .tick(tick), .in(x), .out(fx));
    filter #(.WIDTH(32)) y_filter (.clk(clk), .rst(rst), .tick(tick), .in(y), .out(fy));
endmodule
