//! Runs the quick proofs, and checks that each property file fails on a block with a deliberate fault.

mod blocks;
mod bus;
mod controller;
mod shapers;
mod supervisor;

use crate::support;
use std::time::Duration;

use posicast_testbench::blocks::proofs_named;
use posicast_testbench::formal::{ProofVerdict, Task, proves, run, search};

const LIMIT: Duration = Duration::from_secs(120);

#[track_caller]
pub(crate) fn proven(name: &str, size: usize) {
    let folder = tempfile::tempdir().unwrap();
    let outcome = run(&proofs_named(name).unwrap()[size], folder.path(), LIMIT).unwrap();
    assert!(outcome.is_good(), "{outcome:?}");
    assert!(outcome.assertions > 1 && !outcome.covers.is_empty(), "{outcome:?}");
}

/// Replaces the first `from` in the block's Verilog by `to`, and requires a counterexample to a property whose name
/// begins with `property`.
#[track_caller]
pub(crate) fn fails(name: &str, from: &str, to: &str, expected: &str) {
    let task = broken(name, from, to);
    let folder = tempfile::tempdir().unwrap();
    match search(&task, folder.path(), LIMIT).unwrap() {
        ProofVerdict::Counterexample { property, waveform, .. } => {
            assert!(property.starts_with(expected), "`{to}`: {property}");
            assert!(std::fs::metadata(waveform).unwrap().len() > 1000, "no waveform");
        }
        other => panic!("`{to}` is not found: {other:?}"),
    }
}

/// As [`fails`], for a counterexample that is further from the reset than the search goes: the proof of the broken
/// block must not succeed, whereas that of the block does.
#[track_caller]
pub(crate) fn is_no_longer_proven(name: &str, from: &str, to: &str) {
    let folder = tempfile::tempdir().unwrap();
    assert!(
        !proves(&broken(name, from, to), folder.path(), LIMIT).unwrap(),
        "`{to}`"
    );
}

#[track_caller]
fn broken(name: &str, from: &str, to: &str) -> Task {
    let mut task = proofs_named(name).unwrap().swap_remove(0);
    task.modules = support::broken(&task.modules, from, to);
    task
}
