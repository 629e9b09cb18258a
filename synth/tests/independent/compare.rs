//! The position compare's Verilog in Icarus, at walks whose pulses are worked out in Python from the datasheet.

use super::{output, python, write};
use posicast_testbench::blocks::Block;
use posicast_testbench::compare::CompareBlock;
use serde_json::{Value, json};
use std::path::Path;

/// Runs the bench; returns how often each kind of pulse came.
fn tally(walks: u64, seed: u64) -> Value {
    let block = CompareBlock::new("", "alone");
    let folder = tempfile::tempdir().unwrap();
    let modules = block.modules().unwrap();
    let files = modules
        .iter()
        .map(|module| write(folder.path(), &format!("{}.v", module.name), &module.text));
    let (top, build) = (block.top(), folder.path().join("build"));
    let mut run = python("run_cocotb.py");
    run.env("POSICAST_COMPARE", json!({"walks": walks, "seed": seed}).to_string());
    let said = output(
        run.args([Path::new("bench_compare"), Path::new(&top), &build])
            .args(files),
    );
    assert!(said.contains("1 tests, 0 failed"), "{said}");
    let (_, tally) = said.rsplit_once("tally ").unwrap();
    serde_json::from_str(tally.lines().next().unwrap()).unwrap()
}

#[test]
fn crosssim_compare_gives_the_pulses_of_its_datasheet() {
    let tally = tally(40, 1);
    for kind in ["row", "list", "upward", "downward", "merged", "held"] {
        assert!(tally[kind].as_u64().unwrap() >= 30, "{kind}: {tally}");
    }
}

#[test]
fn long_compare_gives_the_pulses_of_two_thousand_walks() {
    let tally = tally(2000, 2);
    assert!(tally["list"].as_u64().unwrap() >= 2000, "{tally}");
}
