// commit: the staged registers of a bank, as docs/registers.md promises to a host that writes them one after the other.
//
// The properties are proven for all traffic, addresses and byte enables, ticks and resets; nothing is assumed: a read and a write
// in one clock too. Which registers are staged, their fields and what they are after reset comes from the bank's register map.
//
//   all_at_once        all registers in effect are those of the last commit, applied in one clock
//   only_by_commit     no staged register changes in a clock that no commit was applied in, or a reset
//   last_written       a commit applies what was last written, byte by byte, before it
//   reads_what_was_    a staged register reads what was last written, applied or not, a clock after the read
//     written
//   reads_waiting      COMMIT reads 1 from its write to its tick, and 0 otherwise
//   refused_is_flagged a write of a staged register, or a whole one of COMMIT, while a commit waits sets `commit_rejected`;
//   flagged_is_refused nothing else does. That it changes nothing is in last_written
//
// A commit waits from the clock after its write, of the whole word, to the first clock with a tick. Part of a word commits
// nothing. Left open: what a block makes of its settings.
module commit_properties (
    `PORTS,
    (* peek = "flag_commit_rejected" *) input wire rejected
);
    localparam WIDTH = 32 * `REGISTERS;
    localparam [`ADDRESS_BITS*`REGISTERS-1:0] ADDRESSES = `ADDRESSES;
    localparam [WIDTH-1:0] BITS = `BITS;
    localparam [WIDTH-1:0] RESET = `RESET;
    wire [WIDTH-1:0] in_force = `IN_FORCE;

    wire             whole = &avs_byteenable;
    wire [31:0]      bytes = {{8{avs_byteenable[3]}}, {8{avs_byteenable[2]}}, {8{avs_byteenable[1]}}, {8{avs_byteenable[0]}}};
    reg  [WIDTH-1:0] written = RESET;
    reg  [WIDTH-1:0] committed = RESET;
    reg              waits = 1'b0;
    wire             applies = waits & `TICK;
    wire             writes_commit = avs_write & avs_address == `COMMIT & whole;

    wire [`REGISTERS-1:0] writes;
    wire [`REGISTERS-1:0] reads;
    wire [`REGISTERS-1:0] read_well;
    reg  [WIDTH-1:0]      past_written = RESET;
    reg  [`REGISTERS-1:0] past_reads = 0;
    genvar n;
    generate
        for (n = 0; n < `REGISTERS; n = n + 1) begin : register
            localparam [31:0] OWN_BITS = BITS[32*n +: 32];
            wire is_this = avs_address == ADDRESSES[`ADDRESS_BITS*n +: `ADDRESS_BITS];
            assign writes[n] = avs_write & is_this;
            assign reads[n] = avs_read & is_this & !rst;
            assign read_well[n] = !past_reads[n] | avs_readdata == past_written[32*n +: 32];
            always @(posedge clk) begin
                if (rst) written[32*n +: 32] <= RESET[32*n +: 32];
                else if (writes[n] & !waits)
                    written[32*n +: 32] <= ((avs_writedata & bytes) | (written[32*n +: 32] & ~bytes)) & OWN_BITS;
            end
        end
    endgenerate

    reg             past_reset = 1'b1;
    reg             past_applies = 1'b0;
    reg             past_reads_commit = 1'b0;
    reg             past_waits = 1'b0;
    reg             past_refused = 1'b0;
    reg             past_rejected = 1'b0;
    reg [WIDTH-1:0] past_in_force = RESET;
    always @(posedge clk) begin
        if (rst) committed <= RESET;
        else if (applies) committed <= written;
        waits <= !rst & !applies & (waits | writes_commit);
        past_reset <= rst;
        past_applies <= applies & !rst;
        past_reads <= reads;
        past_reads_commit <= avs_read & avs_address == `COMMIT & !rst;
        past_waits <= waits;
        past_refused <= !rst & waits & (writes_commit | (|writes));
        past_rejected <= rejected & !rst;
        past_in_force <= in_force;
        past_written <= written;
    end

    always @(*) begin
        all_at_once: assert (in_force == committed);
        only_by_commit: assert (past_reset | past_applies | in_force == past_in_force);
        last_written: assert (!past_applies | in_force == past_written);
        reads_what_was_written: assert (&read_well);
        reads_waiting: assert (!past_reads_commit | avs_readdata == {31'd0, past_waits});
        refused_is_flagged: assert (!past_refused | rejected);
        flagged_is_refused: assert (!rejected | past_rejected | past_refused);
    end

    // All registers of the group differ from their reset values.
    wire [`REGISTERS-1:0] differs;
    generate
        for (n = 0; n < `REGISTERS; n = n + 1) begin : change
            assign differs[n] = in_force[32*n +: 32] != RESET[32*n +: 32];
        end
    endgenerate
    always @(*) begin
        reach_all_changed: cover (&differs);
        reach_refused: cover (past_refused);
        reach_read: cover (|past_reads);
        reach_waiting: cover (past_reads_commit & past_waits);
    end
endmodule
