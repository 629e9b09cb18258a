//! Mutants of the blocks: faults put into the emitted Verilog one by one, to see whether the checks notice.
//!
//! ```text
//!  block's modules ─► Yosys `mutate` ─► one netlist, its input `mutsel` chooses the mutant ─► Verilator
//!                                                                                                │
//!        the block's stimuli and model, as in the lock-step tests ─► every output, every clock ──┤
//!                                                                                                ▼
//!              survivors ─► block and mutant side by side ─► ABC: equivalent for ever? ─► else property file ─► fate
//! ```
//!
//! - A mutant is one bit at a port of one cell that is stuck at 0 or 1, inverted, or inverted where another bit of the port
//!   is 0 or 1. Yosys spreads the choice evenly over modules, cells, bits and source lines, by a seed.
//! - The netlist keeps the block's modules: a mutant in a module that a block has twice is in both, as a mistake in the
//!   source would be.
//! - All mutants of a block are one simulator; a run of stimuli and model is made once, and every mutant that still lives
//!   is compared with it, piece by piece. `mutsel` = 0 is the block itself, which must match to the end.
//! - *Equivalent* is a proof for all inputs and for ever, from power-up: no output tells the two apart. Block RAM is outside of
//!   the comparison: both must drive it equally, and read the same, whatever that is.
//! - What is not equivalent may still break a property of `testbench/formal`, where the block has a file there.
//! - The rest is *unknown*: each is listed. Where a search finds how to tell it from the block, the stimuli have a hole.

mod by_name;
mod equivalence;
mod inside;
mod mutant;
mod netlist;
mod properties;
mod simulation;
mod subject;
mod table;

pub use self::by_name::NamedMutant;
pub use self::inside::{Found, INSIDE, INSIDE_MARKS, hunt, inside_table};
pub use self::mutant::Mutant;
pub use self::simulation::{Kill, StimuliOf};
pub use self::subject::{Subject, all, named};
pub use self::table::{MARKS, MutationRow, merged, table};

use std::path::Path;
use std::time::Duration;

use self::netlist::Netlist;
use crate::Error;
use crate::netlist::EquivalenceVerdict;

/// How many mutants, and how hard each is tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MutationOptions {
    /// Mutants per block, at most: a small block may have fewer places for them.
    pub mutants: usize,
    /// Chooses them.
    pub seed: u64,
    /// Runs of stimuli, with the seeds 1, 2, …
    pub runs: u64,
    /// Clocks of each run.
    pub clocks: u64,
    /// Limit of each run of a prover.
    pub proof: Duration,
}

impl Default for MutationOptions {
    /// What `docs/verification.md` shows: a run of the blocks' lock-step tests.
    fn default() -> Self {
        Self {
            mutants: 60,
            seed: 1,
            runs: 1,
            clocks: 1_000_000,
            proof: Duration::from_secs(60),
        }
    }
}

/// What became of a mutant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fate {
    /// An output differed from the model's.
    Lockstep(Kill),
    /// A property no longer holds.
    Property(String),
    /// Nothing tells it from the block, proven.
    Equivalent,
    /// None of these.
    Unknown {
        /// Clocks after power-up after which some input tells it from the block, where the search found any.
        differs: Option<u32>,
    },
}

/// Puts mutants into a block and finds out what becomes of each. All files are in `folder`, which must be empty or absent.
///
/// # Errors
/// [`Error::ToolMissing`] without Yosys, its ABC or Verilator; [`Error::ToolFailed`] where one of them refuses the block;
/// [`Error::Unlike`] where the netlist without a mutant does not match the model; [`Error::File`] for the folder.
pub fn run(subject: &Subject, options: &MutationOptions, folder: &Path) -> Result<Vec<(Mutant, Fate)>, Error> {
    let block = subject.block();
    run_with(subject, options, folder, &mut |clocks, seed| {
        block.stimuli(clocks, seed)
    })
}

/// The same under other stimuli than the block's.
///
/// # Errors
/// As [`run`].
pub fn run_with<'a>(
    subject: &'a Subject,
    options: &MutationOptions,
    folder: &Path,
    stimuli: StimuliOf<'a, '_>,
) -> Result<Vec<(Mutant, Fate)>, Error> {
    let block = subject.block();
    let (modules, top) = (block.modules()?, block.top());
    let netlist = Netlist::read(&modules, &top, folder)?;
    let mutants = netlist.mutants(options.mutants, options.seed)?;
    let verilog = netlist.with_all(&mutants)?;
    let kills = simulation::run(block, &verilog, mutants.len(), options, stimuli)?;
    let fate = |(mutant, kill): (Mutant, Option<Kill>)| {
        let fate = match kill {
            Some(kill) => Fate::Lockstep(kill),
            None => survivor(subject, &netlist, &mutant, options)?,
        };
        Ok((mutant, fate))
    };
    mutants.into_iter().zip(kills).map(fate).collect()
}

/// Equivalent, broken by a property, or unknown.
fn survivor(
    subject: &Subject,
    netlist: &Netlist<'_>,
    mutant: &Mutant,
    options: &MutationOptions,
) -> Result<Fate, Error> {
    let differs = match equivalence::compare(netlist, mutant, options.proof)? {
        EquivalenceVerdict::Equivalent => return Ok(Fate::Equivalent),
        EquivalenceVerdict::Different { clock } => Some(clock),
        EquivalenceVerdict::Unknown => None,
    };
    let broken = properties::broken(subject, netlist, mutant, options.proof)?;
    Ok(broken.map_or(Fate::Unknown { differs }, Fate::Property))
}
