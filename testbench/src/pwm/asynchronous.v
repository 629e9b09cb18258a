`timescale 1ns/1ns
// The fault path of a PWM, for the module TOP: pulses of 2 ns between two edges of the clock.
module posicast_asynchronous;
    reg clk = 0;
    reg rst = 1;
    reg fault_n = 1;
    reg pll_locked = 1;
    reg clear_trip = 0;
    reg sync = 0;
    wire a_high, a_low, b_high, b_low, tripped;
    wire [3:0] pins = {a_high, a_low, b_high, b_low};
    reg [3:0] off;
    integer errors = 0;
    integer clocks = 0;
    integer waited;

    TOP dut (
        .clk(clk), .rst(rst), .enable(1'b1), .mode(2'd1), .period(16'dPERIOD), .duty(17'sd0), .max_duty(16'hffff),
        .update_at_peak(1'b0), .dead_time(10'dDEAD), .minimum_pulse(10'dPULSE), .sync(sync), .phase(16'd0),
        .trigger_phase(16'd0), .feed(1'b0), .watchdog_periods(8'd0), .filter_clocks(8'hff), .fault_n(fault_n),
        .pll_locked(pll_locked), .filtered_fault_n(2'b11), .clear_trip(clear_trip), .clear_flags(1'b0), .mask_pins(1'b0),
        .a_high(a_high), .a_low(a_low), .b_high(b_high), .b_low(b_low), .tripped(tripped)
    );

    always #10 clk = !clk;
    always @(posedge clk) clocks = clocks + 1;
    // A PWM on a time base waits for it.
    always @(negedge clk) sync = clocks % PERIOD == 0;

    task check(input good, input [8 * 60 - 1:0] what);
        if (good !== 1'b1 && errors < 5) begin
            errors = errors + 1;
            $display("clock %0d: not %0s", clocks, what);
        end
    endtask

    task clear_and_wait;
        begin
            repeat (8) @(negedge clk);
            clear_trip = 1;
            @(negedge clk) clear_trip = 0;
            waited = 0;
            while (pins === off && waited < 8 * PERIOD) begin
                @(negedge clk);
                waited = waited + 1;
            end
            check(pins !== off, "on again after the trip was cleared");
        end
    endtask

    task pulse(input of_pll, input integer after);
        begin
            clear_and_wait;
            @(posedge clk);
            #(after);
            if (of_pll) pll_locked = 0; else fault_n = 0;
            #1 check(pins === off, "off without a clock");
            #1 fault_n = 1;
            pll_locked = 1;
            repeat (4 * PERIOD) begin
                @(negedge clk);
                check(pins === off, "off after a pulse shorter than a clock");
            end
            check(tripped, "tripped by a pulse shorter than a clock");
        end
    endtask

    initial begin
        repeat (3) @(negedge clk);
        off = pins;
        rst = 0;
        repeat (8) @(negedge clk);
        pulse(0, 2);
        pulse(0, 7);
        pulse(0, 13);
        pulse(1, 3);
        pulse(1, 12);
        $display("passed after %0d clocks", clocks);
        $finish(0);
    end
endmodule
