//! Functions that the lock-step tests of the blocks share: they run a bench of `posicast_testbench::blocks` and check
//! the result.

use posicast_hdl::emit::Module;
use posicast_testbench::blocks::{self, Block, Run, Sources};
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use posicast_testbench::lockstep::{self, Device, LockstepOptions};
use posicast_testbench::named_mutant::NamedMutant;

/// Requires a match, and shows the first mismatch.
#[track_caller]
pub(crate) fn assert_match(report: &LockstepReport, what: &str) {
    for block in &report.blocks {
        if let Some(first) = &block.first {
            panic!("{what}, {}: {} mismatches\n{first}", block.instance, block.mismatches);
        }
    }
    assert_eq!(report.result, LockstepVerdict::Match, "{what}");
}

/// Checks that lint has no warnings, that a million random clocks are equal, and that every bin was hit at least
/// `least` times.
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

/// Checks that the second simulator agrees, and shows no `x`.
#[track_caller]
pub(crate) fn icarus_agrees(block: &dyn Block) {
    let mut device = Sources::write(block).unwrap().icarus(block).unwrap();
    let report = blocks::check(block, &mut device, 20_000, 4, &mut |_| {}).unwrap();
    assert_match(&report, "Icarus");
}

/// Replaces the first `from` in the block's Verilog by `to`, and requires a mismatch within this number of clocks.
///
/// Most faults show early: Icarus has compiled and run so many clocks before Verilator's program is compiled.
#[track_caller]
pub(crate) fn caught(block: &dyn Block, from: &str, to: &str, cycles: u64) {
    const EARLY_CLOCKS: u64 = 5_000;
    let sources = Sources::of_modules(&broken(&block.modules().unwrap(), from, to)).unwrap();
    let compare = |device: &mut dyn Device, clocks: u64| {
        let mut model = block.model(1);
        let instances = block.instances(model.ports());
        let to_the_first = LockstepOptions {
            mismatch_limit: 1,
            ..LockstepOptions::cycles(clocks)
        };
        let mut stimuli = block.stimuli(cycles, 1);
        lockstep::run(
            model.as_mut(),
            device,
            stimuli.as_mut(),
            &instances,
            &to_the_first,
            &mut |_| {},
            &mut |_| {},
        )
        .unwrap()
    };
    let mut report = compare(&mut sources.icarus(block).unwrap(), cycles.min(EARLY_CLOCKS));
    // Unknown bits are no fault that Verilator's program, or a board, would show.
    let first = report.blocks[0].first.as_ref();
    if first.is_none_or(|first| first.actual.contains('x')) {
        report = compare(&mut sources.verilated(block, 1).unwrap(), cycles);
    }
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

/// Returns the Verilog with a mutant that has the name of the test: the first `from` is replaced by `to`.
#[track_caller]
pub(crate) fn broken(modules: &[Module], from: &str, to: &str) -> Vec<Module> {
    let test = std::thread::current();
    let name = test.name().unwrap_or("of a test");
    let module = None;
    let mutant = NamedMutant { name, module, from, to };
    mutant
        .put_into(modules)
        .unwrap_or_else(|error| panic!("{error}: adapt the test"))
}
