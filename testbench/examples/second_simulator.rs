//! Runs every block under Verilator and under Icarus, and compares their waveforms:
//! `cargo run --release --example second_simulator [-- --clocks N] [BLOCK…]`.
//!
//! Prints a row per block. Exit status: 0 if all are equal, 1 otherwise, 2 if it cannot run, 3 if a tool is missing.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::process::ExitCode;

use posicast_testbench::Error;
use posicast_testbench::blocks::library_named;
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
    let mut is_good = true;
    for block in blocks {
        let folder = tempfile::tempdir()
            .map_err(|cause| Error::Option(format!("no temporary folder for the waveforms: {cause}")))?;
        let outcome = run(block.as_ref(), clocks, 1, folder.path())?;
        println!(
            "| {} | {} | {} | {clocks} | {} | {} | {:.1} |",
            block.name(),
            block.instance(),
            outputs(block.as_ref()),
            verdict(&outcome, &outcome.waves),
            verdict(&outcome, &outcome.unset),
            outcome.time.as_secs_f64()
        );
        is_good &= outcome.is_good();
    }
    Ok(is_good)
}

fn verdict(outcome: &CrosssimOutcome, waves: &wavecmp::diff::Comparison) -> String {
    match waves.differences.first() {
        Some(first) => format!("{} differs at {}", first.signal, waves.time(first.time)),
        None if waves.result == DiffVerdict::Equal && outcome.is_good() => "equal".to_owned(),
        None if waves.result == DiffVerdict::Equal => "equal, but not to the model, or not whole".to_owned(),
        None => waves.notes.join("; "),
    }
}
