// setting_banks: the settings of a controller, in three banks.
//
// Proven for all inputs in every clock, resets included; nothing is assumed. Memory and ROM are left out: what is read
// from them is anything, in every clock.
//
//   from_memory        a row that was written since the reset reads as the memory's word at its own place
//   not_written        one that was not reads as 0, whatever the memory holds; so does bank 3
//   machine_...        bank 0 reads as the ROM's word of that row
//   place_...          a write goes to the place that the same bank and row are read from, and each has its own, with its word
//   active_stays       no word of the bank in use is written
//   not_while_written  no word is read in the clock in which it is written
//   refused_is_flagged a write to the bank in use, to bank 0 or 3 changes nothing, and sets `setting_refused` for the clock
//   taken_else         after it; any other one is taken, and is not flagged
module setting_banks_properties (
    input wire        clk,
    input wire        rst,
    input wire        setting_write,
    input wire [1:0]  setting_bank,
    input wire [3:0]  setting_row,
    input wire [31:0] setting_word,
    input wire [1:0]  bank,
    input wire [3:0]  row,
    input wire [31:0] setting,
    input wire        setting_refused,
    (* peek = "u_loaded_settings.write_enable" *)  input wire        taken,
    (* peek = "u_loaded_settings.write_address" *) input wire [4:0]  write_address,
    (* peek = "u_loaded_settings.write_data" *)    input wire [31:0] write_data,
    (* peek = "u_loaded_settings.read_address" *)  input wire [4:0]  read_address,
    (* peek = "u_loaded_settings.read_data" *)     input wire [31:0] read_data,
    (* peek = "u_machine_settings.address" *)      input wire [3:0]  machine_address,
    (* peek = "u_machine_settings.data" *)         input wire [31:0] machine_word,
    (* peek = "written" *)                         input wire [31:0] written
);
    // Which rows of banks 1 and 2 were written since the reset.
    reg  [31:0] rows = 32'd0;
    wire        of_loaded = bank == 2'd1 | bank == 2'd2;
    wire        legal = (setting_bank == 2'd1 | setting_bank == 2'd2) & setting_bank != bank;

    reg        past_reset = 1'b1;
    reg        past_write = 1'b0;
    reg        past_legal = 1'b0;
    reg        past_loaded = 1'b0;
    reg        past_written = 1'b0;
    reg        past_machine = 1'b0;
    always @(posedge clk) begin
        if (rst) rows <= 32'd0;
        else if (setting_write & legal) rows[{setting_bank[1], setting_row}] <= 1'b1;
        past_reset <= rst;
        past_write <= !rst & setting_write;
        past_legal <= legal;
        past_loaded <= !rst & of_loaded;
        past_written <= rows[{bank[1], row}];
        past_machine <= !rst & bank == 2'd0;
    end

    always @(*) begin
        from_memory: assert (!(past_loaded & past_written) | setting == read_data);
        not_written: assert (past_machine | (past_loaded & past_written) | setting == 32'd0);
        not_written_known: assert (written == rows);
        machine_address_is_row: assert (machine_address == row);
        machine_rows: assert (!past_machine | setting == machine_word);
        place_written: assert (!taken | write_address == {setting_bank[1], setting_row});
        place_read: assert (!of_loaded | read_address == {bank[1], row});
        place_word: assert (!taken | write_data == setting_word);
        active_stays: assert (!taken | (setting_bank != bank & setting_bank != 2'd0 & setting_bank != 2'd3));
        not_while_written: assert (!taken | !of_loaded | write_address != read_address);
        refused_is_flagged: assert (setting_refused == (past_write & !past_legal));
        taken_else: assert (taken == (setting_write & legal));
    end

    always @(*) begin
        reach_loaded: cover (past_loaded & past_written);
        reach_empty: cover (past_loaded & !past_written & !past_reset);
        reach_machine: cover (past_machine & setting != 32'd0);
        reach_refused: cover (setting_refused);
    end
endmodule
