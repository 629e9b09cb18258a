// spi_bridge: nothing is read or written but for a whole frame whose CRC holds, whatever is on the lines.
//
// Proven for all inputs in every clock, resets included; nothing is assumed. The lines are those behind the synchronisers. Bytes,
// COBS, length and CRC are computed again here, the CRC a byte at once.
//
//   bytes              a byte comes in the clock after the eighth rising edge of spi_sck in a selection, is the eight levels of
//                      spi_mosi at these edges, the first one highest, and comes at no other time: a bit that is lost or
//                      invented shifts no byte of the next selection
//   cut                bad is high after each clock without selection in which a byte was begun, and at no other time
//   whole_frames       a request begins in the clock after a delimiter that ends a frame: not damaged, no distance left over,
//                      the CRC of all decoded bytes correct; and after no other
//   strobe_needs_frame avm_read and avm_write are high only from such a clock to the end of the reply; never both
//   within             and only with an address below address_limit
//   kept               sequence number, command, number of words and length do not change from a request to the end of its
//                      reply: what is on the lines meanwhile is ignored
//   fresh              after each delimiter a frame begins anew: what was lost or added before it does not shift it
//   dropped            frame_dropped is one clock after a delimiter that ends a damaged frame, and at no other time
//   low_line           spi_miso is low in the clock after each clock without selection
//   taken_once         a byte for the host stays until the first rising edge after it was put on the line, and is what is put on
//                      the line; then it is gone
//   known_...          invariants
//
// Not proven here: what the memories hold (left open), and the sequencer: uart_sequencer.sv, which is the same module.
module spi_bridge_properties (
    `PORTS,
    (* peek = "u_line.u_sck.synchroniser_second" *) input wire sck,
    (* peek = "u_line.u_selected.synchroniser_second" *) input wire selected,
    (* peek = "u_line.u_mosi.synchroniser_second" *) input wire mosi,
    (* peek = "u_line.sck_before" *) input wire sck_before,
    (* peek = "u_line.selected_before" *) input wire selected_before,
    (* peek = "u_line.place" *) input wire [2:0] place,
    (* peek = "u_line.taken" *) input wire [7:0] data,
    (* peek = "u_line.received_q" *) input wire received,
    (* peek = "u_line.bad_q" *) input wire bad,
    (* peek = "u_line.given" *) input wire [7:0] given,
    (* peek = "u_line.gives" *) input wire gives,
    (* peek = "u_line.waiting" *) input wire [7:0] waiting,
    (* peek = "u_line.full" *) input wire full,
    (* peek = "u_decoder.left" *) input wire [7:0] decoder_left,
    (* peek = "u_decoder.begun" *) input wire decoder_begun,
    (* peek = "u_decoder.skips" *) input wire decoder_skips,
    (* peek = "u_decoder.length_q" *) input wire [7:0] decoder_length,
    (* peek = "u_decoder.silence" *) input wire [19:0] silence,
    (* peek = "u_decoder.request_q" *) input wire request,
    (* peek = "u_decoder.sequence_q" *) input wire [7:0] sequence_number,
    (* peek = "u_decoder.command_q" *) input wire [7:0] command,
    (* peek = "u_decoder.count_q" *) input wire [7:0] count,
    (* peek = "u_crc.sum" *) input wire [31:0] sum,
    (* peek = "u_crc.bits" *) input wire [7:0] bits,
    (* peek = "u_crc.left" *) input wire [3:0] crc_left,
    (* peek = "u_sequencer.phase" *) input wire [3:0] phase,
    (* peek = "u_sequencer.ready" *) input wire ready
);
    // The bytes, taken again: edges while selected in two clocks running.
    reg        was_high = 1'b0;
    reg        was_selected = 1'b0;
    reg  [2:0] edges = 3'd0;
    reg  [7:0] levels = 8'd0;
    reg        eighth = 1'b0;
    reg        ends_within = 1'b0;
    reg        past_selected = 1'b1;
    wire       rises = selected & was_selected & sck & !was_high;
    always @(posedge clk) begin
        was_high <= !rst & sck;
        was_selected <= !rst & selected;
        past_selected <= rst | selected;
        eighth <= !rst & rises & edges == 3'd7;
        ends_within <= !rst & !selected & edges != 3'd0;
        if (rst) begin
            edges <= 3'd0;
            levels <= 8'd0;
        end else begin
            if (!selected) edges <= 3'd0;
            else if (rises) edges <= edges + 3'd1;
            if (rises) levels <= {levels[6:0], mosi};
        end
    end

    // The byte that waits for the host.
    reg        past_full = 1'b0;
    reg        past_takes = 1'b0;
    reg  [7:0] past_waiting = 8'd0;
    always @(posedge clk) begin
        past_full <= !rst & full;
        past_takes <= !rst & rises & edges == 3'd0 & gives;
        past_waiting <= waiting;
    end

    always @(*) begin
        bytes: assert (received == eighth & (!received | data == levels));
        cut: assert (bad == ends_within);
        low_line: assert (past_selected | !spi_miso);
        taken_once: assert (!past_full | full == !past_takes);
        stays: assert (!(past_full & full) | waiting == past_waiting);
        known_lines: assert (sck_before == was_high & selected_before == was_selected & place == edges & data == levels);
        known_given: assert (!gives | (full & given == waiting & place == 3'd0));
        known_low: assert (past_selected | given == 8'd0);
        known_received: assert (!received | (place == 3'd0 & sck_before));
        known_unselected: assert (selected_before | place == 3'd0);
    end

    localparam [31:0] START = 32'hffffffff;
    localparam [31:0] RESIDUE = 32'hdebb20e3;
    localparam [3:0]  REST = 4'd0;
    localparam [3:0]  SEND = 4'd11;
    localparam [3:0]  LAST_PHASE = 4'd11;
    localparam [7:0]  MOST = 8'd247;

    // The CRC after `number` bits of a byte.
    function [31:0] after_bits(input [31:0] crc, input [7:0] of, input [3:0] number);
        integer k;
        begin
            after_bits = crc;
            for (k = 0; k < 8; k = k + 1)
                if (k < number)
                    after_bits = (after_bits >> 1) ^ (after_bits[0] ^ of[k] ? 32'hedb88320 : 32'd0);
        end
    endfunction

    // The frame, decoded again.
    reg  [7:0]  left = 8'd0;
    reg         begun = 1'b0;
    reg         damaged = 1'b0;
    reg  [7:0]  length = 8'd0;
    reg  [31:0] crc = START;
    wire        delimiter = received & data == 8'd0;
    wire        spoilt = damaged | bad | (begun & silence == silence_limit);
    wire        taken = received & data != 8'd0 & !spoilt & !busy;
    wire        is_code = taken & left == 8'd0;
    wire        decodes = taken & (begun | left != 8'd0);
    wire [7:0]  at = begun ? length : 8'd0;
    wire        stores = decodes & at != MOST;
    wire        whole = delimiter & begun & !spoilt & left == 8'd0 & crc == RESIDUE;
    wire        ends_damaged = delimiter & !whole & (begun | spoilt);
    always @(posedge clk) begin
        if (rst | delimiter) begin
            left <= 8'd0;
            begun <= 1'b0;
            damaged <= 1'b0;
            crc <= START;
        end else begin
            if (taken) left <= is_code ? data - 8'd1 : left - 8'd1;
            begun <= begun | taken;
            damaged <= spoilt | (received & busy) | (decodes & at == MOST) | (is_code & data == 8'hff);
            if (stores) crc <= after_bits(crc, is_code ? 8'd0 : data, 4'd8);
        end
        if (rst) length <= 8'd0;
        else if (taken) length <= at + {7'd0, stores};
    end

    // Clocks since the last byte, up to 15, and whether it was stored.
    reg  [3:0] since = 4'd15;
    reg        stored = 1'b0;
    reg        past_whole = 1'b0;
    reg        past_damaged = 1'b0;
    reg        past_delimiter = 1'b0;
    reg        past_busy = 1'b0;
    reg        armed = 1'b0;
    reg        known = 1'b0;
    reg [31:0] past_header = 32'd0;
    always @(posedge clk) begin
        if (rst) begin
            since <= 4'd15;
            stored <= 1'b0;
        end else begin
            since <= received ? 4'd1 : since == 4'd15 ? 4'd15 : since + 4'd1;
            if (received) stored <= stores;
        end
        past_whole <= !rst & whole;
        past_damaged <= !rst & ends_damaged;
        past_delimiter <= !rst & delimiter;
        past_busy <= !rst & busy;
        armed <= !rst & (request | (armed & busy));
        past_header <= {sequence_number, command, count, decoder_length};
        known <= !rst & (busy | request);
    end

    always @(*) begin
        whole_frames: assert (request == past_whole);
        strobe_needs_frame: assert (!(avm_read | avm_write) | (busy & armed));
        never_both: assert (!(avm_read & avm_write));
        within: assert (!(avm_read | avm_write) | avm_address < address_limit);
        kept: assert (!known | !(busy | request) | {sequence_number, command, count, decoder_length} == past_header);
        fresh: assert (!past_delimiter | (decoder_left == 8'd0 & !decoder_begun & !decoder_skips
            & (past_busy | (sum == START & crc_left == 4'd0))));
        dropped: assert (frame_dropped == past_damaged);
        known_frame: assert ({decoder_left, decoder_begun, decoder_skips, decoder_length} == {left, begun, damaged, length});
        known_armed: assert (!busy | armed);
        known_phase: assert (phase <= LAST_PHASE & busy == (phase != REST));
        known_pause: assert (since == 4'd15 | {place, !sck_before} <= since);
        known_byte: assert (!received | since == 4'd15);
        known_one: assert (!(received & bad) & since != 4'd0);
        known_request: assert (!request | (!busy & since == 4'd1 & !stored & !begun & crc == START));
        known_stored: assert (!busy | !stored);
        known_begun: assert (!busy | (!begun & crc == START));
        known_empty: assert (begun | (crc == START & left == 8'd0));
        known_left: assert (busy | crc_left == (stored & since <= 4'd8 ? 4'd9 - since : 4'd0));
        known_sum: assert (busy | crc == after_bits(sum, bits, crc_left));
        known_restart: assert (phase != SEND | !ready | (sum == START & crc_left == 4'd0));
    end

    always @(*) begin
        reach_byte: cover (received & data == 8'h5a);
        reach_cut: cover (bad);
        reach_edge: cover (rises & edges == 3'd5);
    end
endmodule
