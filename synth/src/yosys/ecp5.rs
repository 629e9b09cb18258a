//! Makes a netlist for Lattice ECP5, which open tools can place and route, and reads the ports of a top for its
//! wrapper.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::process::{at, scratch};
use super::{Yosys, YosysError, module_name};

/// A port of a top module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TopPort {
    /// Name of the port.
    pub name: String,
    /// Whether it is an input; otherwise it is an output.
    pub is_input: bool,
    /// Width in bits.
    pub width: u32,
}

impl Yosys {
    /// The ports of `top`, sorted by name.
    ///
    /// # Errors
    /// Those of [`check`](Yosys::check).
    pub fn ports(&self, files: &[PathBuf], top: &str) -> Result<Vec<TopPort>, YosysError> {
        let top = module_name(top)?;
        let scratch = scratch()?;
        let script = format!("hierarchy -check -top {top}; proc; write_json ports.json");
        self.run_in(scratch.path(), top, files, &["-p".as_ref(), script.as_ref()])?;
        let path = scratch.path().join("ports.json");
        let text = fs::read(&path).map_err(at(&path))?;
        let unreadable = |reason: String| YosysError::Netlist {
            top: top.to_owned(),
            reason,
        };
        let design: Value = serde_json::from_slice(&text).map_err(|error| unreadable(error.to_string()))?;
        let ports = design["modules"][top]["ports"].as_object();
        let ports = ports.ok_or_else(|| unreadable("it has no ports".to_owned()))?;
        let port = |(name, port): (&String, &Value)| TopPort {
            name: name.clone(),
            is_input: port["direction"] == "input",
            width: port["bits"].as_array().map_or(0, Vec::len) as u32,
        };
        Ok(ports.iter().map(port).collect())
    }

    /// Maps `top` to ECP5 and writes the netlist into `output`, in the format that nextpnr reads.
    ///
    /// # Errors
    /// Those of [`check`](Yosys::check).
    pub fn ecp5_netlist(&self, files: &[PathBuf], top: &str, output: &Path) -> Result<(), YosysError> {
        let top = module_name(top)?;
        let scratch = scratch()?;
        let script = format!("synth_ecp5 -abc9 -top {top} -json netlist.json");
        self.run_in(scratch.path(), top, files, &["-p".as_ref(), script.as_ref()])?;
        let path = scratch.path().join("netlist.json");
        fs::copy(&path, output).map_err(at(&path))?;
        Ok(())
    }
}
