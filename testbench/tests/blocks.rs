//! The same tests for every block of the registry, so that a block that is added has them.
//!
//! | test | what holds |
//! |---|---|
//! | `ports::BLOCK` | the Verilog has the ports of the model |
//! | `lockstep::BLOCK` | Verilator's lint has no warning; in a million random clocks all outputs equal the model's; every case is reached |
//! | `lockstep::long_BLOCK` | the same with the other seeds, or of a size that takes long |
//! | `crosssim::BLOCK` | Icarus agrees with the model, and shows no `x` |
//! | `rusthdl::BLOCK` | RustHDL's simulator agrees with the model |
//! | `mutate::BLOCK::FAULT` | the stimuli find the fault in the Verilog |
//! | `formal::…` | the proofs: see `proofs.rs` |
//!
//! Sizes and faults are rows in `testbench/src/BLOCK/trials.rs`.

#![allow(
    clippy::print_stderr,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "this is a program of tests"
)]

mod proofs;
mod results;
mod support;

use std::process::ExitCode;
use std::sync::Arc;

use libtest_mimic::{Arguments, Trial as Test};
use posicast_testbench::blocks::{self, BlockTrials, Trial, rusthdl};

/// RustHDL's simulator is slow.
const RUSTHDL_CLOCKS: u64 = 3_000;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let all = match blocks::trials() {
        Ok(all) => all,
        Err(error) => {
            eprintln!("a row of the registry has an invalid size: {error}");
            return ExitCode::FAILURE;
        }
    };
    let proofs = match proofs::tests(&all) {
        Ok(proofs) => proofs,
        Err(error) => {
            eprintln!("the folders of the blocks cannot be read: {error}");
            return ExitCode::FAILURE;
        }
    };
    let tests = all.into_iter().flat_map(tests_of).chain(proofs).collect();
    libtest_mimic::run(&arguments, tests).exit_code()
}

fn tests_of(block: BlockTrials) -> Vec<Test> {
    let name = block.name;
    let trials: Vec<Arc<Trial>> = block.trials.into_iter().map(Arc::new).collect();
    let mut tests = Vec::new();
    for mutant in block.mutants {
        let trial = trials
            .iter()
            .find(|trial| mutant.size.is_empty() || trial.size == mutant.size);
        let trial = trial.map(Arc::clone);
        tests.push(Test::test(
            format!("mutate::{name}::{}", snake_case(mutant.name)),
            move || {
                let trial = trial.ok_or_else(|| format!("`{name}` has no size `{}`", mutant.size))?;
                support::caught(trial.block.as_ref(), mutant.from, mutant.to, mutant.clocks);
                Ok(())
            },
        ));
    }
    for (at, trial) in trials.iter().enumerate() {
        let size = match trial.size {
            "" => String::new(),
            size => format!("::{}", snake_case(size)),
        };
        let mut add = |test: String, check: fn(&Trial)| {
            let trial = Arc::clone(trial);
            tests.push(Test::test(test, move || {
                check(&trial);
                Ok(())
            }));
        };
        add(format!("ports::{name}{size}"), verilog_has_the_ports_of_the_model);
        let (short, long) = trial.short_and_long_seeds();
        if !short.is_empty() {
            add(format!("lockstep::{name}{size}"), |trial| {
                random_clocks_are_equal(trial, trial.short_and_long_seeds().0);
            });
        }
        if !long.is_empty() {
            add(format!("lockstep::long_{name}{size}"), |trial| {
                random_clocks_are_equal(trial, trial.short_and_long_seeds().1);
            });
        }
        if at == 0 {
            add(format!("crosssim::{name}"), |trial| {
                support::icarus_agrees(trial.block.as_ref());
            });
            if trial.block.in_rusthdl() {
                add(format!("rusthdl::{name}"), rusthdl_agrees);
            }
        }
    }
    tests
}

fn snake_case(words: &str) -> String {
    let words = words.split(|letter: char| !letter.is_ascii_alphanumeric());
    words
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join("_")
        .to_lowercase()
}

fn verilog_has_the_ports_of_the_model(trial: &Trial) {
    let modules = trial.block.modules().unwrap();
    let top = modules.last().unwrap();
    assert_eq!(top.name, trial.block.top());
    assert_eq!(top.ports, trial.block.model(1).ports());
}

fn random_clocks_are_equal(trial: &Trial, seeds: &[u64]) {
    for seed in seeds {
        let run = support::million_random_clocks(trial.block.as_ref(), *seed, trial.least);
        for (name, count) in run
            .coverage
            .iter()
            .filter(|(name, _)| trial.often.contains(&name.as_str()))
        {
            assert!(*count > 20, "{name}: {:?}", run.coverage);
        }
    }
}

fn rusthdl_agrees(trial: &Trial) {
    let block = trial.block.as_ref();
    let mut device = rusthdl(block).unwrap();
    let report = blocks::check(block, device.as_mut(), RUSTHDL_CLOCKS, 4, &mut |_| {}).unwrap();
    support::assert_match(&report, "RustHDL");
}
