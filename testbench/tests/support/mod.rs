//! What the lock-step tests of the blocks share: a bench from `posicast_testbench::blocks`, run and judged.

use posicast_hdl::emit::Module;
use posicast_testbench::blocks::{self, Block, Run, Sources};
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};

/// Insists on a match, and shows the first mismatch.
#[track_caller]
pub(crate) fn assert_match(report: &LockstepReport, what: &str) {
    for block in &report.blocks {
        if let Some(first) = &block.first {
            panic!("{what}, {}: {} mismatches\n{first}", block.instance, block.mismatches);
        }
    }
    assert_eq!(report.result, LockstepVerdict::Match, "{what}");
}

/// Lint clean; a million random clocks equal; every bin hit `least` times and more.
#[track_caller]
pub(crate) fn million_random_clocks(block: &dyn Block, seed: u64, least: u64) -> Run {
    let sources = Sources::write(block).unwrap();
    assert_eq!(sources.lint(block).unwrap(), [""; 0]);
    let mut device = sources.verilated(block, seed).unwrap();
    let run = blocks::compare(block, &mut device, 1_000_000, seed, &mut |_| {}).unwrap();
    assert_match(&run.report, &format!("seed {seed}"));
    assert_eq!(run.rare(least), [""; 0], "{:?}", run.coverage);
    run
}

/// The second simulator agrees, and shows no `x`.
#[track_caller]
pub(crate) fn icarus_agrees(block: &dyn Block) {
    let mut device = Sources::write(block).unwrap().icarus(block).unwrap();
    let report = blocks::check(block, &mut device, 20_000, 4, &mut |_| {}).unwrap();
    assert_match(&report, "Icarus");
}

/// Replaces the first `from` in the block's Verilog by `to`, and insists on a mismatch within so many clocks.
#[track_caller]
pub(crate) fn caught(block: &dyn Block, from: &str, to: &str, cycles: u64) {
    let sources = Sources::of_modules(&broken(block, from, to)).unwrap();
    let mut device = sources.verilated(block, 1).unwrap();
    let report = blocks::check(block, &mut device, cycles, 1, &mut |_| {}).unwrap();
    assert_eq!(report.result, LockstepVerdict::Mismatch, "`{to}` is not found");
    let first = report.blocks[0].first.as_ref().unwrap();
    assert_eq!(first.expected.len(), first.actual.len());
    assert_ne!(first.expected, first.actual);
    let text = first.to_string();
    assert!(
        text.contains(&first.time.to_string()) && text.contains("(device)"),
        "{text}"
    );
}

/// The block's Verilog with the first `from` replaced by `to`.
#[track_caller]
pub(crate) fn broken(block: &dyn Block, from: &str, to: &str) -> Vec<Module> {
    let mut modules = block.modules().unwrap();
    let found = modules.iter_mut().find(|module| module.text.contains(from));
    let module = found.unwrap_or_else(|| panic!("the Verilog no longer has `{from}`: adapt the test"));
    module.text = module.text.replacen(from, to, 1);
    modules
}
