//! The FuseSoC core of the output folder: its Verilog as file sets, with one target that lints and one that
//! simulates.
//!
//! ```text
//! fusesoc --cores-root DIR run --target lint posicast:machines:NAME
//! fusesoc --cores-root DIR run --target sim  posicast:machines:NAME
//! ```
//!
//! The target `sim` runs a bench that is generated here from the register map: it reads every constant of the stage
//! over the bus, and ends with an error if one differs from the map.

use posicast_blocks::registers::{Access, RegisterMap};
use posicast_blocks::{Direction, Port};
use std::fmt::Write;

/// Version of the core, with the register maps' major number.
const VERSION: &str = "1.0.0";
/// Number of clocks in reset.
const RESET_CLOCKS: u32 = 4;

/// Data from which a core is written.
#[derive(Debug, Clone, Copy)]
pub struct Core<'a> {
    /// The machine's name.
    pub machine: &'a str,
    /// The top module.
    pub top: &'a str,
    /// The top module of the stage with its line to a host, if there is one.
    pub link: Option<&'a str>,
    /// All Verilog files, as paths in the folder.
    pub files: &'a [String],
    /// Register map and ports of the top module, if it has registers.
    pub bus: Option<(&'a RegisterMap, &'a [Port])>,
}

/// The files of the core, as path in the output folder and text: `NAME.core`, and the bench that its target `sim`
/// runs.
pub fn files(core: &Core<'_>) -> Vec<(String, String)> {
    let bench = core.bus.map(|(map, ports)| (bench_path(core), bench(core, map, ports)));
    let of_core = (format!("{}.core", core.machine), description(core));
    [of_core].into_iter().chain(bench).collect()
}

fn bench_name(core: &Core<'_>) -> String {
    format!("{}_bench", core.top)
}

fn bench_path(core: &Core<'_>) -> String {
    format!("sim/{}.v", bench_name(core))
}

fn description(core: &Core<'_>) -> String {
    let (machine, top) = (core.machine, core.top);
    let files: Vec<String> = core.files.iter().map(|file| format!("      - {file}\n")).collect();
    let mut text = format!(
        "CAPI=2:
name: posicast:machines:{machine}:{VERSION}
description: Motion hardware of the machine {machine}, written by posicast

filesets:
  rtl:
    files:
{}    file_type: verilogSource
",
        files.concat(),
    );
    if core.bus.is_some() {
        let _ = write!(
            text,
            "  bench:\n    files:\n      - {}\n    file_type: verilogSource\n",
            bench_path(core)
        );
    }
    let _ = write!(
        text,
        "
targets:
  default:
    filesets: [rtl]
    toplevel: {top}

  lint:
    description: Verilator reads everything below {top}, and warns of nothing
    filesets: [rtl]
    toplevel: {top}
    flow: lint
    flow_options:
      tool: verilator
      verilator_options: [-Wall]
"
    );
    if let Some(link) = core.link {
        let _ = write!(
            text,
            "
  lint_link:
    description: Verilator reads everything below {link}, and warns of nothing
    filesets: [rtl]
    toplevel: {link}
    flow: lint
    flow_options:
      tool: verilator
      verilator_options: [-Wall]
"
        );
    }
    if core.bus.is_some() {
        let _ = write!(
            text,
            "
  sim:
    description: Icarus reads every constant of {top} over the bus
    filesets: [rtl, bench]
    toplevel: {}
    flow: sim
    flow_options:
      tool: icarus
      iverilog_options: [-g2012]
",
            bench_name(core)
        );
    }
    text
}

/// A bench that reads the constants.
fn bench(core: &Core<'_>, map: &RegisterMap, ports: &[Port]) -> String {
    let mut text = format!(
        "// Reads every constant of {top} over its bus. Written by posicast.
`timescale 1ns / 1ns

module {bench};
    reg clk = 0;
    reg rst = 1;
    reg [{high}:0] avs_address = 0;
    reg avs_read = 0;
    wire [31:0] avs_readdata;
    integer errors = 0;

    always #10 clk = !clk;

    {top} dut (
        .clk(clk),
        .rst(rst),
        .avs_address(avs_address),
        .avs_read(avs_read),
        .avs_write(1'b0),
        .avs_byteenable(4'b1111),
        .avs_writedata(32'b0),
",
        top = core.top,
        bench = bench_name(core),
        high = map.address_bits() - 1,
    );
    let own = |port: &&Port| port.name != "rst" && !port.name.starts_with("avs_");
    for port in ports.iter().filter(own) {
        let _ = match port.direction {
            Direction::Input => writeln!(text, "        .{}({}'b0),", port.name, port.width),
            Direction::Output => writeln!(text, "        .{}(),", port.name),
        };
    }
    let _ = write!(
        text,
        "        .avs_readdata(avs_readdata)
    );

    task expect_word(input [{high}:0] address, input [31:0] expected);
        begin
            @(negedge clk);
            avs_address = address;
            avs_read = 1;
            @(negedge clk);
            avs_read = 0;
            if (avs_readdata !== expected) begin
                errors = errors + 1;
                $display(\"word %0d reads %h, not %h\", address, avs_readdata, expected);
            end
        end
    endtask

    initial begin
        repeat ({RESET_CLOCKS}) @(negedge clk);
        rst = 0;
",
        high = map.address_bits() - 1,
    );
    let constants = map
        .registers()
        .iter()
        .filter(|register| register.access == Access::Constant);
    for register in constants {
        let _ = writeln!(
            text,
            "        expect_word({}, 32'h{:08x}); // {}",
            register.offset,
            register.reset(),
            register.name.to_uppercase()
        );
    }
    text.push_str(
        "        if (errors != 0) $fatal(1, \"%0d constants are wrong\", errors);
        $display(\"PASS: every constant is what the register map says\");
        $finish;
    end
endmodule
",
    );
    text
}
