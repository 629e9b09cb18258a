// segments: the command FIFO loses nothing, repeats nothing, and never holds more than 64 entries.
//
// The properties are proven for all inputs in every clock, including resets, with all 64 slots; nothing is assumed. Contents are
// left out: an entry is its slot. The entry that plays, or did so last, is in the slot at the head, those that wait in the slots
// after it, those of a batch that is being written in the slots after these. An entry's words lie in the first slot after all of
// them until it is committed.
//
//   level_bound       0 to 64 entries, with the one that plays
//   pointers          words go into the slot after the last that waits or is staged, modulo 64
//   in_one            an entry comes in there only; that slot moves by one, or back: over the staged ones where their batch is dropped,
//                     behind the head at a flush
//   batch_whole       staged entries become such that wait all at once, with the last of their batch, or none of them does
//   out_one           an entry begins to play in order: the head moves by one
//   no_overwrite      no word is written into a slot that holds an entry that waits or plays
//   never_from_empty  nothing is taken from an empty FIFO
//   refused_when_full a write to a full FIFO changes neither memory nor level
//   accounted         level = entries in - entries out since the last flush, those of a batch when it ends
//
// With pointers, in_one and out_one each slot is filled once and emptied once per turn: so nothing is lost or repeated.
// Not proven here: which words of the entry the integrator reads, and what it makes of them: lock step.
module segments_properties (
    `PORTS,
    (* peek = "u_fifo.head" *) input wire [5:0] head,
    (* peek = "u_fifo.slot" *) input wire [5:0] free,
    (* peek = "u_fifo.level_q" *) input wire [6:0] entries,
    (* peek = "u_fifo.staged" *) input wire [6:0] staged,
    (* peek = "u_fifo.spoilt" *) input wire spoilt,
    (* peek = "u_fifo.stages" *) input wire fifo_stages,
    (* peek = "u_fifo.ends" *) input wire fifo_ends,
    (* peek = "u_fifo.write" *) input wire fifo_write,
    (* peek = "u_fifo.refused" *) input wire fifo_refused,
    (* peek = "u_fifo.takes" *) input wire fifo_takes,
    (* peek = "u_fifo.entered" *) input wire fifo_entered,
    (* peek = "u_fifo.pop" *) input wire fifo_pop,
    (* peek = "u_fifo.plays" *) input wire fifo_plays,
    (* peek = "u_fifo.flush" *) input wire fifo_flush,
    (* peek = "u_fifo.u_memory.write_address" *) input wire [7:0] write_address
);
    reg       past_reset = 1'b1;
    reg       past_entered = 1'b0;
    reg       past_pop = 1'b0;
    reg       past_flush = 1'b0;
    reg [5:0] past_head = 6'd0;
    reg [5:0] past_free = 6'd0;
    reg [6:0] past_staged = 7'd0;
    reg [6:0] past_entries = 7'd0;
    reg       past_ends = 1'b0;
    reg       past_stages = 1'b0;
    reg       past_spoilt = 1'b0;
    reg [6:0] count = 7'd0;
    always @(posedge clk) begin
        past_reset <= rst;
        past_entered <= fifo_entered;
        past_pop <= fifo_pop;
        past_flush <= fifo_flush;
        past_head <= head;
        past_free <= free;
        past_staged <= staged;
        past_entries <= entries;
        past_ends <= fifo_ends;
        past_stages <= fifo_stages;
        past_spoilt <= spoilt;
        count <= rst | fifo_flush ? 7'd0
               : count + (fifo_entered & !fifo_stages ? staged + 7'd1 : 7'd0) - {6'd0, fifo_pop};
    end

    wire [5:0] oldest = head + 6'd1;
    wire [5:0] distance = free - oldest;
    wire [5:0] slot = write_address[7:2];
    wire [5:0] behind_oldest = slot - oldest;
    wire [7:0] kept = {1'b0, entries} + {1'b0, staged};
    wire [7:0] filled = kept + {7'd0, fifo_plays};
    wire       dropped = past_ends & !past_entered;
    wire [6:0] came = entries + {6'd0, past_pop} - past_entries;
    wire [5:0] free_moved = free - past_free;
    wire [5:0] head_moved = head - past_head;
    always @(*) begin
        level_bound: assert (filled <= 8'd64);
        pointers: assert (kept[5:0] == distance);
        in_one: assert (past_reset | past_flush | free_moved == (dropped ? 6'd0 - past_staged[5:0] : {5'd0, past_entered}));
        batch_whole: assert (past_reset | past_flush
            | came == (past_entered & !past_stages ? past_staged + 7'd1 : 7'd0));
        batch_ends: assert (past_reset | past_flush | !past_ends | past_stages | staged == 7'd0);
        batch_spoilt: assert (past_reset | !past_spoilt | !past_entered);
        spoilt_is_empty: assert (!spoilt | staged == 7'd0);
        flush_empties: assert (!past_flush | past_reset | (kept == 8'd0 & free == oldest));
        out_one: assert (past_reset | past_flush | head_moved == {5'd0, past_pop});
        no_overwrite: assert (!fifo_takes | ({2'd0, behind_oldest} >= kept & kept != 8'd64 & !(fifo_plays & slot == head)));
        never_from_empty: assert (!fifo_pop | entries != 7'd0);
        refused_when_full: assert (!(fifo_write & filled == 8'd64) | (fifo_refused & !fifo_takes & !fifo_entered));
        accounted: assert (entries == count);
    end

    always @(*) begin
        reach_in: cover (fifo_entered);
        reach_out: cover (fifo_pop);
        reach_in_and_out: cover (fifo_entered & fifo_pop);
        reach_two: cover (entries == 7'd2);
        reach_batch: cover (past_entered & !past_stages & past_staged == 7'd1);
        reach_spoilt: cover (past_spoilt & past_ends & !past_entered);
        reach_play: cover (fifo_plays & entries == 7'd1);
    end
endmodule
