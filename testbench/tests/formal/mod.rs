//! Checks that each property file fails on a block with a deliberate fault; `blocks.rs` proves the blocks themselves.
//!
//! A result that stands in `formal/results.txt` for the same fingerprint of the task is not computed again: see [`results`].

mod blocks;
mod bus;
mod controller;
mod results;
mod shapers;
mod supervisor;

use crate::support;
use std::time::Duration;

use posicast_testbench::blocks::proofs_named;
use posicast_testbench::formal::{ProofVerdict, Task, proves, search};

const LIMIT: Duration = Duration::from_secs(120);

/// Replaces the first `from` in the block's Verilog by `to`, and requires a counterexample to a property whose name
/// begins with `property`.
#[track_caller]
pub(crate) fn fails(name: &str, from: &str, to: &str, expected: &str) {
    let task = broken(name, from, to);
    let property = results::known_or(&task, "counterexample", || {
        let folder = tempfile::tempdir().unwrap();
        match search(&task, folder.path(), LIMIT).unwrap() {
            ProofVerdict::Counterexample { property, waveform, .. } => {
                assert!(std::fs::metadata(waveform).unwrap().len() > 1000, "no waveform");
                property
            }
            other => panic!("`{to}` is not found: {other:?}"),
        }
    });
    assert!(property.starts_with(expected), "`{to}`: {property}");
}

/// As [`fails`], for a counterexample that is further from the reset than the search goes: the proof of the broken
/// block must not succeed, whereas that of the block does.
#[track_caller]
pub(crate) fn is_no_longer_proven(name: &str, from: &str, to: &str) {
    let task = broken(name, from, to);
    results::known_or(&task, "no proof", || {
        let folder = tempfile::tempdir().unwrap();
        assert!(!proves(&task, folder.path(), LIMIT).unwrap(), "`{to}`");
        "none found".to_owned()
    });
}

#[track_caller]
fn broken(name: &str, from: &str, to: &str) -> Task {
    let mut task = proofs_named(name).unwrap().swap_remove(0);
    task.modules = support::broken(&task.modules, from, to);
    task
}
