//! `posicast generate`: writes the Verilog of a machine, and the files that Quartus needs with it, into a folder.

use crate::Outcome;
use crate::bus_files;
use crate::design::DesignReport;
use crate::driver;
use crate::failure::Failure;
use crate::hal;
use crate::hardware::{Built, LINK_SUFFIX, STAGE_SUFFIX};
use crate::kit;
use crate::machine::{self, MachineFile};
use crate::observer::Observer;
use crate::text::json_text;
use crate::vhdl;
use crate::{sopc, verilog};
use posicast_machine::machine_file::Machine;
use posicast_synth::package::{Committed, Package};
use posicast_synth::sopc::Board;
use posicast_testbench::blocks::Block;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Options of the generation.
#[derive(Debug, Clone)]
pub struct Options {
    /// Machine file.
    pub machine: PathBuf,
    /// Output folder: new, empty, or written by posicast before; `None`: the machine's name.
    pub output: Option<PathBuf>,
    /// Rate of LinuxCNC's servo thread in Hz; `None`: no files for LinuxCNC.
    pub servo_hz: Option<f64>,
}

/// Writes a machine's Verilog, its components and its Quartus projects into a folder.
///
/// # Errors
/// [`Failure`] for files that cannot be read, designed, built or written.
pub fn generate(options: &Options, observer: &dyn Observer) -> Result<Outcome<Document>, Failure> {
    let path = options.machine.as_path();
    let file = machine::read(path)?;
    let report = DesignReport::new(&file.machine, path)?;
    report.warn(observer);
    let board = sopc::board(&file.machine, path)?;
    let built = Built::new(&report, path, observer)?;
    let mut package = open(options.output.as_deref(), &file)?;
    add(&mut package, (&file, path), &built, board, observer)?;
    let has_stage = built.stage.is_some();
    if let Some(servo_hz) = options.servo_hz {
        let of_file = (&file.machine, path);
        hal::add(&mut package, servo_hz, of_file, &report.design, has_stage, observer)?;
    }
    package
        .add("report.json", json_text(&report.json())?.as_bytes())
        .map_err(Failure::because)?;
    let folder = package.root().to_owned();
    let committed = package.commit().map_err(Failure::because)?;
    tell(&committed, observer);
    let document = Document::new(&file.machine, &built, &folder, &committed.files);
    Ok(Outcome::passed(document))
}

/// Adds the machine's Verilog, and its descriptions for tools, systems and drivers. Returns the paths of the Verilog.
pub(crate) fn add(
    package: &mut Package,
    (file, path): (&MachineFile, &Path),
    built: &Built<'_>,
    board: Option<Board>,
    observer: &dyn Observer,
) -> Result<Vec<PathBuf>, Failure> {
    let machine = &file.machine;
    let modules = built.modules(path)?;
    let sources = verilog::add_sources(package, file, &modules)?;
    kit::add(package, &kit::files(machine, &modules, built))?;
    let of_stage = (built.stage.as_ref(), built.link.as_ref());
    let inline = built.inline_unit();
    sopc::add(
        package,
        (machine, path),
        board,
        of_stage,
        &built.components,
        inline,
        observer,
    )?;
    driver::add(package, machine, &modules, built)?;
    vhdl::add(package, (machine, path), &modules, built, observer)?;
    bus_files::add(package, machine, &modules, built)?;
    Ok(sources)
}

/// The files that were generated, and their folder.
#[derive(Serialize, JsonSchema)]
pub struct Document {
    /// Name of the machine.
    pub name: String,
    /// The output folder.
    pub folder: String,
    /// The top modules: the shapers, then the stage, the stage with its line, and the inline shaper, where the machine has them.
    pub top: Vec<String>,
    /// The top modules of what has registers, on the bus of `[target]`.
    pub on_bus: Vec<String>,
    /// Name of that bus, if it is not Avalon-MM.
    #[serde(skip)]
    pub bus: Option<&'static str>,
    /// Paths in the folder.
    pub files: Vec<String>,
    /// Name of the stage's line, if it has one.
    #[serde(skip)]
    pub line: Option<&'static str>,
    /// Whether there is an inline shaper.
    #[serde(skip)]
    pub has_inline: bool,
}

impl Document {
    fn new(machine: &Machine, built: &Built<'_>, folder: &Path, files: &[PathBuf]) -> Self {
        let name = &machine.name;
        let relative = |path: &PathBuf| path.strip_prefix(folder).unwrap_or(path).display().to_string();
        Self {
            name: name.clone(),
            folder: folder.display().to_string(),
            top: std::iter::once(name.clone())
                .chain(built.stage.as_ref().map(|_| format!("{name}{STAGE_SUFFIX}")))
                .chain(built.link.as_ref().map(|_| format!("{name}{LINK_SUFFIX}")))
                .chain(built.inline_top())
                .collect(),
            on_bus: built.buses.iter().map(Block::top).collect(),
            bus: built.buses.first().map(|block| block.bus().title()),
            files: files.iter().map(relative).collect(),
            has_inline: built.inline_top().is_some(),
            line: built.link.as_ref().map(|link| link.config().line()),
        }
    }
}

/// Reports which files of an earlier run were removed, and which of its evidence was kept.
pub(crate) fn tell(committed: &Committed, observer: &dyn Observer) {
    let note = |what: &str, files: &[String]| {
        if !files.is_empty() {
            observer.say(&format!("note: {what}: {}", files.join(", ")));
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
