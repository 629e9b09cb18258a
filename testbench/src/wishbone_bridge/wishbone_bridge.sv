// wishbone_bridge: each request is made once, as it was asked for, and answered once, in the third clock after it.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed, not even that `pipelined` is constant.
//
//   answers_in_time    ack or err is high exactly in the third clock after a request whose master has listened since
//   one_answer         ack and err are never high together; err exactly where there was no register
//   answer_is_asked    no answer without an open request: requests less answers are never below 0, nor more than three
//   read_word          a read's answer has the word that the registers gave for it
//   read_as_asked      the registers are read in the clock after a request to read, at its address
//   written_as_asked   and written after a request to write with a byte, with its word and its bytes
//   one_at_a_time      a classic bus has no request while one is open
//   stalls_at_reset    a pipelined bus waits in the clock after a reset only
module wishbone_bridge_properties (
    `PORTS,
    (* peek = "awake" *) input wire awake,
    (* peek = "asked" *) input wire asked,
    (* peek = "passed" *) input wire passed,
    (* peek = "failed" *) input wire failed
);
    // Requests one, two and three clocks ago whose master has listened since.
    reg        past_1 = 1'b0, past_2 = 1'b0, past_3 = 1'b0;
    reg        past_reset = 1'b1;
    reg        writes = 1'b0;
    reg [15:0] address = 16'd0;
    reg [3:0]  bytes = 4'd0;
    reg [31:0] word = 32'd0;
    reg        mapped_2 = 1'b0, mapped_3 = 1'b0;
    reg [31:0] given = 32'd0;
    reg [2:0]  open = 3'd0;
    wire       request = wb_cyc & wb_stb & !wb_stall & (pipelined | !(past_1 | past_2 | past_3));
    wire       listens = wb_cyc & (pipelined | wb_stb);
    wire       answer = wb_ack | wb_err;
    always @(posedge clk) begin
        past_reset <= rst;
        past_1 <= !rst & request;
        past_2 <= !rst & past_1 & listens;
        past_3 <= !rst & past_2 & listens;
        writes <= wb_we;
        address <= wb_adr;
        bytes <= wb_sel;
        word <= wb_dat_w;
        mapped_2 <= avm_mapped;
        mapped_3 <= mapped_2;
        given <= avm_readdata;
        open <= rst ? 3'd0 : (listens ? open - {2'd0, answer} : 3'd0) + {2'd0, request};
    end

    always @(*) begin
        answers_in_time: assert (answer == past_3);
        one_answer: assert (!(wb_ack & wb_err) & (!answer | wb_err == !mapped_3));
        answer_is_asked: assert ((!answer | open != 3'd0) & open <= 3'd3);
        read_word: assert (!wb_ack | wb_dat_r == given);
        read_as_asked: assert (avm_read == (past_1 & !writes) & (!avm_read | avm_address == address));
        written_as_asked: assert (avm_write == (past_1 & writes & bytes != 4'd0)
            & (!avm_write | (avm_address == address & avm_writedata == word & avm_byteenable == bytes)));
        one_at_a_time: assert (!(request & !pipelined) | !(past_1 | past_2 | past_3));
        stalls_at_reset: assert (wb_stall == past_reset);
    end

    // Invariants of the registers, for the induction.
    always @(*) begin
        wakes: assert (awake == !past_reset);
        same_asked: assert (asked == past_1 & passed == past_2);
        same_failed: assert (!passed | failed == !mapped_2);
        counted: assert (open == {2'd0, past_1} + {2'd0, past_2} + {2'd0, past_3});
    end

    always @(*) begin
        reach_stream: cover (past_1 & past_2 & past_3 & wb_ack);
        reach_error: cover (wb_err & !pipelined);
        reach_left: cover (past_1 & avm_write & !wb_cyc);
    end
endmodule
