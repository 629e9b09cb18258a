//! Synthesises every block with Yosys to a netlist of a family's cells, simulates it against the model and proves it
//! equal to the RTL: `cargo run --release --example netlist [-- --write] [--family NAME] [--clocks N] [BLOCK…]`.
//!
//! Prints a row per block. Without names it takes all blocks but the stage, which consists of them. `--family cyclone5` maps to
//! Cyclone V's cells and, in the simulation, multipliers too; without it, to Cyclone IV E's logic elements. `--clocks 0` only
//! proves. `--write` renews the family's table in `ladder/RESULTS.md`, or the rows of the blocks that are named. Exit status: 0 if
//! all are equal, 1 otherwise, 2 if it cannot run, 3 if a tool is missing.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::error::Error;
use std::process::ExitCode;
use std::time::Duration;

use posicast_ladder::netlist::{EquivalenceOutcome, EquivalenceVerdict, MappedParts, NetlistParts, check};
use posicast_ladder::netlist_table;
use posicast_synth::yosys::{CellNetlist, Family, Yosys, YosysError};
use posicast_system::cores;
use posicast_testbench::blocks::{Block, Sources, library_named};
use posicast_testbench::lockstep::report;

/// An error of a block, from any core.
type Failure = Box<dyn Error + Send + Sync>;

/// Default number of clocks of the simulation.
const CLOCKS: u64 = 100_000;
/// Processor time of each engine of a proof.
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

fn compare() -> Result<bool, Failure> {
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    let mut clocks = CLOCKS;
    let write = names.first().is_some_and(|first| first == "--write");
    if write {
        names.remove(0);
    }
    let mut family = Family::Cyclone4e;
    if names.first().is_some_and(|first| first == "--family") {
        family = names.get(1).ok_or("--family needs a name")?.parse()?;
        names.drain(..2);
    }
    if names.first().is_some_and(|first| first == "--clocks") {
        clocks = names.get(1).ok_or("--clocks needs a number")?.parse()?;
        names.drain(..2);
    }
    let yosys = Yosys::installed()?;
    let mut blocks = library_named(&names)?;
    blocks.retain(|block| !names.is_empty() || block.name() != "stage");
    println!("| block | instance | LUT | flip-flops | multipliers | kept | simulated | RTL = netlist | seconds |");
    println!("|---|---|---|---|---|---|---|---|---|");
    let one = |block: &dyn Block| {
        let compared = Compared::new(&yosys, family, block, clocks)?;
        Ok::<_, Failure>((compared.row(block), compared))
    };
    let compared = cores::each(&blocks, |block| one(block.as_ref()), |(row, _)| println!("{row}"))?;
    let is_good = compared.iter().all(|(_, compared)| compared.is_equal());
    if write && is_good {
        let all = library_named(&[])?;
        let table = match family {
            Family::Cyclone5 => netlist_table::CYCLONE5,
            _ => netlist_table::CYCLONE4E,
        };
        let rows = blocks.iter().zip(&compared);
        let rows: String = rows
            .map(|(block, (_, compared))| compared.table_row(family, block.as_ref()))
            .collect();
        table.marks.renew(|old| table.renewed(old, &rows, &all))?;
    }
    Ok(is_good)
}

/// A block beside its netlist.
struct Compared {
    made: CellNetlist,
    outcome: EquivalenceOutcome,
}

impl Compared {
    fn new(yosys: &Yosys, family: Family, block: &dyn Block, clocks: u64) -> Result<Self, Failure> {
        let make = |parts: &NetlistParts| -> Result<CellNetlist, Failure> {
            let (logic, kept) = (Sources::of_modules(&parts.logic)?, Sources::of_modules(&parts.kept)?);
            Ok(yosys.netlist(logic.files(), kept.files(), &block.top(), family)?)
        };
        let modules = block.modules()?;
        let kept = NetlistParts::of(modules.clone());
        // A proof cannot decide whether two multipliers are equal; a simulation can run those of the device.
        let mapped = match family {
            Family::Cyclone5 => NetlistParts::with_multipliers_mapped(modules),
            _ => kept.clone(),
        };
        let made = make(&mapped)?;
        let proven = if kept == mapped { made.clone() } else { make(&kept)? };
        let simulated = MappedParts {
            parts: &mapped,
            netlist: &made.verilog,
        };
        let proven = MappedParts {
            parts: &kept,
            netlist: &proven.verilog,
        };
        let outcome = check(block, simulated, proven, (clocks, 1), LIMIT)?;
        Ok(Self { made, outcome })
    }

    fn is_equal(&self) -> bool {
        self.matches() && self.outcome.verdict == EquivalenceVerdict::Equivalent
    }

    fn matches(&self) -> bool {
        let report = self.outcome.simulated.as_ref();
        report.is_none_or(|report| report.result == report::LockstepVerdict::Match)
    }

    fn row(&self, block: &dyn Block) -> String {
        let Self { made, outcome } = self;
        let simulated = match &outcome.simulated {
            None => "no".to_owned(),
            Some(report) if self.matches() => format!("{} clocks, equal", report.cycles),
            Some(report) => format!("{} wrong values in {} clocks", report.mismatches(), report.cycles),
        };
        let proof = match outcome.verdict {
            EquivalenceVerdict::Equivalent => "proven".to_owned(),
            EquivalenceVerdict::Different { clock } => format!("differ in clock {clock}"),
            EquivalenceVerdict::Unknown => "unknown".to_owned(),
        };
        format!(
            "| {} | {} | {} | {} | {} | {} | {simulated} | {proof} | {:.1} |",
            block.name(),
            block.instance(),
            made.luts,
            made.flip_flops,
            made.multipliers,
            outcome.kept,
            outcome.time.as_secs_f64()
        )
    }

    fn table_row(&self, family: Family, block: &dyn Block) -> String {
        let multipliers = (family == Family::Cyclone5).then_some(self.made.multipliers);
        netlist_table::row(block, self.outcome.kept, multipliers)
    }
}
