//! Proves the properties (`testbench/src/*/*.sv`) of the blocks:
//! `cargo run --example formal [-- BLOCK…]`.
//!
//! Prints a row per proof. Exit status: 0 if all properties are proven and all covers reached, 1 otherwise, 2 if it
//! cannot run, 3 if a tool is missing. `POSICAST_FORMAL_KEEP` names a folder that keeps all files, including
//! counterexamples as VCD; `POSICAST_FORMAL_SECONDS` limits each run of an engine (900).
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use posicast_system::cores;
use posicast_testbench::Error;
use posicast_testbench::blocks::{proofs, proofs_named};
use posicast_testbench::formal::{ProofOutcome, ProofVerdict, Task, run};

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
    let blocks: Vec<String> = std::env::args().skip(1).collect();
    let mut tasks = Vec::new();
    for block in &blocks {
        tasks.extend(proofs_named(block)?);
    }
    if blocks.is_empty() {
        tasks = proofs()?;
    }
    let seconds = std::env::var("POSICAST_FORMAL_SECONDS")
        .ok()
        .and_then(|text| text.parse().ok());
    let limit = Duration::from_secs(seconds.unwrap_or(900));
    let temporary = std::env::temp_dir().join(format!("posicast-formal-{}", std::process::id()));
    let kept = std::env::var_os("POSICAST_FORMAL_KEEP").map(PathBuf::from);
    let folder = kept.clone().unwrap_or_else(|| temporary.clone());

    println!("| block | size | engine | assertions | result | covers reached | seconds |");
    println!("|---|---|---|---|---|---|---|");
    let tasks: Vec<(usize, Task)> = tasks.into_iter().enumerate().collect();
    let proven = |(at, task): &(usize, Task)| {
        let outcome = run(task, &folder.join(format!("{at}_{}", task.name)), limit)?;
        Ok::<_, Error>((row(task, &outcome), outcome.is_good()))
    };
    let rows = cores::each(&tasks, proven, |(row, _)| println!("{row}"))?;
    let is_good = rows.iter().all(|(_, is_good)| *is_good);
    if kept.is_none() && is_good {
        // A file that cannot be deleted stays in the temporary folder; that is no reason to fail.
        let _ = std::fs::remove_dir_all(&temporary);
    }
    Ok(is_good)
}

fn row(task: &Task, outcome: &ProofOutcome) -> String {
    let result = match &outcome.verdict {
        ProofVerdict::Proven => "proven".to_owned(),
        ProofVerdict::Counterexample {
            property,
            clock,
            waveform,
        } => format!("`{property}` fails in clock {clock}: {}", waveform.display()),
        ProofVerdict::Unknown => "unknown".to_owned(),
    };
    let missed: Vec<&str> = outcome
        .covers
        .iter()
        .filter(|cover| cover.clock.is_none())
        .map(|cover| cover.name.as_str())
        .collect();
    let reached = outcome.covers.len() - missed.len();
    let covers = match missed.len() {
        0 => format!("{reached} of {reached}"),
        _ => format!("{reached} of {}, not {}", outcome.covers.len(), missed.join(", ")),
    };
    format!(
        "| {} | {} | {} | {} | {result} | {covers} | {:.1} |",
        task.name,
        task.size,
        task.engine.name(),
        outcome.assertions,
        outcome.time.as_secs_f64()
    )
}
