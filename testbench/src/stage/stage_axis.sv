// An axis of a stage, as its blocks are wired: the machine's pins at an emergency stop, and the conditions under which they are on.
//
// The properties are proven for all inputs in every clock, including resets: whatever a host, the other axes, encoder and switches
// do, and whatever the controller says. Nothing is assumed. Memories and products are left out. FILTER_CLOCKS is what the stage
// ties.
//
//   stop_*            drive off and brake applied once the emergency stop's line has been low for FILTER_CLOCKS + 5 clocks, and
//                     as long as it stays low; all four pins of the bridge off a clock later: in direct mode, in a self-test,
//                     from every state
//   group_stop_*      drive off and brake applied two clocks after the emergency stop of another axis, the bridge three
//   raw_fault_is_off  the bridge is off in the clock in which fault_n is low or the clock's lock is lost
//   bridge_with_drive a pin of the bridge is on only after a clock with the drive enabled
//   brake_with_drive  the brake is open only with the drive enabled
//   off_is_off        a clock after one in OFF drive and brake are off, two after it the bridge
//   ready_by_direct   a clock after one in READY they are on by direct mode alone
//
// pwm.sv proves that both sides of a leg are never on together.
module stage_axis_properties (
    `PORTS,
    (* peek = "u_axis.primed" *) input wire [3:0] primed,
    (* peek = "u_axis.u_emergency_stop_line.u_synchroniser.synchroniser_first" *) input wire first,
    (* peek = "u_axis.u_emergency_stop_line.u_synchroniser.synchroniser_second" *) input wire second,
    (* peek = "u_axis.u_emergency_stop_line.u_filter.left" *) input wire [5:0] left,
    (* peek = "u_axis.u_states.on_q" *) input wire axis_on,
    (* peek = "u_axis.u_states.released_q" *) input wire axis_released,
    (* peek = "u_axis.u_states.closing" *) input wire axis_closing,
    (* peek = "u_axis.u_cause_word.had_fault_q" *) input wire had_fault,
    (* peek = "u_axis.u_cause_word.had_cut_q" *) input wire had_cut,
    (* peek = "u_drive_command.pwm_enable_q" *) input wire pwm_enable,
    (* peek = "u_drive_command.masked" *) input wire masked,
    (* peek = "u_pwm.u_pin_gates.masked" *) input wire gates_masked,
    (* peek = "u_pwm.gates" *) input wire [3:0] gates
);
    // Lines are used from the fifth clock after a reset on.
    reg [3:0] awake = 4'd0;
    // Clocks for which the line has been low.
    reg [6:0] low = 7'd0;
    always @(posedge clk) begin
        awake <= rst ? 4'd0 : {awake[2:0], 1'b1};
        low <= rst | emergency_stop_n ? 7'd0 : low == 7'd127 ? low : low + 7'd1;
    end
    localparam [6:0] FILTER = `FILTER_CLOCKS;

    // Values of the previous clocks, the last one in bit 0.
    reg [2:0] group = 3'd0;
    reg [1:0] off = 2'd3;
    reg       ready = 1'b0;
    reg       past_drive = 1'b0, past_enable = 1'b0, past_mask = 1'b0;
    always @(posedge clk) begin
        group <= {group[1:0], group_emergency_stop & !rst};
        off <= {off[0], state == `OFF | rst};
        ready <= state == `READY & !rst;
        past_drive <= drive_enable & !rst;
        past_enable <= pwm_enable & !rst;
        past_mask <= masked & !rst;
    end

    wire [3:0] pins = {b_low, b_high, a_low, a_high};
    always @(*) begin
        stop_drive: assert (low < FILTER + 7'd5 | (!drive_enable & !brake_release));
        stop_bridge: assert (low < FILTER + 7'd6 | pins == 4'd0);
        group_stop_drive: assert (!group[1] | (!drive_enable & !brake_release));
        group_stop_bridge: assert (!group[2] | pins == 4'd0);
        raw_fault_is_off: assert ((fault_n & pll_locked) | pins == 4'd0);
        bridge_with_drive: assert (pins == 4'd0 | past_drive);
        brake_with_drive: assert (!brake_release | drive_enable);
        off_is_off: assert (!off[0] | (!drive_enable & !brake_release));
        off_bridge_is_off: assert (!off[1] | pins == 4'd0);
        ready_by_direct: assert (!ready | direct_active | (!drive_enable & !brake_release & !pwm_enable));
    end

    // Invariants of the registers, for the induction.
    wire axis_is_off = !axis_on & (state == `OFF | state == `FAULT);
    wire harmful = |(causes & ~`HARMLESS);
    always @(*) begin
        lines_wait: assert (primed == awake & (awake & (awake + 4'd1)) == 4'd0);
        off_before_lines: assert (awake[3] | (state == `OFF & !axis_on));
        line_begins: assert (low != 7'd0 | first | (!second & !level_emergency_stop_n));
        line_comes: assert (low != 7'd1 | (!first & (second | !level_emergency_stop_n)));
        line_counts: assert (low < 7'd2 | (!first & !second));
        filter_counts: assert (low < 7'd2 | !level_emergency_stop_n | {1'b0, left} == FILTER + 7'd2 - low);
        filter_bound: assert ({1'b0, left} <= FILTER);
        filter_passes: assert (low < FILTER + 7'd3 | !level_emergency_stop_n);
        known_state: assert (state <= `FAULT);
        on_by_state: assert (state == `FAULT | axis_on == (state == `HOLD | state == `RUN | state == `QUICK_STOP));
        closing_against_brake: assert (axis_closing == (axis_on & !axis_released) & (axis_on | !axis_released));
        brake_by_state: assert (!axis_closing | state == `HOLD | state == `FAULT);
        cause_stands: assert (had_fault == harmful & (!had_cut | had_fault));
        stop_in_axis: assert (low < FILTER + 7'd4 | axis_is_off);
        group_stop_in_axis: assert (!group[0] | axis_is_off);
        command_is_off: assert (!(low >= FILTER + 7'd5 | group[1]) | (!pwm_enable & !direct_active));
        off_in_command: assert (!off[0] | (!pwm_enable & !direct_active));
        off_before: assert (!off[1] | !past_enable);
        drive_unless_masked: assert (!pwm_enable | masked | drive_enable);
        gates_were_enabled: assert (past_enable | gates == 4'd0);
        mask_follows: assert (gates_masked == past_mask);
    end

    always @(*) begin
        reach_on: cover (axis_on & drive_enable & brake_release);
        reach_direct: cover (direct_active & drive_enable & low == FILTER + 7'd4);
        reach_off: cover (low == FILTER + 7'd5 & past_drive);
    end
endmodule
