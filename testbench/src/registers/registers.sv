// registers: the bank of the PWM's component, as the Avalon-MM agent that a host sees.
//
// The properties are proven for all traffic, addresses and byte enables, inputs of the block, and resets; nothing is assumed: a
// read and a write in one clock too.
//
//   reads_what_was_    a configuration register reads what was written to it, a clock after the read, byte by byte:
//     written          only the enabled bytes of the addressed register change
//   holds_what_was_    and so do the ports to the block
//     written
//   reads_unmapped     words that are not mapped read 0
//   read_has_no_effect data stay until the next read; a read has no other effect (no port depends on it)
//   period_guarded     the period changes in no clock in which the PWM runs
//   times_guarded      nor do dead time and minimum pulse; they never are below their floors
//   events             an event sets its interrupt state, also in the clock in which it is cleared
//   held, cleared      interrupt state stays until a one is written to it, and then goes
//   caused             nothing but an event or a test sets it
//   irq_level          irq is high exactly while an enabled state was, a clock before
//   command_*          a command is one clock, after a write of the whole word, and at no other time
//
// Proven for this bank; the banks of other blocks are written by the same emitter. It has no staged registers: what
// a commit does with these is in commit.sv.
module registers_properties (
    `PORTS,
    (* peek = "irq_state_tripped" *) input wire state_tripped,
    (* peek = "irq_state_saturated" *) input wire state_saturated,
    (* peek = "irq_state_unaligned" *) input wire state_unaligned,
    (* peek = "irq_state_valley" *) input wire state_valley,
    (* peek = "irq_state_trigger" *) input wire state_trigger,
    (* peek = "irq_enable_tripped" *) input wire enable_tripped,
    (* peek = "irq_enable_saturated" *) input wire enable_saturated,
    (* peek = "irq_enable_unaligned" *) input wire enable_unaligned,
    (* peek = "irq_enable_valley" *) input wire enable_valley,
    (* peek = "irq_enable_trigger" *) input wire enable_trigger
);
    localparam [7:0] CONTROL = 8'h10;
    localparam [7:0] INTERRUPT_STATE = 8'h14;
    localparam [7:0] INTERRUPT_ENABLE = 8'h15;
    localparam [7:0] INTERRUPT_TEST = 8'h16;
    localparam [7:0] LAST_WORD = 8'h20;

    // A copy of each configuration register, with its existing bits, written byte by byte.
    function [31:0] merged(input [31:0] old, input [31:0] bits);
        merged = {
            avs_byteenable[3] ? avs_writedata[31:24] : old[31:24],
            avs_byteenable[2] ? avs_writedata[23:16] : old[23:16],
            avs_byteenable[1] ? avs_writedata[15:8] : old[15:8],
            avs_byteenable[0] ? avs_writedata[7:0] : old[7:0]
        } & bits;
    endfunction

    wire [31:0] port [0:5];
    assign port[0] = {22'd0, mode, 5'd0, update_at_peak, from_pins, enable};
    assign port[1] = {27'd0, enable_trigger, enable_valley, enable_unaligned, enable_saturated, enable_tripped};
    assign port[2] = {15'd0, host_x_0};
    assign port[3] = {16'd0, max_duty};
    assign port[4] = {trigger_phase, phase};
    assign port[5] = {16'd0, filter_clocks, watchdog_periods};

    reg        past_read = 1'b0;
    reg        past_reset = 1'b1;
    reg [7:0]  past_address = 8'd0;
    reg [31:0] past_data = 32'd0;
    always @(posedge clk) begin
        past_read <= avs_read & !rst;
        past_reset <= rst;
        past_address <= avs_address;
        past_data <= avs_readdata;
    end

    wire [5:0] reads_well;
    wire [5:0] holds_well;
    genvar n;
    generate
        for (n = 0; n < 6; n = n + 1) begin : register
            localparam [7:0] WORD = n == 0 ? CONTROL : n == 1 ? INTERRUPT_ENABLE : n == 2 ? 8'h1a : n == 3 ? 8'h1b
                : n == 4 ? 8'h1c : 8'h1d;
            localparam [31:0] BITS = n == 0 ? 32'h307 : n == 1 ? 32'h1f : n == 2 ? 32'h1ffff : n == 4 ? 32'hffffffff
                : 32'hffff;
            localparam [31:0] RESET = n == 0 ? 32'h200 : n == 3 ? 32'd2500 : 32'd0;
            reg [31:0] copy = RESET;
            reg [31:0] past_copy = RESET;
            always @(posedge clk) begin
                past_copy <= copy;
                if (rst) copy <= RESET;
                else if (avs_write & avs_address == WORD) copy <= merged(copy, BITS);
            end
            assign reads_well[n] = !(past_read & past_address == WORD) | avs_readdata == past_copy;
            assign holds_well[n] = port[n] == copy;
        end
    endgenerate

    // Guarded registers.
    reg [15:0] past_period = 16'd0;
    reg [9:0]  past_dead_time = 10'd0;
    reg [9:0]  past_minimum_pulse = 10'd0;
    reg        past_running = 1'b0;
    always @(posedge clk) begin
        past_period <= period;
        past_dead_time <= dead_time;
        past_minimum_pulse <= minimum_pulse;
        past_running <= running;
    end

    // Interrupts.
    wire [4:0] state = {state_trigger, state_valley, state_unaligned, state_saturated, state_tripped};
    wire [4:0] enabled = {enable_trigger, enable_valley, enable_unaligned, enable_saturated, enable_tripped};
    wire [4:0] event_now = {trigger, valley, unaligned, saturated, tripped};
    reg  [4:0] past_state = 5'd0;
    reg  [4:0] past_event = 5'd0;
    reg  [4:0] past_clear = 5'd0;
    reg  [4:0] past_test = 5'd0;
    reg        past_raised = 1'b0;
    always @(posedge clk) begin
        past_state <= state;
        past_event <= event_now;
        past_clear <= avs_write & avs_address == INTERRUPT_STATE & avs_byteenable[0] ? avs_writedata[4:0] : 5'd0;
        past_test <= avs_write & avs_address == INTERRUPT_TEST & (&avs_byteenable) ? avs_writedata[4:0] : 5'd0;
        past_raised <= !rst & |(state & enabled);
    end

    // Commands.
    reg past_feed = 1'b0;
    reg past_clear_trip = 1'b0;
    always @(posedge clk) begin
        past_feed <= !rst & avs_write & avs_address == 8'h1e & (&avs_byteenable);
        past_clear_trip <= !rst & avs_write & avs_address == 8'h1f & (&avs_byteenable);
    end

    always @(*) begin
        reads_what_was_written: assert (&reads_well);
        holds_what_was_written: assert (&holds_well);
        reads_unmapped: assert (!(past_read & past_address > LAST_WORD) | avs_readdata == 32'd0);
        read_has_no_effect: assert (past_read | past_reset | avs_readdata == past_data);
        period_guarded: assert (past_reset | !past_running | period == past_period);
        times_guarded: assert (past_reset | !past_running | (dead_time == past_dead_time & minimum_pulse == past_minimum_pulse));
        floors: assert (dead_time >= 10'd25 & minimum_pulse >= 10'd50);
        events: assert (past_reset | (past_event & ~state) == 5'd0);
        held: assert (past_reset | (past_state & ~past_clear & ~state) == 5'd0);
        cleared: assert (past_reset | (past_clear & ~past_event & ~past_test & state) == 5'd0);
        caused: assert (past_reset | (state & ~past_state & ~past_event & ~past_test) == 5'd0);
        irq_level: assert (irq == past_raised);
        command_feed: assert (host_strobe == past_feed);
        command_clear_trip: assert (clear_trip == past_clear_trip);
    end

    always @(*) begin
        reach_irq: cover (irq);
        reach_partial: cover (past_read & past_address == 8'h1c & avs_readdata == 32'h00ff00ff);
        reach_period: cover (period == 16'd1234);
        reach_command: cover (host_strobe);
    end
endmodule
