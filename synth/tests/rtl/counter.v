// Test design: counts up and down; Yosys shares one adder between the branches late in its flow.
module counter (
    input  wire        clk,
    input  wire        rst,
    input  wire        step,
    input  wire        up,
    output reg  [15:0] count
);
    always @(posedge clk) begin
        if (rst) count <= 16'd0;
        else if (step) begin
            if (up) count <= count + 16'd1;
            else count <= count - 16'd1;
        end
    end
endmodule
