// Model of the block RAM of iCE40: 4096 bits, a write port and a read port of 16, 8, 4 or 2 bits.
//
// Narrow words lie interleaved: the upper address bits select one of 2, 4 or 8 neighbouring bits. The wires of a narrow port are
// 0, 2, 4, … (8 bits), 1, 5, 9, 13 (4 bits), or 3, 11 (2 bits). A word that is read while it is written is the old one.
//
// Written by posicast, to simulate a netlist that was read back from a bitstream.

`default_nettype none

module SB_RAM40_4K #(
    parameter [1:0] WRITE_MODE = 2'd0,
    parameter [1:0] READ_MODE = 2'd0,
    parameter [255:0] INIT_0 = 256'd0, INIT_1 = 256'd0, INIT_2 = 256'd0, INIT_3 = 256'd0,
    parameter [255:0] INIT_4 = 256'd0, INIT_5 = 256'd0, INIT_6 = 256'd0, INIT_7 = 256'd0,
    parameter [255:0] INIT_8 = 256'd0, INIT_9 = 256'd0, INIT_A = 256'd0, INIT_B = 256'd0,
    parameter [255:0] INIT_C = 256'd0, INIT_D = 256'd0, INIT_E = 256'd0, INIT_F = 256'd0
) (
    input  wire [10:0] WADDR,
    input  wire [15:0] MASK,
    input  wire [15:0] WDATA,
    input  wire        WE,
    input  wire        WCLKE,
    input  wire        WCLK,
    input  wire [10:0] RADDR,
    output wire [15:0] RDATA,
    input  wire        RE,
    input  wire        RCLKE,
    input  wire        RCLK
);
    localparam [4095:0] CONTENTS = {
        INIT_F, INIT_E, INIT_D, INIT_C, INIT_B, INIT_A, INIT_9, INIT_8,
        INIT_7, INIT_6, INIT_5, INIT_4, INIT_3, INIT_2, INIT_1, INIT_0
    };

    reg [15:0] words [0:255];
    reg [15:0] selected = 16'd0;
    integer word;

    initial begin
        for (word = 0; word < 256; word = word + 1) words[word] = CONTENTS[16 * word +: 16];
    end

    // The bits that a port leaves alone.
    function [15:0] other_bits(input [1:0] mode, input [2:0] part);
        case (mode)
            2'd1: other_bits = ~(16'h5555 << part[0]);
            2'd2: other_bits = ~(16'h1111 << part[1:0]);
            2'd3: other_bits = ~(16'h0101 << part);
            default: other_bits = 16'h0000;
        endcase
    endfunction

    // The wire of a port that belongs to a bit.
    function [3:0] wire_of(input [1:0] mode, input [3:0] at);
        case (mode)
            2'd1: wire_of = {at[3:1], 1'b0};
            2'd2: wire_of = {at[3:2], 2'b01};
            2'd3: wire_of = {at[3], 3'b011};
            default: wire_of = at;
        endcase
    endfunction

    reg [15:0] written;
    reg [15:0] gathered;
    reg [4:0] at;

    always @* begin
        written = 16'd0;
        gathered = 16'd0;
        for (at = 5'd0; at < 5'd16; at = at + 5'd1) begin
            written[at[3:0]] = WDATA[wire_of(WRITE_MODE, at[3:0])];
            gathered[wire_of(READ_MODE, at[3:0])] = gathered[wire_of(READ_MODE, at[3:0])] | selected[at[3:0]];
        end
    end

    wire [15:0] kept = (WRITE_MODE == 2'd0) ? MASK : other_bits(WRITE_MODE, WADDR[10:8]);

    always @(posedge WCLK) begin
        if (WE & WCLKE) words[WADDR[7:0]] <= (words[WADDR[7:0]] & kept) | (written & ~kept);
    end

    always @(posedge RCLK) begin
        if (RE & RCLKE) selected <= words[RADDR[7:0]] & ~other_bits(READ_MODE, RADDR[10:8]);
    end

    assign RDATA = gathered;
endmodule

`default_nettype wire
