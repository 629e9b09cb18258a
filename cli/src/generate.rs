//! `posicast generate`: the Verilog of a machine, and what Quartus needs beside it, in a folder of its own.

use crate::blocks;
use crate::design::Report;
use crate::driver;
use crate::failure::Failure;
use crate::machine::{self, MachineFile};
use crate::output;
use crate::sopc;
use crate::stage::{self, Stage};
use posicast_hdl::emit::{Module, add};
use posicast_hdl::machine::{AxisShaper, emit_machine};
use posicast_model::spec::Machine;
use posicast_synth::package::{Committed, Package};
use posicast_system::scratch;
use posicast_testbench::blocks::{Block, ComponentBlock};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Write the machine's Verilog, its components and its Quartus projects into a folder
#[derive(clap::Args)]
#[command(after_help = "Example:\n  posicast generate examples/xy-stage.toml -o xy_stage")]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    /// Output folder: new, empty, or written by posicast before [default: ./NAME]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let file = machine::read(&args.machine)?;
    let report = Report::new(&file.machine, &args.machine)?;
    report.warn();
    let board = sopc::board(&file.machine, &args.machine)?;
    let shapers = machine::shapers(&file.machine, &report.design, &args.machine)?;
    let stage = stage::of_machine(&file.machine, &report.design, &args.machine)?;
    let components = blocks::components(&file.machine, &shapers, &report.controllers, &args.machine)?;
    let modules = modules(&file.machine, &shapers, &components, stage.as_ref(), &args.machine)?;
    let mut package = open(args.output.as_deref(), &file)?;
    add_sources(&mut package, &file, &modules)?;
    sopc::add(&mut package, &file.machine, board, stage.as_ref(), &components)?;
    driver::add(&mut package, &file.machine, &modules, &components, stage.as_ref())?;
    package
        .add("report.json", output::json_text(&report.json())?.as_bytes())
        .map_err(Failure::because)?;
    let committed = package.commit().map_err(Failure::because)?;
    tell(&committed);
    let mut text = String::new();
    for path in &committed.files {
        let _ = writeln!(text, "{}", path.display());
    }
    output::print(&text)
}

/// Says on standard error which files of an earlier run went, and which of its evidence stayed.
pub(crate) fn tell(committed: &Committed) {
    let note = |what: &str, files: &[String]| {
        if !files.is_empty() {
            output::say(&format!("note: {what}: {}", files.join(", ")));
        }
    };
    note(
        "kept the evidence of the last `posicast run`, which is about this very machine file and Verilog",
        &committed.kept,
    );
    note(
        "removed the evidence of an earlier `posicast run`, which was about another machine file or other Verilog (`posicast \
         run` makes it anew)",
        &committed.outdated,
    );
    note(
        "removed what an earlier run wrote and this one does not",
        &committed.removed,
    );
}

/// The Verilog modules of a machine, each once: those of its top, then those of its components, then those of its stage. `path` is
/// the machine file.
pub(crate) fn modules(
    machine: &Machine,
    shapers: &[AxisShaper],
    components: &[ComponentBlock],
    stage: Option<&Stage>,
    path: &Path,
) -> Result<Vec<Module>, Failure> {
    let mut modules = emit_machine(&machine.name, shapers).map_err(Failure::because)?;
    for component in components {
        add(&mut modules, component.modules().map_err(Failure::because)?).map_err(Failure::because)?;
    }
    if let Some(stage) = stage {
        add(&mut modules, stage.modules(path)?).map_err(Failure::because)?;
    }
    Ok(modules)
}

/// The output folder, by default named after the machine.
pub(crate) fn open(output: Option<&Path>, file: &MachineFile) -> Result<Package, Failure> {
    let name = &file.machine.name;
    Package::open(output.unwrap_or(Path::new(name)), name).map_err(Failure::because)
}

/// Adds the machine file and its Verilog to the folder, and returns where the Verilog stands until the folder is complete.
pub(crate) fn add_sources(
    package: &mut Package,
    file: &MachineFile,
    modules: &[Module],
) -> Result<Vec<PathBuf>, Failure> {
    package
        .add("machine.toml", file.text.as_bytes())
        .map_err(Failure::because)?;
    let write = |module: &Module| {
        let path = package
            .stage(&format!("rtl/{}.v", module.name))
            .map_err(Failure::because)?;
        std::fs::write(&path, &module.text).map_err(Failure::because)?;
        Ok(path)
    };
    modules.iter().map(write).collect()
}

/// Writes the modules into a temporary folder, for tools that read files. The folder goes when the guard is dropped.
pub(crate) fn write_scratch(modules: &[Module]) -> Result<(Vec<PathBuf>, scratch::Folder), Failure> {
    let folder = scratch::Folder::new(scratch::PREFIX).map_err(Failure::because)?;
    let files: Result<Vec<_>, _> = modules
        .iter()
        .map(|module| {
            let path = folder.path().join(format!("{}.v", module.name));
            std::fs::write(&path, &module.text).map(|()| path)
        })
        .collect();
    Ok((files.map_err(Failure::because)?, folder))
}
