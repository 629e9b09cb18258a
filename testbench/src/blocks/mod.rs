//! One bench per hardware block: `posicast verify`, the lock-step tests and the benchmarks all take a block from here.
//!
//! A [`Block`] is a hardware block at one size, with all that a comparison of it needs: its Verilog, its bit-exact model, its
//! RustHDL simulation, its stimuli, and what these are expected to reach. To try one:
//!
//! ```no_run
//! use posicast_testbench::blocks::{self, Block, PulseCounterBlock, Sources};
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
//! A new block adds a file here that implements [`Block`] and has a row in the registry: all rungs take it from there.

mod axis;
mod cascade;
mod changes;
mod component;
mod divider;
mod drive_command;
mod encoder_generator;
mod error_table;
mod excitation;
mod inside;
mod levels;
mod library;
mod linear_scale;
mod part;
mod proofs;
mod pulse_counter;
mod pwm;
mod registers;
mod registry;
mod segments;
mod shaper;
mod short_ticks;
mod sliding_mode;
mod sources;
mod stage;
mod trace;

pub use self::axis::AxisBlock;
pub use self::cascade::CascadeBlock;
pub use self::component::ComponentBlock;
pub use self::divider::DividerBlock;
pub use self::drive_command::DriveCommandBlock;
pub use self::encoder_generator::EncoderGeneratorBlock;
pub use self::error_table::ErrorTableBlock;
pub use self::excitation::ExcitationBlock;
pub use self::library::{library, library_sizes};
pub use self::linear_scale::LinearScaleBlock;
pub use self::part::{PartBlock, SmallPart};
pub use self::pulse_counter::PulseCounterBlock;
pub use self::pwm::PwmBlock;
pub use self::registers::RegistersBlock;
pub use self::registry::{
    AreaBudget, AreaRow, BenchSizes, SmallBench, areas, benches, proofs, proofs_named, small_benches,
};
pub use self::segments::SegmentsBlock;
pub use self::shaper::{MachineShapers, ShaperBlock};
pub use self::short_ticks::ShortTicksBlock;
pub use self::sliding_mode::SlidingModeBlock;
pub use self::sources::{Sources, rusthdl};
pub use self::stage::StageBlock;
pub use self::trace::TraceBlock;

use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_model::rtl::{ClockedBlock, Port};

use std::ops::{ControlFlow, RangeInclusive};

use crate::Error;
use crate::lockstep::report::LockstepReport;
use crate::lockstep::{self, Clock, Device, Instance, LockstepOptions};
use crate::stimuli::Stimuli;

/// Clocks between two looks of [`judge`] at what is still missing.
const LOOK_CLOCKS: u64 = 1 << 10;

/// A hardware block at one size. It may be shared between threads; what it makes belongs to one.
pub trait Block: Send + Sync {
    /// Its name, as in `model/src/rtl/` and `docs/`.
    fn name(&self) -> &str;

    /// What tells it from others of its kind: the axes that it serves, or its size.
    fn instance(&self) -> &str;

    /// Its Verilog modules, the top last.
    ///
    /// # Errors
    /// [`EmitError`] where its prefix makes no Verilog name.
    fn modules(&self) -> Result<Vec<Module>, EmitError>;

    /// Name of the top module.
    fn top(&self) -> String;

    /// The Verilog that this row runs, of the files `sources`: those as they are, unless the row says otherwise.
    ///
    /// # Errors
    /// [`Error::File`] where a file cannot be read or written.
    fn adapted(&self, sources: Sources) -> Result<Sources, Error> {
        Ok(sources)
    }

    /// The bit-exact model. Memories start with contents that depend on the seed.
    fn model(&self, seed: u64) -> Box<dyn ClockedBlock>;

    /// The block in RustHDL's simulator.
    ///
    /// # Errors
    /// [`SimulationError`] where RustHDL finds a fault in the block, or where it is not [`Self::in_rusthdl`].
    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError>;

    /// The sizes at which RustHDL's simulator runs the block, in words, where they are not the block's own. Outputs are equal.
    fn simulated_as(&self) -> Option<String> {
        None
    }

    /// Whether the whole block is written in RustHDL. Register banks are not, and so no component is.
    fn in_rusthdl(&self) -> bool {
        true
    }

    /// Inputs for a run of `cycles` clocks: directed cases where there are any, then random, by the seed.
    fn stimuli(&self, cycles: u64, seed: u64) -> Box<dyn Stimuli + '_>;

    /// Counts what a run reached.
    fn coverage(&self) -> Box<dyn Bins + '_>;

    /// Clocks after which its stimuli have driven all that [`Self::exercise`] wants; 0 where it wants nothing.
    fn least_clocks(&self) -> u64 {
        0
    }

    /// What a run must have driven before it says anything of the block: both levels of every flag, by default.
    fn exercise(&self) -> Option<Box<dyn Exercise + '_>> {
        let model = self.model(0);
        Some(Box::new(levels::Levels::new(
            self.instance(),
            model.ports(),
            &self.fixed(),
        )))
    }

    /// Flags among the outputs that cannot change as the block is built, and why.
    fn fixed(&self) -> Vec<(String, &'static str)> {
        Vec::new()
    }

    /// A testbench for what no clock sees, and the name of its top module; see [`crate::asynchronous`].
    fn asynchronous(&self) -> Option<(String, &'static str)> {
        None
    }

    /// The entries of the report: one for all outputs, unless several blocks stand side by side in one top.
    fn instances(&self, ports: &[Port]) -> Vec<Instance> {
        vec![Instance::whole(self.name(), self.instance(), ports)]
    }
}

/// Counts what happens in a run, by name.
pub trait Bins {
    /// Adds a clock.
    fn observe(&mut self, clock: &Clock<'_>);

    /// What happened how often. A bin at 0 after a long run is a hole in the stimuli.
    fn counts(&self) -> Vec<(String, u64)>;
}

/// Watches whether a run drives what it must.
pub trait Exercise {
    /// Adds a clock.
    fn observe(&mut self, clock: &Clock<'_>);

    /// What was not driven yet: the instance of its row, and what it is, in words.
    fn missing(&self) -> Vec<(String, String)>;

    /// Bits of words that never changed, for the reader; no verdict hangs on them.
    fn unchanged(&self) -> Vec<(String, String)> {
        Vec::new()
    }
}

/// A lock step that is over, and what it reached.
#[derive(Debug, Clone)]
pub struct Run {
    /// Whether it matched.
    pub report: LockstepReport,
    /// What it reached: names and counts.
    pub coverage: Vec<(String, u64)>,
}

impl Run {
    /// The bins that were hit less than `least` times.
    pub fn rare(&self, least: u64) -> Vec<&str> {
        let rare = self.coverage.iter().filter(|(_, count)| *count < least);
        rare.map(|(name, _)| name.as_str()).collect()
    }
}

/// Runs a block's model and a device under the block's stimuli, compares every output in every clock, and counts what the
/// run reached. `progress` gets the clocks done.
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

/// The same under other stimuli.
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

/// As [`compare`], without the counts: faster.
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
    let mut to_the_end = |_: &Clock<'_>| ControlFlow::Continue(());
    run(
        block,
        device,
        stimuli.as_mut(),
        (cycles, seed),
        &mut to_the_end,
        progress,
    )
}

/// As [`check`], for a verdict: it compares the fewest of `clocks`, then goes on until everything was exercised or the most are
/// over. What was not exercised then stands in the report, which is no match.
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
    let mut watch = |clock: &Clock<'_>| {
        if let Some(exercise) = &mut exercise {
            exercise.observe(clock);
        }
        let done = clock.time + 1;
        let looks = done == fewest || (done > fewest && done.is_multiple_of(LOOK_CLOCKS));
        match looks && exercise.as_ref().is_none_or(|exercise| exercise.missing().is_empty()) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
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

/// The seed of a row: each has stimuli of its own, so that one axis's may find what another's miss. It depends on what the row
/// is, not on where it stands, so that a row alone repeats what it did among others.
pub fn row_seed(block: &dyn Block, seed: u64) -> u64 {
    // FNV-1a, 64 bits; a byte that no text holds parts name and instance.
    let bytes = block.name().bytes().chain([0xff]).chain(block.instance().bytes());
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    seed ^ hash
}

/// Why a block that is written from a register map is not in RustHDL's simulator.
fn not_in_rusthdl(block: &'static str) -> SimulationError {
    SimulationError::Refused {
        block,
        reason: "its registers are written from their map, not in RustHDL".to_owned(),
    }
}

/// Names and counts as a report keeps them.
fn named<const N: usize>(counts: [(&str, u64); N]) -> Vec<(String, u64)> {
    counts.map(|(name, count)| (name.to_owned(), count)).to_vec()
}
