//! Compares the waveforms of some blocks in two simulators, and checks faults that only this comparison finds.
//!
//! The example `second_simulator`, which `scripts/verify-all` runs, covers all blocks.

use crate::support::broken;
use posicast_blocks::divider::DividerConfig;
use posicast_testbench::blocks::{Block, library};
use posicast_testbench::crosssim::{self, CrosssimOutcome};
use posicast_testbench::divider::DividerBlock;
use posicast_testbench::lockstep::report;
use posicast_testbench::parts::{PartBlock, SmallPart};
use wavecmp::diff::DiffVerdict;

const CLOCKS: u64 = 3000;

fn divider() -> DividerBlock {
    DividerBlock::new(DividerConfig::new(5000).unwrap(), "")
}

/// Returns the outcome with the first `from` in the block's Verilog replaced by `to`.
fn after(block: &dyn Block, from: &str, to: &str) -> CrosssimOutcome {
    let modules = broken(&block.modules().unwrap(), from, to);
    let folder = tempfile::tempdir().unwrap();
    crosssim::run_modules(block, &modules, CLOCKS, 1, folder.path()).unwrap()
}

/// The blocks have clocked outputs and combinational ones, a memory, a multiplier and a bus.
#[test]
fn crosssim_waveforms_of_both_simulators_are_equal() {
    let names = ["divider", "group", "sample_select", "cascade", "registers"];
    let blocks = library().unwrap();
    for name in names {
        let block = blocks.iter().find(|block| block.name() == name).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let outcome = crosssim::run(block.as_ref(), CLOCKS, 1, folder.path()).unwrap();
        assert!(outcome.is_good(), "{name}: {outcome:?}");
        assert_eq!(outcome.waves.samples, CLOCKS, "{name}");
    }
}

/// The value at power-up hides the fault from every other run, until the second reset or for ever.
#[test]
fn crosssim_a_register_without_reset_is_x_after_it() {
    let outcome = after(&divider(), "        saturated_q <= 1'd0;\n", "");
    assert_eq!(outcome.unset.result, DiffVerdict::Different);
    let first = &outcome.unset.differences[0];
    assert_eq!(first.signal, "posicast_bench.saturated");
    assert!(format!("{:?}", first.b).contains('x'), "{first:?}");
    assert!(!outcome.is_good());
}

#[test]
fn crosssim_a_wire_that_nothing_drives_is_found_in_the_waveforms() {
    let outcome = after(&divider(), "    assign busy = busy_q;\n", "");
    let first = &outcome.waves.differences[0];
    assert_eq!(
        (outcome.waves.result, first.signal.as_str()),
        (DiffVerdict::Different, "posicast_bench.busy")
    );
}

/// The simulators read different Verilog, here because of a macro, as if one of them had a bug.
#[test]
fn crosssim_a_difference_between_the_simulators_is_found() {
    let from = "        refused_q <= start & blocked;";
    let to = format!("`ifdef __ICARUS__\n        refused_q <= start;\n`else\n{from}\n`endif");
    let outcome = after(&PartBlock::new(SmallPart::Group(2), ""), from, &to);
    assert_eq!(outcome.verilator.result, report::LockstepVerdict::Match);
    assert_eq!(outcome.waves.result, DiffVerdict::Different);
    assert!(!outcome.is_good());
}
