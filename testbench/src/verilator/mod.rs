//! Turns Verilog into a running simulation: Verilator, a generated C++ harness, a shared object, `dlopen`.
//!
//! ```text
//!  files, top, ports ─► sha256 ─► in the cache? ──yes──────────────────────────┐
//!                                   └─no─► verilator --cc ─► ports compared ─► make ─► rename into the cache ─► load
//! ```
//!
//! - **Cache.** There is one shared object per content of the sources, ports, harness, Verilator version and flags,
//!   in `$POSICAST_CACHE`, else `$XDG_CACHE_HOME/posicast`, else `~/.cache/posicast`, else the temporary folder. It
//!   is built in a folder of its own and renamed when complete, so that parallel builds never see half a file, and
//!   under a lock, so that one builds it and the others wait. Every kept file has its checksum beside it, and is made
//!   anew where that does not fit, or where the system cannot load it. An object that was not used for 30 days is
//!   removed. Verilator's own C++ and its headers (50 MB) are compiled once and kept there too.
//! - **Random start.** Registers without a reset value and memories start with random contents, by the seed: a block
//!   that works only because a simulator clears its memory fails here.
//! - **Versions.** Debian's Verilator 5.006 and later. `$VERILATOR` names another executable.
//! - **Time.** A step sets `clk` low, applies the inputs, settles, reads the outputs, and sets `clk` high.
//! - `$display` goes to standard error; `$finish`, `$stop` and a loop that does not settle are a [`StepError`].

mod cache;
mod compiler;
mod dynamic;
mod harness;
mod runtime;
mod unity;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use posicast_blocks::{ClockedBlock, Direction, Port, StepError};
use posicast_system::{interrupt, kept, scratch};
use sha2::{Digest, Sha256};

use crate::Error;
use crate::error::MissingTool;
use crate::patience::Patience;
use crate::tool::{self, Tool, text};

const VERILATOR: Tool = Tool {
    name: "verilator",
    variable: "VERILATOR",
    purpose: "it simulates the Verilog",
    remedy: "Install it (Debian: apt-get install verilator), or choose another simulator with --simulator",
};
const MAKE: Tool = Tool {
    name: "make",
    variable: "MAKE",
    purpose: "it compiles Verilator's output",
    remedy: "Install it together with a C++ compiler (Debian: apt-get install make g++)",
};
/// More optimisation of what runs in every clock takes longer than a million clocks win back.
const MAKE_FLAGS: [&str; 3] = ["OPT_FAST=-O1", "OPT_SLOW=-O0", "OPT_GLOBAL=-O1"];
/// Arguments of `verilator --cc`. `--no-gnu-unique` keeps the statics of two loaded simulations apart.
const FLAGS: [&str; 12] = [
    "--cc",
    "--exe",
    "-Wno-fatal",
    "-Wno-lint",
    "--x-initial",
    "unique",
    "--prefix",
    harness::CLASS,
    "-CFLAGS",
    "-fPIC -fno-gnu-unique -Wno-attributes",
    "-LDFLAGS",
    "-shared -Wl,-Bsymbolic",
];

/// Exit status of a process whose simulation does not come back: that of bad input, here of its Verilog.
const NO_ANSWER_STATUS: i32 = 2;

/// Additional flags for a simulation that counts lines, toggles and `cover` statements. Buses with more bits than given here are not
/// counted.
const COVERAGE_FLAGS: [&str; 5] = [
    "--coverage-line",
    "--coverage-toggle",
    "--coverage-user",
    "--coverage-max-width",
    "1024",
];

/// Verilog to simulate.
#[derive(Debug, Clone)]
pub struct VerilogSource<'a> {
    /// The Verilog files, in any order.
    pub files: &'a [PathBuf],
    /// Name of the top module; it has a port `clk`.
    pub top: &'a str,
    /// All other ports, which must be exactly those of the Verilog.
    pub ports: &'a [Port],
}

/// A simulated Verilog module.
#[derive(Debug)]
pub struct Verilated {
    ports: Vec<Port>,
    patience: Patience,
    simulation: dynamic::Simulation,
}

impl Verilated {
    /// Builds the module, or takes it from the cache, and starts it. Equal seeds give equal runs.
    ///
    /// # Errors
    /// [`Error::ToolMissing`] without Verilator, make or a compiler; [`Error::ToolFailed`] where one of them refuses the
    /// Verilog; [`Error::Ports`] where the ports are not the expected ones; [`Error::File`] for files and cache.
    pub fn build(source: &VerilogSource<'_>, seed: u64) -> Result<Self, Error> {
        Self::build_in(&kept::folder(), source, seed)
    }

    /// Builds the module as [`Verilated::build`] does, with counters for its lines and nets; it is several times
    /// slower.
    ///
    /// # Errors
    /// Those of [`Verilated::build`].
    pub fn counting(source: &VerilogSource<'_>, seed: u64) -> Result<Self, Error> {
        Self::build_with(&kept::folder(), source, seed, true)
    }

    /// Builds the module with another cache folder.
    ///
    /// # Errors
    /// Those of [`Verilated::build`].
    pub fn build_in(cache: &Path, source: &VerilogSource<'_>, seed: u64) -> Result<Self, Error> {
        Self::build_with(cache, source, seed, false)
    }

    fn build_with(cache: &Path, source: &VerilogSource<'_>, seed: u64, counts: bool) -> Result<Self, Error> {
        if let Some(port) = source.ports.iter().find(|p| !(1..=64).contains(&p.width)) {
            return Err(Error::Unlike(format!(
                "port `{}` has {} bits; a port has 1 to 64",
                port.name, port.width
            )));
        }
        let count = |direction| source.ports.iter().filter(|p| p.direction == direction).count();
        let numbers = [count(Direction::Input), count(Direction::Output)];
        let build = Build::new(cache, source, counts)?;
        let object = build.object(Kept::IfItFits)?;
        let simulation = match dynamic::Simulation::load(&object, seed, numbers) {
            // It fits its checksum, but not this system: another one may use the same cache.
            Err(Error::Load { .. }) => dynamic::Simulation::load(&build.object(Kept::Never)?, seed, numbers)?,
            other => other?,
        };
        let limit = tool::answer_limit();
        let said = format!(
            "error: the simulation of `{}` did not come back from a clock for {} s: the Verilog loops without end, or {} is too short",
            source.top,
            limit.as_secs(),
            tool::LIMIT_VARIABLE
        );
        Ok(Self {
            ports: source.ports.to_vec(),
            // A call into the simulation cannot be ended from outside: only the whole process can.
            patience: Patience::new(limit, move || interrupt::give_up(&said, NO_ANSWER_STATUS)),
            simulation,
        })
    }

    /// Simulates many clocks at once: `inputs` and `outputs` have one row per clock, one after the other.
    ///
    /// # Errors
    /// [`StepError`] where the Verilog stops the simulation, or if the lengths are not equal numbers of whole rows.
    pub fn run(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        self.patience.during(|| self.simulation.run(inputs, outputs))
    }

    /// Simulates clocks with the same inputs up to the first one in which an output is not `expected`, or `clocks` of them. Returns how
    /// many were as expected, also where the Verilog stops the simulation; `outputs` are those of the one that was not.
    pub(crate) fn hold(
        &mut self,
        inputs: &[u64],
        expected: &[u64],
        clocks: u64,
        outputs: &mut [u64],
    ) -> (u64, Result<(), StepError>) {
        self.patience
            .during(|| self.simulation.hold(inputs, expected, clocks, outputs))
    }

    /// Writes the counts since the start into a file, in the format of `verilator_coverage`.
    ///
    /// # Errors
    /// [`StepError`] if it was not built by [`Verilated::counting`], or the file cannot be written.
    pub fn write_coverage(&mut self, path: &Path) -> Result<(), StepError> {
        self.simulation.write_coverage(path)
    }
}

impl ClockedBlock for Verilated {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        self.run(inputs, outputs)
    }
}

/// Returns the warnings of Verilator's `--lint-only -Wall` about the files.
///
/// # Errors
/// [`Error::ToolMissing`] without Verilator.
pub fn lint(files: &[PathBuf], top: &str) -> Result<Vec<String>, Error> {
    warnings(files, &["--top-module", top])
}

/// Returns the warnings of [`lint`] with each module as the top that no other contains, in one run.
///
/// # Errors
/// [`Error::ToolMissing`] without Verilator.
pub fn lint_all(files: &[PathBuf]) -> Result<Vec<String>, Error> {
    warnings(files, &["-Wno-MULTITOP"])
}

fn warnings(files: &[PathBuf], tops: &[&str]) -> Result<Vec<String>, Error> {
    let mut command = VERILATOR.command();
    command.args(["--lint-only", "-Wall"]).args(tops).args(files);
    let output = VERILATOR.output(&mut command, "checking the Verilog")?;
    let said: Vec<String> = text(&output).lines().map(str::to_owned).collect();
    if said.is_empty() && !output.status.success() {
        return Err(VERILATOR.failed("checking the Verilog", output.status.to_string(), ""));
    }
    Ok(said)
}

/// Version line of the installed Verilator, which is determined once per process.
///
/// # Errors
/// [`Error::ToolMissing`] without Verilator, which is a cheap check before a long job.
pub fn version() -> Result<&'static str, Error> {
    static VERSION: OnceLock<String> = OnceLock::new();
    if let Some(version) = VERSION.get() {
        return Ok(version);
    }
    let output = VERILATOR.answer(VERILATOR.command().arg("--version"), "telling its version")?;
    Ok(VERSION.get_or_init(|| text(&output).trim().to_owned()))
}

/// Whether a simulation of this source is kept, so that nothing but Verilator, for its version, is needed to run it.
///
/// # Errors
/// [`Error::ToolMissing`] without Verilator, the error of one that does not start, or that of a file that cannot be read.
pub fn is_built(source: &VerilogSource<'_>) -> Result<bool, Error> {
    Ok(Build::new(&kept::folder(), source, false)?.is_held())
}

/// Returns the tools that building a simulation needs and that are not installed.
pub fn missing_tools() -> Vec<MissingTool> {
    let tools = [VERILATOR, MAKE].iter().filter_map(Tool::missing);
    tools.chain(compiler::of_verilator().missing()).collect()
}

/// When a kept simulation is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kept {
    /// If its checksum fits.
    IfItFits,
    /// Never: it is built again.
    Never,
}

/// A source that is to be built.
struct Build<'a> {
    folder: &'a Path,
    source: &'a VerilogSource<'a>,
    counts: bool,
    contents: Vec<(PathBuf, Vec<u8>)>,
    object: PathBuf,
}

impl<'a> Build<'a> {
    fn new(folder: &'a Path, source: &'a VerilogSource<'a>, counts: bool) -> Result<Self, Error> {
        let mut contents = Vec::with_capacity(source.files.len());
        for file in source.files {
            let text = std::fs::read(file).map_err(Error::file(file, "read the Verilog"))?;
            let path = std::path::absolute(file).map_err(Error::file(file, "find"))?;
            contents.push((path, text));
        }
        let hash = content_hash(source, &contents, version()?, counts);
        Ok(Self {
            folder,
            source,
            counts,
            contents,
            object: folder.join(format!("verilator-{hash}.so")),
        })
    }

    fn is_held(&self) -> bool {
        kept::holds(&self.object)
    }

    /// Path of the built simulation, which is built if it is not kept, or if what is kept does not fit.
    fn object(&self, kept: Kept) -> Result<PathBuf, Error> {
        if kept == Kept::IfItFits && self.is_held() {
            return Ok(self.object.clone());
        }
        let folder = self.folder;
        std::fs::create_dir_all(folder).map_err(Error::file(folder, "create the cache folder"))?;
        cache::tidy(folder);
        // Another process may be building the same: it is then waited for.
        let _lock = cache::Lock::wait_for(&self.object);
        if kept == Kept::IfItFits && self.is_held() {
            return Ok(self.object.clone());
        }
        let work = scratch::Folder::new_in(cache::BUILD_PREFIX, folder)
            .map_err(Error::file(folder, "create a folder to build in"))?;
        compile(&work, self)?;
        kept::keep(&work.path().join("simulation.so"), &self.object)
            .map_err(Error::file(&self.object, "put the simulation into the cache"))?;
        Ok(self.object.clone())
    }
}

/// Builds `simulation.so` in the folder `work`.
fn compile(work: &scratch::Folder, build: &Build<'_>) -> Result<(), Error> {
    let Build {
        folder,
        source,
        counts,
        contents,
        ..
    } = build;
    let counts = *counts;
    let write = |name: &str, text: &str| {
        let path = work.path().join(name);
        std::fs::write(&path, text).map_err(Error::file(&path, "write"))
    };
    write("harness.cpp", "")?;
    write("harness_print.h", harness::PRINT)?;
    write("harness_headers.h", harness::HEADERS)?;
    write("simulation.mk", harness::MAKEFILE)?;
    let mut verilate = VERILATOR.command_in(work.path());
    verilate
        .args(FLAGS)
        .args(coverage_flags(counts))
        .args(["-o", "simulation.so", "--Mdir", ".", "--top-module", source.top])
        .args(contents.iter().map(|(path, _)| path))
        .arg("harness.cpp");
    VERILATOR.run(&mut verilate, "translating the Verilog")?;

    let header = work.path().join(format!("{}.h", harness::CLASS));
    let header = std::fs::read_to_string(&header).map_err(Error::file(&header, "read Verilator's output"))?;
    let members = harness::members(source, &harness::declared_ports(&header))?;
    let coverage = if counts { harness::COVERAGE } else { "" };
    let classes = unity::Classes::of(work.path()).map_err(Error::file(work.path(), "list Verilator's output"))?;
    let harness = harness::source_text(source.ports, &members) + coverage;
    write("harness.cpp", &(harness + &classes.includes()))?;
    let runtime = runtime::Runtime::new(folder, &runtime_hash(version()?, counts));
    runtime.lend(work.path());
    let mut make = MAKE.command_in(work.path());
    make.args(["-s", "-f", "simulation.mk"])
        .args(MAKE_FLAGS)
        .args(unity::MAKE_VARIABLES);
    // A make that runs this process may have set these; they would change flags, or claim its job slots.
    make.env_remove("MAKEFLAGS")
        .env_remove("MAKELEVEL")
        .env_remove("MFLAGS");
    MAKE.run(&mut make, "compiling the simulation")?;
    runtime
        .keep(work.path())
        .map_err(Error::file(folder, "put Verilator's own objects into the cache"))
}

fn coverage_flags(counts: bool) -> &'static [&'static str] {
    if counts { &COVERAGE_FLAGS } else { &[] }
}

/// Hash of everything on which the shared object depends.
fn content_hash(source: &VerilogSource<'_>, contents: &[(PathBuf, Vec<u8>)], version: &str, counts: bool) -> String {
    let mut hash = ContentHash::of_tools(version, counts);
    hash.add(harness::TEMPLATE.as_bytes());
    if counts {
        hash.add(harness::COVERAGE.as_bytes());
    }
    hash.add(source.top.as_bytes());
    for port in source.ports {
        hash.add(port.name.as_bytes());
        hash.add(&[u8::from(port.direction == Direction::Input), port.width as u8]);
    }
    for (_, text) in contents {
        hash.add(text);
    }
    hash.text()
}

/// Hash of everything on which Verilator's own objects depend.
fn runtime_hash(version: &str, counts: bool) -> String {
    ContentHash::of_tools(version, counts).text()
}

struct ContentHash(Sha256);

impl ContentHash {
    /// Hashes version, flags, makefile, and the files that every C++ file includes.
    fn of_tools(version: &str, counts: bool) -> Self {
        let mut hash = Self(Sha256::new());
        hash.add(version.as_bytes());
        // Machines of several kinds may share the cache.
        hash.add(std::env::consts::ARCH.as_bytes());
        for text in [harness::PRINT, harness::HEADERS, harness::MAKEFILE] {
            hash.add(text.as_bytes());
        }
        for flag in FLAGS.iter().chain(&MAKE_FLAGS).chain(coverage_flags(counts)) {
            hash.add(flag.as_bytes());
        }
        hash
    }

    /// The length is hashed too, so that inputs cannot run into each other.
    fn add(&mut self, bytes: &[u8]) {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    fn text(self) -> String {
        let bytes = self.0.finalize();
        bytes.iter().take(16).map(|byte| format!("{byte:02x}")).collect()
    }
}
