//! Compares the PWM's Verilog with its bit-exact model, every output in every clock, and checks the gates' safety.

use crate::support::broken;
use posicast_blocks::ClockedBlock;
use posicast_blocks::pwm::{ActiveLow, Pwm, PwmConfig, ports};
use posicast_hdl::pwm::{emit, name};
use posicast_testbench::blocks::Sources;
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use posicast_testbench::lockstep::{self, Device, Instance, LockstepOptions};
use posicast_testbench::pwm::{GateSafety, PwmCoverage, PwmRandom};
use posicast_testbench::verilator::{Verilated, VerilogSource, lint};

struct Bench {
    config: PwmConfig,
    top: String,
    sources: Sources,
}

struct Outcome {
    report: LockstepReport,
    coverage: PwmCoverage,
    violation: Option<String>,
}

fn plain() -> PwmConfig {
    PwmConfig::new(ActiveLow::default(), 2, 1).unwrap()
}

impl Bench {
    /// Compiles the PWM with the first `from` in the Verilog replaced by `to`.
    fn new(config: PwmConfig, from: &str, to: &str) -> Self {
        let modules = broken(&emit(&config, "").unwrap(), from, to);
        Self {
            config,
            top: name(&config, ""),
            sources: Sources::of_modules(&modules).unwrap(),
        }
    }

    fn run(&self, device: &mut dyn Device, seed: u64, cycles: u64) -> Outcome {
        let mut model = Pwm::new(&self.config);
        let instances = [Instance::whole("pwm", "alone", model.ports())];
        let mut coverage = PwmCoverage::default();
        let mut safety = GateSafety::new(self.config.active_low());
        let report = lockstep::run(
            &mut model,
            device,
            &mut PwmRandom::new(seed),
            &instances,
            &LockstepOptions::cycles(cycles),
            &mut |clock| {
                coverage.observe(clock.inputs, clock.expected);
                safety.observe(clock.actual);
            },
            &mut |_| {},
        );
        Outcome {
            report: report.unwrap(),
            coverage,
            violation: safety.violation().map(str::to_owned),
        }
    }

    fn source<'a>(&'a self, ports: &'a [posicast_blocks::Port]) -> VerilogSource<'a> {
        VerilogSource {
            files: self.sources.files(),
            top: &self.top,
            ports,
        }
    }

    fn verilated(&self, seed: u64) -> Verilated {
        let ports = ports();
        Verilated::build(&self.source(&ports), seed).unwrap()
    }
}

fn assert_holds(outcome: &Outcome) {
    if let Some(first) = &outcome.report.blocks[0].first {
        panic!("{} mismatches\n{first}", outcome.report.blocks[0].mismatches);
    }
    assert_eq!(outcome.report.result, LockstepVerdict::Match);
    assert_eq!(outcome.violation, None);
}

#[test]
fn lockstep_a_million_random_clocks() {
    let bench = Bench::new(plain(), "", "");
    assert_eq!(lint(bench.sources.files(), &bench.top).unwrap(), [""; 0]);
    for seed in 1..=2 {
        let outcome = bench.run(&mut bench.verilated(seed), seed, 1_000_000);
        assert_holds(&outcome);
        assert!(outcome.coverage.least() > 10, "{:?}", outcome.coverage.counts());
    }
}

#[test]
fn lockstep_other_polarities_and_floors() {
    let active_low = ActiveLow {
        a_high: true,
        b_low: true,
        ..ActiveLow::default()
    };
    let bench = Bench::new(PwmConfig::new(active_low, 1, 7).unwrap(), "", "");
    assert_eq!(lint(bench.sources.files(), &bench.top).unwrap(), [""; 0]);
    assert_holds(&bench.run(&mut bench.verilated(3), 3, 1_000_000));
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    let bench = Bench::new(plain(), "", "");
    let ports = ports();
    let mut icarus = Icarus::build(&bench.source(&ports)).unwrap();
    assert_holds(&bench.run(&mut icarus, 4, 20_000));
}

/// Breaks the Verilog and requires a mismatch.
fn caught(from: &str, to: &str) -> Outcome {
    let bench = Bench::new(plain(), from, to);
    let outcome = bench.run(&mut bench.verilated(1), 1, 600_000);
    assert_eq!(outcome.report.result, LockstepVerdict::Mismatch, "`{to}` is not found");
    outcome
}

#[test]
fn lockstep_catches_a_watchdog_that_a_feed_does_not_reset() {
    caught("waits = running & !feed", "waits = running");
}

#[test]
fn lockstep_catches_a_clear_while_the_fault_stands() {
    caught(
        "clear_trip & !running & latched & over",
        "(clear_trip & !running) & latched",
    );
}

#[test]
fn lockstep_catches_an_unlimited_duty() {
    caught("limited_next = !under", "limited_next = 1'd0");
}

#[test]
fn lockstep_catches_a_duty_one_above_its_limit() {
    caught("first = {3'd0, max_duty}", "first = {3'd0, max_duty} + 19'd1");
}

#[test]
fn lockstep_catches_a_pin_that_the_mask_forgets() {
    caught("b_low_gate & on", "b_low_gate & armed");
}

#[test]
fn lockstep_watches_the_gates_of_a_leg_without_dead_time() {
    let outcome = caught("lasts = dead_time;", "lasts = 10'd1;");
    assert!(outcome.violation.is_some(), "the gates' safety is not checked");
}
