//! A block as Yosys reads it, with its mutants.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use posicast_hdl::emit::Module;

use super::mutant::Mutant;
use posicast_testbench::Error;
use posicast_testbench::yosys;

/// Name of the input that selects a mutant; 0 selects none.
pub(super) const SELECT: &str = "mutsel";
/// Width of that input in bits.
pub(super) const SELECT_BITS: u32 = 16;
/// Largest number of mutants of a netlist, which is limited by that input.
const MOST: usize = (1 << SELECT_BITS) - 1;

/// A block's modules as cells, in a folder.
pub(super) struct Netlist<'a> {
    folder: &'a Path,
    modules: &'a [Module],
    top: &'a str,
}

impl<'a> Netlist<'a> {
    /// Reads the Verilog. Only logic that is clearly redundant is removed; mutants go into the rest.
    pub(super) fn read(modules: &'a [Module], top: &'a str, folder: &'a Path) -> Result<Self, Error> {
        std::fs::create_dir_all(folder).map_err(Error::file(folder, "create"))?;
        let netlist = Self { folder, modules, top };
        let mut script = String::new();
        for module in modules {
            let file = format!("{}.v", module.name);
            netlist.write(&file, &module.text)?;
            let _ = writeln!(script, "read_verilog {file}");
        }
        let _ = writeln!(
            script,
            "hierarchy -check -top {top}\nproc\nopt -nodffe -nosdff\nwrite_ilang block.il"
        );
        netlist.yosys("read", &script)?;
        Ok(netlist)
    }

    /// Path of the folder with the files.
    pub(super) fn folder(&self) -> &Path {
        self.folder
    }

    /// Name of the top module.
    pub(super) fn top(&self) -> &str {
        self.top
    }

    /// Whether it contains multipliers.
    pub(super) fn multiplies(&self) -> bool {
        self.modules.iter().any(|module| module.name.contains("smul_"))
    }

    /// Number of writable bits of its memories, from the modules' names: `ram_WORDSxBITS`.
    pub(super) fn memory_bits(&self) -> u32 {
        let bits = |name: &str| -> Option<u32> {
            let (words, bits) = name.rsplit_once("ram_")?.1.split_once('x')?;
            Some(words.parse::<u32>().ok()? * bits.parse::<u32>().ok()?)
        };
        self.modules.iter().filter_map(|module| bits(&module.name)).sum()
    }

    /// Chooses at most this many mutants, by the seed.
    pub(super) fn mutants(&self, count: usize, seed: u64) -> Result<Vec<Mutant>, Error> {
        if !(1..=MOST).contains(&count) {
            return Err(Error::Option(format!(
                "{count} mutants of a block: 1 to {MOST} are possible"
            )));
        }
        // Yosys takes a seed of 31 bits.
        let seed = seed & 0x7fff_ffff;
        // More are listed than needed, because some places cannot be used.
        let listed = 2 * count;
        self.yosys(
            "list",
            &format!(
                "read_ilang block.il\nmutate -list {listed} -seed {seed} -ctrl {SELECT} {SELECT_BITS} 1 -o mutants.txt \
                 * t:$meminit* %d\n"
            ),
        )?;
        let path = self.folder.join("mutants.txt");
        let list = std::fs::read_to_string(&path).map_err(Error::file(&path, "read"))?;
        let usable = list.lines().filter_map(Mutant::parse).filter(Mutant::keeps_registers);
        let numbered = (1..=count).zip(usable);
        Ok(numbered.map(|(number, mutant)| mutant.numbered(number)).collect())
    }

    /// Writes a Verilog file with all mutants, and the input that selects one.
    ///
    /// A mutant may tie a bit of a net to another bit of it. Verilator 5.006 takes that for a loop, and then
    /// simulates logic that depends on it wrongly, whichever mutant is selected; therefore nets are split at their
    /// drivers.
    pub(super) fn with_all(&self, mutants: &[Mutant]) -> Result<PathBuf, Error> {
        let mut script = String::from("read_ilang block.il\n");
        for mutant in mutants {
            let Mutant { number, arguments, .. } = mutant;
            let _ = writeln!(script, "mutate -ctrl {SELECT} {SELECT_BITS} {number} {arguments}");
        }
        script.push_str("opt_clean\nsplitnets -driver\nwrite_verilog -noattr mutants.v\n");
        self.yosys("mutate", &script)?;
        Ok(self.folder.join("mutants.v"))
    }

    /// The block's modules with one mutant, all in one text.
    pub(super) fn with(&self, mutant: &Mutant) -> Result<Vec<Module>, Error> {
        let arguments = &mutant.arguments;
        self.yosys(
            "mutant",
            &format!("read_ilang block.il\nmutate {arguments}\nopt_clean\nwrite_verilog -noattr mutant.v\n"),
        )?;
        let path = self.folder.join("mutant.v");
        let text = std::fs::read_to_string(&path).map_err(Error::file(&path, "read"))?;
        let top = self.modules.last().cloned();
        Ok(top
            .into_iter()
            .map(|top| Module {
                text: text.clone(),
                ..top
            })
            .collect())
    }

    /// Runs a script, which is kept in the folder under this name.
    pub(super) fn yosys(&self, name: &str, script: &str) -> Result<(), Error> {
        let file = format!("{name}.ys");
        self.write(&file, script)?;
        yosys::run_script(self.folder, &file, "putting mutants into a block")
    }

    fn write(&self, file: &str, text: &str) -> Result<(), Error> {
        let path = self.folder.join(file);
        std::fs::write(&path, text).map_err(Error::file(&path, "write"))
    }
}
