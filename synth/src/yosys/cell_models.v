// What the two cells of a netlist do, for simulation and proof, from the Cyclone II Device Handbook ("Logic Elements"). Yosys's
// own model of the flip-flop leaves out enable, clear and power-up.

// Four inputs to one output by a table; in arithmetic mode the third input is the carry of the element before.
module cycloneive_lcell_comb #(
    parameter [15:0] lut_mask = 16'hffff,
    parameter sum_lutc_input = "datac",
    parameter dont_touch = "off",
    parameter lpm_type = "cycloneive_lcell_comb"
) (
    input  wire dataa,
    input  wire datab,
    input  wire datac,
    input  wire datad,
    input  wire cin,
    output wire combout,
    output wire cout
);
    wire third = sum_lutc_input == "cin" ? cin : datac;
    assign combout = lut_mask[{datad, third, datab, dataa}];
    assign cout = lut_mask[{1'b0, cin, datab, dataa}];
endmodule

// Preset and asynchronous load are never used: `prn` and `aload` are tied off and have no effect here.
module dffeas #(
    parameter power_up = "low",
    parameter is_wysiwyg = "TRUE"
) (
    input  wire d,
    input  wire clk,
    input  wire clrn,
    input  wire prn,
    input  wire ena,
    input  wire asdata,
    input  wire aload,
    input  wire sclr,
    input  wire sload,
    output reg  q
);
    initial q = power_up == "high";
    always @(posedge clk or negedge clrn) begin
        if (!clrn) begin
            q <= 1'b0;
        end else if (ena) begin
            q <= sclr ? 1'b0 : sload ? asdata : d;
        end
    end
endmodule
