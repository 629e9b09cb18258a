// error_table: the table in use and its weight, what a host can load, and the sum.
//
// Proven for entries that differ by at most MOST_STEP and LAST as the index of the last one, for all inputs in every clock, resets
// included; nothing is assumed. What a memory gives is anything, in every clock; error_lookup proves the use of these values.
//
//   weight_changes     the weight changes with `valid` only: by one, or to 0 with the drive off; it is never above 1024
//   weight_rises       it goes up only with the drive on, homed, enabled, and the wanted bank in use; from 0 with bank 1 only if all its
//                      entries are loaded
//   weight_falls       with `valid` and one of these missing it is not 0 but one less
//   taken_at_0         bank and count of the first entry change with `valid` only, where the weight was 0: to what the host wants, and to
//                      origin + FIRST
//   loads_in_turn      a word is written to bank 1 only: while it is not in use, entry 0 or the one after those that are loaded, never one
//                      after the last
//   neighbours         and none that differs from the one before it by more than MOST_STEP. So all neighbours of a complete table do not
//   complete_is        all entries were written in turn since entry 0 was last; a reset clears them
//   used_is_complete   a weight above 0 with bank 1 means that it is complete
//   stays_while_used   while it is in use no word of it is written
//   refused_is_flagged any other write changes nothing, and sets `error_refused` for the clock after it
//   not_while_written  no pass and no host reads a word of bank 1 in use in the clock in which one is written
//   serves_idle        a host's read takes the memories only while no pass runs and nothing is written
//   found_is, waits_is the word that a host reads back is that of its bank and index, 0 where none is loaded; it waits until it is there
//   sum_is             `compensated` changes with `compensated_valid` only: to the reference minus the error, clamped at the ends of its word
//   error_is           the error is that of error_lookup, times 16 with `coarse`
module error_table_properties (
    `PORTS,
    (* peek = "base" *)                                  input wire signed [31:0] base,
    (* peek = "u_lookup.busy" *)                         input wire               busy,
    (* peek = "u_lookup.ends" *)                         input wire               ends,
    (* peek = "u_lookup.error" *)                        input wire signed [17:0] found_error,
    (* peek = "u_lookup.counts" *)                       input wire [31:0]        counts,
    (* peek = "u_lookup.fraction" *)                     input wire [7:0]         fraction,
    (* peek = "u_lookup.address" *)                      input wire [7:0]         address,
    (* peek = "u_lookup.entry" *)                        input wire signed [17:0] entry,
    (* peek = "u_banks.loaded" *)                        input wire [8:0]         loaded,
    (* peek = "u_banks.previous" *)                      input wire signed [17:0] previous,
    (* peek = "u_banks.serves" *)                        input wire               serves,
    (* peek = "u_banks.served" *)                        input wire               served,
    (* peek = "u_banks.served_entry" *)                  input wire               served_entry,
    (* peek = "u_banks.served_bank" *)                   input wire               served_bank,
    (* peek = "u_banks.u_machine_errors.address" *)      input wire [7:0]         machine_address,
    (* peek = "u_banks.u_machine_errors.data" *)         input wire [17:0]        machine_word,
    (* peek = "u_banks.u_loaded_errors.write_enable" *)  input wire               taken,
    (* peek = "u_banks.u_loaded_errors.write_address" *) input wire [7:0]         write_address,
    (* peek = "u_banks.u_loaded_errors.write_data" *)    input wire [17:0]        write_data,
    (* peek = "u_banks.u_loaded_errors.read_address" *)  input wire [7:0]         read_address,
    (* peek = "u_banks.u_loaded_errors.read_data" *)     input wire [17:0]        loaded_word
);
    localparam [8:0]         entries = 9'd1 + `LAST;
    localparam signed [19:0] most = `MOST_STEP;

    // Number of entries that a host has loaded in order, and the last of them.
    reg         [8:0]  count = 9'd0;
    reg  signed [17:0] last_entry = 18'sd0;
    wire               in_use = error_bank_used & error_weight != 11'd0;
    wire signed [19:0] entry_step = $signed({{2{error_entry[17]}}, error_entry}) - $signed({{2{last_entry[17]}}, last_entry});
    wire               is_gentle = entry_step <= most & entry_step >= -most;
    wire               in_turn = error_index == 8'd0 | ({1'b0, error_index} == count & count < entries & is_gentle);
    wire               legal = error_bank & !in_use & in_turn;
    wire               wanted = error_enable & homed & drive_enable;
    wire               may_use = !error_select | error_complete;

    reg                past_reset = 1'b1;
    reg                past_valid = 1'b0, past_drive = 1'b0, past_wanted = 1'b0, past_may = 1'b0, past_select = 1'b0, past_used = 1'b0;
    reg                past_refused = 1'b0, past_write = 1'b0, past_ends = 1'b0;
    reg         [10:0] past_weight = 11'd0;
    reg  signed [31:0] past_base = 32'sd0, past_place = 32'sd0, past_compensated = 32'sd0;
    reg  signed [33:0] past_sum = 34'sd0;
    // The states of a host's read: it waits; its word is read; the word is ready.
    reg                waits = 1'b0, has_word = 1'b0, past_has_word = 1'b0, is_loaded = 1'b0, of_bank_1 = 1'b0;
    reg         [17:0] past_word = 18'd0;
    reg  signed [17:0] past_found = 18'sd0;
    wire signed [33:0] sum = $signed({{2{position_reference[31]}}, position_reference}) - $signed({{2{table_error[31]}}, table_error});
    always @(posedge clk) begin
        if (rst) count <= 9'd0;
        else if (error_write & legal) count <= {1'b0, error_index} + 9'd1;
        if (rst) last_entry <= 18'sd0;
        else if (error_write & legal) last_entry <= error_entry;
        past_reset <= rst;
        past_valid <= !rst & valid;
        past_drive <= drive_enable;
        past_wanted <= wanted;
        past_may <= may_use;
        past_select <= error_select;
        past_used <= !rst & error_bank_used;
        past_write <= error_write;
        past_refused <= !rst & error_write & !legal;
        past_ends <= !rst & ends;
        past_weight <= rst ? 11'd0 : error_weight;
        past_base <= rst ? 32'sd0 : base;
        past_place <= origin + `FIRST;
        past_compensated <= rst ? 32'sd0 : compensated;
        past_sum <= sum;
        waits <= !rst & (error_read | (waits & !has_word));
        has_word <= !rst & waits & !has_word & !busy & !error_write;
        past_has_word <= !rst & has_word;
        is_loaded <= !rst & {1'b0, error_index} < (error_bank ? count : entries);
        of_bank_1 <= !rst & error_bank;
        past_word <= !is_loaded ? 18'd0 : of_bank_1 ? loaded_word : machine_word;
        past_found <= rst ? 18'sd0 : error_loaded;
    end

    wire [10:0] one_more = past_weight + 11'd1;
    wire [10:0] one_less = past_weight - 11'd1;
    wire        was_off = past_weight == 11'd0;
    wire        keeps_bank = past_select == past_used;
    always @(*) begin
        weight_bound: assert (error_weight <= 11'd1024);
        weight_stays: assert (past_valid | error_weight == past_weight);
        weight_steps: assert (error_weight == past_weight | error_weight == one_more | error_weight == one_less | (error_weight == 11'd0 & !past_drive));
        weight_drive: assert (!(past_valid & !past_drive) | error_weight == 11'd0);
        weight_rises: assert (!(error_weight > past_weight) | (past_valid & past_wanted & past_may & (was_off | keeps_bank)));
        weight_rises_if: assert (!(past_valid & past_wanted & past_may & !was_off & keeps_bank) | error_weight == one_more | error_weight == 11'd1024);
        weight_rises_from_0: assert (!(past_valid & past_wanted & past_may & was_off & !past_write) | error_weight == 11'd1);
        weight_falls: assert (!(past_valid & !was_off & past_drive & !(past_wanted & past_may & keeps_bank)) | error_weight == one_less);
        taken_at_0: assert ((past_valid & was_off) | (base == past_base & error_bank_used == past_used));
        taken_is: assert (!(past_valid & was_off) | (base == past_place & error_bank_used == past_select));
        loads_in_turn: assert (!taken | (error_bank & !in_use & {1'b0, write_address} <= count & write_address <= `LAST));
        loads_word: assert (!taken | (write_address == error_index & write_data == error_entry));
        neighbours: assert (!(taken & write_address != 8'd0) | is_gentle);
        taken_else: assert (taken == (error_write & legal));
        complete_is: assert (error_complete == (count == entries));
        used_is_complete: assert (!in_use | error_complete);
        stays_while_used: assert (!(taken & in_use));
        refused_is_flagged: assert (error_refused == past_refused);
        serves_idle: assert (!serves | (waits & !busy & !error_write));
        not_while_written: assert (!taken | !serves);
        read_is_pass: assert (serves | (read_address == address & machine_address == address));
        read_is_host: assert (!serves | (read_address == error_index & machine_address == error_index));
        entry_is: assert (served | entry == (error_bank_used ? loaded_word : machine_word));
        waits_is: assert (error_read_waits == waits);
        found_is: assert (!past_has_word | error_loaded == past_word);
        found_stays: assert (past_has_word | error_loaded == past_found);
        error_is: assert (table_error == (coarse ? {{10{found_error[17]}}, found_error, 4'd0} : {{14{found_error[17]}}, found_error}));
        valid_is: assert (compensated_valid == past_ends);
        sum_is: assert (!past_ends | compensated == (past_sum > 34'sd2147483647 ? 32'sh7fffffff : past_sum < -34'sd2147483648 ? 32'sh80000000 : past_sum[31:0]));
        sum_stays: assert (past_ends | compensated == past_compensated);
        place_is: assert (counts == (on_measured ? measured : {{8{position_reference[31]}}, position_reference[31:8]}) - base & fraction == (on_measured ? 8'd0 : position_reference[7:0]));
        known_count: assert (loaded == count & previous == last_entry & count <= entries);
        known_served: assert (served == has_word & served_entry == is_loaded & served_bank == of_bank_1);
    end

    always @(*) begin
        reach_weight: cover (error_weight == 11'd2 & !error_bank_used);
        reach_loaded: cover (error_weight == 11'd2 & error_bank_used);
        reach_refused: cover (error_refused & past_select);
        reach_steep: cover (error_write & error_bank & !in_use & {1'b0, error_index} == count & count < entries & !is_gentle & count != 9'd0);
        reach_read_back: cover (past_has_word & error_loaded != 18'sd0);
        reach_sum: cover (compensated_valid & compensated != 32'sd0);
        reach_waiting: cover (error_read_waits & busy);
    end
endmodule
