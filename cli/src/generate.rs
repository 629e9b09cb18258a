//! `posicast generate`: the Verilog of a machine, and what Quartus needs beside it, in a folder of its own.

use crate::design::DesignReport;
use crate::driver;
use crate::failure::Failure;
use crate::hardware::Built;
use crate::kit;
use crate::machine::{self, MachineFile};
use crate::output;
use crate::{sopc, verilog};
use posicast_synth::package::{Committed, Package};
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
    let report = DesignReport::new(&file.machine, &args.machine)?;
    report.warn();
    let board = sopc::board(&file.machine, &args.machine)?;
    let built = Built::new(&report, &args.machine)?;
    let modules = built.modules(&args.machine)?;
    let mut package = open(args.output.as_deref(), &file)?;
    verilog::add_sources(&mut package, &file, &modules)?;
    kit::add(&mut package, &kit::files(&file.machine, &modules, &built))?;
    let (components, stage) = (&built.components, built.stage.as_ref());
    sopc::add(&mut package, &file.machine, board, stage, components)?;
    driver::add(&mut package, &file.machine, &modules, components, stage)?;
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

/// The output folder, by default named after the machine.
pub(crate) fn open(output: Option<&Path>, file: &MachineFile) -> Result<Package, Failure> {
    let name = &file.machine.name;
    Package::open(output.unwrap_or(Path::new(name)), name).map_err(Failure::because)
}
