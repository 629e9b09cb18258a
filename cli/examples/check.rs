//! Checks one block, from its lint to its area, while it is being changed: `scripts/check BLOCK`.
//!
//! ```text
//! cargo run -p posicast --example check -- BLOCK [--clocks N]
//! ```
//!
//! The instances of the block are those of the registry (`testbench/src/blocks/registry.rs`), at the sizes of `library.rs`. Each is linted, run for N clocks (20,000) in
//! Verilator and in Icarus beside its model, which are compared with each other too, and measured by Yosys; then the proofs
//! of the block are run. Exit status: 0 all holds, 1 not so, 2 bad usage, 3 a tool is missing.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a program")]

use posicast_blocks::Port;
use posicast_synth::yosys::{Family, Yosys, YosysError};
use posicast_testbench::blocks::{self, Block, Sources, library};
use posicast_testbench::formal::{self, ProofVerdict};
use posicast_testbench::{Error, crosssim, lockstep};
use std::collections::BTreeSet;
use std::process::ExitCode;
use std::time::Duration;

/// Time limit of a proof: the longest, that of the PWM, takes 320 s on a quiet machine.
const PROOF: Duration = Duration::from_secs(900);

#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error(transparent)]
    Testbench(#[from] Error),
    #[error(transparent)]
    Yosys(#[from] YosysError),
    #[error("{0}")]
    Usage(String),
    #[error("no temporary folder: {0}")]
    Folder(#[from] std::io::Error),
}

fn main() -> ExitCode {
    match check() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(failure) => {
            eprintln!("{failure}");
            let is_missing = match &failure {
                Failure::Testbench(error) => error.is_missing_tool(),
                Failure::Yosys(error) => matches!(error, YosysError::Missing(_)),
                _ => false,
            };
            ExitCode::from(if is_missing { 3 } else { 2 })
        }
    }
}

/// The block and the number of clocks from the command line.
fn options() -> Result<(String, u64), Failure> {
    let usage = || Failure::Usage("usage: scripts/check BLOCK [--clocks N]".to_owned());
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [block] => Ok(((*block).to_owned(), 20_000)),
        [block, "--clocks", clocks] => {
            let clocks = clocks.parse().ok().filter(|clocks| *clocks > 0);
            Ok(((*block).to_owned(), clocks.ok_or_else(usage)?))
        }
        _ => Err(usage()),
    }
}

fn check() -> Result<bool, Failure> {
    let (name, clocks) = options()?;
    let mut blocks = library()?;
    let known: BTreeSet<String> = blocks.iter().map(|block| block.name().to_owned()).collect();
    blocks.retain(|block| block.name() == name);
    let mut proofs = blocks::proofs()?;
    proofs.retain(|task| task.name == name || task.name.starts_with(&format!("{name}_")));
    if blocks.is_empty() && proofs.is_empty() {
        let known: Vec<String> = known.into_iter().collect();
        return Err(Failure::Usage(format!(
            "there is no block `{name}`: the blocks are {}",
            known.join(", ")
        )));
    }
    let mut is_good = true;
    if !blocks.is_empty() {
        println!("| block | instance | lint | model = Verilator | model = Icarus | waveforms | LUT | flip-flops |");
        println!("|---|---|---|---|---|---|---|---|");
    }
    let yosys = Yosys::installed()?;
    for block in &blocks {
        is_good &= row(block.as_ref(), clocks, &yosys)?;
    }
    if proofs.is_empty() {
        println!("\nNo properties of `{name}` are stated in testbench/src: nothing is proven.");
        return Ok(is_good);
    }
    println!("\n| properties | size | result | seconds |\n|---|---|---|---|");
    for task in &proofs {
        let folder = tempfile::tempdir()?;
        let outcome = formal::run(task, folder.path(), PROOF)?;
        let result = match &outcome.verdict {
            ProofVerdict::Proven if outcome.is_good() => "proven".to_owned(),
            ProofVerdict::Proven => "proven, but a cover is not reached".to_owned(),
            ProofVerdict::Counterexample {
                property,
                clock,
                waveform,
            } => {
                let kept = folder.keep();
                let waveform = kept.join(waveform.file_name().unwrap_or_default());
                format!("**`{property}` fails in clock {clock}**: {}", waveform.display())
            }
            ProofVerdict::Unknown => "**unknown**: the engine found no answer".to_owned(),
        };
        println!(
            "| {} | {} | {result} | {:.1} |",
            task.name,
            task.size,
            outcome.time.as_secs_f64()
        );
        is_good &= outcome.is_good();
    }
    Ok(is_good)
}

/// Prints the row of an instance, and returns whether all of it holds.
fn row(block: &dyn Block, clocks: u64, yosys: &Yosys) -> Result<bool, Failure> {
    let sources = Sources::write(block)?;
    let warnings = sources.lint(block)?;
    warnings.iter().for_each(|warning| eprintln!("{warning}"));
    let waves = tempfile::tempdir()?;
    let outcome = crosssim::run(block, clocks, 1, waves.path())?;
    let matches = |report: &lockstep::report::LockstepReport| match report.mismatches() {
        0 => "equal".to_owned(),
        count => format!("**{count} wrong**"),
    };
    let same = if outcome.is_good() { "equal" } else { "**different**" };
    let ports: Vec<Port> = block.model(0).ports().to_vec();
    let area = yosys
        .estimate_alone(sources.files(), &block.top(), &ports, Family::Cyclone2)?
        .total;
    println!(
        "| {} | {} | {} | {} | {} | {same} | {} | {} |",
        block.name(),
        block.instance(),
        if warnings.is_empty() { "clean" } else { "**warnings**" },
        matches(&outcome.verilator),
        matches(&outcome.icarus),
        area.luts,
        area.registers
    );
    Ok(warnings.is_empty() && outcome.is_good())
}
