//! Proves of every block that nothing from before a reset reaches an output after it:
//! `cargo run --release --example unset [BLOCK…]`.
//!
//! Prints a row per block. Without names it takes all blocks but the stage, which consists of them. Exit status: 0 if all are proven, 1 otherwise, 2 if it cannot run, 3 if a tool is missing.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::process::ExitCode;
use std::time::{Duration, Instant};

use posicast_ladder::netlist::{EquivalenceVerdict, NetlistParts};
use posicast_ladder::unset::check;
use posicast_system::cores;
use posicast_testbench::Error;
use posicast_testbench::blocks::{Block, library_named};

/// Processor time of each engine of a proof.
const LIMIT: Duration = Duration::from_secs(300);

fn main() -> ExitCode {
    match prove() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(if error.is_missing_tool() { 3 } else { 2 })
        }
    }
}

fn prove() -> Result<bool, Error> {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let mut blocks = library_named(&names)?;
    blocks.retain(|block| !names.is_empty() || block.name() != "stage");
    println!("| block | instance | memories and multipliers | after a reset | seconds |");
    println!("|---|---|---|---|---|");
    let rows = cores::each(&blocks, |block| row(block.as_ref()), |(row, _)| println!("{row}"))?;
    Ok(rows.iter().all(|(_, is_proven)| *is_proven))
}

/// Returns a block's row, and whether it is proven.
fn row(block: &dyn Block) -> Result<(String, bool), Error> {
    let start = Instant::now();
    let verdict = check(block, LIMIT)?;
    let says = match verdict {
        EquivalenceVerdict::Equivalent => "proven".to_owned(),
        EquivalenceVerdict::Different { clock } => format!("differs in clock {clock}"),
        EquivalenceVerdict::Unknown => "unknown".to_owned(),
    };
    let row = format!(
        "| {} | {} | {} | {says} | {:.1} |",
        block.name(),
        block.instance(),
        NetlistParts::of(block.modules()?).kept.len(),
        start.elapsed().as_secs_f64()
    );
    Ok((row, verdict == EquivalenceVerdict::Equivalent))
}
