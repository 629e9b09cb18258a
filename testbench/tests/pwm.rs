//! Checks the safety of the gates in the PWM's Verilog: no leg is ever on at both ends, with each polarity of the pins.

use crate::support::{assert_match, broken};
use posicast_blocks::pwm::{ActiveLow, PwmConfig};
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::lockstep::report::LockstepReport;
use posicast_testbench::lockstep::{self, LockstepOptions};
use posicast_testbench::pwm::{GateSafety, PwmBlock, PwmRandom};

/// Runs the Verilog with the first `from` replaced by `to`; returns the comparison and the first violation.
fn run(config: PwmConfig, (from, to): (&str, &str), clocks: u64) -> (LockstepReport, Option<String>) {
    let block = PwmBlock::new(config, "", "alone");
    let sources = Sources::of_modules(&broken(&block.modules().unwrap(), from, to)).unwrap();
    let mut device = sources.verilated(&block, 1).unwrap();
    let mut model = block.model(1);
    let instances = block.instances(model.ports());
    let mut safety = GateSafety::new(config.active_low());
    let report = lockstep::run(
        model.as_mut(),
        &mut device,
        &mut PwmRandom::new(1),
        &instances,
        &LockstepOptions::cycles(clocks),
        &mut |clock| safety.observe(clock.actual),
        &mut |_| {},
    );
    (report.unwrap(), safety.violation().map(str::to_owned))
}

#[test]
fn lockstep_no_leg_is_on_at_both_ends() {
    let inverted = ActiveLow {
        a_high: true,
        b_low: true,
        ..ActiveLow::default()
    };
    for (active_low, dead_time, pulse) in [(ActiveLow::default(), 2, 1), (inverted, 1, 7)] {
        let config = PwmConfig::new(active_low, dead_time, pulse).unwrap();
        let (report, violation) = run(config, ("", ""), 400_000);
        assert_match(&report, "random clocks");
        assert_eq!(violation, None);
    }
}

#[test]
fn lockstep_watches_the_gates_of_a_leg_without_dead_time() {
    let config = PwmConfig::new(ActiveLow::default(), 2, 1).unwrap();
    let (_, violation) = run(config, ("lasts = dead_time;", "lasts = 10'd1;"), 600_000);
    assert!(violation.is_some(), "the gates' safety is not checked");
}
