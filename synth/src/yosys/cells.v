// What the estimate counts by itself, from sizes: black boxes that Yosys carries through to the netlist.

(* blackbox *)
module posicast_memory #(
    parameter SIZE = 1,
    parameter WIDTH = 1,
    parameter ABITS = 1,
    parameter RD_PORTS = 1,
    parameter WR_PORTS = 1
) (
    input  [RD_PORTS-1:0]       RD_CLK,
    input  [RD_PORTS-1:0]       RD_EN,
    input  [RD_PORTS*ABITS-1:0] RD_ADDR,
    output [RD_PORTS*WIDTH-1:0] RD_DATA,
    input  [WR_PORTS-1:0]       WR_CLK,
    input  [WR_PORTS*WIDTH-1:0] WR_EN,
    input  [WR_PORTS*ABITS-1:0] WR_ADDR,
    input  [WR_PORTS*WIDTH-1:0] WR_DATA
);
endmodule

(* blackbox *)
module posicast_multiplier #(
    parameter A_WIDTH = 1,
    parameter B_WIDTH = 1,
    parameter Y_WIDTH = 1
) (
    input  [A_WIDTH-1:0] A,
    input  [B_WIDTH-1:0] B,
    output [Y_WIDTH-1:0] Y
);
endmodule
