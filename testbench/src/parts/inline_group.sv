// inline_group: the drives go off at once, every axis stops for a fault of one, and the shaping changes only at rest.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. The runner writes the lists of
// ports per axis.
//
//   off_at_once        the drives are off in every clock in which enable or emergency_stop_n is low
//   kept_off           and after an emergency stop of three clocks, until a clear
//   faults_stop        one clock after a fault of any axis, no axis runs
//   runs_enabled       an axis runs only if enable was high three clocks before, and no emergency stop was there
//   changes_at_rest    the shaping changes only at a tick, with all axes settled or none running
//   clears_once        clear lasts one clock
//   all_settled        settled: all axes were
//   fault_shown        fault: an axis had one, or there was an emergency stop
module inline_group_properties (
    `PORTS,
    (* peek = "emergency" *) input wire emergency
);
    reg       past_fault = 1'b0;
    reg       past_settled = 1'b0;
    reg       past_tick = 1'b0;
    reg       past_run = 1'b0;
    reg       past_clear = 1'b0;
    reg       past_bypassed = 1'b0;
    reg       past_reset = 1'b1;
    reg       past_emergency = 1'b0;
    reg [2:0] enabled = 3'd0;
    reg [2:0] pressed = 3'd0;
    always @(posedge clk) begin
        past_fault <= !rst & (|`AXIS_FAULT);
        past_settled <= !rst & (&`AXIS_SETTLED);
        past_tick <= !rst & tick;
        past_run <= !rst & run;
        past_clear <= !rst & clear;
        past_bypassed <= !rst & bypassed;
        past_reset <= rst;
        past_emergency <= !rst & emergency;
        enabled <= rst ? 3'd0 : {enabled[1:0], enable};
        pressed <= rst ? 3'd0 : {pressed[1:0], !emergency_stop_n};
    end

    always @(*) begin
        off_at_once: assert ((enable & emergency_stop_n) | !drive_enable);
        kept_off: assert (!emergency | !drive_enable);
        remembers: assert (!pressed[2] | emergency);
        kept_until_clear: assert (past_reset | !past_emergency | past_clear | emergency);
        faults_stop: assert (!past_fault | !run);
        runs_enabled: assert (!run | (enabled[2] & !pressed[2] & !past_emergency));
        changes_at_rest: assert (past_reset | bypassed == past_bypassed | (past_tick & (past_settled | !past_run)));
        clears_once: assert (!past_clear | !clear);
        all_settled: assert (settled == past_settled);
        fault_shown: assert (fault == (past_fault | past_emergency));
    end

    always @(*) begin
        reach_run: cover (run & drive_enable);
        reach_bypassed: cover (bypassed & run);
        reach_emergency: cover (emergency & fault);
    end
endmodule
