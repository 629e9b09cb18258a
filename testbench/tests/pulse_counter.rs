//! The pulse counter's Verilog against its bit-exact model, every output in every clock.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use posicast_hdl::pulse_counter::emit;
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::pulse_counter::{PulseCounter, ports};
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{Report, Verdict};
use posicast_testbench::lockstep::{self, Device, Instance, Options};
use posicast_testbench::stimuli::{PulseCounterCoverage, PulseCounterRandom};
use posicast_testbench::verilator::{Source, Verilated, lint};
use std::path::PathBuf;
use tempfile::TempDir;

struct Bench {
    files: Vec<PathBuf>,
    _folder: TempDir,
}

impl Bench {
    /// With the first `from` in the Verilog replaced by `to`.
    fn new(from: &str, to: &str) -> Self {
        let mut modules = emit("").unwrap();
        let found = modules.iter_mut().find(|module| module.text.contains(from));
        let module = found.unwrap_or_else(|| panic!("the Verilog no longer has `{from}`: adapt the test"));
        module.text = module.text.replacen(from, to, 1);
        let folder = tempfile::tempdir().unwrap();
        let file = |module: &posicast_hdl::emit::Module| {
            let path = folder.path().join(format!("{}.v", module.name));
            std::fs::write(&path, &module.text).unwrap();
            path
        };
        Self {
            files: modules.iter().map(file).collect(),
            _folder: folder,
        }
    }

    fn run(&self, device: &mut dyn Device, seed: u64, cycles: u64) -> (Report, PulseCounterCoverage) {
        let mut model = PulseCounter::new();
        let instances = [Instance::whole("pulse_counter", "alone", model.ports())];
        let mut coverage = PulseCounterCoverage::default();
        let report = lockstep::run(
            &mut model,
            device,
            &mut PulseCounterRandom::new(seed),
            &instances,
            &Options::cycles(cycles),
            &mut |clock| coverage.observe(clock.inputs, clock.expected),
            &mut |_| {},
        );
        (report.unwrap(), coverage)
    }

    fn verilated(&self, seed: u64) -> Verilated {
        let ports = ports();
        let source = Source {
            files: &self.files,
            top: "pulse_counter",
            ports: &ports,
        };
        Verilated::build(&source, seed).unwrap()
    }
}

fn assert_match(report: &Report) {
    if let Some(first) = &report.blocks[0].first {
        panic!("{} mismatches\n{first}", report.blocks[0].mismatches);
    }
    assert_eq!(report.result, Verdict::Match);
}

#[test]
fn lockstep_a_million_random_clocks() {
    let bench = Bench::new("", "");
    assert_eq!(lint(&bench.files, "pulse_counter").unwrap(), [""; 0]);
    for seed in 1..=2 {
        let (report, coverage) = bench.run(&mut bench.verilated(seed), seed, 1_000_000);
        assert_match(&report);
        assert!(coverage.least() > 20, "{:?}", coverage.counts());
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    let bench = Bench::new("", "");
    let ports = ports();
    let source = Source {
        files: &bench.files,
        top: "pulse_counter",
        ports: &ports,
    };
    let (report, _) = bench.run(&mut Icarus::build(&source).unwrap(), 4, 20_000);
    assert_match(&report);
}

/// Breaks the Verilog and insists on a mismatch.
fn caught(from: &str, to: &str) {
    let bench = Bench::new(from, to);
    let (report, _) = bench.run(&mut bench.verilated(1), 1, 200_000);
    assert_eq!(report.result, Verdict::Mismatch, "`{to}` is not found");
}

#[test]
fn lockstep_catches_a_filter_a_clock_too_short() {
    caught("left == NO_CLOCKS", "left <= ONE_CLOCK");
}

#[test]
fn lockstep_catches_an_index_that_latches_before_the_step() {
    caught("index_count_q_next = counted", "index_count_q_next = count_q");
}
