//! `posicast generate`: writes the Verilog of a machine, and the files that Quartus needs with it, into a folder.

use crate::design::DesignReport;
use crate::driver;
use crate::failure::Failure;
use crate::hal::HalArgs;
use crate::hardware::{Built, LINK_SUFFIX, STAGE_SUFFIX};
use crate::kit;
use crate::machine::{self, MachineFile};
use crate::output::{self, shell_word};
use crate::{sopc, verilog};
use posicast_machine::machine_file::Machine;
use posicast_synth::package::{Committed, Package};
use posicast_testbench::blocks::LinkedStageBlock;
use posicast_testbench::wording::counted;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Write the machine's Verilog, its components and its Quartus projects into a folder
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  posicast generate examples/xy-stage.toml -o xy_stage

It says how many files went where, which modules are the top ones, and what to do next.")]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    /// Output folder: new, empty, or written by posicast before [default: ./NAME]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    hal: HalArgs,
    /// List every file that was written
    #[arg(short, long)]
    verbose: bool,
    /// Print one JSON document on standard output: name, folder, top modules, files
    #[arg(long, conflicts_with = "verbose")]
    json: bool,
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
    sopc::add(
        &mut package,
        (&file.machine, &args.machine),
        board,
        (stage, built.link.as_ref()),
        components,
    )?;
    let of_stage = (stage, built.link.as_ref());
    driver::add(&mut package, &file.machine, &modules, components, of_stage)?;
    args.hal.add(
        &mut package,
        &file.machine,
        &report.design,
        stage.is_some(),
        &args.machine,
    )?;
    package
        .add("report.json", output::json_text(&report.json())?.as_bytes())
        .map_err(Failure::because)?;
    let folder = package.root().to_owned();
    let committed = package.commit().map_err(Failure::because)?;
    tell(&committed);
    let document = Document::new(
        &file.machine,
        (stage.is_some(), built.link.as_ref()),
        &folder,
        &committed.files,
    );
    if args.json {
        return output::print_json(&document);
    }
    output::print(&match args.verbose {
        true => committed
            .files
            .iter()
            .map(|path| format!("{}\n", path.display()))
            .collect(),
        false => document.text(&folder),
    })
}

/// `generate --json`.
#[derive(Serialize)]
struct Document {
    name: String,
    folder: String,
    top: Vec<String>,
    files: Vec<String>,
    /// What the line of the stage is called, where it has one.
    #[serde(skip)]
    line: Option<&'static str>,
}

impl Document {
    fn new(
        machine: &Machine,
        (has_stage, link): (bool, Option<&LinkedStageBlock>),
        folder: &Path,
        files: &[PathBuf],
    ) -> Self {
        let name = &machine.name;
        let relative = |path: &PathBuf| path.strip_prefix(folder).unwrap_or(path).display().to_string();
        Self {
            name: name.clone(),
            folder: folder.display().to_string(),
            top: std::iter::once(name.clone())
                .chain(has_stage.then(|| format!("{name}{STAGE_SUFFIX}")))
                .chain(link.map(|_| format!("{name}{LINK_SUFFIX}")))
                .collect(),
            files: files.iter().map(relative).collect(),
            line: link.map(|link| link.config().line()),
        }
    }

    /// Number of files by folder, the top modules, and what to do next.
    fn text(&self, folder: &Path) -> String {
        let files: Vec<PathBuf> = self.files.iter().map(|file| folder.join(file)).collect();
        let top = match (self.top.as_slice(), self.line) {
            ([shapers, stage], _) => format!("top modules: {shapers} (the shapers), {stage} (the whole stage)"),
            ([shapers, stage, link], Some(line)) => {
                format!(
                    "top modules: {shapers} (the shapers), {stage} (the whole stage), {link} (the stage with its {line})"
                )
            }
            _ => format!("top module: {} (the shapers)", self.top.join(", ")),
        };
        format!(
            "{} in {}: {}\n{top}\nnext: read {}; `posicast verify {}` compares this Verilog with its model\n",
            counted(files.len() as u64, "file"),
            folder.display(),
            entries(folder, &files).join(", "),
            folder.join("README.md").display(),
            shell_word(folder),
        )
    }
}

/// Contents of the folder with these files: subfolders with a `/` and their number of files, then the names of the
/// files.
pub(crate) fn entries(root: &Path, files: &[PathBuf]) -> Vec<String> {
    let (mut folders, mut alone): (Vec<(String, usize)>, Vec<String>) = (Vec::new(), Vec::new());
    for file in files {
        let mut parts = file.strip_prefix(root).unwrap_or(file).iter();
        let first = parts.next().unwrap_or_default().to_string_lossy().into_owned();
        if parts.next().is_none() {
            alone.push(first);
        } else if let Some((_, count)) = folders.iter_mut().find(|(name, _)| *name == first) {
            *count += 1;
        } else {
            folders.push((first, 1));
        }
    }
    let folders = folders.into_iter().map(|(name, count)| format!("{name}/ ({count})"));
    folders.chain(alone).collect()
}

/// Prints on standard error which files of an earlier run were removed, and which of its evidence was kept.
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
