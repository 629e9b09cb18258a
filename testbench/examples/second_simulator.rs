//! Runs every block under Verilator and under Icarus, and compares their waveforms:
//! `cargo run --release --example second_simulator [-- --clocks N] [BLOCK…]`.
//!
//! Prints a row per block. Exit status: 0 if all are equal, 1 otherwise, 2 if it cannot run, 3 if a tool is missing.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::process::ExitCode;

use posicast_system::cores;
use posicast_testbench::Error;
use posicast_testbench::blocks::{Block, library_named};
use posicast_testbench::crosssim::{CrosssimOutcome, outputs, run};
use wavecmp::diff::DiffVerdict;

fn main() -> ExitCode {
    match compare() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(if error.is_missing_tool() { 3 } else { 2 })
        }
    }
}

fn compare() -> Result<bool, Error> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut clocks = 20_000;
    if arguments.first().is_some_and(|first| first == "--clocks") {
        let number = arguments.get(1).and_then(|text| text.parse().ok());
        clocks = number.ok_or_else(|| Error::Option("--clocks needs a number".to_owned()))?;
        arguments.drain(..2);
    }
    let blocks = library_named(&arguments)?;
    println!("| block | instance | outputs | clocks | Verilator = Icarus | after reset, nothing preset | seconds |");
    println!("|---|---|---|---|---|---|---|");
    let compared = |block: &dyn Block| -> Result<(String, bool), Error> {
        let folder = tempfile::tempdir()
            .map_err(|cause| Error::Option(format!("no temporary folder for the waveforms: {cause}")))?;
        let outcome = run(block, clocks, 1, folder.path())?;
        let row = format!(
            "| {} | {} | {} | {clocks} | {} | {} | {:.1} |",
            block.name(),
            block.instance(),
            outputs(block),
            verdict(&outcome, &outcome.waves),
            verdict(&outcome, &outcome.unset),
            outcome.time.as_secs_f64()
        );
        Ok((row, outcome.is_good()))
    };
    let rows = cores::each(&blocks, |block| compared(block.as_ref()), |(row, _)| println!("{row}"))?;
    Ok(rows.iter().all(|(_, is_good)| *is_good))
}

fn verdict(outcome: &CrosssimOutcome, waves: &wavecmp::diff::Comparison) -> String {
    match waves.differences.first() {
        Some(first) => format!("{} differs at {}", first.signal, waves.time(first.time)),
        None if waves.result == DiffVerdict::Equal && outcome.is_good() => "equal".to_owned(),
        None if waves.result == DiffVerdict::Equal => "equal, but not to the model, or not whole".to_owned(),
        None => waves.notes.join("; "),
    }
}
