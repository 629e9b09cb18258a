// Test design: a syntax error in line 3.
module broken (input wire a, output wire q);
    assign q = a +;
endmodule
