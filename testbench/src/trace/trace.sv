// trace: which rows are taken, where their words are stored, which is the trigger's row, and which words can be read.
//
// Proven for all inputs in every clock, resets and arm at any time included; nothing is assumed. The memory is left out: any
// value can be read from it. `row` is the clock of the row that is being taken, 0 where none is, as in the datasheet;
// n the signals of a row.
//
//   exact_state        the states of the datasheet: filling until the rows before the trigger are there, waiting until it comes
//                      with a row, taking until the memory is full; idle then, or after a halt and the row of it
//   row_*              a row takes 3 + n clocks: from a strobe that is due; the first one, then every (decimation + 1)th
//   exact_missed       missed: a strobe came while a row was being taken; until the next arm
//   exact_done         done: one clock, where the memory was full
//   exact_trigger      the trigger comes while waiting alone, with the row whose signal crossed the level, or with an event
//                      since the row before
//   trigger_position   then as many rows are there as the settings of arm asked for, at most all but one; that row is the next,
//                      and later rows never move it
//   exact_rows         rows: one more at the end of each row, but while waiting; never more than the memory has
//   written_*          words are written in clocks 3 to 2 + n of a row alone, one after the other round the ring; each is the
//                      selected signal of the clock before
//   nothing_after_end  idle, and before an arm, nothing is written; rows, trigger row, missed and the ring stay as they are
//   ring_*             the ring holds rows and the words of this one from `oldest` on; none of them is written over, but the
//                      oldest row's while waiting
//   shown_*            data is word read_address from the oldest on, of the clock before; 0 beyond the last, or if not idle then
module trace_properties (
    `PORTS,
    (* peek = "active" *) input wire active,
    (* peek = "triggered" *) input wire triggered,
    (* peek = "halting" *) input wire halting,
    (* peek = "phase" *) input wire [2:0] phase,
    (* peek = "signals_q" *) input wire [1:0] signals_q,
    (* peek = "skip" *) input wire [15:0] skip,
    (* peek = "select" *) input wire [3:0] select,
    (* peek = "u_selector.chosen" *) input wire [31:0] chosen,
    (* peek = "u_watch.has_row" *) input wire has_row,
    (* peek = "u_watch.was_above" *) input wire was_above,
    (* peek = "u_watch.kept_event" *) input wire kept_event,
    (* peek = "u_memory.u_ram.write_enable" *) input wire write,
    (* peek = "u_memory.u_ram.write_address" *) input wire [`ADDRESS_BITS-1:0] write_address,
    (* peek = "u_memory.u_ram.write_data" *) input wire [31:0] write_data,
    (* peek = "u_memory.u_ram.read_address" *) input wire [`ADDRESS_BITS-1:0] ram_read_address,
    (* peek = "u_memory.ram_read_data" *) input wire [31:0] ram_data,
    (* peek = "u_memory.pointer" *) input wire [`ADDRESS_BITS-1:0] pointer,
    (* peek = "u_memory.oldest" *) input wire [`ADDRESS_BITS-1:0] oldest,
    (* peek = "u_memory.valid" *) input wire valid
);
    localparam [1:0] IDLE = 2'd0, FILLING = 2'd1, WAITING = 2'd2, TAKING = 2'd3;

    // Values at arm: signals in a row, and rows before the trigger.
    reg  [1:0]  code = 2'd0;
    reg  [11:0] before = 12'd0;
    function [1:0] shift(input [1:0] of);
        shift = of == 2'd0 ? 2'd0 : of == 2'd1 ? 2'd1 : 2'd2;
    endfunction
    wire [2:0]  n = 3'd1 << shift(code);
    wire [11:0] total = `SAMPLES >> shift(code);
    wire [11:0] last_at_arm = (`SAMPLES >> shift(signals)) - 12'd1;
    wire        full = rows == total;

    reg         armed = 1'b0, halts = 1'b0, come = 1'b0, fresh = 1'b1, is_missed = 1'b0;
    reg  [2:0]  row = 3'd0;
    reg  [15:0] left_out = 16'd0, leaves_out = 16'd0;
    wire        between = row == 3'd0;
    wire        ends = armed & between & (full | halts);
    wire        begins = armed & between & !ends & strobe & (fresh | left_out == leaves_out);
    wire        last_clock = row == 3'd2 + n;
    wire        waits = armed & !come & rows == before;

    // Signal that each clock samples, and the comparison.
    wire [511:0] all = `ALL_SIGNALS;
    reg  [3:0]  selected = 4'd0;
    reg  signed [31:0] taken = 32'sd0;
    reg         has_before = 1'b0, above_before = 1'b0, event_since = 1'b0;
    wire        compares = row == 3'd2;
    wire        above = taken >= trigger_level;
    wire        crosses = trigger_mode == 2'd0 | (trigger_mode == 2'd1 & has_before & !above_before & above)
        | (trigger_mode == 2'd2 & has_before & above_before & !above) | (trigger_mode == 2'd3 & event_since);
    wire        comes = compares & waits & crosses & !arm & !rst;
    always @(posedge clk) begin
        selected <= row == 3'd0 ? trigger_select : row == 3'd1 ? select_0 : row == 3'd2 ? select_1 :
            row == 3'd3 ? select_2 : select_3;
        taken <= all[{selected, 5'd0} +: 32];
        if (rst | arm) begin
            armed <= !rst;
            {halts, come, is_missed, has_before, event_since} <= 5'd0;
            fresh <= 1'b1;
            row <= 3'd0;
            code <= rst ? 2'd0 : signals;
            before <= rst ? 12'd0 : {1'b0, pre_trigger} > last_at_arm ? last_at_arm : {1'b0, pre_trigger};
        end else begin
            armed <= armed & !ends;
            halts <= halts | halt;
            come <= come | comes;
            is_missed <= is_missed | (strobe & armed & !between);
            row <= begins ? 3'd1 : between | last_clock ? 3'd0 : row + 3'd1;
            if (begins) {fresh, left_out, leaves_out} <= {1'b0, 16'd0, decimation};
            else if (armed & between & !ends & strobe) left_out <= left_out + 16'd1;
            has_before <= has_before | compares;
            event_since <= trigger_event | (event_since & !compares);
        end
        if (compares & !rst) above_before <= above;
        if (rst) {selected, taken, above_before} <= 37'd0;
    end

    // Values of the previous clock.
    reg         past_reset = 1'b1, past_arm = 1'b0, past_done = 1'b0, past_idle = 1'b0, past_more = 1'b0, past_come = 1'b0;
    reg         past_write = 1'b0, past_missed = 1'b0, past_drops = 1'b0;
    reg  [11:0] past_rows = 12'd0;
    reg  [10:0] past_trigger = 11'd0, past_read = 11'd0;
    reg  [`ADDRESS_BITS-1:0] past_pointer = 0, past_oldest = 0, past_ram_address = 0;
    reg  [13:0] past_words = 14'd0;
    wire [13:0] words = {2'd0, rows} << shift(code);
    wire [13:0] stored = row > 3'd3 ? {11'd0, row} - 14'd3 : 14'd0;
    always @(posedge clk) begin
        past_reset <= rst;
        past_arm <= arm;
        past_done <= ends & full & !arm & !rst;
        past_idle <= !armed & !rst;
        past_more <= last_clock & !waits & !arm & !rst;
        past_come <= comes;
        {past_write, past_missed, past_drops} <= {write, missed, waits};
        {past_rows, past_trigger, past_read, past_words} <= {rows, trigger_row, read_address, words};
        {past_pointer, past_oldest} <= {pointer, oldest};
    end
    wire stays = past_idle & !past_arm & !past_reset;
    wire moves = !past_arm & !past_reset;

    wire [`ADDRESS_BITS-1:0] in_ring = pointer - oldest;
    wire [`ADDRESS_BITS-1:0] expected_address = oldest + read_address[`ADDRESS_BITS-1:0];
    wire [13:0] held = words + (waits ? 14'd0 : stored);
    always @(*) begin
        exact_state: assert (state == (!armed ? IDLE : come ? TAKING : rows == before ? WAITING : FILLING));
        row_length: assert (row <= 3'd2 + n);
        row_only_armed: assert (armed | between);
        row_has_room: assert (between | rows < total);
        exact_missed: assert (missed == is_missed);
        exact_done: assert (done == past_done);
        exact_trigger: assert (triggered == come);
        trigger_row_of_arm: assert (trigger_row == before[10:0] & before < total);
        trigger_position: assert (!past_come | (past_rows == {1'b0, trigger_row} & rows == past_rows));
        trigger_is_there: assert (come ? rows >= before & (row >= 3'd3 | rows > before) : rows <= before);
        exact_rows: assert (rows == (past_reset | past_arm ? 12'd0 : past_rows + {11'd0, past_more}));
        rows_bound: assert (rows <= total);
        written_in_rows: assert (write == (row >= 3'd3));
        written_word: assert (!write | write_data == taken);
        written_in_order: assert (!write | write_address == pointer);
        nothing_after_end: assert (armed | !write);
        all_stays_after_end: assert (!stays | (rows == past_rows & trigger_row == past_trigger & missed == past_missed
            & pointer == past_pointer & oldest == past_oldest));
        ring_moves: assert (!moves | (pointer == past_pointer + past_write & oldest == past_oldest + (past_write & past_drops)));
        ring_holds: assert (in_ring == held[`ADDRESS_BITS-1:0] & held <= {2'd0, `SAMPLES});
        ring_not_overwritten: assert (!write | held < {2'd0, `SAMPLES});
        shown_address: assert (ram_read_address == expected_address);
        shown_word: assert (data == (past_idle & !past_reset & {3'd0, past_read} < past_words ? ram_data : 32'd0));
    end

    // Invariants of the registers, for the induction.
    always @(*) begin
        known_row: assert (phase == row & active == armed & halting == halts & signals_q == code);
        strobes_left: assert (skip == (fresh ? 16'd0 : leaves_out - left_out) & (fresh | left_out <= leaves_out));
        signals_taken: assert (select == selected & chosen == taken);
        trigger_watches: assert (has_row == has_before & kept_event == event_since & was_above == above_before);
        shown_when_valid: assert (valid == (past_idle & !past_reset & {3'd0, past_read} < past_words));
    end

    always @(*) begin
        reach_trigger: cover (past_come & trigger_row == 11'd2 & trigger_mode == 2'd1);
        reach_dropped: cover (waits & oldest == 8'd2 & rows == 12'd2);
        reach_halted: cover (state == IDLE & rows == 12'd3 & !past_done);
        reach_shown: cover (state == IDLE & valid & past_read == 11'd2);
        reach_missed: cover (missed);
        reach_four: cover (row == 3'd6);
    end
endmodule
