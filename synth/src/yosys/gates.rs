//! Writes a design as a Verilog netlist of a family's cells, for simulation and proof.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Cell, Family, Mapping, Yosys, YosysError, module_name, process, to_logic_elements};

/// Models of Cyclone IV E's cells; Yosys's own leave out what the netlists use.
const CELL_MODELS: &str = include_str!("cell_models.v");

/// Maps to Cyclone V's cells, and puts Yosys's own models of them in their places.
const CYCLONE5_MODELS: &str = "read_verilog -nowb +/intel_alm/common/alm_sim.v +/intel_alm/common/dff_sim.v \
     +/intel_alm/common/dsp_sim.v +/intel_alm/common/misc_sim.v; hierarchy -check; proc; flatten -wb; opt_clean";

/// A flat netlist of a family's cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CellNetlist {
    /// Verilog of the top, with models of its cells.
    pub verilog: String,
    /// Number of cells that are look-up tables, those of carry chains among them.
    pub luts: usize,
    /// Number of cells that are flip-flops.
    pub flip_flops: usize,
    /// Number of cells that are multipliers.
    pub multipliers: usize,
}

impl Yosys {
    /// Maps the design to the cells of `family`, flat. The modules in the files `kept` stay instances with their names:
    /// memories and, where a caller wants them kept, multipliers, which a device has as blocks of their own.
    ///
    /// - Cyclone V: `synth_intel_alm` with its multipliers; in place of each cell stands Yosys's own model of it.
    /// - All others: Cyclone IV E's logic elements, as [`estimate`](Yosys::estimate) counts them: instances of
    ///   `cycloneive_lcell_comb` and `dffeas`, followed by our models of both.
    ///
    /// # Errors
    /// Those of [`check`](Yosys::check).
    pub fn netlist(
        &self,
        files: &[PathBuf],
        kept: &[PathBuf],
        top: &str,
        family: Family,
    ) -> Result<CellNetlist, YosysError> {
        let top = module_name(top)?;
        let scratch = process::scratch()?;
        let map = scratch.path().join("logic_element.v");
        fs::write(&map, include_str!("logic_element.v")).map_err(process::at(&map))?;
        let mut read = String::new();
        for (at, file) in kept.iter().enumerate() {
            // The copy is numbered, because a path with a space would be two words to Yosys.
            let name = format!("kept_{at}.v");
            let copy = scratch.path().join(&name);
            fs::copy(file, &copy).map_err(process::at(file))?;
            read += &format!("read_verilog -lib {name}; ");
        }
        let (map, models) = match family.device().cell {
            Cell::LogicElement => (to_logic_elements(top, Mapping::LogicElement), None),
            Cell::AdaptiveLogicModule => (
                format!("synth_intel_alm -family cyclonev -nobram -nolutram -noiopad -noclkbuf -top {top}"),
                Some(CYCLONE5_MODELS),
            ),
        };
        let mut script = format!(
            "{read}hierarchy -check -top {top}; proc; flatten; opt_clean; {map}; opt_clean; \
             select {top}; write_verilog -noattr -selected cells.v; select -clear"
        );
        if let Some(models) = models {
            script += &format!(
                "; design -reset; {read}read_verilog cells.v; hierarchy -top {top}; {models}; \
                 write_verilog -noattr flat.v"
            );
        }
        self.run_in(scratch.path(), top, files, &["-p".as_ref(), script.as_ref()])?;
        let cells = read_text(&scratch.path().join("cells.v"))?;
        let count = |kinds: &[&str]| {
            kinds
                .iter()
                .map(|kind| cells.matches(&format!("  {kind}")).count())
                .sum()
        };
        Ok(CellNetlist {
            luts: count(&["cycloneive_lcell_comb ", "MISTRAL_ALUT", "MISTRAL_NOT "]),
            flip_flops: count(&["dffeas ", "MISTRAL_FF "]),
            multipliers: count(&["MISTRAL_MUL"]),
            verilog: match models {
                Some(_) => read_text(&scratch.path().join("flat.v"))?,
                None => cells + CELL_MODELS,
            },
        })
    }
}

fn read_text(path: &Path) -> Result<String, YosysError> {
    fs::read_to_string(path).map_err(process::at(path))
}
