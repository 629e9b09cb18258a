// A RISC-V core with its memory, a console, and a bridge to an Avalon-MM agent: the smallest system on a programmable chip.
//
//   picorv32 ─► decoder ─┬─ 0x0…    RAM, 2 clocks
//                        ├─ 0x1…    console: takes a byte
//                        └─ STAGE   bridge ─► Avalon-MM host
//
// The bridge models an interconnect. It posts one write, so that the core continues before the agent has it; a read waits until
// that write is done. Each direction takes 0 to 7 random clocks from `seed`, or none with seed 0.
`default_nettype none
module processor #(
    parameter [31:0] STAGE = 32'h4000_0000,
    parameter ADDRESS_BITS = 10
) (
    input  wire                    clk,
    input  wire                    rst,
    // The program, one word per clock while `rst` is high.
    input  wire                    load,
    input  wire [12:0]             load_word,
    input  wire [31:0]             load_data,
    input  wire [15:0]             seed,
    output reg                     console_valid,
    output reg  [31:0]             console_data,
    output wire                    stopped,
    output wire                    in_interrupt,
    input  wire                    irq,
    output reg  [ADDRESS_BITS-1:0] avs_address,
    output wire                    avs_read,
    output wire                    avs_write,
    output reg  [3:0]              avs_byteenable,
    output reg  [31:0]             avs_writedata,
    input  wire [31:0]             avs_readdata
);
    // ---- core

    wire        mem_valid, mem_instr;
    wire [31:0] mem_addr, mem_wdata;
    wire [3:0]  mem_wstrb;
    reg         mem_ready;
    reg  [31:0] mem_rdata;
    wire        trap;
    wire [31:0] eoi;

    picorv32 #(
        .BARREL_SHIFTER(1), .ENABLE_FAST_MUL(1), .ENABLE_DIV(1),
        .ENABLE_IRQ(1), .ENABLE_IRQ_TIMER(0),
        // The stage's interrupt is a level: it stays until it is cleared in the stage.
        .LATCHED_IRQ(32'hffff_fff7),
        .PROGADDR_RESET(32'h0000_0000), .PROGADDR_IRQ(32'h0000_0010)
    ) core (
        .clk(clk), .resetn(!rst), .trap(trap),
        .mem_valid(mem_valid), .mem_instr(mem_instr), .mem_ready(mem_ready),
        .mem_addr(mem_addr), .mem_wdata(mem_wdata), .mem_wstrb(mem_wstrb), .mem_rdata(mem_rdata),
        .mem_la_read(), .mem_la_write(), .mem_la_addr(), .mem_la_wdata(), .mem_la_wstrb(),
        .pcpi_valid(), .pcpi_insn(), .pcpi_rs1(), .pcpi_rs2(),
        .pcpi_wr(1'b0), .pcpi_rd(32'd0), .pcpi_wait(1'b0), .pcpi_ready(1'b0),
        .irq({28'd0, irq, 3'd0}), .eoi(eoi),
        .trace_valid(), .trace_data()
    );

    // ---- decoder and RAM

    reg  [31:0] ram [0:8191];
    wire        request = mem_valid && !mem_ready;
    wire        of_ram = mem_addr[31:15] == 17'd0;
    wire        of_console = mem_addr[31:28] == 4'd1;
    wire        of_stage = mem_addr[31:ADDRESS_BITS+2] == STAGE[31:ADDRESS_BITS+2];
    wire        writes = mem_wstrb != 4'd0;
    reg         stray;

    assign stopped = trap || stray;
    assign in_interrupt = eoi[3];

    wire        bridge_ready;
    reg  [31:0] word;

    always @(posedge clk) begin
        mem_ready <= 1'b0;
        console_valid <= 1'b0;
        if (load) ram[load_word] <= load_data;
        if (rst) stray <= 1'b0;
        else if (request) begin
            if (of_ram) begin
                mem_ready <= 1'b1;
                mem_rdata <= ram[mem_addr[14:2]];
                if (mem_wstrb[0]) ram[mem_addr[14:2]][7:0] <= mem_wdata[7:0];
                if (mem_wstrb[1]) ram[mem_addr[14:2]][15:8] <= mem_wdata[15:8];
                if (mem_wstrb[2]) ram[mem_addr[14:2]][23:16] <= mem_wdata[23:16];
                if (mem_wstrb[3]) ram[mem_addr[14:2]][31:24] <= mem_wdata[31:24];
            end else if (of_console) begin
                mem_ready <= 1'b1;
                console_valid <= writes;
                console_data <= mem_wdata;
            end else if (of_stage) begin
                mem_ready <= bridge_ready;
                mem_rdata <= word;
            end else stray <= 1'b1;
        end
    end

    // ---- bridge

    localparam IDLE = 2'd0, THERE = 2'd1, TAKEN = 2'd2, BACK = 2'd3;

    reg  [1:0]  state;
    reg  [2:0]  wait_left;
    reg         is_write;
    reg  [15:0] random;
    wire        arrives = state == THERE && wait_left == 3'd0;

    assign avs_read = arrives && !is_write;
    assign avs_write = arrives && is_write;
    // A write is accepted at once; a read ends when its word has come back.
    assign bridge_ready = (state == IDLE && writes) || (state == BACK && wait_left == 3'd0);

    always @(posedge clk) begin
        // Galois LFSR, x^16 + x^14 + x^13 + x^11 + 1; with 0 it does not change.
        random <= {1'b0, random[15:1]} ^ (random[0] ? 16'hb400 : 16'd0);
        if (wait_left != 3'd0) wait_left <= wait_left - 3'd1;
        case (state)
            IDLE: if (request && of_stage) begin
                avs_address <= mem_addr[ADDRESS_BITS+1:2];
                avs_byteenable <= writes ? mem_wstrb : 4'hf;
                avs_writedata <= mem_wdata;
                is_write <= writes;
                wait_left <= random[2:0];
                state <= THERE;
            end
            THERE: if (wait_left == 3'd0) state <= is_write ? IDLE : TAKEN;
            // The agent shows the word only in the clock after avs_read.
            TAKEN: begin
                word <= avs_readdata;
                wait_left <= random[5:3];
                state <= BACK;
            end
            default: if (wait_left == 3'd0) state <= IDLE;
        endcase
        if (rst) begin
            state <= IDLE;
            wait_left <= 3'd0;
            random <= seed;
        end
    end
endmodule
