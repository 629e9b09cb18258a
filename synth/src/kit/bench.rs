//! The test bench of the example: a step through every shaper.

use std::fmt::Write;

use super::example::signals;
use super::{Kit, KitShaper};

/// A step is a sixteenth of a word, so that shapers whose partial sums exceed the command do not saturate.
const STEP_SHIFT: u32 = 4;
/// Number of samples before the step, and after the last tap.
const QUIET_SAMPLES: u32 = 4;

/// Writes the bench: every axis makes a step, must change with it, come to rest exactly at it, and neither saturate
/// nor overrun.
pub(super) fn bench(kit: &Kit<'_>) -> String {
    let machine = kit.machine;
    let (pass, samples) = (kit.pass_clocks(), kit.longest_delay_samples() + 2 * QUIET_SAMPLES);
    let mut text = format!(
        "\
// A step of every axis through {machine}_example: each must end at the command, to the bit.
// Samples are {pass} clocks apart here, so that it does not take long; in the machine they are {sample_clocks} apart.
//
//     iverilog -g2012 -o bench.vvp -f filelist.f kit/{machine}_strobe.v kit/{machine}_example.v kit/{machine}_bench.v
//     vvp bench.vvp
//
// Written by posicast {posicast} for the machine {machine}.

`default_nettype none
`timescale 1ns / 1ps

module {machine}_bench;
    reg clk = 1'b0;
    reg rst = 1'b1;
    wire strobe;
    integer failures = 0;
",
        sample_clocks = kit.sample_clocks,
        posicast = env!("CARGO_PKG_VERSION"),
    );
    for shaper in kit.shapers {
        let (axis, bits) = (shaper.axis, shaper.config.word_bits());
        let _ = write!(
            text,
            "
    reg  signed [{high}:0] {axis}_command = {bits}'sd0;
    wire signed [{high}:0] {axis}_shaped;
    wire {flags};
    integer {axis}_values = 0;
    reg  signed [{high}:0] {axis}_before = {bits}'sd0;
",
            high = bits - 1,
            flags = flags(shaper).join(", "),
        );
    }
    let _ = write!(
        text,
        "
    {machine}_example #(.SAMPLE_CLOCKS(32'd{pass})) dut (
        .clk(clk),
        .rst(rst)"
    );
    for shaper in kit.shapers {
        let axis = shaper.axis;
        for port in signals(shaper) {
            let _ = write!(text, ",\n        .{axis}_{port}({axis}_{port})");
        }
    }
    text.push_str(
        ",\n        .strobe(strobe)\n    );\n\n    always #10 clk = ~clk;\n\n    always @(posedge clk) begin\n",
    );
    for shaper in kit.shapers {
        let axis = shaper.axis;
        let _ = write!(
            text,
            "        if ({axis}_valid && {axis}_shaped != {axis}_before) begin
            {axis}_before <= {axis}_shaped;
            {axis}_values <= {axis}_values + 1;
        end
"
        );
    }
    let _ = write!(
        text,
        "    end

    initial begin
        $dumpfile(\"bench.vcd\");
        $dumpvars(0, {machine}_bench);
        repeat (4) @(posedge clk);
        rst <= 1'b0;
        repeat ({QUIET_SAMPLES}) @(posedge strobe);
"
    );
    for shaper in kit.shapers {
        let step = 1i64 << (shaper.config.word_bits() - STEP_SHIFT);
        let _ = writeln!(
            text,
            "        {}_command <= {}'sd{step};",
            shaper.axis,
            shaper.config.word_bits()
        );
    }
    let _ = writeln!(text, "        repeat ({samples}) @(posedge strobe);");
    for shaper in kit.shapers {
        let axis = shaper.axis;
        let _ = write!(
            text,
            "        $display(\"axis {axis}: command %0d, shaped %0d, in %0d steps\", {axis}_command, {axis}_shaped, {axis}_values);
        if ({axis}_shaped !== {axis}_command || {axis}_values == 0{failed}) begin
            $display(\"FAILED: axis {axis}\");
            failures = failures + 1;
        end
",
            failed = flags(shaper)[1..].iter().map(|flag| format!(" || {flag}")).collect::<String>()
        );
    }
    text.push_str(
        "        if (failures != 0) $fatal(1, \"FAIL\");
        $display(\"PASS\");
        $finish;
    end
endmodule

`default_nettype wire
",
    );
    text
}

/// The flags of an axis: a new value first, then those that a step must not raise.
fn flags(shaper: &KitShaper<'_>) -> Vec<String> {
    let flags = signals(shaper).into_iter().skip(2);
    flags.map(|signal| format!("{}_{signal}", shaper.axis)).collect()
}
