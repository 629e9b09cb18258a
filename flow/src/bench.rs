//! Blocks on the test bench: the choice of the simulator, and the lock step of several blocks.

use crate::choice::WordChoice;
use crate::failure::Failure;
use crate::observer::{Observer, WorkProgress};
use posicast_testbench::asynchronous;
use posicast_testbench::blocks::{self, Block, Sources};
use posicast_testbench::lockstep::Device;
use posicast_testbench::lockstep::report::{BlockReport, LockstepReport};
use posicast_testbench::wording::counted;
use posicast_testbench::{Error, MissingTool};
use posicast_testbench::{icarus, verilator};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;
use std::num::NonZero;
use std::ops::RangeInclusive;
use std::sync::Mutex;
use std::thread;

/// Largest number of blocks that are built and simulated at a time: a build takes up to a gigabyte.
const MOST_AT_ONCE: usize = 2;

/// Factor by which a row may run longer than usual, while its stimuli have not exercised everything that a verdict
/// covers.
const MOST_TIMES_LONGER: u64 = 10;

/// Simulator of the hardware.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Simulator {
    /// The emitted Verilog, compiled
    Verilator,
    /// The emitted Verilog, in a second, event-driven simulator
    Icarus,
    /// The RustHDL description itself, not the Verilog: needs no tool, the weaker check
    Rusthdl,
}

impl WordChoice for Simulator {
    const ALL: &'static [Self] = &[Self::Verilator, Self::Icarus, Self::Rusthdl];

    fn word(self) -> &'static str {
        match self {
            Self::Verilator => "verilator",
            Self::Icarus => "icarus",
            Self::Rusthdl => "rusthdl",
        }
    }

    fn about(self) -> &'static str {
        match self {
            Self::Verilator => "The emitted Verilog, compiled",
            Self::Icarus => "The emitted Verilog, in a second, event-driven simulator",
            Self::Rusthdl => "The RustHDL description itself, not the Verilog: needs no tool, the weaker check",
        }
    }
}

/// Parses a number of clocks as people write it: `1000000`, `1_000_000` or `1e6`.
///
/// # Errors
/// What is allowed, for any other text.
pub fn clocks(text: &str) -> Result<u64, String> {
    const LARGEST: f64 = 1e18;
    let plain = text.replace('_', "");
    let whole = plain.parse().ok();
    let number = plain
        .parse()
        .ok()
        .filter(|number: &f64| number.fract() == 0.0 && (1.0..=LARGEST).contains(number));
    let clocks = whole.or_else(|| number.map(|number| number as u64));
    clocks
        .filter(|clocks| *clocks > 0)
        .ok_or_else(|| "allowed: a whole number of clocks from 1 on, such as 1000000, 1_000_000 or 1e6".to_owned())
}

/// Whether this program is linked statically and can therefore load no library.
pub(crate) const IS_STATIC: bool = cfg!(target_feature = "crt-static");

/// Whether a variable names Verilator.
fn names_verilator() -> bool {
    std::env::var_os("VERILATOR").is_some_and(|name| !name.is_empty())
}

impl Simulator {
    /// Returns the requested simulator, or else the best that is installed.
    ///
    /// A Verilator that `$VERILATOR` names, or that fails to run, gives an error instead of counting as missing.
    pub(crate) fn choose(asked: Option<Self>, observer: &dyn Observer) -> Result<Self, Failure> {
        if IS_STATIC && asked == Some(Self::Verilator) {
            return Err(Failure::input(
                "this posicast is linked statically and cannot load the library that Verilator builds",
            )
            .with_help(
                "use --simulator icarus, or a posicast that is linked dynamically: cargo install --path cli --locked",
            ));
        }
        if let Some(simulator) = asked {
            return Ok(simulator);
        }
        if IS_STATIC {
            observer.say(
                "note: this posicast is linked statically and cannot load the library that Verilator builds: Icarus simulates the Verilog, on \
                 fewer clocks.",
            );
            return Ok(Self::Icarus);
        }
        match verilator::version() {
            Ok(_) => Ok(Self::Verilator),
            Err(error) if !error.is_missing_tool() || names_verilator() => Err(failure(error)),
            Err(_) => {
                observer.say(
                    "warning: Verilator is not installed: RustHDL's own simulator runs instead, on fewer clocks. It is the \
                     weaker check: the emitted Verilog itself is not simulated.",
                );
                Ok(Self::Rusthdl)
            }
        }
    }

    /// Number of clocks that the simulator does in a few seconds.
    pub(crate) fn usual_cycles(self) -> u64 {
        match self {
            Self::Verilator => 1_000_000,
            Self::Icarus | Self::Rusthdl => 20_000,
        }
    }

    /// Fewest and most clocks of a block's lock step by default: as many as the simulator does in a few seconds, and
    /// more until the stimuli have exercised everything that a verdict covers.
    fn default_cycles(self, block: &dyn Block) -> RangeInclusive<u64> {
        let fewest = self.usual_cycles().max(block.least_clocks());
        fewest..=MOST_TIMES_LONGER * fewest
    }

    /// Reports blocks that the simulator runs at other sizes than those of their Verilog.
    pub(crate) fn say_sizes<'a>(self, blocks: impl Iterator<Item = &'a dyn Block>, observer: &dyn Observer) {
        for block in blocks.filter(|_| self == Self::Rusthdl) {
            if let Some(sizes) = block.simulated_as() {
                observer.say(&format!(
                    "note: RustHDL's simulator runs {} {} at larger sizes with equal outputs ({sizes})",
                    block.name(),
                    block.instance()
                ));
            }
        }
    }

    /// Opens the block in this simulator. RustHDL's simulator runs its description instead of the Verilog.
    pub(crate) fn device(self, block: &dyn Block, sources: &Sources, seed: u64) -> Result<Box<dyn Device>, Error> {
        match self {
            Self::Verilator => Ok(Box::new(sources.verilated(block, seed)?)),
            Self::Icarus => Ok(Box::new(sources.icarus(block)?)),
            Self::Rusthdl => blocks::rusthdl(block),
        }
    }
}

impl fmt::Display for Simulator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// A block with the number of its clocks.
pub(crate) struct Bench<'a> {
    pub(crate) block: &'a dyn Block,
    pub(crate) sources: &'a Sources,
    /// Number of clocks to compare; `None`: the default.
    pub(crate) cycles: Option<u64>,
}

impl Bench<'_> {
    /// Fewest and most clocks to compare: the requested number, or the default range.
    fn clocks(&self, simulator: Simulator) -> RangeInclusive<u64> {
        match self.cycles {
            Some(cycles) => cycles..=cycles,
            None => simulator.default_cycles(self.block),
        }
    }
}

/// A simulator, and the blocks that it is to run.
pub(crate) type Needs<'a> = (Simulator, Vec<(&'a dyn Block, &'a Sources)>);

/// Returns an error if one of these tools is missing; it names each missing tool once.
pub(crate) fn require_installed(tools: impl IntoIterator<Item = MissingTool>) -> Result<(), Failure> {
    let mut missing: Vec<MissingTool> = Vec::new();
    for tool in tools {
        if !missing.contains(&tool) {
            missing.push(tool);
        }
    }
    if missing.is_empty() {
        Ok(())
    } else {
        Err(failure(Error::ToolMissing(missing)))
    }
}

/// Returns an error if a tool that one of these blocks needs is missing; it names each missing tool once.
/// `with_directed` includes the tools of the blocks' directed tests, which [`compare_all`] runs.
pub(crate) fn require_tools(needs: &[Needs<'_>], with_directed: bool) -> Result<(), Failure> {
    let mut missing = Vec::new();
    for (simulator, blocks) in needs {
        let mut blocks = blocks.iter();
        match simulator {
            Simulator::Verilator => missing.extend(missing_builders(blocks.clone().copied())),
            Simulator::Icarus => missing.extend(icarus::missing_tools()),
            Simulator::Rusthdl => continue,
        }
        if with_directed && blocks.any(|(block, _)| block.asynchronous().is_some()) {
            missing.extend(icarus::missing_tools());
        }
    }
    require_installed(missing)
}

/// Returns the missing tools for Verilator's simulations of these blocks. No compiler is needed if all of them are
/// built.
fn missing_builders<'a>(mut blocks: impl Iterator<Item = (&'a dyn Block, &'a Sources)>) -> Vec<MissingTool> {
    let missing = verilator::missing_tools();
    if missing.is_empty() || blocks.all(|(block, sources)| matches!(sources.is_built(block), Ok(true))) {
        return Vec::new();
    }
    missing
}

/// Compares every block with its model, at most [`MOST_AT_ONCE`] at a time, and reports them in their order.
pub(crate) fn compare_all(
    benches: &[Bench<'_>],
    simulator: Simulator,
    seed: u64,
    observer: &dyn Observer,
) -> Result<LockstepReport, Failure> {
    simulator.say_sizes(benches.iter().map(|bench| bench.block), observer);
    let fewest = |bench: &Bench<'_>| *bench.clocks(simulator).start();
    let total = benches.iter().map(fewest).fold(0, u64::saturating_add);
    let bar = observer.begin("lock step", Some(total));
    let next = Mutex::new(benches.iter().enumerate());
    let done = Mutex::new(Vec::new());
    let worker = || {
        loop {
            let Some((row, bench)) = locked(&next).next() else {
                return;
            };
            let result = compare(bench, simulator, seed, bar.as_ref());
            if result.is_err() {
                // The remaining blocks are not begun: the error ends the command.
                locked(&next).by_ref().for_each(drop);
            }
            locked(&done).push((row, result));
        }
    };
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    thread::scope(|scope| {
        for _ in 1..benches.len().min(cores).min(MOST_AT_ONCE) {
            scope.spawn(worker);
        }
        worker();
    });
    drop(bar);
    let mut rows = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    rows.sort_by_key(|(row, _)| *row);
    let (mut reports, mut failed) = (Vec::new(), None);
    for (_, result) in rows {
        match result {
            Ok(report) => reports.push(report),
            Err(error) => failed = failed.or(Some(error)),
        }
    }
    match failed {
        Some(error) => Err(failure(error).with_help(until_then(&reports, benches.len()))),
        None => Ok(LockstepReport::joined(reports)),
    }
}

/// Returns a sentence about the comparisons that were done before an error ended the command.
fn until_then(reports: &[LockstepReport], all: usize) -> String {
    let of_row = |row: &BlockReport| {
        let found = match (row.mismatches, row.not_exercised.len()) {
            (0, 0) => "equal".to_owned(),
            (0, few) => format!("equal, {few} not exercised"),
            (wrong, _) => counted(wrong, "mismatch"),
        };
        format!(
            "{} {}, {}, {found}",
            row.name,
            row.instance,
            counted(row.cycles, "clock")
        )
    };
    let rows: Vec<String> = reports.iter().flat_map(|report| &report.blocks).map(of_row).collect();
    if rows.is_empty() {
        "nothing was compared until then".to_owned()
    } else {
        format!("compared until then, {} of {all}: {}", reports.len(), rows.join("; "))
    }
}

fn compare(
    bench: &Bench<'_>,
    simulator: Simulator,
    seed: u64,
    bar: &dyn WorkProgress,
) -> Result<LockstepReport, Error> {
    bar.rename(&format!("building {} {}", bench.block.name(), bench.block.instance()));
    let seed = blocks::row_seed(bench.block, seed);
    let mut device = simulator.device(bench.block, bench.sources, seed)?;
    bar.rename(&format!("{} {}", bench.block.name(), bench.block.instance()));
    let mut shown = 0;
    let clocks = bench.clocks(simulator);
    let report = blocks::judge(bench.block, device.as_mut(), clocks, seed, &mut |done| {
        bar.advance(done - shown);
        shown = done;
    })?;
    if simulator == Simulator::Rusthdl {
        return Ok(report);
    }
    Ok(match asynchronous::check(bench.block, bench.sources)? {
        Some(row) => LockstepReport::joined(vec![report, row]),
        None => report,
    })
}

/// Locks a mutex. It ignores a thread that panicked while it held the lock, since the panic propagates by itself.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Turns an error of the test bench into the failure of a command.
pub(crate) fn failure(error: Error) -> Failure {
    if error.is_missing_tool() {
        Failure::missing_tool(error)
    } else {
        Failure::because(error)
    }
}

#[cfg(test)]
mod tests {
    use super::clocks;

    #[test]
    fn clocks_are_read_as_people_write_them() {
        for text in ["1000000", "1_000_000", "1e6"] {
            assert_eq!(clocks(text), Ok(1_000_000));
        }
        for text in ["0", "-1", "1.5", "many", "", "1e30", "nan"] {
            assert!(clocks(text).is_err(), "{text}");
        }
    }
}
