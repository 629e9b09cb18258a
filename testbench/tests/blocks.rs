//! The same tests for every block of the registry, so that a block that is added has them.
//!
//! | test | what holds |
//! |---|---|
//! | `ports::BLOCK` | the Verilog has the ports of the model |
//! | `lockstep::BLOCK` | Verilator's lint has no warning; in a million random clocks all outputs equal the model's; every case is reached |
//! | `lockstep::long_BLOCK` | the same with the other seeds |
//! | `crosssim::BLOCK` | Icarus agrees with the model, and shows no `x` |
//! | `rusthdl::BLOCK` | RustHDL's simulator agrees with the model |
//! | `mutate::BLOCK::FAULT` | the stimuli find the fault in the Verilog |
//! | `formal::FILE` | all proofs with the property file `testbench/src/*/FILE.sv` succeed, and all their covers are reached |
//!
//! Sizes and faults are rows in `testbench/src/BLOCK/trials.rs`.

#![allow(
    clippy::print_stderr,
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "this is a program of tests"
)]

#[path = "formal/results.rs"]
mod results;

use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use libtest_mimic::{Arguments, Failed, Trial as Test};
use posicast_testbench::blocks::{self, Block, BlockMutant, BlockTrials, Run, Sources, Trial, rusthdl};
use posicast_testbench::formal;
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use posicast_testbench::lockstep::{self, Device, LockstepOptions};
use posicast_testbench::mutation::NamedMutant;

const CLOCKS: u64 = 1_000_000;
/// The slow simulators run this many clocks.
const ICARUS_CLOCKS: u64 = 20_000;
const RUSTHDL_CLOCKS: u64 = 3_000;
const ICARUS_SEED: u64 = 4;
/// Time of a proof whose result is not recorded.
const PROOF_LIMIT: Duration = Duration::from_secs(500);
/// Cases of a shaper that a million clocks reach often.
const OFTEN: [&str; 4] = ["swaps", "saturated", "handovers", "handovers over"];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let all = match blocks::trials() {
        Ok(all) => all,
        Err(error) => {
            eprintln!("a row of the registry has an invalid size: {error}");
            return ExitCode::FAILURE;
        }
    };
    let files = match property_files() {
        Ok(files) => files,
        Err(error) => {
            eprintln!("the folders of the blocks cannot be read: {error}");
            return ExitCode::FAILURE;
        }
    };
    let proofs = files
        .into_iter()
        .map(|file| Test::test(format!("formal::{file}"), move || is_proven(&file)));
    let tests = all.into_iter().flat_map(tests_of).chain(proofs).collect();
    libtest_mimic::run(&arguments, tests).exit_code()
}

/// Names of the property files in the folders of the blocks.
fn property_files() -> std::io::Result<Vec<String>> {
    let mut files = Vec::new();
    for folder in Path::new(env!("CARGO_MANIFEST_DIR")).join("src").read_dir()? {
        let folder = folder?.path();
        if !folder.is_dir() {
            continue;
        }
        for file in folder.read_dir()? {
            let file = file?.path();
            let name = file.file_stem().and_then(|name| name.to_str());
            files.extend(
                name.filter(|_| file.extension().is_some_and(|end| end == "sv"))
                    .map(str::to_owned),
            );
        }
    }
    files.sort();
    Ok(files)
}

fn is_proven(file: &str) -> Result<(), Failed> {
    for task in &blocks::proofs_named(file)? {
        let result = results::known_or(task, "proven", || {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let outcome = formal::run(task, folder.path(), PROOF_LIMIT).expect("the proof runs");
            assert!(outcome.is_good(), "{outcome:?}");
            assert!(outcome.assertions > 1 && !outcome.covers.is_empty(), "{outcome:?}");
            format!("{} assertions, {} covers", outcome.assertions, outcome.covers.len())
        });
        if !result.ends_with(" covers") {
            return Err(format!("{}: {result}", task.name).into());
        }
    }
    Ok(())
}

fn tests_of(block: BlockTrials) -> Vec<Test> {
    let mut tests = Vec::new();
    let name = block.name;
    for mutant in block.mutants {
        let test = format!("mutate::{name}::{}", snake_case(mutant.name));
        tests.push(Test::test(test, move || is_found(name, mutant)));
    }
    for (at, trial) in block.trials.into_iter().enumerate() {
        let size = match trial.size {
            "" => String::new(),
            size => format!("::{}", snake_case(size)),
        };
        let of = move |what: fn(&Trial) -> Result<(), Failed>| move || what(&trial_of(name, at)?);
        tests.push(Test::test(
            format!("ports::{name}{size}"),
            of(verilog_has_the_ports_of_the_model),
        ));
        tests.push(Test::test(
            format!("lockstep::{name}{size}"),
            of(random_clocks_are_equal),
        ));
        if trial.seeds.len() > 1 {
            tests.push(Test::test(
                format!("lockstep::long_{name}{size}"),
                of(other_seeds_are_equal),
            ));
        }
        if at == 0 {
            tests.push(Test::test(format!("crosssim::{name}"), of(icarus_agrees)));
            if trial.block.in_rusthdl() {
                tests.push(Test::test(format!("rusthdl::{name}"), of(rusthdl_agrees)));
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

fn trial_of(name: &str, at: usize) -> Result<Trial, Failed> {
    let all = blocks::trials()?;
    let block = all.into_iter().find(|block| block.name == name);
    let trial = block.and_then(|block| block.trials.into_iter().nth(at));
    trial.ok_or_else(|| format!("`{name}` has no size {at}").into())
}

fn matches(report: &LockstepReport, what: &str) -> Result<(), Failed> {
    if let Some(first) = report.blocks.iter().find_map(|block| block.first.as_ref()) {
        return Err(format!("{what}: {} mismatches\n{first}", report.mismatches()).into());
    }
    match report.result {
        LockstepVerdict::Match => Ok(()),
        _ => Err(format!("{what}: no verdict").into()),
    }
}

fn verilog_has_the_ports_of_the_model(trial: &Trial) -> Result<(), Failed> {
    let modules = trial.block.modules()?;
    let top = modules.last().ok_or("no module")?;
    let model = trial.block.model(1);
    if top.name == trial.block.top() && top.ports == model.ports() {
        Ok(())
    } else {
        Err(format!(
            "`{}` has the ports {:?}, and the model {:?}",
            top.name,
            top.ports,
            model.ports()
        )
        .into())
    }
}

fn random_clocks_are_equal(trial: &Trial) -> Result<(), Failed> {
    let block = trial.block.as_ref();
    let sources = Sources::write(block)?;
    let warnings = sources.lint(block)?;
    if !warnings.is_empty() {
        return Err(warnings.join("\n").into());
    }
    run_is_equal(trial, &sources, trial.seeds[0])
}

fn other_seeds_are_equal(trial: &Trial) -> Result<(), Failed> {
    let sources = Sources::write(trial.block.as_ref())?;
    trial.seeds[1..]
        .iter()
        .try_for_each(|seed| run_is_equal(trial, &sources, *seed))
}

fn run_is_equal(trial: &Trial, sources: &Sources, seed: u64) -> Result<(), Failed> {
    let block = trial.block.as_ref();
    let mut device = sources.verilated(block, seed)?;
    let run = blocks::compare(block, &mut device, CLOCKS, seed, &mut |_| {})?;
    matches(&run.report, &format!("seed {seed}"))?;
    reaches_every_case(&run, trial.least)
}

fn reaches_every_case(run: &Run, least: u64) -> Result<(), Failed> {
    let mut rare = run.rare(least);
    let is_rare = |(name, count): &&(String, u64)| OFTEN.contains(&name.as_str()) && *count <= 20;
    rare.extend(run.coverage.iter().filter(is_rare).map(|(name, _)| name.as_str()));
    if rare.is_empty() {
        Ok(())
    } else {
        Err(format!("too rare: {rare:?} of {:?}", run.coverage).into())
    }
}

fn agrees(block: &dyn Block, device: &mut dyn Device, clocks: u64, what: &str) -> Result<(), Failed> {
    let report = blocks::check(block, device, clocks, ICARUS_SEED, &mut |_| {})?;
    matches(&report, what)
}

fn icarus_agrees(trial: &Trial) -> Result<(), Failed> {
    let block = trial.block.as_ref();
    let mut device = Sources::write(block)?.icarus(block)?;
    agrees(block, &mut device, ICARUS_CLOCKS, "Icarus")
}

fn rusthdl_agrees(trial: &Trial) -> Result<(), Failed> {
    let block = trial.block.as_ref();
    agrees(block, rusthdl(block)?.as_mut(), RUSTHDL_CLOCKS, "RustHDL")
}

fn is_found(name: &str, mutant: &BlockMutant) -> Result<(), Failed> {
    let all = blocks::trials()?;
    let trials = all
        .into_iter()
        .find(|block| block.name == name)
        .map(|block| block.trials);
    let trials = trials.into_iter().flatten();
    let trial = trials
        .into_iter()
        .find(|trial| mutant.size.is_empty() || trial.size == mutant.size);
    let trial = trial.ok_or_else(|| format!("`{name}` has no size `{}`", mutant.size))?;
    let block = trial.block.as_ref();
    let fault = NamedMutant {
        name: mutant.name,
        module: None,
        from: mutant.from,
        to: mutant.to,
    };
    let sources = Sources::of_modules(&fault.put_into(&block.modules()?)?)?;
    let mut device = sources.verilated(block, 1)?;
    let mut model = block.model(1);
    let instances = block.instances(model.ports());
    let report = lockstep::run_until(
        model.as_mut(),
        &mut device,
        block.stimuli(mutant.clocks, 1).as_mut(),
        &instances,
        &LockstepOptions::cycles(mutant.clocks),
        &mut |clock: &lockstep::Clock<'_>| {
            if clock.expected == clock.actual {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        },
        &mut |_| {},
    )?;
    let Some(first) = report.blocks.iter().find_map(|block| block.first.as_ref()) else {
        return Err(format!("`{}` is not found in {} clocks", mutant.to, mutant.clocks).into());
    };
    let text = first.to_string();
    if text.contains(&first.time.to_string()) && text.contains("(device)") {
        Ok(())
    } else {
        Err(format!("the mismatch does not show its clock: {text}").into())
    }
}
