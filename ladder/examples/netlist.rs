//! Synthesises every block with Yosys to a netlist of logic elements, simulates it against the model and proves it
//! equal to the RTL: `cargo run --release --example netlist [-- --write] [--clocks N] [BLOCK…]`.
//!
//! Prints a row per block. Without names it takes all blocks but the stage, which consists of them. `--clocks 0` only
//! proves. `--write` renews the table in `ladder/RESULTS.md`, or the rows of the blocks that are named. Exit status: 0 if all are equal, 1 otherwise, 2 if it cannot run, 3 if a tool is missing.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::error::Error;
use std::process::ExitCode;
use std::time::Duration;

use posicast_ladder::netlist::{EquivalenceOutcome, EquivalenceVerdict, NetlistParts, check};
use posicast_ladder::netlist_table;
use posicast_synth::yosys::{CELL_MODELS, Yosys, YosysError};
use posicast_testbench::blocks::{Block, Sources, library_named};
use posicast_testbench::lockstep::report;

/// Default number of clocks of the simulation.
const CLOCKS: u64 = 100_000;
/// Time limit of each engine of a proof.
const LIMIT: Duration = Duration::from_secs(300);

fn main() -> ExitCode {
    match compare() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("{error}");
            let no_simulator = error
                .downcast_ref()
                .is_some_and(posicast_testbench::Error::is_missing_tool);
            let no_yosys = matches!(error.downcast_ref(), Some(YosysError::Missing(_)));
            ExitCode::from(if no_simulator || no_yosys { 3 } else { 2 })
        }
    }
}

fn compare() -> Result<bool, Box<dyn Error>> {
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    let mut clocks = CLOCKS;
    let write = names.first().is_some_and(|first| first == "--write");
    if write {
        names.remove(0);
    }
    if names.first().is_some_and(|first| first == "--clocks") {
        clocks = names.get(1).ok_or("--clocks needs a number")?.parse()?;
        names.drain(..2);
    }
    let yosys = Yosys::installed()?;
    let mut blocks = library_named(&names)?;
    blocks.retain(|block| !names.is_empty() || block.name() != "stage");
    println!("| block | instance | LUT | flip-flops | kept | simulated | RTL = netlist | seconds |");
    println!("|---|---|---|---|---|---|---|---|");
    let (mut is_good, mut rows) = (true, String::new());
    for block in blocks {
        match row(&yosys, block.as_ref(), clocks)? {
            Some(kept) => rows += &netlist_table::row(block.as_ref(), kept),
            None => is_good = false,
        }
    }
    if write && is_good {
        let all = library_named(&[])?;
        netlist_table::MARKS.renew(|old| netlist_table::renewed(old, &rows, &all))?;
    }
    Ok(is_good)
}

/// Prints a block's row. Returns the number of memories and multipliers that were kept if netlist, model and RTL are equal.
fn row(yosys: &Yosys, block: &dyn Block, clocks: u64) -> Result<Option<usize>, Box<dyn Error>> {
    let parts = NetlistParts::of(block.modules()?);
    let (logic, kept) = (Sources::of_modules(&parts.logic)?, Sources::of_modules(&parts.kept)?);
    let netlist = yosys.netlist(logic.files(), kept.files(), &block.top())?;
    let outcome = check(block, &parts, (&netlist, CELL_MODELS), (clocks, 1), LIMIT)?;
    let EquivalenceOutcome {
        cells: [luts, flip_flops],
        kept,
        simulated,
        verdict,
        time,
    } = &outcome;
    let matches = simulated
        .as_ref()
        .is_none_or(|report| report.result == report::LockstepVerdict::Match);
    let simulated = match simulated {
        None => "no".to_owned(),
        Some(report) if matches => format!("{} clocks, equal", report.cycles),
        Some(report) => format!("{} wrong values in {} clocks", report.mismatches(), report.cycles),
    };
    let proof = match verdict {
        EquivalenceVerdict::Equivalent => "proven".to_owned(),
        EquivalenceVerdict::Different { clock } => format!("differ in clock {clock}"),
        EquivalenceVerdict::Unknown => "unknown".to_owned(),
    };
    println!(
        "| {} | {} | {luts} | {flip_flops} | {kept} | {simulated} | {proof} | {:.1} |",
        block.name(),
        block.instance(),
        time.as_secs_f64()
    );
    let is_equal = matches && *verdict == EquivalenceVerdict::Equivalent;
    Ok(is_equal.then_some(*kept))
}
