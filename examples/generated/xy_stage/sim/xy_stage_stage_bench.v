// Reads every constant of xy_stage_stage over its bus. Written by posicast.
`timescale 1ns / 1ns

module xy_stage_stage_bench;
    reg clk = 0;
    reg rst = 1;
    reg [9:0] avs_address = 0;
    reg avs_read = 0;
    wire [31:0] avs_readdata;
    integer errors = 0;

    always #10 clk = !clk;

    xy_stage_stage dut (
        .clk(clk),
        .rst(rst),
        .avs_address(avs_address),
        .avs_read(avs_read),
        .avs_write(1'b0),
        .avs_byteenable(4'b1111),
        .avs_writedata(32'b0),
        .emergency_stop_n(1'b0),
        .pll_locked(1'b0),
        .x_a(1'b0),
        .x_b(1'b0),
        .x_z(1'b0),
        .x_limit_plus_n(1'b0),
        .x_limit_minus_n(1'b0),
        .x_home(1'b0),
        .x_drive_ready(1'b0),
        .x_drive_fault_n(1'b0),
        .x_fault_n(1'b0),
        .y_a(1'b0),
        .y_b(1'b0),
        .y_z(1'b0),
        .y_limit_plus_n(1'b0),
        .y_limit_minus_n(1'b0),
        .y_home(1'b0),
        .y_drive_ready(1'b0),
        .y_drive_fault_n(1'b0),
        .y_fault_n(1'b0),
        .irq(),
        .tick(),
        .x_a_high(),
        .x_a_low(),
        .x_b_high(),
        .x_b_low(),
        .x_pwm_trigger(),
        .x_drive_enable(),
        .x_brake_release(),
        .y_a_high(),
        .y_a_low(),
        .y_b_high(),
        .y_b_low(),
        .y_pwm_trigger(),
        .y_drive_enable(),
        .y_brake_release(),
        .avs_readdata(avs_readdata)
    );

    task expect_word(input [9:0] address, input [31:0] expected);
        begin
            @(negedge clk);
            avs_address = address;
            avs_read = 1;
            @(negedge clk);
            avs_read = 0;
            if (avs_readdata !== expected) begin
                errors = errors + 1;
                $display("word %0d reads %h, not %h", address, avs_readdata, expected);
            end
        end
    endtask

    initial begin
        repeat (4) @(negedge clk);
        rst = 0;
        expect_word(0, 32'h45475453); // MAGIC
        expect_word(1, 32'h00020002); // VERSION
        expect_word(2, 32'h00000002); // AXES
        expect_word(3, 32'h00001388); // TICK_CLOCKS
        expect_word(4, 32'h000000d2); // CONTROL_CLOCKS
        expect_word(5, 32'h000002d9); // DUTY_CLOCKS
        expect_word(256, 32'h000009c4); // X_PWM_PERIOD_CLOCKS
        expect_word(257, 32'h00000080); // X_RING_SAMPLES
        expect_word(258, 32'h00000040); // X_MOST_TAPS
        expect_word(259, 32'h00000005); // X_MACHINE_TAPS
        expect_word(260, 32'h00000010); // X_COEFFICIENT_FRACTION
        expect_word(512, 32'h000009c4); // Y_PWM_PERIOD_CLOCKS
        expect_word(513, 32'h00000080); // Y_RING_SAMPLES
        expect_word(514, 32'h00000040); // Y_MOST_TAPS
        expect_word(515, 32'h00000005); // Y_MACHINE_TAPS
        expect_word(516, 32'h00000010); // Y_COEFFICIENT_FRACTION
        if (errors != 0) $fatal(1, "%0d constants are wrong", errors);
        $display("PASS: every constant is what the register map says");
        $finish;
    end
endmodule
