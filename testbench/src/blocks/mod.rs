//! One bench per hardware block, for `posicast verify`, the lock-step tests and the benchmarks.
//!
//! A [`Block`] is a hardware block at one size, with everything that a comparison needs: its Verilog, its bit-exact
//! model, its RustHDL simulation, its stimuli, and the cases that these are expected to reach. To try one:
//!
//! ```no_run
//! use posicast_testbench::blocks::{self, Block, Sources};
//! use posicast_testbench::pulse_counter::PulseCounterBlock;
//!
//! let block = PulseCounterBlock::new("", "all axes");
//! let sources = Sources::write(&block)?;
//! let mut device = sources.verilated(&block, 1)?;
//! let run = blocks::compare(&block, &mut device, 1_000_000, 1, &mut |_| {})?;
//! assert_eq!(run.report.mismatches(), 0);
//! assert!(run.coverage.iter().all(|(_, count)| *count > 0), "{:?}", run.coverage);
//! # Ok::<(), posicast_testbench::Error>(())
//! ```
//!
//! A new block has a folder beside this one, with its [`Block`] and its row of the registry, from which all rungs take it.

pub(crate) mod changes;
pub(crate) mod inside;
pub(crate) mod levels;
pub(crate) mod library;
pub(crate) mod reached;
pub(crate) mod registry;
mod sources;
mod trials;

pub use self::library::{library, library_named, library_sizes};
pub use self::reached::{Reach, ReachedCount};
pub use self::registry::{
    AreaBudget, AreaRow, BenchSizes, SmallBench, areas, benches, proofs, proofs_by_block, proofs_named, proofs_of,
    small_benches,
};
pub use self::sources::{Sources, rusthdl};
pub use self::trials::{BlockMutant, BlockTrials, ProofMutant, Trial, trials};

use posicast_blocks::{ClockedBlock, Port};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};

use std::ops::{ControlFlow, RangeInclusive};

use self::reached::AtThePorts;
use crate::Error;
use crate::lockstep::report::LockstepReport;
use crate::lockstep::{self, Clock, Device, Instance, LockstepOptions};
use crate::stimuli::Stimuli;

/// Number of clocks after which [`judge`] checks again what is still missing.
const LOOK_CLOCKS: u64 = 1 << 10;

/// A hardware block at one size. It can be shared between threads; models, devices and stimuli belong to one thread.
pub trait Block: Send + Sync {
    /// Returns its name, as in `model/blocks/src/` and `docs/`.
    fn name(&self) -> &str;

    /// Returns what distinguishes it from others of its kind: the axes that it serves, or its size.
    fn instance(&self) -> &str;

    /// Returns its Verilog modules, the top last.
    ///
    /// # Errors
    /// [`EmitError`] if names with its prefix are not valid in Verilog.
    fn modules(&self) -> Result<Vec<Module>, EmitError>;

    /// Returns the name of the top module.
    fn top(&self) -> String;

    /// Returns the Verilog that this row simulates, made from the files `sources`; by default they are not changed.
    ///
    /// # Errors
    /// [`Error::File`] if a file cannot be read or written.
    fn adapted(&self, sources: Sources) -> Result<Sources, Error> {
        Ok(sources)
    }

    /// Creates the bit-exact model. The initial contents of memories depend on the seed.
    fn model(&self, seed: u64) -> Box<dyn ClockedBlock>;

    /// Creates the block in RustHDL's simulator.
    ///
    /// # Errors
    /// [`SimulationError`] if RustHDL finds a fault in the block, or if [`Self::in_rusthdl`] is false.
    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError>;

    /// Returns the sizes at which RustHDL's simulator runs the block, in words, if they differ from its own. Outputs
    /// are equal.
    fn simulated_as(&self) -> Option<String> {
        None
    }

    /// Returns whether the whole block is written in RustHDL. Register banks are not, and therefore no component is.
    fn in_rusthdl(&self) -> bool {
        true
    }

    /// Returns inputs for a run of `cycles` clocks: directed cases if there are any, then random ones from the seed.
    fn stimuli(&self, cycles: u64, seed: u64) -> Box<dyn Stimuli + '_>;

    /// Creates the counters of the cases that a run reaches.
    fn coverage(&self) -> Box<dyn Bins + '_>;

    /// Returns the number of clocks after which the stimuli have exercised everything that [`Self::exercise`] requires;
    /// 0 if that is nothing.
    fn least_clocks(&self) -> u64 {
        0
    }

    /// Returns what a run must exercise before it counts as a check of the block: both levels of every flag, by
    /// default.
    fn exercise(&self) -> Option<Box<dyn Exercise + '_>> {
        let model = self.model(0);
        Some(Box::new(levels::Levels::new(
            self.instance(),
            model.ports(),
            &self.fixed(),
        )))
    }

    /// Creates the counters of what a run reaches, with the bars of a verdict.
    fn reach(&self) -> Box<dyn Reach + '_> {
        let model = self.model(0);
        Box::new(AtThePorts::new(self.instance(), "", model.ports(), None))
    }

    /// Returns the output flags that cannot change as the block is built, each with the reason.
    fn fixed(&self) -> Vec<(String, &'static str)> {
        Vec::new()
    }

    /// Returns a testbench for asynchronous paths, and the name of its top module; see [`crate::asynchronous`].
    fn asynchronous(&self) -> Option<(String, &'static str)> {
        None
    }

    /// Returns the entries of the report: one for all outputs, unless one top contains several blocks side by side.
    fn instances(&self, ports: &[Port]) -> Vec<Instance> {
        vec![Instance::whole(self.name(), self.instance(), ports)]
    }
}

/// Counts the cases that a run reaches, by name.
pub trait Bins {
    /// Adds a clock.
    fn observe(&mut self, clock: &Clock<'_>);

    /// Returns names and counts. A bin at 0 after a long run is a gap in the stimuli.
    fn counts(&self) -> Vec<(String, u64)>;
}

/// Records whether a run exercises what it must.
pub trait Exercise {
    /// Adds a clock.
    fn observe(&mut self, clock: &Clock<'_>);

    /// Returns what was not exercised yet: the instance of its row, and a description.
    fn missing(&self) -> Vec<(String, String)>;

    /// Returns bits of words that never changed, for the reader; they do not affect the verdict.
    fn unchanged(&self) -> Vec<(String, String)> {
        Vec::new()
    }
}

/// Result of a lock step, and the cases that it reached.
#[derive(Debug, Clone)]
pub struct Run {
    /// The comparison.
    pub report: LockstepReport,
    /// Names and counts of the cases reached.
    pub coverage: Vec<(String, u64)>,
}

impl Run {
    /// Returns the bins with counts below `least`.
    pub fn rare(&self, least: u64) -> Vec<&str> {
        let rare = self.coverage.iter().filter(|(_, count)| *count < least);
        rare.map(|(name, _)| name.as_str()).collect()
    }
}

/// Runs a block's model and a device with the block's stimuli, compares every output in every clock, and counts the
/// cases that the run reaches. `progress` is called with the number of clocks so far.
///
/// # Errors
/// As [`lockstep::run`].
pub fn compare(
    block: &dyn Block,
    device: &mut dyn Device,
    cycles: u64,
    seed: u64,
    progress: &mut dyn FnMut(u64),
) -> Result<Run, Error> {
    let mut stimuli = block.stimuli(cycles, seed);
    compare_with(block, device, stimuli.as_mut(), cycles, seed, progress)
}

/// As [`compare`], with other stimuli.
///
/// # Errors
/// As [`lockstep::run`].
pub fn compare_with(
    block: &dyn Block,
    device: &mut dyn Device,
    stimuli: &mut dyn Stimuli,
    cycles: u64,
    seed: u64,
    progress: &mut dyn FnMut(u64),
) -> Result<Run, Error> {
    let mut coverage = block.coverage();
    let mut watch = |clock: &Clock<'_>| {
        coverage.observe(clock);
        ControlFlow::Continue(())
    };
    let report = run(block, device, stimuli, (cycles, seed), &mut watch, progress)?;
    Ok(Run {
        report,
        coverage: coverage.counts(),
    })
}

/// As [`compare`], without the counts, and therefore faster.
///
/// # Errors
/// As [`lockstep::run`].
pub fn check(
    block: &dyn Block,
    device: &mut dyn Device,
    cycles: u64,
    seed: u64,
    progress: &mut dyn FnMut(u64),
) -> Result<LockstepReport, Error> {
    let mut stimuli = block.stimuli(cycles, seed);
    check_with(block, device, stimuli.as_mut(), (cycles, seed), progress)
}

/// As [`check`], with other stimuli.
///
/// # Errors
/// As [`lockstep::run`].
pub fn check_with(
    block: &dyn Block,
    device: &mut dyn Device,
    stimuli: &mut dyn Stimuli,
    clocks_and_seed: (u64, u64),
    progress: &mut dyn FnMut(u64),
) -> Result<LockstepReport, Error> {
    let mut to_the_end = |_: &Clock<'_>| ControlFlow::Continue(());
    run(block, device, stimuli, clocks_and_seed, &mut to_the_end, progress)
}

/// As [`check`], for a verdict: it compares the smallest number of `clocks`, then continues until everything was
/// exercised and every bar was reached, or the largest number of clocks. The report lists what was missing then, and is not a match.
///
/// # Errors
/// As [`lockstep::run`].
pub fn judge(
    block: &dyn Block,
    device: &mut dyn Device,
    clocks: RangeInclusive<u64>,
    seed: u64,
    progress: &mut dyn FnMut(u64),
) -> Result<LockstepReport, Error> {
    let fewest = *clocks.start();
    let mut stimuli = block.stimuli(fewest, seed);
    let mut exercise = block.exercise();
    let mut reach = block.reach();
    let mut watch = |clock: &Clock<'_>| {
        if let Some(exercise) = &mut exercise {
            exercise.observe(clock);
        }
        reach.observe(clock);
        let done = clock.time + 1;
        let looks = done == fewest || (done > fewest && done.is_multiple_of(LOOK_CLOCKS));
        let is_enough = || {
            let exercised = exercise.as_ref().is_none_or(|exercise| exercise.missing().is_empty());
            exercised && !reach.reached().iter().any(|(_, count)| count.is_low())
        };
        if looks && is_enough() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let report = run(
        block,
        device,
        stimuli.as_mut(),
        (*clocks.end(), seed),
        &mut watch,
        progress,
    )?;
    let report = report.with_reached(reach.reached());
    Ok(match exercise {
        Some(exercise) => report.without(exercise.missing()).with_unchanged(exercise.unchanged()),
        None => report,
    })
}

fn run(
    block: &dyn Block,
    device: &mut dyn Device,
    stimuli: &mut dyn Stimuli,
    (cycles, seed): (u64, u64),
    watch: &mut dyn FnMut(&Clock<'_>) -> ControlFlow<()>,
    progress: &mut dyn FnMut(u64),
) -> Result<LockstepReport, Error> {
    let mut model = block.model(seed);
    let instances = block.instances(model.ports());
    let options = LockstepOptions::cycles(cycles);
    lockstep::run_until(model.as_mut(), device, stimuli, &instances, &options, watch, progress)
}

/// Returns the seed of a row. Each row has different stimuli, so that those of one axis may find what those of another
/// miss. The seed depends on the row's name, not on its position, so that a row alone repeats its run among others.
pub fn row_seed(block: &dyn Block, seed: u64) -> u64 {
    // This is FNV-1a with 64 bits; a byte that occurs in no text separates name and instance.
    let bytes = block.name().bytes().chain([0xff]).chain(block.instance().bytes());
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    seed ^ hash
}

/// Error for a block that is written from a register map and therefore not in RustHDL's simulator.
pub(crate) fn not_in_rusthdl(block: &'static str) -> SimulationError {
    SimulationError::Refused {
        block,
        reason: "its registers are written from their map, not in RustHDL".to_owned(),
    }
}

/// Converts names and counts to the form of a report.
pub(crate) fn named<'a>(counts: impl IntoIterator<Item = (&'a str, u64)>) -> Vec<(String, u64)> {
    counts
        .into_iter()
        .map(|(name, count)| (name.to_owned(), count))
        .collect()
}
