//! Estimates a block by itself, in a module without logic, so that all of it is one row.

use super::{Estimate, Family, Yosys, YosysError, process};
use posicast_blocks::{Direction, Port};
use std::fs;
use std::path::PathBuf;

/// Name of the module around the block.
const AROUND: &str = "block_alone";

impl Yosys {
    /// Estimates the resources of one block by itself, mapped as a whole, from its Verilog, its top module, and the
    /// top's ports except the clock `clk`.
    ///
    /// # Errors
    /// Those of [`estimate`](Yosys::estimate).
    pub fn estimate_alone(
        &self,
        files: &[PathBuf],
        top: &str,
        ports: &[Port],
        family: Family,
    ) -> Result<Estimate, YosysError> {
        let scratch = process::scratch()?;
        let around = scratch.path().join("block_alone.v");
        fs::write(&around, text(top, ports)).map_err(process::at(&around))?;
        let files: Vec<PathBuf> = files.iter().cloned().chain([around]).collect();
        self.estimate(&files, AROUND, family)
    }
}

fn text(top: &str, ports: &[Port]) -> String {
    let mut heads = vec!["input clk".to_owned()];
    let mut connections = vec![".clk(clk)".to_owned()];
    for port in ports {
        let direction = match port.direction {
            Direction::Input => "input",
            Direction::Output => "output",
        };
        heads.push(format!("{direction} [{}:0] {}", port.width - 1, port.name));
        connections.push(format!(".{0}({0})", port.name));
    }
    format!(
        "module {AROUND} ({});\n    {top} block ({});\nendmodule\n",
        heads.join(", "),
        connections.join(", ")
    )
}
