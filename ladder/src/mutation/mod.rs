//! Mutants of the blocks: faults put into the emitted Verilog one by one, to see whether the checks detect them.
//!
//! ```text
//!  block's modules ─► Yosys `mutate` ─► one netlist, its input `mutsel` chooses the mutant ─► Verilator
//!                                                                                                │
//!        the block's stimuli and model, as in the lock-step tests ─► every output, every clock ──┤
//!                                                                                                ▼
//!              survivors ─► block and mutant side by side ─► ABC: equivalent for ever? ─► else property file ─► fate
//! ```
//!
//! - A mutant is one bit at a port of one cell that is stuck at 0 or 1, inverted, or inverted where another bit of
//!   the port is 0 or 1. Yosys distributes the choice evenly over modules, cells, bits and source lines, by a seed.
//! - The netlist keeps the block's modules: a mutant in a module that a block contains twice is in both, as a mistake
//!   in the source would be.
//! - All mutants of a block are one simulator. A run of stimuli and model is made once, and every mutant that has not
//!   been detected yet is compared with it, piece by piece. `mutsel` = 0 is the block itself, which must match to the
//!   end.
//! - *Equivalent* is a proof for all inputs and without a bound, from power-up on: no output differs. Block RAM is
//!   outside the comparison: both must drive it equally, and read the same arbitrary data.
//! - A mutant that is not equivalent may still break a property, where the block has a file
//!   there.
//! - The rest is *unknown*, and each is listed. Where a search finds an input that distinguishes it from the block,
//!   the stimuli have a gap.

mod equivalence;
mod inside;
mod mutant;
mod netlist;
mod properties;
mod simulation;
mod subject;
mod table;
mod wires;

pub use self::inside::{Found, INSIDE, INSIDE_MARKS, hunt, inside_table};
pub use self::mutant::Mutant;
pub use self::simulation::{Kill, StimuliOf};
pub use self::subject::{Subject, all, named};
pub use self::table::{MARKS, MutationRow, merged, table, unknown_of, unlisted};
pub use self::wires::{
    STEPS_WIRES_MARKS, WIRES_MARKS, WireFate, WireKind, WireMutant, hunt_wires, wires, wires_table, with_wires,
};

use std::path::Path;
use std::time::Duration;

use self::equivalence::Comparison;
use self::netlist::Netlist;
use crate::netlist::EquivalenceVerdict;
use posicast_testbench::Error;

/// Number of mutants, and effort for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MutationOptions {
    /// Largest number of mutants per block: a small block may have fewer places for them.
    pub mutants: usize,
    /// Seed of the choice.
    pub seed: u64,
    /// Number of runs of stimuli, with the seeds 1, 2, …
    pub runs: u64,
    /// Number of clocks of each run.
    pub clocks: u64,
    /// Time limit of each run of a prover.
    pub proof: Duration,
}

impl Default for MutationOptions {
    /// The settings for `ladder/RESULTS.md`, which are those of the blocks' lock-step tests.
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

/// Result for a mutant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fate {
    /// An output differed from the model's.
    Lockstep(Kill),
    /// A property no longer holds.
    Property(String),
    /// It is proven equivalent to the block.
    Equivalent,
    /// Neither detected nor proven equivalent.
    Unknown {
        /// Number of clocks from power-up until some input distinguishes it from the block; `None` if the search
        /// found no such input.
        differs: Option<u32>,
    },
    /// Not detected by lock step, and among the mutants listed as unknown; it was not searched again. Its line in the list.
    Listed(String),
}

/// Puts mutants into a block and determines the result of each. All files are in `folder`, which must be empty or
/// absent.
///
/// # Errors
/// [`Error::ToolMissing`] without Yosys, its ABC or Verilator; [`Error::ToolFailed`] where one of them refuses the block;
/// [`Error::Unlike`] where the netlist without a mutant does not match the model; [`Error::File`] for the folder.
pub fn run(subject: &Subject, options: &MutationOptions, folder: &Path) -> Result<Vec<(Mutant, Fate)>, Error> {
    run_beside(subject, options, &[], folder)
}

/// Does the same, but takes a mutant that is among `listed` ([`unknown_of`]) as unknown without a search: the searches
/// in vain take most of the time.
///
/// # Errors
/// Those of [`run`].
pub fn run_beside(
    subject: &Subject,
    options: &MutationOptions,
    listed: &[String],
    folder: &Path,
) -> Result<Vec<(Mutant, Fate)>, Error> {
    let block = subject.block();
    run_with(subject, options, listed, folder, &mut |clocks, seed| {
        block.stimuli(clocks, seed)
    })
}

/// Does the same with other stimuli than the block's.
///
/// # Errors
/// Those of [`run`].
pub fn run_with<'a>(
    subject: &'a Subject,
    options: &MutationOptions,
    listed: &[String],
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
        let fate = match (kill, mutant.line_among(listed)) {
            (Some(kill), _) => Fate::Lockstep(kill),
            (None, Some(line)) => Fate::Listed(line.to_owned()),
            (None, None) => survivor(subject, &netlist, &mutant, options)?,
        };
        Ok((mutant, fate))
    };
    mutants.into_iter().zip(kills).map(fate).collect()
}

/// Determines whether a mutant is equivalent, broken by a property, or unknown.
fn survivor(
    subject: &Subject,
    netlist: &Netlist<'_>,
    mutant: &Mutant,
    options: &MutationOptions,
) -> Result<Fate, Error> {
    let mut comparison = Comparison::new(netlist, mutant, options.proof);
    if comparison.is_soon_proven()? {
        return Ok(Fate::Equivalent);
    }
    if let Some(property) = properties::broken(subject, netlist, mutant, options.proof)? {
        return Ok(Fate::Property(property));
    }
    Ok(match comparison.verdict()? {
        EquivalenceVerdict::Equivalent => Fate::Equivalent,
        EquivalenceVerdict::Different { clock } => Fate::Unknown { differs: Some(clock) },
        EquivalenceVerdict::Unknown => Fate::Unknown { differs: None },
    })
}
