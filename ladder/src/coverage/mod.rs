//! Measures which lines, nets and situations of the emitted Verilog the lock step reaches.
//!
//! ```text
//! block ─► Verilog ─► Verilator --coverage-line --coverage-toggle --coverage-user ─► lock step with the block's own stimuli
//!                                                                       ├─► points at 0: holes ─┐
//!                                                                       └─► bins at 0 ──────────┤
//! ladder/coverage/holes.txt: explanations ────────────────────────────────────────────────────┴─► table, or errors
//! ```
//!
//! - **Line**: the body that begins in a line was run; for an `if`, the other branch counts too.
//! - **Toggle**: a bit of a net changed. Memories have no toggles.
//! - **Condition**: a term of a condition was true, and was false, while it decided (`coverage/condition.rs`).
//! - **Bins** are what the block's bench counts: saturation at each side, every flag, every state
//!   ([`Bins`](posicast_testbench::blocks::Bins)).
//! - Toggles in the first clocks are not counted, because all nets leave their random start there.
//! - A hole without an [explanation] is an error, and so is an explanation that no longer matches any hole.
//! - A module that a block contains several times is counted once, over all its instances.

mod condition;
pub mod explanation;
pub mod point;
pub mod table;

use posicast_blocks::pwm::{ActiveLow, PwmConfig};
use posicast_system::scratch;

use explanation::{Explanation, Hole};
use point::{CoveragePoint, PointKind};
use posicast_testbench::Error;
use posicast_testbench::blocks;
use posicast_testbench::blocks::{Block, Sources, library};
use posicast_testbench::pwm::PwmBlock;
use posicast_testbench::stimuli::Stimuli;

/// Number of clocks of a measurement. The explanations assume this number: a shorter run leaves other holes.
pub const CLOCKS: u64 = 1_000_000;
/// Seed of a measurement.
pub const SEED: u64 = 1;
/// Number of clocks at the beginning that do not count.
const BEGINNING_CLOCKS: u64 = 3;

/// Dead time and minimum pulse below which a host cannot go, in clocks.
const PWM_FLOORS_CLOCKS: [u64; 2] = [2, 1];
/// Suffix of the instances of components and of the stage.
const ON_A_BUS: &str = ", Avalon";

/// Reached points and all points, of one kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Share {
    /// Number that was reached.
    pub reached: usize,
    /// Number of all.
    pub all: usize,
}

/// Coverage of a block after its lock step.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Name of the block.
    pub block: String,
    /// Its instance.
    pub instance: String,
    /// Lines of code.
    pub lines: Share,
    /// Bits of nets.
    pub toggles: Share,
    /// Terms of conditions, each twice: true and false while it decides.
    pub conditions: Share,
    /// Bins of the bench.
    pub bins: Share,
    /// Points that were not reached, in the order of the files.
    pub holes: Vec<Hole>,
    /// Number of wrong values in the lock step.
    pub mismatches: u64,
}

/// The blocks that are measured: those of the [`library`] that stand alone. Components and the stage are joined from
/// these, and their connections are compared in their lock step. The PWM has low limits here, so that its short
/// stimuli exceed them.
///
/// # Errors
/// Those of [`library`].
pub fn subjects() -> Result<Vec<Box<dyn Block>>, Error> {
    let mut blocks = library()?;
    // These only join blocks, each of which has its own row.
    let joins = |name: &str| matches!(name, "inline_shaper" | "linked_inline_shaper" | "bus_component");
    blocks.retain(|block| !block.instance().ends_with(ON_A_BUS) && !joins(block.name()));
    let [dead_time, minimum_pulse] = PWM_FLOORS_CLOCKS;
    let pwm = PwmConfig::new(ActiveLow::default(), dead_time, minimum_pulse)
        .map_err(|error| Error::Option(format!("the PWM of the coverage: {error}")))?;
    for block in blocks.iter_mut().filter(|block| block.name() == "pwm") {
        *block = Box::new(PwmBlock::new(pwm, "", "low floors"));
    }
    Ok(blocks)
}

/// Measures a block with its own stimuli.
///
/// # Errors
/// Those of [`blocks::compare`], and [`Error::File`] where the counts cannot be read.
pub fn measure(block: &dyn Block, clocks: u64) -> Result<Measured, Error> {
    measure_with(block, &|| block.stimuli(clocks, SEED), clocks)
}

/// Measures a block with other stimuli, which are made twice.
///
/// # Errors
/// Those of [`measure`].
pub fn measure_with<'a>(
    block: &dyn Block,
    stimuli: &dyn Fn() -> Box<dyn Stimuli + 'a>,
    clocks: u64,
) -> Result<Measured, Error> {
    let folder =
        scratch::Folder::new(scratch::PREFIX).map_err(Error::file(&std::env::temp_dir(), "create a folder in"))?;
    let path = folder.path().join("coverage.dat");
    let run = |sources: &Sources, clocks: u64| {
        let mut device = sources.counting(block, SEED)?;
        let run = blocks::compare_with(block, &mut device, stimuli().as_mut(), clocks, SEED, &mut |_| {})?;
        let written = device.write_coverage(&path);
        written.map_err(|source| Error::Step { clock: clocks, source })?;
        Ok::<_, Error>((run, point::read(&path, sources.files())?))
    };
    let sources = Sources::write(block)?;
    let (_, beginning) = run(&sources, BEGINNING_CLOCKS)?;
    let modules: Vec<_> = block.modules()?.iter().map(condition::with_points).collect();
    let (_, with_conditions) = run(&Sources::of_modules(&modules)?, clocks)?;
    let (run, mut points) = run(&sources, clocks)?;
    for (point, before) in points.iter_mut().zip(&beginning) {
        // A line is run or not, independent of the nets' random start; Verilator runs what depends on no input only
        // once.
        if point.kind == PointKind::Toggle {
            point.count -= before.count.min(point.count);
        }
    }
    let conditions = with_conditions
        .into_iter()
        .filter(|point| point.kind == PointKind::Condition);
    points.extend(conditions);
    Ok(Measured::new(block, &run, &points))
}

impl Measured {
    fn new(block: &dyn Block, run: &blocks::Run, points: &[CoveragePoint]) -> Self {
        let share = |kind| {
            let of_kind = points.iter().filter(|point| point.kind == kind);
            Share {
                reached: of_kind.clone().filter(|point| point.count > 0).count(),
                all: of_kind.count(),
            }
        };
        let mut holes: Vec<Hole> = points
            .iter()
            .filter(|point| point.count == 0)
            .map(Hole::of_point)
            .collect();
        let missed = run.rare(1);
        holes.extend(missed.iter().map(|bin| Hole::of_bin(block.name(), bin)));
        Self {
            block: block.name().to_owned(),
            instance: block.instance().to_owned(),
            lines: share(PointKind::Line),
            toggles: share(PointKind::Toggle),
            conditions: share(PointKind::Condition),
            bins: Share {
                reached: run.coverage.len() - missed.len(),
                all: run.coverage.len(),
            },
            holes,
            mismatches: run.report.mismatches(),
        }
    }

    /// The block and its instance, as explanations name it.
    fn name(&self) -> String {
        format!("{} {}", self.block, self.instance)
    }

    /// Problems of the measurement: unexplained holes, and wrong values.
    pub fn problems(&self, explanations: &[Explanation]) -> Vec<String> {
        let name = self.name();
        let unexplained = self
            .holes
            .iter()
            .filter(|hole| !explanations.iter().any(|e| e.explains(&name, hole)));
        let mut problems: Vec<String> = unexplained
            .map(|hole| format!("{name}: no explanation of {hole}"))
            .collect();
        if self.mismatches > 0 {
            problems.push(format!("{name}: {} wrong values", self.mismatches));
        }
        problems
    }
}

/// The explanations that match no hole: their points are reached now, or have another name. An explanation that concerns several of
/// the `subjects` is judged only if all of these were measured.
pub fn outdated(measured: &[Measured], subjects: &[Box<dyn Block>], explanations: &[Explanation]) -> Vec<String> {
    let mut outdated = Vec::new();
    for explanation in explanations {
        let concerned: Vec<_> = measured.iter().filter(|of| explanation.concerns(&of.name())).collect();
        let is_measured = |name: &String| concerned.iter().any(|of| of.name() == *name);
        let names = subjects
            .iter()
            .map(|block| format!("{} {}", block.name(), block.instance()));
        let is_judged = names
            .filter(|name| explanation.concerns(name))
            .all(|name| is_measured(&name));
        let fits = |of: &&Measured| of.holes.iter().any(|hole| explanation.explains(&of.name(), hole));
        if is_judged && !concerned.is_empty() && !concerned.iter().any(fits) {
            outdated.push(format!("no hole is left for the explanation `{explanation}`"));
        }
    }
    outdated
}
