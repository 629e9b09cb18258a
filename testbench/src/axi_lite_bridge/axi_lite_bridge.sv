// axi_lite_bridge: each write and each read is made once, as it was asked for, and answered once, in order.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed, not even that the manager keeps what
// it offers. What was taken and not yet answered is kept beside the bridge, in queues of another kind.
//
//   write_is_asked     a write begins where an address and a word were taken for it, and no other write has them
//   read_is_asked      likewise a read; both never begin in the same clock
//   written_as_asked   the registers get the oldest address with the oldest word and its bytes, and no write without bytes
//   read_as_asked      the registers get the oldest address of a read
//   answers_writes     an answer to a write is there exactly where a write has begun and was not answered, and says whether it was mapped
//   answers_reads      an answer to a read is that to the oldest read without one: what the registers gave, and whether it was mapped
//   answers_soon       an answer to a read is there a clock after the one before it was taken
//   b_stays, r_stays   an answer stays as it is until it is taken
//   takes_what_fits    two addresses or words wait at most, and up to two are always taken
//   takes_turns        a read that can begin waits for one write at most, and the other way round
//   goes_on            what can begin begins, or the other kind does
//   idle_after_reset   after a reset nothing is there
module axi_lite_bridge_properties (
    `PORTS,
    (* peek = "awake" *) input wire awake,
    (* peek = "writes" *) input wire writes,
    (* peek = "reading" *) input wire reading,
    (* peek = "failed" *) input wire failed,
    (* peek = "read_first" *) input wire read_first,
    (* peek = "open_reads" *) input wire [2:0] open_reads,
    (* peek = "u_write_addresses.holds_q" *) input wire aw_holds,
    (* peek = "u_write_addresses.full_q" *) input wire aw_full,
    (* peek = "u_write_addresses.first_q" *) input wire [15:0] aw_first,
    (* peek = "u_write_addresses.second" *) input wire [15:0] aw_second,
    (* peek = "u_write_words.holds_q" *) input wire w_holds,
    (* peek = "u_write_words.full_q" *) input wire w_full,
    (* peek = "u_write_words.first_q" *) input wire [35:0] w_first,
    (* peek = "u_write_words.second" *) input wire [35:0] w_second,
    (* peek = "u_read_addresses.holds_q" *) input wire ar_holds,
    (* peek = "u_read_addresses.full_q" *) input wire ar_full,
    (* peek = "u_read_addresses.first_q" *) input wire [15:0] ar_first,
    (* peek = "u_read_addresses.second" *) input wire [15:0] ar_second,
    (* peek = "u_write_answers.holds_q" *) input wire b_holds,
    (* peek = "u_write_answers.full_q" *) input wire b_full,
    (* peek = "u_write_answers.first_q" *) input wire [1:0] b_first,
    (* peek = "u_write_answers.second" *) input wire [1:0] b_second,
    (* peek = "u_read_words.holds_q" *) input wire inner_holds,
    (* peek = "u_read_words.full_q" *) input wire inner_full,
    (* peek = "u_read_words.first_q" *) input wire [33:0] inner_first,
    (* peek = "u_read_words.second" *) input wire [33:0] inner_second,
    (* peek = "u_read_answers.holds_q" *) input wire r_holds,
    (* peek = "u_read_answers.full_q" *) input wire r_full,
    (* peek = "u_read_answers.first_q" *) input wire [33:0] r_first,
    (* peek = "u_read_answers.second" *) input wire [33:0] r_second
);
    // What waits, the oldest in place 0, and how many.
    reg [15:0] aw_0, aw_1, ar_0, ar_1;
    reg [35:0] w_0, w_1;
    reg [1:0]  b_0, b_1;
    reg [33:0] r_0, r_1, r_2, r_3;
    reg [1:0]  aw_count = 2'd0, w_count = 2'd0, ar_count = 2'd0, b_count = 2'd0;
    reg [2:0]  r_count = 3'd0;
    reg        was_read = 1'b0, was_mapped = 1'b0;
    reg        past_reset = 1'b1, past_b = 1'b0, past_r = 1'b0, past_waits = 1'b0;
    reg [1:0]  past_bresp = 2'd0;
    reg [33:0] past_rword = 34'd0;
    reg        write_passed = 1'b0, read_passed = 1'b0;

    wire takes_aw = s_axi_awvalid & s_axi_awready;
    wire takes_w  = s_axi_wvalid & s_axi_wready;
    wire takes_ar = s_axi_arvalid & s_axi_arready;
    wire takes_b  = s_axi_bvalid & s_axi_bready;
    wire takes_r  = s_axi_rvalid & s_axi_rready;
    wire [1:0]  resp = avm_mapped ? 2'd0 : 2'd2;
    wire [33:0] r_new = {avm_readdata, was_mapped ? 2'd0 : 2'd2};
    wire [35:0] w_new = {s_axi_wdata, s_axi_wstrb};
    // Places after the oldest was taken.
    wire [1:0] aw_left = aw_count - {1'b0, writes};
    wire [1:0] w_left  = w_count - {1'b0, writes};
    wire [1:0] ar_left = ar_count - {1'b0, avm_read};
    wire [1:0] b_left  = b_count - {1'b0, takes_b};
    wire [2:0] r_left  = r_count - {2'b0, takes_r};
    always @(posedge clk) begin
        if (writes) begin
            aw_0 <= aw_1;
            w_0 <= w_1;
        end
        if (avm_read) ar_0 <= ar_1;
        if (takes_b) b_0 <= b_1;
        if (takes_r) begin
            r_0 <= r_1;
            r_1 <= r_2;
            r_2 <= r_3;
        end
        if (takes_aw) begin
            if (aw_left == 2'd0) aw_0 <= s_axi_awaddr[17:2]; else aw_1 <= s_axi_awaddr[17:2];
        end
        if (takes_w) begin
            if (w_left == 2'd0) w_0 <= w_new; else w_1 <= w_new;
        end
        if (takes_ar) begin
            if (ar_left == 2'd0) ar_0 <= s_axi_araddr[17:2]; else ar_1 <= s_axi_araddr[17:2];
        end
        if (writes) begin
            if (b_left == 2'd0) b_0 <= resp; else b_1 <= resp;
        end
        if (was_read) begin
            case (r_left)
                3'd0: r_0 <= r_new;
                3'd1: r_1 <= r_new;
                3'd2: r_2 <= r_new;
                default: r_3 <= r_new;
            endcase
        end
        aw_count <= rst ? 2'd0 : aw_left + {1'b0, takes_aw};
        w_count <= rst ? 2'd0 : w_left + {1'b0, takes_w};
        ar_count <= rst ? 2'd0 : ar_left + {1'b0, takes_ar};
        b_count <= rst ? 2'd0 : b_left + {1'b0, writes};
        r_count <= rst ? 3'd0 : r_left + {2'b0, was_read};
        was_read <= !rst & avm_read;
        was_mapped <= avm_mapped;
        past_reset <= rst;
        past_b <= !rst & s_axi_bvalid & !s_axi_bready;
        past_bresp <= s_axi_bresp;
        past_r <= !rst & s_axi_rvalid & !s_axi_rready;
        past_rword <= {s_axi_rdata, s_axi_rresp};
        past_waits <= !rst & r_count != 3'd0;
        write_passed <= !rst & writes & can_read;
        read_passed <= !rst & avm_read & can_write;
    end
    wire can_write = aw_count != 2'd0 & w_count != 2'd0 & b_count != 2'd2;
    wire can_read  = ar_count != 2'd0 & r_count + {2'b0, was_read} != 3'd4;

    always @(*) begin
        write_is_asked: assert (!writes | (aw_count != 2'd0 & w_count != 2'd0));
        read_is_asked: assert (!avm_read | (ar_count != 2'd0 & !writes));
        written_as_asked: assert (avm_write == (writes & w_0[3:0] != 4'd0)
            & (!writes | (avm_address == aw_0 & {avm_writedata, avm_byteenable} == w_0)));
        read_as_asked: assert (!avm_read | avm_address == ar_0);
        answers_writes: assert (s_axi_bvalid == (b_count != 2'd0) & (!s_axi_bvalid | s_axi_bresp == b_0));
        answers_reads: assert (!s_axi_rvalid | (r_count != 3'd0 & {s_axi_rdata, s_axi_rresp} == r_0));
        answers_soon: assert (!past_waits | s_axi_rvalid | r_count == 3'd0 | past_reset | !waited);
        b_stays: assert (!past_b | (s_axi_bvalid & s_axi_bresp == past_bresp));
        r_stays: assert (!past_r | (s_axi_rvalid & {s_axi_rdata, s_axi_rresp} == past_rword));
        takes_what_fits: assert (s_axi_awready == (awake & aw_count != 2'd2) & s_axi_wready == (awake & w_count != 2'd2)
            & s_axi_arready == (awake & ar_count != 2'd2) & (awake | past_reset));
        takes_turns: assert (!(write_passed & can_read & writes) & !(read_passed & can_write & avm_read));
        goes_on: assert ((!can_write | writes | avm_read) & (!can_read | avm_read | writes));
        idle_after_reset: assert (!past_reset | !(s_axi_bvalid | s_axi_rvalid | avm_read | avm_write | s_axi_awready
            | s_axi_wready | s_axi_arready));
    end
    // An answer that waits behind the first queue comes a clock later.
    reg waited = 1'b0;
    always @(posedge clk) waited <= !rst & r_count != 3'd0 & !s_axi_rvalid;

    // Invariants of the registers, for the induction.
    wire [2:0] inner_count = {2'b0, inner_holds} + {2'b0, inner_full};
    wire [2:0] outer_count = {2'b0, r_holds} + {2'b0, r_full};
    wire [33:0] next_r = outer_count == 3'd0 ? r_0 : outer_count == 3'd1 ? r_1 : r_2;
    wire [33:0] last_r = outer_count == 3'd0 ? r_1 : outer_count == 3'd1 ? r_2 : r_3;
    always @(*) begin
        same_writes: assert (aw_count == {1'b0, aw_holds} + {1'b0, aw_full} & (!aw_full | aw_holds)
            & (!aw_holds | aw_first == aw_0) & (!aw_full | aw_second == aw_1));
        same_words: assert (w_count == {1'b0, w_holds} + {1'b0, w_full} & (!w_full | w_holds)
            & (!w_holds | w_first == w_0) & (!w_full | w_second == w_1));
        same_reads: assert (ar_count == {1'b0, ar_holds} + {1'b0, ar_full} & (!ar_full | ar_holds)
            & (!ar_holds | ar_first == ar_0) & (!ar_full | ar_second == ar_1));
        same_write_answers: assert (b_count == {1'b0, b_holds} + {1'b0, b_full} & (!b_full | b_holds)
            & (!b_holds | b_first == b_0) & (!b_full | b_second == b_1));
        same_answers: assert (r_count == inner_count + outer_count & (!r_full | r_holds) & (!inner_full | inner_holds)
            & (!r_holds | r_first == r_0) & (!r_full | r_second == r_1)
            & (!inner_holds | inner_first == next_r) & (!inner_full | inner_second == last_r));
        counted: assert (open_reads == r_count + {2'b0, was_read} & open_reads <= 3'd4);
        same_reading: assert (reading == was_read & (!reading | failed == !was_mapped));
        turns_known: assert ((!write_passed | read_first) & (!read_passed | !read_first));
        wakes: assert (awake | (!aw_holds & !w_holds & !ar_holds & !b_holds & !was_read & r_count == 3'd0));
        resets: assert (awake == !past_reset);
        // While two words wait inside, none is on its way: it would find no place.
        full_inside: assert (!inner_full | !was_read);
        waits_inside: assert (!waited | r_count == 3'd0 | r_holds);
    end

    always @(*) begin
        reach_full: cover (r_count == 3'd4 & aw_count == 2'd2 & w_count == 2'd2 & b_count == 2'd2 & ar_count == 2'd2);
        reach_error: cover (s_axi_rvalid & s_axi_rresp == 2'd2 & s_axi_bvalid & s_axi_bresp == 2'd2);
        reach_stream: cover (past_waits & takes_r & was_read & avm_read & takes_ar);
    end
endmodule
