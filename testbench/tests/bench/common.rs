//! Small hand-written Verilog with its models, for tests of the bench itself.

use std::path::PathBuf;

use posicast_blocks::{ClockedBlock, Direction, Port, StepError};
use tempfile::TempDir;

pub(crate) fn port(name: &str, direction: Direction, width: u32, signed: bool) -> Port {
    Port {
        name: name.to_owned(),
        direction,
        width,
        signed,
    }
}

/// A counter that adds signed steps; `moving` is combinational.
pub(crate) const COUNTER: &str = "
module counter(
    input wire clk, input wire rst, input wire strobe,
    input wire signed [8:0] a__step,
    output reg signed [31:0] count, output wire moving);
    initial count = 0;
    assign moving = strobe && a__step != 0;
    always @(posedge clk)
        if (rst) count <= 32'd0;
        else if (strobe) count <= count + {{23{a__step[8]}}, a__step};
endmodule
";

pub(crate) fn counter_ports() -> Vec<Port> {
    use Direction::{Input, Output};
    vec![
        port("rst", Input, 1, false),
        port("strobe", Input, 1, false),
        port("a__step", Input, 9, true),
        port("count", Output, 32, true),
        port("moving", Output, 1, false),
    ]
}

pub(crate) struct Counter {
    pub(crate) ports: Vec<Port>,
    count: i32,
}

impl Counter {
    pub(crate) fn new() -> Self {
        Self {
            ports: counter_ports(),
            count: 0,
        }
    }
}

impl ClockedBlock for Counter {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let step = ((inputs[2] << 55) as i64 >> 55) as i32;
        outputs[0] = u64::from(self.count as u32);
        outputs[1] = u64::from(inputs[1] == 1 && step != 0);
        if inputs[0] == 1 {
            self.count = 0;
        } else if inputs[1] == 1 {
            self.count = self.count.wrapping_add(step);
        }
        Ok(())
    }
}

/// A memory without reset, which reads cells that were never written.
pub(crate) const MEMORY: &str = "
module memory(input wire clk, input wire write, input wire [3:0] address, input wire [63:0] data, output wire [63:0] q);
    reg [63:0] words [0:15];
    assign q = words[address];
    always @(posedge clk) if (write) words[address] <= data;
endmodule
";

pub(crate) fn memory_ports() -> Vec<Port> {
    use Direction::{Input, Output};
    vec![
        port("write", Input, 1, false),
        port("address", Input, 4, false),
        port("data", Input, 64, false),
        port("q", Output, 64, false),
    ]
}

/// Verilog in a separate folder, with a cache beside it.
pub(crate) struct Files {
    pub(crate) folder: TempDir,
    pub(crate) files: Vec<PathBuf>,
}

impl Files {
    /// Writes the Verilog; the file is named after the first module, as lint requires.
    pub(crate) fn new(verilog: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let name = verilog
            .split(['(', ' ', '\n'])
            .skip_while(|word| *word != "module")
            .nth(1)
            .unwrap();
        let file = folder.path().join(format!("{name}.v"));
        std::fs::write(&file, verilog).unwrap();
        Self {
            folder,
            files: vec![file],
        }
    }

    pub(crate) fn cache(&self) -> PathBuf {
        self.folder.path().join("cache")
    }
}
