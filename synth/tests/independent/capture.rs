//! The position capture's Verilog in Icarus, at a probe that bounces in real time, axes and a host, written in Python from the
//! datasheet.

use super::{python, write};
use posicast_testbench::blocks::Block;
use posicast_testbench::capture::CaptureBlock;
use serde_json::{Value, json};
use std::path::Path;

/// Runs the bench on the Verilog, in which `from` is replaced by `to` if a fault is given; returns whether it passes, and what it
/// prints.
fn bench(runs: u64, seed: u64, fault: Option<(&str, &str)>) -> (bool, String) {
    let block = CaptureBlock::new("", "alone");
    let folder = tempfile::tempdir().unwrap();
    let mut faults = 0;
    let files: Vec<_> = block
        .modules()
        .unwrap()
        .into_iter()
        .map(|module| {
            let text = match fault {
                Some((from, to)) => {
                    faults += module.text.matches(from).count();
                    module.text.replace(from, to)
                }
                None => module.text,
            };
            write(folder.path(), &format!("{}.v", module.name), &text)
        })
        .collect();
    assert_eq!(faults, usize::from(fault.is_some()), "the Verilog has the text once");
    let asked = json!({ "runs": runs, "clocks": 1500, "seed": seed });
    let (top, build) = (block.top(), folder.path().join("build"));
    let mut run = python("run_cocotb.py");
    run.env("POSICAST_CAPTURE", asked.to_string());
    let ran = run
        .args([Path::new("bench_capture"), Path::new(&top), &build])
        .args(files);
    let ran = ran.output().unwrap();
    let said = String::from_utf8_lossy(&ran.stdout).into_owned() + &String::from_utf8_lossy(&ran.stderr);
    assert!(said.contains("1 tests, "), "the bench runs: {said}");
    (ran.status.success() && said.contains("1 tests, 0 failed"), said)
}

fn tally(runs: u64, seed: u64) -> Value {
    let (passes, said) = bench(runs, seed, None);
    assert!(passes, "{said}");
    let (_, tally) = said.rsplit_once("tally ").unwrap();
    serde_json::from_str(tally.lines().next().unwrap()).unwrap()
}

/// Asserts that a run had at least this many of each.
fn has(tally: &Value, least: u64) {
    for kind in [
        "captured",
        "taken",
        "cleared",
        "outside",
        "overflowed",
        "unwanted",
        "ignored",
        "known_high",
    ] {
        let count = tally[kind].as_u64().unwrap();
        assert!(count >= least, "{kind}: {tally}");
    }
}

#[test]
fn crosssim_capture_takes_the_positions_at_the_edges_of_a_probe() {
    has(&tally(12, 1), 4);
}

#[test]
fn the_bench_finds_a_capture_that_is_a_clock_early() {
    let (passes, said) = bench(
        12,
        2,
        Some(("lasts >= filter_clocks", "lasts + 16'd1 >= filter_clocks")),
    );
    assert!(!passes && said.contains("(shown, expected)"), "{said}");
}

#[test]
fn the_bench_finds_a_window_without_its_last_position() {
    let fault = ("position <= window_last", "position < window_last");
    let (passes, said) = bench(12, 3, Some(fault));
    assert!(!passes && said.contains("'outside'"), "{said}");
}

#[test]
fn long_captures_follow_a_probe_for_half_a_million_clocks() {
    for seed in 11..15 {
        has(&tally(85, seed), 30);
    }
}
