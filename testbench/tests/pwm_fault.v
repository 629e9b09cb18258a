// Tests the fault path of the PWM in an event simulator: pulses between two edges of the clock, and a clock that stops.
// Prints `passed`, or what failed.
`timescale 1ns/1ns

module pwm_fault;
    localparam integer CLOCK = 20;
    localparam integer DEAD_TIME = 3;

    reg clk = 0;
    reg clock_runs = 1;
    reg rst = 1;
    reg fault_n = 1;
    reg pll_locked = 1;
    reg clear_trip = 0;
    wire a_high, a_low, b_high, b_low, running, tripped, valley;
    wire [4:0] trip_causes;
    integer errors = 0;
    integer pulses = 0;
    integer valley_time = 0;
    integer high_off = 0;
    integer low_off = 0;
    integer length;

    pwm dut (
        .clk(clk), .rst(rst), .enable(1'b1), .mode(2'd1), .period(16'd80), .duty(17'sd33), .max_duty(16'd60),
        .update_at_peak(1'b0), .dead_time(10'd3), .minimum_pulse(10'd4), .sync(1'b0), .phase(16'd0),
        .trigger_phase(16'd0), .feed(1'b0), .watchdog_periods(8'd0), .filter_clocks(8'd4), .fault_n(fault_n),
        .pll_locked(pll_locked), .filtered_fault_n(2'b11), .clear_trip(clear_trip), .clear_flags(1'b0), .mask_pins(1'b0),
        .a_high(a_high), .a_low(a_low), .b_high(b_high), .b_low(b_low), .running(running), .tripped(tripped),
        .trip_causes(trip_causes), .valley(valley)
    );

    always #(CLOCK / 2) if (clock_runs) clk = !clk;

    task check(input good, input [8 * 40 - 1:0] what);
        if (good !== 1'b1) begin
            errors = errors + 1;
            $display("%0t: not %0s", $time, what);
        end
    endtask

    // In any state both sides are never on, and the dead time is between them.
    always @(a_high or a_low) if ($time > 0) check(!(a_high & a_low), "one side only");
    always @(negedge a_high) high_off = $time;
    always @(negedge a_low) low_off = $time;
    always @(posedge a_high) begin
        pulses = pulses + 1;
        check($time - low_off >= DEAD_TIME * CLOCK, "dead time before high");
    end
    always @(posedge a_low) if (high_off != 0) check($time - high_off >= DEAD_TIME * CLOCK, "dead time before low");
    always @(posedge valley) valley_time = $time;

    // After a trip, a side turns on a dead time after a valley.
    task wait_return;
        begin
            @(posedge a_low or posedge a_high);
            check($time == valley_time + DEAD_TIME * CLOCK, "back at the start of a period");
        end
    endtask

    task clear;
        begin
            @(negedge clk) clear_trip = 1;
            @(negedge clk) clear_trip = 0;
        end
    endtask

    task expect_off_for(input integer clocks);
        repeat (clocks) begin
            @(negedge clk);
            check({a_high, a_low, b_high, b_low} === 4'b0000, "off after the pulse");
        end
    endtask

    // Makes a pulse of 1 to 3 ns at this number of ns after a rising edge while the high side is on.
    task pulse_on(input integer which, input integer after, input integer width);
        begin
            @(posedge a_high);
            #(3 * CLOCK + after);
            check(a_high, "high before the pulse");
            if (which == 0) fault_n = 0; else pll_locked = 0;
            #0;
            #(width) check({a_high, a_low} === 2'b00, "off without a clock");
            fault_n = 1;
            pll_locked = 1;
            expect_off_for(200);
            check(tripped & trip_causes[0], "tripped by the latch");
            check(!running, "stopped");
            clear;
            wait_return;
        end
    endtask

    initial begin
        #(3 * CLOCK) check({a_high, a_low, b_high, b_low} === 4'b0000, "off in reset");
        @(negedge clk) rst = 0;
        expect_off_for(200);
        check(tripped, "tripped until the first clear");
        clear;
        wait_return;

        // The pulse comes anywhere in the clock period, including at the edge itself.
        for (length = 1; length <= 3; length = length + 1) begin
            pulse_on(0, 1, length);
            pulse_on(0, 9, length);
            pulse_on(0, 19, length);
            pulse_on(1, 12, length);
        end

        // A clear during the fault has no effect, and neither has one at its end.
        @(posedge a_high) #7 fault_n = 0;
        repeat (5) begin
            clear;
            expect_off_for(70);
        end
        fault_n = 1;
        clear_trip = 1;
        @(negedge clk) clear_trip = 0;
        expect_off_for(200);
        clear;
        wait_return;

        // A new pulse just before the clear takes effect keeps it off.
        @(posedge a_high) #7 fault_n = 0;
        #2 fault_n = 1;
        expect_off_for(20);
        @(negedge clk) clear_trip = 1;
        #(CLOCK / 2 - 1) fault_n = 0;
        #2 fault_n = 1;
        @(negedge clk) clear_trip = 0;
        expect_off_for(200);
        clear;
        wait_return;

        // The clock stops while a side is on.
        @(posedge a_high) #2 clock_runs = 0;
        #500 check(a_high, "high while the clock stands");
        pll_locked = 0;
        #1 check({a_high, a_low, b_high, b_low} === 4'b0000, "off without any clock");
        pll_locked = 1;
        #500 check({a_high, a_low, b_high, b_low} === 4'b0000, "still off");
        clock_runs = 1;
        expect_off_for(200);
        clear;
        wait_return;

        check(pulses > 12, "enough pulses");
        if (errors == 0) $display("passed");
        $finish(0);
    end
endmodule
