//! `posicast bitstream`: builds a bitstream of a machine's shapers for a board by open tools, reads it back from its bits, and compares
//! what they are with the router's result and with the bit-exact model.

mod document;
mod machine;

use self::document::Evidence;
pub use self::document::{CheckDocument, Document};
use crate::Outcome;
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::generate::{self, open, tell};
use crate::hardware::Built;
use crate::kit;
use crate::observer::Observer;
use crate::sopc;
use crate::text::json_text;
use crate::verilog;
use posicast_bitstream::BitstreamError;
use posicast_bitstream::behaviour::{self, BehaviourReport};
pub use posicast_bitstream::boards::names as board_names;
use posicast_bitstream::boards::{self, FpgaBoard};
use posicast_bitstream::flips::{self, FaultFree, FlipReport};
use posicast_bitstream::network::Network;
use posicast_bitstream::toolchain::{self, Toolchain};
use posicast_bitstream::top::{BoardTop, TopAxis};
use posicast_synth::package::Package;
use std::path::{Path, PathBuf};
use std::thread;

/// Clocks of the lock step by default, unless exercising every tap takes more.
pub const CLOCKS: u64 = 2_000_000;
/// Largest number of clocks of a flip's lock step, unless exercising every tap takes more.
const FLIP_CLOCKS: u64 = 300_000;
/// Folder of the files of a board, in the output folder.
const FOLDER: &str = "bitstream";

/// Options of a bitstream.
#[derive(Debug, Clone)]
pub struct Options {
    /// Machine file.
    pub machine: PathBuf,
    /// Name of the board.
    pub board: String,
    /// Output folder: new, empty, or written by posicast before; `None`: the machine's name.
    pub output: Option<PathBuf>,
    /// Clocks of the lock step; `None`: [`CLOCKS`], and more if exercising every tap takes more.
    pub clocks: Option<u64>,
    /// Seed of the random commands.
    pub seed: u64,
}

/// Builds a bitstream, reads it back, and compares it. The files are written only if every check holds.
///
/// # Errors
/// [`Failure`] for a machine, a board or a folder that cannot be used, and for a missing tool. A check that fails is not an error but
/// gives [`Outcome::failed`].
pub fn bitstream(options: &Options, observer: &dyn Observer) -> Result<Outcome<Document>, Failure> {
    let path = options.machine.as_path();
    let board = boards::board(&options.board).map_err(failure)?;
    let file = self::machine::on_board(path, &board)?;
    let tools = toolchain::installed(&board).map_err(failure)?;
    let report = DesignReport::new(&file.machine, path)?;
    report.warn(observer);
    let built = Built::new(&report, path, observer)?;
    let top = self::top(&file.machine, &board, &built).map_err(|error| failure(error).in_file(path))?;
    let quartus = sopc::board(&file.machine, path)?;
    let mut package = open(options.output.as_deref(), &file)?;
    let modules = built.modules(path)?;
    let (mut files, scratch) = verilog::write_scratch(&modules)?;
    let of_kit = kit::files(&file.machine, &modules, &built);
    let needed = ["strobe", "example"].map(|part| format!("kit/{}_{part}.v", file.machine.name));
    let joined = of_kit
        .into_iter()
        .filter(|(name, _)| needed.contains(name))
        .map(|(_, text)| text);
    for (index, text) in joined.chain([top.verilog()]).enumerate() {
        let path = scratch.path().join(format!("top_{index}.v"));
        std::fs::write(&path, text).map_err(Failure::of_file(&path, "write it"))?;
        files.push(path);
    }
    let evidence = evidence(&top, &files, (tools.as_ref(), scratch.path()), options, observer).map_err(failure)?;
    let mut document = Document::new(&top, &file.machine, &evidence);
    let failed = document.failed();
    if failed.is_none() {
        generate::add(&mut package, (&file, path), &built, quartus, observer)?;
        add(&mut package, &top, &evidence, &document)?;
        let root = package.root().to_owned();
        let committed = package.commit().map_err(Failure::because)?;
        tell(&committed, observer);
        document.written(&root, FOLDER, &committed.files);
    }
    Ok(Outcome {
        failed,
        ..Outcome::passed(document)
    })
}

/// The top of a machine on a board.
fn top(
    machine: &posicast_machine::machine_file::Machine,
    board: &FpgaBoard,
    built: &Built<'_>,
) -> Result<BoardTop, BitstreamError> {
    let axes = built.shapers.iter().map(|shaper| TopAxis {
        name: shaper.axis.clone(),
        config: shaper.config.clone(),
    });
    BoardTop::new(&machine.name, *board, machine.clock.clocks_per_sample(), axes.collect())
}

/// Builds the bitstream of these files, reads it back, and compares it.
fn evidence(
    top: &BoardTop,
    files: &[PathBuf],
    (tools, scratch): (&dyn Toolchain, &Path),
    options: &Options,
    observer: &dyn Observer,
) -> Result<Evidence, BitstreamError> {
    let board = top.board();
    let during = |what: &str| observer.begin(what, None);
    let versions = tools.versions(scratch)?;
    let synthesised = {
        let _shown = during("Yosys synthesises");
        tools.synthesise(files, &top.module(), scratch)?
    };
    synthesised.check_fit(board)?;
    let routed = {
        let _shown = during("nextpnr places and routes");
        tools.place_and_route(&top.constraints(), scratch)?
    };
    let (packed, text, netlist, tiles) = {
        let _shown = during("reading the bits back");
        let packed = tools.pack(&routed.text, scratch)?;
        let text = tools.unpack(&packed, scratch)?;
        let netlist = tools.decode(&text, scratch)?;
        let tiles = tools.compare_tiles(&routed, &packed, &text, scratch)?;
        (packed, text, netlist, tiles)
    };
    let cells = netlist.compare_cells(&routed.netlist)?;
    let network = netlist.network();
    let fault_free = FaultFree {
        routed: &routed,
        packed: &packed,
        text: &text,
        netlist: netlist.as_ref(),
        network: &network,
        top,
    };
    let least = behaviour::least_clocks(top);
    // Decoding the flips takes as long as the lock step, and neither needs the other.
    let (lock_step, flips) = thread::scope(|scope| {
        let flips = scope.spawn(|| flips(&fault_free, (tools, scratch), FLIP_CLOCKS.max(least), observer));
        let clocks = options.clocks.unwrap_or(CLOCKS.max(least));
        let lock_step = lock_step(&network, top, (clocks, options.seed), observer);
        (lock_step, flips.join())
    });
    Ok(Evidence {
        versions,
        highest_mhz: routed.highest_mhz,
        tiles,
        cells,
        lock_step: lock_step?,
        flips: flips.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?,
        packed,
        verilog: netlist.verilog(&format!("{}_netlist", top.module())),
        seed: options.seed,
    })
}

fn lock_step(
    network: &Network,
    top: &BoardTop,
    (clocks, seed): (u64, u64),
    observer: &dyn Observer,
) -> Result<BehaviourReport, BitstreamError> {
    let bar = observer.begin("lock step of the bits with the model", Some(clocks));
    behaviour::compare(network, top, (clocks, seed), &mut |done| bar.reach(done))
}

fn flips(
    fault_free: &FaultFree<'_>,
    tools: (&dyn Toolchain, &Path),
    clocks: u64,
    observer: &dyn Observer,
) -> Result<Vec<FlipReport>, BitstreamError> {
    let bar = observer.begin("single faults in the bits", None);
    flips::flips(fault_free, tools, clocks, &|kind| {
        bar.rename(&format!("a fault in the bits: {}", kind.word()));
    })
}

/// Adds the board's files to the folder.
fn add(package: &mut Package, top: &BoardTop, evidence: &Evidence, document: &Document) -> Result<(), Failure> {
    let module = top.module();
    let family = top.board().device.family();
    let mut texts = vec![
        (format!("{module}.v"), top.verilog()),
        (format!("{module}.{}", family.constraints_ending()), top.constraints()),
        (format!("{module}.json"), json_text(document)?),
    ];
    texts.extend(evidence.verilog.iter().cloned());
    for (name, text) in texts {
        package
            .add(&format!("{FOLDER}/{name}"), text.as_bytes())
            .map_err(Failure::because)?;
    }
    package
        .add(
            &format!("{FOLDER}/{module}.{}", family.bitstream_ending()),
            &evidence.packed,
        )
        .map_err(Failure::because)
}

fn failure(error: BitstreamError) -> Failure {
    match error {
        BitstreamError::Missing(_) => Failure::missing_tool(error),
        other => Failure::because(other),
    }
}
