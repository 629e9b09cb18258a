//! Two designs with the same ports, side by side: Yosys joins them, and ABC decides whether an output ever differs.
//!
//! Kept modules, such as memories, are cut out of both designs: their inputs are compared like outputs of the designs, and their outputs
//! are free, with the same value in both.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

use posicast_hdl::emit::Module;

use posicast_testbench::Error;
use posicast_testbench::yosys::{abc_within, counterexample_clock, run_script};

use crate::netlist::EquivalenceVerdict;

/// The top module of both sides, the modules that are kept in both, and the folder with the files.
pub(crate) struct Sides<'a> {
    folder: &'a Path,
    top: &'a str,
    /// Commands that read the kept modules, and that cut them out.
    read_kept: String,
    cut: String,
}

impl<'a> Sides<'a> {
    /// Writes the kept modules into the folder.
    ///
    /// # Errors
    /// [`Error::File`] for the files.
    pub(crate) fn new(top: &'a str, kept: &[Module], folder: &'a Path) -> Result<Self, Error> {
        let mut sides = Self {
            folder,
            top,
            read_kept: String::new(),
            cut: String::new(),
        };
        for file in sides.write_modules(kept)? {
            let _ = writeln!(sides.read_kept, "read_verilog -lib {file}");
        }
        if !kept.is_empty() {
            let types = kept.iter().map(|module| format!(" t:{}", module.name));
            sides.cut = format!("expose -evert{}\n", types.collect::<String>());
        }
        Ok(sides)
    }

    /// Writes a file of the script.
    ///
    /// # Errors
    /// [`Error::File`].
    pub(crate) fn write(&self, name: &str, text: &str) -> Result<(), Error> {
        let path = self.folder.join(name);
        std::fs::write(&path, text).map_err(Error::file(&path, "write"))
    }

    /// Writes a file per module, and returns their names.
    ///
    /// # Errors
    /// [`Error::File`].
    pub(crate) fn write_modules(&self, modules: &[Module]) -> Result<Vec<String>, Error> {
        let files = modules.iter().map(|module| {
            let file = format!("{}.v", module.name);
            self.write(&file, &module.text)?;
            Ok(file)
        });
        files.collect()
    }

    /// Returns the commands that make a side from these files and keep it as the design `name`.
    pub(crate) fn side(&self, files: &str, name: &str) -> String {
        let Self {
            read_kept, top, cut, ..
        } = self;
        format!(
            "{read_kept}read_verilog {files}\nhierarchy -check -top {top}\nproc\nflatten\nasync2sync\nopt_clean\n{cut}rename -top {name}\n\
             design -stash {name}\n"
        )
    }

    /// Runs the script `NAME.ys`, which writes `NAME.aig` with an assertion that no output differs, and decides the assertion. The search
    /// for a difference covers `searched_clocks` clocks; each of ABC's engines gets `limit` of processor time. `joining` and `comparing`
    /// describe the two steps in messages.
    ///
    /// # Errors
    /// [`Error::ToolMissing`] without Yosys or its ABC; [`Error::ToolFailed`] where Yosys refuses the Verilog; [`Error::File`].
    pub(crate) fn decide(
        &self,
        (name, script): (&str, &str),
        searched_clocks: u32,
        limit: Duration,
        [joining, comparing]: [&'static str; 2],
    ) -> Result<EquivalenceVerdict, Error> {
        let file = format!("{name}.ys");
        self.write(&file, script)?;
        run_script(self.folder, &file, joining)?;

        let proof = format!("read_aiger {name}.aig; fold; strash; scorr; pdr");
        let said = abc_within(self.folder, &proof, comparing, limit)?;
        if said.is_some_and(|said| said.contains("Property proved")) {
            return Ok(EquivalenceVerdict::Equivalent);
        }
        let search = format!("read_aiger {name}.aig; fold; strash; bmc3 -F {searched_clocks}");
        let said = abc_within(self.folder, &search, comparing, limit)?;
        let found = said.and_then(|said| counterexample_clock(&said));
        Ok(
            found.map_or(EquivalenceVerdict::Unknown, |clock| EquivalenceVerdict::Different {
                clock,
            }),
        )
    }
}
