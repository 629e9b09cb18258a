//! `posicast generate --block NAME`: one block alone, for people who need just that, with a bench that any simulator runs, its proofs,
//! its datasheet, file lists, and its registers on three buses where it has any.
//!
//! ```text
//! rtl/*.v                          the block, and what it consists of
//! bench/TOP_bench.v, …_vectors.hex recorded clocks, and the bench that plays and compares them
//! formal/PROPERTIES_N/             a proof: Verilog, properties, scripts for Yosys
//! bus/avalon.f, axi.f, wishbone.f  the block behind registers, with its bridge: file lists of bus/*.v and rtl/*.v
//! docs/                            datasheets
//! filelist.f, TOP.qip, Makefile    for simulators, Quartus, and to run all of it
//! ```

use crate::Outcome;
use crate::bench;
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::generate::tell;
use crate::hardware::{Built, COMPONENT_SUFFIX};
use crate::machine::{self, of_hardware};
use crate::observer::Observer;
use crate::verilog;
use posicast_blocks::bus_component::BridgedBus;
use posicast_hdl::emit::{Module, add};
use posicast_machine::hardware;
use posicast_machine::spelling::choose_from;
use posicast_shaper::unit::short;
use posicast_synth::driver;
use posicast_synth::kit::{self, Kit};
use posicast_synth::package::Package;
use posicast_synth::{datasheets, register_documents};
use posicast_testbench::blocks::{Block, benches, library_sizes, proofs_of};
use posicast_testbench::bus_component::BusComponentBlock;
use posicast_testbench::cascade::CascadeBlock;
use posicast_testbench::component::ComponentBlock;
use posicast_testbench::formal;
use posicast_testbench::shaper::ShaperBlock;
use posicast_testbench::stage::StageBlock;
use posicast_testbench::vectors::{self, Vectors};
use posicast_testbench::wording::counted;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Clocks that the bench plays at the least.
const LEAST_CLOCKS: u64 = 20_000;
/// Clocks that it plays at the most: its file has a line for each.
const MOST_CLOCKS: u64 = 100_000;
/// Seed of the recorded stimuli.
const SEED: u64 = 1;
/// Time limit of a proof.
const PROOF: Duration = Duration::from_secs(600);
/// The blocks that are made of a machine, and are no block by themselves.
const WHOLES: [&str; 6] = [
    "component",
    "registers",
    "stage",
    "inline_shaper",
    "linked_inline_shaper",
    "bus_component",
];

/// Options of the kit.
#[derive(Debug, Clone)]
pub struct Options {
    /// Name of the block.
    pub block: String,
    /// The machine whose sizes and settings it has; `None`: those of the library.
    pub machine: Option<PathBuf>,
    /// Output folder: new, empty, or written by posicast before; `None`: the block's name.
    pub output: Option<PathBuf>,
}

/// The kit that was written.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "BlockKit")]
pub struct BlockDocument {
    /// Name of the block.
    pub block: String,
    /// Its size, or the axes that it is for.
    pub instance: String,
    /// Its top module.
    pub top: String,
    /// The output folder.
    pub folder: String,
    /// Clocks that the bench plays and compares.
    pub bench_clocks: u64,
    /// What these clocks do not exercise.
    pub not_exercised: Vec<String>,
    /// Number of proofs.
    pub proofs: usize,
    /// The top modules of the block with registers, one for each bus; none if it has no registers of its own.
    pub on_bus: Vec<String>,
    /// Paths in the folder.
    pub files: Vec<String>,
}

/// Writes the kit of a block into a folder.
///
/// # Errors
/// [`Failure`] for a block that does not exist, or that the machine does not have, and for files that cannot be read or written.
pub fn generate_block(options: &Options, observer: &dyn Observer) -> Result<Outcome<BlockDocument>, Failure> {
    let name = options.block.as_str();
    let Blocks { all, components, notes } = match &options.machine {
        Some(path) => of_machine(path, observer)?,
        None => of_library()?,
    };
    let block = chosen(all, name, options.machine.as_deref())?;
    let modules = block.modules().map_err(Failure::because)?;
    let top = block.top();
    let clocks = block.least_clocks().clamp(LEAST_CLOCKS, MOST_CLOCKS);
    let recorded = vectors::record(block.as_ref(), clocks, SEED).map_err(bench::failure)?;
    let component = components
        .into_iter()
        .find(|component| component.component().name() == name);

    let root = options.output.clone().unwrap_or_else(|| PathBuf::from(name));
    let mut package = Package::open(&root, name).map_err(Failure::because)?;
    let mut files: Vec<(String, String)> = modules
        .iter()
        .map(|module| (verilog::path(module), module.text.clone()))
        .collect();
    files.extend(lists(&top, &modules));
    files.push((format!("bench/{}.v", recorded.bench_name), recorded.bench.clone()));
    files.push((format!("bench/{}", recorded.vectors_name), recorded.vectors.clone()));
    let proofs = proofs(name)?;
    files.extend(proofs.iter().flat_map(|proof| proof.files.clone()));
    let buses = match &component {
        Some(component) => on_buses(component, &modules)?,
        None => Buses::default(),
    };
    files.extend(buses.files.clone());
    files.extend(datasheets::of_block(name, component.is_some()));
    files.push(("Makefile".to_owned(), makefile(&top, &recorded, &proofs)));
    files.push((
        "README.md".to_owned(),
        readme(
            (block.as_ref(), options.machine.is_some()),
            &recorded,
            (&proofs, &notes),
            &buses,
        ),
    ));
    for (path, text) in &files {
        package.add(path, text.as_bytes()).map_err(Failure::because)?;
    }
    let folder = package.root().to_owned();
    let committed = package.commit().map_err(Failure::because)?;
    tell(&committed, observer);
    let relative = |path: &PathBuf| path.strip_prefix(&folder).unwrap_or(path).display().to_string();
    Ok(Outcome::passed(BlockDocument {
        block: name.to_owned(),
        instance: block.instance().to_owned(),
        top,
        folder: folder.display().to_string(),
        bench_clocks: recorded.clocks,
        not_exercised: recorded.not_exercised,
        proofs: proofs.len(),
        on_bus: buses.tops,
        files: committed.files.iter().map(relative).collect(),
    }))
}

/// The blocks from which one is chosen.
struct Blocks {
    all: Vec<Box<dyn Block>>,
    components: Vec<ComponentBlock>,
    /// What is to be said of a block, by its name.
    notes: Vec<(&'static str, String)>,
}

/// The blocks of the library, and its components.
fn of_library() -> Result<Blocks, Failure> {
    let sizes = library_sizes().map_err(bench::failure)?;
    let all = benches(&sizes).map_err(bench::failure)?;
    Ok(Blocks {
        all,
        components: sizes.components,
        notes: Vec::new(),
    })
}

/// The blocks of a machine, each alone, and its components.
fn of_machine(path: &Path, observer: &dyn Observer) -> Result<Blocks, Failure> {
    let file = machine::read(path)?;
    let machine = &file.machine;
    let report = DesignReport::new(machine, path)?;
    let built = Built::new(&report, path, observer)?;
    let mut all: Vec<Box<dyn Block>> = Vec::new();
    for shaper in &built.shapers {
        let prefix = format!("{}_{}", machine.name, shaper.axis);
        if let Some(taps) = shaper.config.taps() {
            let block = ShaperBlock::new(taps.clone(), &prefix, &shaper.axis).map_err(bench::failure)?;
            all.push(Box::new(block));
        }
    }
    // Those of the components are made to stand alone; in a stage, some share what is outside of them.
    for component in &built.components {
        all.extend(component.inner().map_err(bench::failure)?);
    }
    let mut notes = Vec::new();
    for (index, axis) in machine.axes.iter().enumerate() {
        let found = hardware::cascade(machine, index).map_err(|error| of_hardware(&error, path))?;
        let Some(found) = found else { continue };
        all.push(Box::new(CascadeBlock::new(
            found.config,
            &format!("{}_{}", machine.name, axis.name),
        )));
        let modes = axis.modes.iter().zip(&found.residuals);
        let modes =
            modes.map(|(mode, residual)| format!("{:.3} % at {} Hz", 100.0 * residual, short(mode.mode.frequency_hz)));
        let text = format!(
            "The cascade of axis {}, whose delays are whole samples, leaves a residual vibration of {}.",
            axis.name,
            modes.collect::<Vec<_>>().join(", ")
        );
        notes.push(("cascade", text));
    }
    if let Some(stage) = &built.stage {
        let block = StageBlock::new(&stage.of_machine.config, &stage.block.top()).map_err(Failure::because)?;
        all.extend(block.with_prefix(&machine.name).inner().map_err(bench::failure)?);
    }
    if let Some(inline) = &built.inline {
        all.extend(inline.inner().map_err(bench::failure)?);
    }
    Ok(Blocks {
        all,
        components: built.components,
        notes,
    })
}

/// The block of this name, the first where a machine has several that differ.
fn chosen(all: Vec<Box<dyn Block>>, name: &str, machine: Option<&Path>) -> Result<Box<dyn Block>, Failure> {
    let mut names: Vec<String> = all.iter().map(|block| block.name().to_owned()).collect();
    names.retain(|name| !WHOLES.contains(&name.as_str()));
    names.sort_unstable();
    names.dedup();
    if let Some(block) = all
        .into_iter()
        .find(|block| block.name() == name && !WHOLES.contains(&name))
    {
        return Ok(block);
    }
    let whose = machine.map_or_else(|| "posicast".to_owned(), |path| path.display().to_string());
    let known: Vec<&str> = names.iter().map(String::as_str).collect();
    Err(Failure::input(format!("--block {name}: {whose} has no such block")).with_help(choose_from(name, &known)))
}

/// The lists of files for simulators and Quartus.
fn lists(top: &str, modules: &[Module]) -> Vec<(String, String)> {
    let files: Vec<String> = modules.iter().map(verilog::path).collect();
    kit::files(&Kit {
        machine: top,
        clock_hz: 0.0,
        sample_clocks: 0,
        command_fraction: 0,
        files: &files,
        shapers: &[],
    })
}

/// A proof of the kit.
struct Proof {
    folder: String,
    size: String,
    /// What can have any value in every clock.
    left_open: Vec<&'static str>,
    files: Vec<(String, String)>,
}

fn proofs(name: &str) -> Result<Vec<Proof>, Failure> {
    let tasks = proofs_of(name).map_err(bench::failure)?.into_iter();
    let proofs = tasks.enumerate().map(|(index, task)| {
        let folder = format!("formal/{}_{}", task.name, index + 1);
        let files = formal::files(&task, PROOF).into_iter();
        Proof {
            size: format!("{}, {}", task.name, task.size),
            left_open: task.left_open(),
            files: files.map(|(file, text)| (format!("{folder}/{file}"), text)).collect(),
            folder,
        }
    });
    Ok(proofs.collect())
}

/// A block behind registers on every bus.
#[derive(Default)]
struct Buses {
    /// Top modules: Avalon-MM, AXI4-Lite, Wishbone.
    tops: Vec<String>,
    files: Vec<(String, String)>,
}

fn on_buses(component: &ComponentBlock, alone: &[Module]) -> Result<Buses, Failure> {
    let of_component = component.component().clone();
    let bare = component.top();
    let mut all: Vec<Module> = Vec::new();
    let mut buses = Buses::default();
    let mut put = |list: &str, top: String, modules: Vec<Module>| -> Result<(), Failure> {
        let beside = |module: &Module| {
            alone
                .iter()
                .any(|own| own.name == module.name && own.text == module.text)
        };
        let path = |module: &Module| {
            if beside(module) {
                verilog::path(module)
            } else {
                format!("bus/{}.v", module.name)
            }
        };
        let files: String = modules.iter().map(|module| path(module) + "\n").collect();
        buses.files.push((format!("bus/{list}.f"), files));
        buses.tops.push(top);
        let own = modules.into_iter().filter(|module| !beside(module));
        add(&mut all, own.collect()).map_err(Failure::because)
    };
    put("avalon", bare.clone(), component.modules().map_err(Failure::because)?)?;
    for bus in [BridgedBus::AxiLite, BridgedBus::Wishbone { pipelined: false }] {
        let top = format!(
            "{}_{}",
            bare.strip_suffix(COMPONENT_SUFFIX).unwrap_or(&bare),
            bus.suffix()
        );
        let block = BusComponentBlock::new(of_component.clone(), bus, &[], [&top, &bare, component.prefix()]);
        put(bus.suffix(), top, block.modules().map_err(Failure::because)?)?;
    }
    let verilog = all
        .iter()
        .map(|module| (format!("bus/{}.v", module.name), module.text.clone()));
    buses.files.extend(verilog);
    let header = driver::component_header(&bare, of_component.map());
    buses.files.push((header.path, header.text));
    buses
        .files
        .extend(register_documents::files(&bare, &buses.tops, of_component.map()));
    Ok(buses)
}

fn makefile(top: &str, recorded: &Vectors, proofs: &[Proof]) -> String {
    let bench = &recorded.bench_name;
    let prove: String = proofs
        .iter()
        .map(|proof| format!("\tsh {}/prove.sh\n", proof.folder))
        .collect();
    let prove = if prove.is_empty() {
        String::new()
    } else {
        format!("\nprove:\n{prove}")
    };
    format!(
        "# make bench    plays the recorded clocks in Icarus Verilog; ends with PASS, or fails\n\
         # make lint     Verilator's warnings\n# make prove    the proofs, by Yosys\n\n\
         bench: bench/{bench}.vvp\n\tcd bench && vvp -N {bench}.vvp\n\n\
         bench/{bench}.vvp: bench/{bench}.v $(shell cat filelist.f)\n\
         \tiverilog -g2005 -s {bench} -o $@ -f filelist.f bench/{bench}.v\n\n\
         lint:\n\tverilator --lint-only -Wall --top-module {top} -f filelist.f\n{prove}\n.PHONY: bench lint prove\n"
    )
}

fn readme(
    (block, modules_are_named): (&dyn Block, bool),
    recorded: &Vectors,
    (proofs, notes): (&[Proof], &[(&str, String)]),
    buses: &Buses,
) -> String {
    let (name, top) = (block.name(), block.top());
    let datasheet = if datasheets::of_block(name, false).is_empty() {
        "It has no datasheet: it is part of others, and the head of its Verilog says what it does."
    } else {
        "Its datasheet is in `docs/`."
    };
    let mut text = format!(
        "# {name}\n\nThe block `{name}` of posicast {}, {}: Verilog-2001, top module `{top}`. {datasheet}\n\n\
         | where | what |\n|---|---|\n\
         | `rtl/` | the Verilog; `filelist.f` lists it for simulators, `{top}.qip` for Quartus |\n\
         | `bench/` | {} of stimuli and the outputs of the bit-exact model, and a bench that compares them in every clock: `make bench` |\n",
        env!("CARGO_PKG_VERSION"),
        block.instance(),
        counted(recorded.clocks, "clock"),
    );
    if !proofs.is_empty() {
        text.push_str("| `formal/` | proofs for every input, without a bound, by Yosys, about the copies of the Verilog there: `make prove` |\n");
    }
    if let [avalon, axi, wishbone] = buses.tops.as_slice() {
        let _ = writeln!(
            text,
            "| `bus/` | the block behind registers: `{avalon}` on Avalon-MM (`bus/avalon.f`), `{axi}` on AXI4-Lite (`bus/axi.f`), `{wishbone}` \
             on Wishbone (`bus/wishbone.f`); paths are from this folder. It may be built for more than `rtl/`, as for three channels in place of one, \
             and `make` does not look at it |\n| `driver/`, `docs/` | the registers as C header, SVD, SystemRDL and page |"
        );
    }
    text.push_str("\n`make lint` shows that Verilator has no warning.\n");
    if !modules_are_named {
        text.push_str(
            "\nThe names of the modules have no prefix. If they clash with others in your design, generate the block with a machine file: \
             its modules then begin with `posicast_` or the machine's name.\n",
        );
    }
    if let Some((_, note)) = notes.iter().find(|(of, _)| *of == name) {
        let _ = writeln!(text, "\n{note}");
    }
    if !recorded.not_exercised.is_empty() {
        let _ = write!(text, "\nThe recorded clocks do not exercise:\n\n");
        for what in &recorded.not_exercised {
            let _ = writeln!(text, "- {what}");
        }
    }
    if proofs.is_empty() {
        text.push_str("\nThere is no proof of this block alone.\n");
    } else {
        text.push_str("\n| proof | any value in every clock |\n|---|---|\n");
        for proof in proofs {
            let open = if proof.left_open.is_empty() {
                "inputs".to_owned()
            } else {
                format!("inputs, {}", proof.left_open.join(", "))
            };
            let _ = writeln!(text, "| `{}`: {} | {open} |", proof.folder, proof.size);
        }
        text.push_str("\nA proof is about the block at the size that its row names.\n");
    }
    if buses.tops.is_empty() {
        text.push_str("\nThe block has no registers of its own, so there is no `bus/`.\n");
    }
    text
}
