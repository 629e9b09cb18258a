// bridge_sequencer: a request is executed completely or not at all, and once.
//
// Proven for all inputs in every clock, resets included; nothing is assumed. The header is that of the clock after the request; it
// is kept while that of the inputs does not change until the end of the reply (which uart_bridge.sv proves of the bridge).
// What the memories hold is anything, in every clock.
//
//   only_judged        read and write are high only for a header that is kept: known command, 1 to 40 words, the length that
//                      these need, and a sequence number other than 0 for a write; read for a command that reads, write for one that writes
//   looked_first       and only after as many addresses as the request has words were found below address_limit
//   once               and not if the sequence number, other than 0, is that of the request before
//   never_more         not for more words than the request has; when its tail is put, for all of them, if the status is 0
//   in_order           the address of each word but the first is one above that before it, unless each has its own
//   waits              while the registers wait, the strobe, its address and its word stay (with an address_limit that is kept)
//   known_...          invariants
module uart_sequencer_properties (
    `PORTS,
    (* peek = "phase" *) input wire [3:0] phase,
    (* peek = "part" *) input wire [1:0] part,
    (* peek = "looks" *) input wire looks,
    (* peek = "status" *) input wire [7:0] status,
    (* peek = "last_sequence" *) input wire [7:0] last_sequence,
    (* peek = "words_left" *) input wire [7:0] words_left,
    (* peek = "index" *) input wire [1:0] index
);
    localparam [3:0] REST = 4'd0, JUDGE = 4'd1, ADDRESS_LOW = 4'd2, ADDRESS_HIGH = 4'd3, WORD = 4'd4, ACCESS = 4'd5, NEXT = 4'd6,
        HEAD = 4'd7, PUT = 4'd8, TAIL = 4'd9, CLOSE = 4'd10, SEND = 4'd11;

    // The header, judged again.
    wire [31:0] header = {length, sequence_number, command, count};
    wire [8:0]  needed = 9'd7 + (command[1] ? {count, 1'b0} : 9'd2) + (command[0] ? {count[6:0], 2'd0} : 9'd0);
    wire        good = command[7:2] == 6'b000100 & count >= 8'd1 & count <= 8'd40 & {1'b0, length} == needed
        & !(command[0] & sequence_number == 8'd0);
    wire        again = sequence_number != 8'd0 & sequence_number == previous;
    reg  [31:0] judged = 32'd0;
    reg         is_kept = 1'b0;
    reg         is_good = 1'b0;
    reg         is_again = 1'b0;
    reg  [7:0]  previous = 8'd0;
    reg         limit_kept = 1'b0;
    reg  [15:0] limit = 16'd0;
    wire        kept = is_kept & header == judged;
    wire        same_limit = limit_kept & address_limit == limit;

    // Addresses looked at, words accessed.
    reg  [7:0]  seen = 8'd0;
    reg  [7:0]  done = 8'd0;
    reg  [15:0] past_address = 16'd0;
    reg  [31:0] past_word = 32'd0;
    reg         past_waits = 1'b0;
    reg         past_read = 1'b0;
    reg         past_write = 1'b0;
    wire        strobe = read | write;
    always @(posedge clk) begin
        if (rst) begin
            is_kept <= 1'b0;
            previous <= 8'd0;
        end else if (phase == JUDGE) begin
            judged <= header;
            is_kept <= 1'b1;
            is_good <= good;
            is_again <= again;
            previous <= sequence_number;
            seen <= 8'd0;
            done <= 8'd0;
            limit <= address_limit;
            limit_kept <= 1'b1;
        end else begin
            is_kept <= kept;
            limit_kept <= same_limit;
            if (phase == ACCESS & looks & address < address_limit) seen <= seen + 8'd1;
            if (strobe & !waitrequest) done <= done + 8'd1;
        end
        past_waits <= !rst & strobe & waitrequest;
        past_read <= read;
        past_write <= write;
        past_address <= address;
        past_word <= writedata;
    end

    wire walks = phase >= ADDRESS_LOW & phase <= NEXT;
    wire puts_word = phase == PUT & part == 2'd1;
    wire puts_head = phase == PUT & part == 2'd0;
    wire puts_tail = phase == PUT & part == 2'd2;
    wire walked = phase == NEXT | puts_word;
    wire of_words = walks | puts_word;
    always @(*) begin
        only_judged: assert (!strobe | !kept | (is_good & write == command[0] & read == !command[0]));
        never_both: assert (!(read & write));
        looked_first: assert (!strobe | !kept | seen == count);
        once: assert (!strobe | !is_again);
        never_more: assert (!(strobe & kept) | done < count);
        all_done: assert (!(kept & (phase == TAIL | puts_tail | phase == CLOSE) & status == 8'd0) | done == count);
        within: assert (!strobe | address < address_limit);
        in_order: assert (!(strobe & kept & !command[1] & done != 8'd0) | address == last_address + 16'd1);
        waits: assert (!(past_waits & kept & same_limit) | (read == past_read & write == past_write & address == past_address
            & writedata == past_word));
    end

    reg [15:0] last_address = 16'd0;
    always @(posedge clk) if (strobe & !waitrequest) last_address <= address;

    always @(*) begin
        known_phase: assert (phase <= SEND & part <= 2'd2);
        known_last: assert (last_sequence == previous);
        known_again: assert (phase == REST | phase == JUDGE | phase == SEND | !is_again);
        known_good: assert (!kept | !(of_words | (status == 8'd0 & (phase == HEAD | puts_head))) | is_good);
        known_status: assert (!of_words | status == 8'd0);
        known_looks: assert (!(phase == HEAD | puts_head) | status != 8'd0 | looks);
        known_judged: assert (!kept | is_good == good);
        known_word_part: assert (!puts_word | !looks);
        known_reads: assert (!(kept & puts_word) | !command[0]);
        known_left: assert (!(kept & of_words) | (words_left != 8'd0 & words_left <= count));
        known_seen: assert (!kept | !(walks & looks) | seen == count - words_left + {7'd0, phase == NEXT});
        known_all_seen: assert (!kept | !((of_words & !looks) | (status == 8'd0 & (phase == HEAD | puts_head))) | seen == count);
        known_none_done: assert (!(looks & (walks | phase == HEAD | puts_head)) | done == 8'd0);
        known_done: assert (!(kept & of_words & !looks) | done == count - words_left + {7'd0, walked});
        known_address: assert (!(kept & of_words & !looks & !command[1] & done != 8'd0)
            | (phase != ADDRESS_LOW & phase != ADDRESS_HIGH & address == last_address + {15'd0, !walked}));
        known_index: assert (phase == PUT | phase == WORD | index == 2'd0);
    end

    always @(*) begin
        reach_write: cover (write & done == 8'd1);
        reach_read: cover (read & done == 8'd1 & command[1]);
        reach_refused: cover (phase == CLOSE & status == 8'd3);
        reach_repeated: cover (phase == SEND & is_again);
        reach_wait: cover (past_waits & write);
    end
endmodule
