// setting_banks: the settings of a controller, in three banks.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. Memory and ROM are left out: any
// value can be read from them in every clock.
//
//   from_memory        a row that was written since the reset reads as the memory's word at its own place
//   not_written        one that was not reads as 0, whatever the memory holds; so does bank 3
//   machine_...        bank 0 reads as the ROM's word of that row
//   place_...          a write goes to the place that the same bank and row are read from, and each has its own, with its word
//   active_stays       no word of the bank in use is written
//   not_while_written  no word is read in the clock in which it is written
//   refused_is_flagged a write to the bank in use, to bank 0 or 3 changes nothing, and sets `setting_refused` for the clock
//   taken_else         after it; any other write is taken, and is not flagged
//   serves_idle        a host's read takes the place of the controller's only while that is not busy, and nothing is written
//   undisturbed        in every other clock bank and row that are read are the controller's
//   waits_...          a host's read waits from its strobe until its word is there, and no longer
//   loaded_is_word     that word is the one that was read from the host's bank and row, by the same rules
//   loaded_stays       it changes for no other reason
module setting_banks_properties (
    `PORTS,
    (* peek = "serves" *) input wire serves,
    (* peek = "served" *) input wire served,
    (* peek = "u_loaded_settings.write_enable" *) input wire taken,
    (* peek = "u_loaded_settings.write_address" *) input wire [4:0] write_address,
    (* peek = "u_loaded_settings.write_data" *) input wire [31:0] write_data,
    (* peek = "u_loaded_settings.read_address" *) input wire [4:0] read_address,
    (* peek = "u_loaded_settings.read_data" *) input wire [31:0] read_data,
    (* peek = "u_machine_settings.address" *) input wire [3:0] machine_address,
    (* peek = "u_machine_settings.data" *) input wire [31:0] machine_word,
    (* peek = "written" *) input wire [31:0] written
);
    // Rows of banks 1 and 2 that were written since the reset.
    reg  [31:0] rows = 32'd0;
    wire [1:0]  bank_read = serves ? setting_bank : bank;
    wire [3:0]  row_read = serves ? setting_row : row;
    wire        of_loaded = bank_read == 2'd1 | bank_read == 2'd2;
    wire        legal = (setting_bank == 2'd1 | setting_bank == 2'd2) & setting_bank != bank;

    reg        past_reset = 1'b1;
    reg        past_write = 1'b0;
    reg        past_legal = 1'b0;
    reg        past_loaded = 1'b0;
    reg        past_written = 1'b0;
    reg        past_machine = 1'b0;
    // A host's read has been requested; its word is in `setting`.
    reg        waits = 1'b0;
    reg        has_word = 1'b0;
    reg        past_has_word = 1'b0;
    reg [31:0] past_setting = 32'd0;
    reg [31:0] past_loaded_word = 32'd0;
    always @(posedge clk) begin
        if (rst) rows <= 32'd0;
        else if (setting_write & legal) rows[{setting_bank[1], setting_row}] <= 1'b1;
        past_reset <= rst;
        past_write <= !rst & setting_write;
        past_legal <= legal;
        past_loaded <= !rst & of_loaded;
        past_written <= rows[{bank_read[1], row_read}];
        past_machine <= !rst & bank_read == 2'd0;
        waits <= !rst & (setting_read | (waits & !has_word));
        has_word <= !rst & waits & !has_word & !busy & !setting_write;
        past_has_word <= !rst & has_word;
        past_setting <= setting;
        past_loaded_word <= rst ? 32'd0 : setting_loaded;
    end

    always @(*) begin
        from_memory: assert (!(past_loaded & past_written) | setting == read_data);
        not_written: assert (past_machine | (past_loaded & past_written) | setting == 32'd0);
        not_written_known: assert (written == rows);
        machine_address_is_row: assert (machine_address == row_read);
        machine_rows: assert (!past_machine | setting == machine_word);
        place_written: assert (!taken | write_address == {setting_bank[1], setting_row});
        place_read: assert (!of_loaded | read_address == {bank_read[1], row_read});
        place_word: assert (!taken | write_data == setting_word);
        active_stays: assert (!taken | (setting_bank != bank & setting_bank != 2'd0 & setting_bank != 2'd3));
        not_while_written: assert (!taken | !of_loaded | write_address != read_address);
        refused_is_flagged: assert (setting_refused == (past_write & !past_legal));
        taken_else: assert (taken == (setting_write & legal));
        serves_idle: assert (!serves | (waits & !busy & !setting_write));
        undisturbed: assert (serves | ((!of_loaded | read_address == {bank[1], row}) & machine_address == row));
        waits_for_word: assert (setting_read_waits == waits);
        waits_served: assert (served == has_word);
        loaded_is_word: assert (!past_has_word | setting_loaded == past_setting);
        loaded_stays: assert (past_has_word | setting_loaded == past_loaded_word);
    end

    always @(*) begin
        reach_loaded: cover (past_loaded & past_written);
        reach_empty: cover (past_loaded & !past_written & !past_reset);
        reach_machine: cover (past_machine & setting != 32'd0);
        reach_refused: cover (setting_refused);
        reach_read_back: cover (past_has_word & setting_loaded != 32'd0);
        reach_waiting: cover (setting_read_waits & busy);
    end
endmodule
