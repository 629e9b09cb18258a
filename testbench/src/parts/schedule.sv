// schedule: `control` comes exactly CONTROL_CLOCKS after a tick, and at no other time.
//
// The properties are proven for all inputs in every clock, including resets; nothing is assumed. If a tick comes before the
// previous one has led to `control`, only the last one counts; a stage's registers make this impossible.
module schedule_properties (
    `PORTS,
    (* peek = "since" *) input wire [16:0] since,
    (* peek = "waits" *) input wire waits
);
    // Clocks since the last tick; 0 if there was none, or if its control is over.
    reg [16:0] age = 17'd0;
    reg        due = 1'b0;
    always @(posedge clk) begin
        due <= !rst & age == `CONTROL_CLOCKS - 17'd1;
        if (rst) age <= 17'd0;
        else if (tick) age <= 17'd1;
        else if (age == `CONTROL_CLOCKS - 17'd1) age <= 17'd0;
        else if (age != 17'd0) age <= age + 17'd1;
    end

    always @(*) begin
        exactly: assert (control == due);
        known_age: assert (waits == (age != 17'd0) & (!waits | since == age - 17'd1) & age < `CONTROL_CLOCKS);
    end

    always @(*) begin
        reach_tick: cover (age == 17'd1);
    end
endmodule
