//! Blocks on the test bench: the choice of the simulator, and the lock step of several blocks.

use crate::failure::Failure;
use crate::{output, progress};
use clap::ValueEnum;
use indicatif::ProgressBar;
use posicast_testbench::Error;
use posicast_testbench::asynchronous;
use posicast_testbench::blocks::{self, Block, Sources};
use posicast_testbench::lockstep::Device;
use posicast_testbench::lockstep::report::LockstepReport;
use posicast_testbench::verilator;
use serde::Serialize;
use std::fmt;
use std::num::NonZero;
use std::ops::RangeInclusive;
use std::sync::Mutex;
use std::thread;

/// Largest number of blocks that are built and simulated at a time: a build takes up to a gigabyte.
const MOST_AT_ONCE: usize = 2;

/// Factor by which a row may run longer than usual, where it has not exercised all that a verdict speaks of.
const MOST_TIMES_LONGER: u64 = 10;

/// Simulator of the hardware.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Simulator {
    /// The emitted Verilog, compiled
    Verilator,
    /// The emitted Verilog, in a second, event-driven simulator
    Icarus,
    /// The RustHDL description itself, not the Verilog: needs no tool, the weaker check
    Rusthdl,
}

/// Parses a number of clocks as people write it: `1000000`, `1_000_000` or `1e6`.
pub(crate) fn clocks(text: &str) -> Result<u64, String> {
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
const IS_STATIC: bool = cfg!(target_feature = "crt-static");

impl Simulator {
    /// The simulator that was asked for, else the best that is installed.
    ///
    /// A Verilator that `$VERILATOR` names, or that fails to run, is an error, and does not count as not installed.
    pub(crate) fn choose(asked: Option<Self>) -> Result<Self, Failure> {
        if IS_STATIC && asked == Some(Self::Verilator) {
            return Err(Failure::from(miette::miette!(
                help = "use --simulator icarus, or a posicast that is linked dynamically: cargo install --path cli --locked",
                "this posicast is linked statically and cannot load the library that Verilator builds"
            )));
        }
        if let Some(simulator) = asked {
            return Ok(simulator);
        }
        if IS_STATIC {
            output::say(
                "note: this posicast is linked statically and cannot load the library that Verilator builds: Icarus simulates the Verilog, on \
                 fewer clocks.",
            );
            return Ok(Self::Icarus);
        }
        match verilator::version() {
            Ok(_) => Ok(Self::Verilator),
            Err(error) if !error.is_missing_tool() || std::env::var_os("VERILATOR").is_some() => Err(failure(error)),
            Err(_) => {
                output::say(
                    "warning: Verilator is not installed: RustHDL's own simulator runs instead, on fewer clocks. It is the \
                     weaker check: the emitted Verilog itself is not simulated.",
                );
                Ok(Self::Rusthdl)
            }
        }
    }

    /// Fewest and most clocks of a block's lock step by default: as many as the simulator does in a few seconds, and
    /// more until the stimuli have exercised what a verdict speaks of.
    fn default_cycles(self, block: &dyn Block) -> RangeInclusive<u64> {
        let usual = match self {
            Self::Verilator => 1_000_000,
            Self::Icarus | Self::Rusthdl => 20_000,
        };
        let fewest = usual.max(block.least_clocks());
        fewest..=MOST_TIMES_LONGER * fewest
    }

    /// Says where the simulator runs a block at other sizes than those of its Verilog.
    pub(crate) fn say_sizes<'a>(self, blocks: impl Iterator<Item = &'a dyn Block>) {
        for block in blocks.filter(|_| self == Self::Rusthdl) {
            if let Some(sizes) = block.simulated_as() {
                output::say(&format!(
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
        f.write_str(match self {
            Self::Verilator => "verilator",
            Self::Icarus => "icarus",
            Self::Rusthdl => "rusthdl",
        })
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
    /// Fewest and most clocks to compare: the number that was asked for, or the default range.
    fn clocks(&self, simulator: Simulator) -> RangeInclusive<u64> {
        match self.cycles {
            Some(cycles) => cycles..=cycles,
            None => simulator.default_cycles(self.block),
        }
    }
}

/// Compares every block with its model, at most [`MOST_AT_ONCE`] at a time, and reports them in their order.
pub(crate) fn compare_all(benches: &[Bench<'_>], simulator: Simulator, seed: u64) -> Result<LockstepReport, Failure> {
    simulator.say_sizes(benches.iter().map(|bench| bench.block));
    let fewest = |bench: &Bench<'_>| *bench.clocks(simulator).start();
    let total = benches.iter().map(fewest).fold(0, u64::saturating_add);
    let bar = progress::bar("lock step", total);
    let next = Mutex::new(benches.iter().enumerate());
    let done = Mutex::new(Vec::new());
    let worker = || {
        loop {
            let Some((row, bench)) = locked(&next).next() else {
                return;
            };
            let result = compare(bench, simulator, seed, &bar);
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
    bar.finish_and_clear();
    let mut rows = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    rows.sort_by_key(|(row, _)| *row);
    let reports: Result<Vec<LockstepReport>, Error> = rows.into_iter().map(|(_, result)| result).collect();
    Ok(LockstepReport::joined(reports.map_err(failure)?))
}

fn compare(bench: &Bench<'_>, simulator: Simulator, seed: u64, bar: &ProgressBar) -> Result<LockstepReport, Error> {
    bar.set_message(format!("building {} {}", bench.block.name(), bench.block.instance()));
    let seed = blocks::row_seed(bench.block, seed);
    let mut device = simulator.device(bench.block, bench.sources, seed)?;
    bar.set_message(format!("{} {}", bench.block.name(), bench.block.instance()));
    let mut shown = 0;
    let clocks = bench.clocks(simulator);
    let report = blocks::judge(bench.block, device.as_mut(), clocks, seed, &mut |done| {
        bar.inc(done - shown);
        shown = done;
    })?;
    if simulator == Simulator::Rusthdl {
        return Ok(report);
    }
    let between_clocks = match asynchronous::check(bench.block, bench.sources) {
        Err(error) if error.is_missing_tool() => asynchronous::not_run(bench.block, &error.to_string()),
        other => other?,
    };
    Ok(match between_clocks {
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
    fn unit_clocks_are_read_as_people_write_them() {
        for text in ["1000000", "1_000_000", "1e6"] {
            assert_eq!(clocks(text), Ok(1_000_000));
        }
        for text in ["0", "-1", "1.5", "many", "", "1e30", "nan"] {
            assert!(clocks(text).is_err(), "{text}");
        }
    }
}
