//! The proofs of the blocks, and of blocks with a fault.
//!
//! | test | what holds |
//! |---|---|
//! | `formal::FILE` | all proofs with the property file `testbench/src/*/FILE.sv` succeed, and all their covers are reached |
//! | `formal::BLOCK::FAULT` | with the fault in the Verilog, a property fails, or the proof at least does not succeed |
//! | `formal::every_property_file_fails_on_a_fault` | each property file has such a fault |
//! | `formal::every_proof_is_recorded` | `formal/results.txt` has the result of each: see `results.rs` |

use std::collections::HashSet;
use std::path::Path;
use std::time::Duration;

use libtest_mimic::{Failed, Trial as Test};
use posicast_testbench::blocks::{self, BlockTrials, ProofMutant};
use posicast_testbench::formal::{self, ProofVerdict, Task};

use crate::results::{self, Question};
use crate::{snake_case, support};

/// Time of a proof whose result is not recorded.
const PROOF_LIMIT: Duration = Duration::from_secs(500);
/// Time of a search for a counterexample, and of the proof of a block with a fault.
const FAULT_LIMIT: Duration = Duration::from_secs(120);

/// A fault, and the block that has it.
type Fault = (&'static str, &'static ProofMutant);

/// The tests of all property files.
///
/// # Errors
/// The error of the system if a folder cannot be read.
pub(crate) fn tests(blocks: &[BlockTrials]) -> std::io::Result<Vec<Test>> {
    let of_block = |block: &BlockTrials| {
        let name = block.name;
        block.proof_mutants.iter().map(move |mutant| (name, mutant))
    };
    let faults: Vec<Fault> = blocks.iter().flat_map(of_block).collect();
    let files = property_files()?;
    let mut tests = results::tests();
    for file in &files {
        let file = file.clone();
        tests.push(Test::test(format!("formal::{file}"), move || is_proven(&file)));
    }
    for (block, mutant) in faults.clone() {
        let name = format!("formal::{block}::{}", snake_case(mutant.name));
        tests.push(Test::test(name, move || fails_on(block, mutant)));
    }
    let recorded = faults.clone();
    tests.push(Test::test("formal::every_proof_is_recorded", move || {
        every_proof_is_recorded(&recorded)
    }));
    tests.push(Test::test("formal::every_property_file_fails_on_a_fault", move || {
        every_file_fails_on_a_fault(&files, &faults)
    }));
    Ok(tests)
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
        let result = results::known_or(task, Question::IsProven, || {
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

/// The first proof with the property file of the fault, if there is one, with the fault in its Verilog.
fn with_fault(proofs: Vec<Task>, (block, mutant): Fault) -> Option<Task> {
    let file = mutant.file(block);
    let mut task = proofs.into_iter().find(|task| task.name == file)?;
    task.modules = support::broken(&task.modules, mutant.from, mutant.to);
    Some(task)
}

/// What is asked of a block with a fault.
fn question(mutant: &ProofMutant) -> Question {
    match mutant.violated {
        Some(_) => Question::Counterexample,
        None => Question::IsUnproven,
    }
}

/// Requires that the proof fails with the fault: a counterexample to the named property, or at least no success.
fn fails_on(block: &'static str, mutant: &'static ProofMutant) -> Result<(), Failed> {
    let proofs = blocks::proofs_named(mutant.file(block))?;
    let task = with_fault(proofs, (block, mutant)).ok_or("there is no such proof")?;
    let answer = results::known_or(&task, question(mutant), || {
        let folder = tempfile::tempdir().expect("a temporary folder");
        if mutant.violated.is_none() {
            let is_proven = formal::proves(&task, folder.path(), FAULT_LIMIT).expect("the proof runs");
            assert!(!is_proven, "`{}` is proven", mutant.to);
            return "none found".to_owned();
        }
        match formal::search(&task, folder.path(), FAULT_LIMIT).expect("the search runs") {
            ProofVerdict::Counterexample { property, waveform, .. } => {
                assert!(std::fs::metadata(waveform).unwrap().len() > 1000, "no waveform");
                property
            }
            other => panic!("`{}` is not found: {other:?}", mutant.to),
        }
    });
    match mutant.violated {
        Some(expected) if !answer.starts_with(expected) => Err(format!("`{}` violates {answer}", mutant.to).into()),
        _ => Ok(()),
    }
}

fn every_file_fails_on_a_fault(files: &[String], faults: &[Fault]) -> Result<(), Failed> {
    let with_fault: HashSet<&str> = faults.iter().map(|(block, mutant)| mutant.file(block)).collect();
    let without = files.iter().filter(|file| !with_fault.contains(file.as_str()));
    match without.cloned().collect::<Vec<_>>().join(", ") {
        none if none.is_empty() => Ok(()),
        without => Err(format!("no `ProofMutant` of a block is for {without}").into()),
    }
}

/// A proof that is not in the file is computed in every run of the tests, without a word.
fn every_proof_is_recorded(faults: &[Fault]) -> Result<(), Failed> {
    let proofs = blocks::proofs()?;
    assert!(proofs.len() > 1 && faults.len() > 1);
    let of_file = |file: &str| proofs.iter().find(|task| task.name == file).cloned();
    let faulty = faults.iter().filter_map(|&(block, mutant)| {
        let proof = of_file(mutant.file(block)).into_iter().collect();
        Some((with_fault(proof, (block, mutant))?, question(mutant)))
    });
    let whole = proofs.iter().map(|task| (task.clone(), Question::IsProven));
    let all: Vec<(Task, Question)> = whole.chain(faulty).collect();
    let is_missing = |(task, question): &&(Task, Question)| !results::is_recorded(task, *question);
    let missing: Vec<&str> = all.iter().filter(is_missing).map(|(task, _)| task.name).collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(format!(
        "{} of {} results are not in testbench/formal/results.txt; `scripts/record-proofs` writes it: {missing:?}",
        missing.len(),
        all.len()
    )
    .into())
}
