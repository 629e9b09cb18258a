//! Compares a block's netlist, as a synthesiser wrote it, with the block, by simulation and by proof.
//!
//! ```text
//!  modules ─┬─ logic ─► synthesiser ─► netlist ─┬─► with models of its cells ─► Verilator, lock step with the model
//!           │                                   └─► ┐
//!           └─ memories, multipliers: kept ─────────┴─► RTL = netlist?  Yosys: miter ─► ABC: register correspondence, PDR
//! ```
//!
//! - Memories, ROMs and multipliers are modules of their own, which a device has as blocks. They are kept: the
//!   simulation uses them unchanged; the proof cuts them out, on both sides. Their outputs are then free, and their
//!   inputs are compared like outputs. Equal inputs give equal contents, so the proof holds for the whole.
//! - The proof is for all inputs in all clocks from power-up on, resets included, without a bound.
//! - An asynchronous clear counts as a synchronous one.
//! - The netlist is read from its text, so a changed table is detected.

use std::path::Path;
use std::time::{Duration, Instant};

use posicast_hdl::emit::Module;
use posicast_system::scratch;

use posicast_testbench::Error;
use posicast_testbench::blocks::{self, Block, Sources};
use posicast_testbench::lockstep::report::LockstepReport;

use crate::sides::Sides;

/// Length in clocks of the longest difference that is searched for: longer than a division.
const SEARCHED_CLOCKS: u32 = 150;

/// Whether two versions of a block are equivalent: its RTL and its netlist, or the block and a mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EquivalenceVerdict {
    /// They are equivalent, for all inputs and without a bound.
    Equivalent,
    /// Some input makes them differ in this clock after power-up, from 0.
    Different {
        /// Number of the clock.
        clock: u32,
    },
    /// Neither was found within the time limit.
    Unknown,
}

/// A block's Verilog, sorted by what is mapped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NetlistParts {
    /// Modules that are mapped to logic elements, the top among them.
    pub logic: Vec<Module>,
    /// Modules that are kept.
    pub kept: Vec<Module>,
}

impl NetlistParts {
    /// Sorts a block's modules; keeps memories and multipliers.
    pub fn of(modules: Vec<Module>) -> Self {
        Self::keeping(modules, |module| {
            module.has_memory() || module.text.contains(" <= a_q * b_q;")
        })
    }

    /// Sorts a block's modules; keeps memories, and maps multipliers to those of the device.
    pub fn with_multipliers_mapped(modules: Vec<Module>) -> Self {
        Self::keeping(modules, Module::has_memory)
    }

    fn keeping(modules: Vec<Module>, is_kept: impl Fn(&Module) -> bool) -> Self {
        let (kept, logic) = modules.into_iter().partition(is_kept);
        Self { logic, kept }
    }
}

/// A netlist, with models of its cells, and what it was made of.
#[derive(Debug, Clone, Copy)]
pub struct MappedParts<'a> {
    /// The block's modules.
    pub parts: &'a NetlistParts,
    /// The netlist of those that are mapped.
    pub netlist: &'a str,
}

/// Runs the netlist in lock step with the block's model.
///
/// # Errors
/// Those of [`Sources::verilated`] and [`blocks::check`].
pub fn simulate(block: &dyn Block, mapped: MappedParts<'_>, clocks: u64, seed: u64) -> Result<LockstepReport, Error> {
    let mut modules = mapped.parts.kept.clone();
    modules.push(Module {
        name: "netlist".to_owned(),
        text: mapped.netlist.to_owned(),
        ports: Vec::new(),
        clocked: true,
        notes: Vec::new(),
    });
    let sources = Sources::of_modules(&modules)?;
    let mut device = sources.verilated(block, seed)?;
    blocks::check(block, &mut device, clocks, seed, &mut |_| {})
}

/// Checks whether the netlist is equivalent to the RTL, with files in `folder`. Each of ABC's engines gets `limit`
/// of processor time.
///
/// # Errors
/// [`Error::ToolMissing`] without Yosys or its ABC; [`Error::ToolFailed`] where Yosys refuses RTL or netlist, for
/// example because only one of them has a port or kept module; [`Error::File`] for the files.
pub fn equivalent(
    top: &str,
    MappedParts { parts, netlist }: MappedParts<'_>,
    folder: &Path,
    limit: Duration,
) -> Result<EquivalenceVerdict, Error> {
    let sides = Sides::new(top, &parts.kept, folder)?;
    sides.write("netlist.v", netlist)?;
    let rtl = sides.write_modules(&parts.logic)?.join(" ");
    let script = format!(
        "{}{}design -copy-from gold -as gold gold\ndesign -copy-from gate -as gate gate\n\
         miter -equiv -flatten -make_assert gold gate miter\nhierarchy -top miter\nproc\nsetundef -undriven -zero\n\
         delete -output\nopt -fast\ntechmap\nopt -fast\ndffunmap\nabc -g AND -fast\nopt_clean\n\
         write_aiger -I -B -zinit -no-startoffset miter.aig\n",
        sides.side(&rtl, "gold"),
        sides.side("netlist.v", "gate")
    );
    let doing = ["joining RTL and netlist", "comparing RTL and netlist"];
    sides.decide(("miter", &script), SEARCHED_CLOCKS, limit, doing)
}

/// Result for a block.
#[derive(Debug, Clone)]
pub struct EquivalenceOutcome {
    /// Number of modules that the proof kept.
    pub kept: usize,
    /// Lock step of the netlist with the model; `None` if it was not simulated.
    pub simulated: Option<LockstepReport>,
    /// Equivalence of the netlist with the RTL.
    pub verdict: EquivalenceVerdict,
    /// Duration without the synthesis.
    pub time: Duration,
}

/// Simulates the netlist `simulated` for this many clocks (0: not at all), and proves the netlist `proven`. They are one,
/// or differ in what they keep.
///
/// # Errors
/// Those of [`simulate`] and [`equivalent`].
pub fn check(
    block: &dyn Block,
    simulated: MappedParts<'_>,
    proven: MappedParts<'_>,
    (clocks, seed): (u64, u64),
    limit: Duration,
) -> Result<EquivalenceOutcome, Error> {
    let start = Instant::now();
    let simulated = match clocks {
        0 => None,
        _ => Some(simulate(block, simulated, clocks, seed)?),
    };
    let temporary = std::env::temp_dir();
    let folder = scratch::Folder::new(scratch::PREFIX);
    let folder = folder.map_err(Error::file(&temporary, "create a folder in"))?;
    let verdict = equivalent(&block.top(), proven, folder.path(), limit)?;
    Ok(EquivalenceOutcome {
        kept: proven.parts.kept.len(),
        simulated,
        verdict,
        time: start.elapsed(),
    })
}
