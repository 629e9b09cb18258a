// law_and_bank: the component of the controller, as its blocks are wired: law, modulo and bank of settings of a pass.
//
// The properties are proven for all traffic on the bus, all pins and resets; nothing is assumed. The controller's
// arithmetic and the contents of the banks are left out, so they have any value.
//
//   one_law_and_bank   law, modulo and bank of settings are, in every clock of a pass, what they were in the clock of its start
//   law_of_pass        the law that the pass computes is the one of that clock
//   known_idle         no step is counted between two passes: an invariant
//   changes_between    they change in the first clock after a pass, that of `valid`, or by a reset, and in no other clock
//
// That all three change in the same clock is proven of the register bank: commit.sv.
module law_and_bank_properties (
    `PORTS,
    (* peek = "u_sliding_mode.start" *) input wire start,
    (* peek = "u_sliding_mode.busy" *) input wire busy,
    (* peek = "u_sliding_mode.law" *) input wire [1:0] law,
    (* peek = "u_sliding_mode.modulo" *) input wire modulo,
    (* peek = "u_setting_banks.bank" *) input wire [1:0] bank,
    (* peek = "u_registers.waits" *) input wire waits,
    (* peek = "u_sliding_mode.u_sequencer.step_q" *) input wire [4:0] step,
    (* peek = "u_sliding_mode.u_sequencer.phase" *) input wire [5:0] phase,
    (* peek = "u_sliding_mode.u_sequencer.linear_q" *) input wire linear,
    (* peek = "u_sliding_mode.u_sequencer.integrates_q" *) input wire integrates
);
    wire [4:0] in_force = {bank, modulo, law};

    reg        past_reset = 1'b1;
    reg  [4:0] past_in_force = 5'd0;
    // Values at the start of the pass.
    reg        runs = 1'b0;
    reg  [4:0] of_pass = 5'd0;
    always @(posedge clk) begin
        past_reset <= rst;
        past_in_force <= in_force;
        runs <= !rst & (busy | start);
        if (start & !busy) of_pass <= in_force;
    end

    always @(*) begin
        known_idle: assert (busy ? runs & !past_reset : step == 5'd0 & phase == 6'd0);
        one_law_and_bank: assert (past_reset | !busy | in_force == of_pass);
        law_of_pass: assert (past_reset | !busy | (linear == (of_pass[1:0] != 2'd0) & integrates == (of_pass[1:0] == 2'd2)));
        changes_between: assert (past_reset | valid | in_force == past_in_force);
    end

    always @(*) begin
        // That a pass begins in the clock in which they change is in model/blocks/tests/controller_commit.rs, at every distance.
        reach_pass: cover (busy & step == 5'd2 & linear);
        reach_waiting: cover (busy & waits);
    end
endmodule
