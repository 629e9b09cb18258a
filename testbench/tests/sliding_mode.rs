//! The controller's Verilog compared with its bit-exact model: every output in every clock.

use crate::support;

use posicast_blocks::sliding_mode::{CONTROL_CLOCKS, Inputs};
use posicast_testbench::blocks;
use posicast_testbench::blocks::Sources;
use posicast_testbench::sliding_mode::SlidingModeBlock;
use support::assert_match;

fn sliding_mode() -> SlidingModeBlock {
    SlidingModeBlock::new("", "alone")
}

/// Returns the count of limited ticks after this many ticks, each of which limits.
fn limited_ticks(ticks: u64) -> u64 {
    let block = sliding_mode();
    let mut clock = 0;
    let mut stimuli = |seen: &[u64], inputs: &mut [u64]| {
        clock += 1;
        // Every gain is 1/2 and the limit 1: every reference velocity exceeds it.
        let setting = if seen[0] == 11 { 1 } else { 0x1_0000 };
        let now = Inputs {
            rst: clock < 3,
            start: seen[6] == 0,
            velocity_reference: 1 << 20,
            setting,
            ..Inputs::default()
        };
        inputs.copy_from_slice(&now.to_raw());
    };
    let mut device = Sources::write(&block).unwrap().verilated(&block, 1).unwrap();
    let run = blocks::compare_with(
        &block,
        &mut device,
        &mut stimuli,
        ticks * (u64::from(CONTROL_CLOCKS) + 1),
        1,
        &mut |_| {},
    )
    .unwrap();
    assert_match(&run.report, "cut for ever");
    let counted = run.coverage.into_iter().find(|(name, _)| name == "limited_ticks");
    counted.unwrap().1
}

#[test]
fn lockstep_a_command_that_is_cut_is_counted() {
    assert_eq!(limited_ticks(1000), 1000);
}

#[test]
fn long_lockstep_a_command_that_is_cut_until_its_count_stops() {
    assert_eq!(limited_ticks(65_545), 65_535);
}
