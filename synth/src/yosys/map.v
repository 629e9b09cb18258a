// Turns Yosys's multipliers and memories into the black boxes of cells.v.

// An operand below 5 bits stays in logic: a few adders are no case for a multiplier.
(* techmap_celltype = "$mul" *)
module posicast_map_multiplier(A, B, Y);
    parameter A_SIGNED = 0;
    parameter B_SIGNED = 0;
    parameter A_WIDTH = 1;
    parameter B_WIDTH = 1;
    parameter Y_WIDTH = 1;
    input [A_WIDTH-1:0] A;
    input [B_WIDTH-1:0] B;
    output [Y_WIDTH-1:0] Y;

    wire _TECHMAP_FAIL_ = A_WIDTH < 5 || B_WIDTH < 5;

    posicast_multiplier #(
        .A_WIDTH(A_WIDTH),
        .B_WIDTH(B_WIDTH),
        .Y_WIDTH(Y_WIDTH)
    ) _TECHMAP_REPLACE_ (.A(A), .B(B), .Y(Y));
endmodule

// A block RAM reads at a clock edge; a memory with a read port without clock stays in logic. So do less than 256 bits:
// Yosys makes such memories of tables in case statements, which a device keeps in its LUTs.
(* techmap_celltype = "$mem_v2" *)
module posicast_map_memory(RD_CLK, RD_EN, RD_ARST, RD_SRST, RD_ADDR, RD_DATA, WR_CLK, WR_EN, WR_ADDR, WR_DATA);
    parameter MEMID = "";
    parameter SIZE = 4;
    parameter OFFSET = 0;
    parameter ABITS = 2;
    parameter WIDTH = 8;
    parameter INIT = 1'bx;
    parameter RD_PORTS = 1;
    parameter RD_CLK_ENABLE = 1'b1;
    parameter RD_CLK_POLARITY = 1'b1;
    parameter RD_TRANSPARENCY_MASK = 1'b0;
    parameter RD_COLLISION_X_MASK = 1'b0;
    parameter RD_WIDE_CONTINUATION = 1'b0;
    parameter RD_CE_OVER_SRST = 1'b0;
    parameter RD_ARST_VALUE = 1'b0;
    parameter RD_SRST_VALUE = 1'b0;
    parameter RD_INIT_VALUE = 1'b0;
    parameter WR_PORTS = 1;
    parameter WR_CLK_ENABLE = 1'b1;
    parameter WR_CLK_POLARITY = 1'b1;
    parameter WR_PRIORITY_MASK = 1'b0;
    parameter WR_WIDE_CONTINUATION = 1'b0;
    input [RD_PORTS-1:0] RD_CLK;
    input [RD_PORTS-1:0] RD_EN;
    input [RD_PORTS-1:0] RD_ARST;
    input [RD_PORTS-1:0] RD_SRST;
    input [RD_PORTS*ABITS-1:0] RD_ADDR;
    output [RD_PORTS*WIDTH-1:0] RD_DATA;
    input [WR_PORTS-1:0] WR_CLK;
    input [WR_PORTS*WIDTH-1:0] WR_EN;
    input [WR_PORTS*ABITS-1:0] WR_ADDR;
    input [WR_PORTS*WIDTH-1:0] WR_DATA;

    wire _TECHMAP_FAIL_ = RD_CLK_ENABLE != {RD_PORTS{1'b1}} || SIZE * WIDTH < 256;

    posicast_memory #(
        .SIZE(SIZE),
        .WIDTH(WIDTH),
        .ABITS(ABITS),
        .RD_PORTS(RD_PORTS),
        .WR_PORTS(WR_PORTS)
    ) _TECHMAP_REPLACE_ (
        .RD_CLK(RD_CLK),
        .RD_EN(RD_EN),
        .RD_ADDR(RD_ADDR),
        .RD_DATA(RD_DATA),
        .WR_CLK(WR_CLK),
        .WR_EN(WR_EN),
        .WR_ADDR(WR_ADDR),
        .WR_DATA(WR_DATA)
    );
endmodule
