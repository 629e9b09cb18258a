//! Writes a design as a Verilog netlist of logic elements, as an estimate counts them, for simulation and proof.

use std::fs;
use std::path::PathBuf;

use super::{Mapping, Yosys, YosysError, module_name, process, to_logic_elements};

/// Verilog models of the netlist's cells.
pub const CELL_MODELS: &str = include_str!("cell_models.v");

impl Yosys {
    /// Maps the design to Cyclone IV E's logic elements, flat, as [`estimate`](Yosys::estimate) does for Cyclone II
    /// and IV. Returns Verilog of one module `top` with the cells `cycloneive_lcell_comb` and `dffeas`
    /// ([`CELL_MODELS`]). The modules in the files `kept` stay instances with their names: memories and multipliers,
    /// which a device has as blocks of their own.
    ///
    /// # Errors
    /// Those of [`check`](Yosys::check).
    pub fn netlist(&self, files: &[PathBuf], kept: &[PathBuf], top: &str) -> Result<String, YosysError> {
        let top = module_name(top)?;
        let scratch = process::scratch()?;
        let map = scratch.path().join("logic_element.v");
        fs::write(&map, include_str!("logic_element.v")).map_err(process::at(&map))?;
        let mut script = String::new();
        for (at, file) in kept.iter().enumerate() {
            // The copy is numbered, because a path with a space would be two words to Yosys.
            let name = format!("kept_{at}.v");
            let copy = scratch.path().join(&name);
            fs::copy(file, &copy).map_err(process::at(file))?;
            script += &format!("read_verilog -lib {name}; ");
        }
        script += &format!(
            "hierarchy -check -top {top}; proc; flatten; opt_clean; {}; opt_clean; write_verilog -noattr netlist.v",
            to_logic_elements(top, Mapping::LogicElement)
        );
        self.run_in(scratch.path(), top, files, &["-p".as_ref(), script.as_ref()])?;
        let path = scratch.path().join("netlist.v");
        fs::read_to_string(&path).map_err(process::at(&path))
    }
}
