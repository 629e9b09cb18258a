//! The command FIFO's Verilog against its bit-exact model, every output in every clock.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use posicast_hdl::segments::emit;
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::segments::{Segments, ports};
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{Report, Verdict};
use posicast_testbench::lockstep::{self, Device, Instance, Options};
use posicast_testbench::stimuli::{SegmentsCoverage, SegmentsRandom};
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

    fn run(&self, device: &mut dyn Device, seed: u64, cycles: u64) -> (Report, SegmentsCoverage) {
        let mut model = Segments::new(seed);
        let instances = [Instance::whole("segments", "alone", model.ports())];
        let mut coverage = SegmentsCoverage::default();
        let report = lockstep::run(
            &mut model,
            device,
            &mut SegmentsRandom::new(seed),
            &instances,
            &Options::cycles(cycles),
            &mut |clock| coverage.observe(clock.expected),
            &mut |_| {},
        );
        (report.unwrap(), coverage)
    }

    fn verilated(&self, seed: u64) -> Verilated {
        let ports = ports();
        let source = Source {
            files: &self.files,
            top: "segments",
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
    assert_eq!(lint(&bench.files, "segments").unwrap(), [""; 0]);
    for seed in 1..=2 {
        let (report, coverage) = bench.run(&mut bench.verilated(seed), seed, 1_000_000);
        assert_match(&report);
        assert!(coverage.least() > 50, "{:?}", coverage.counts().collect::<Vec<_>>());
    }
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    let bench = Bench::new("", "");
    let ports = ports();
    let source = Source {
        files: &bench.files,
        top: "segments",
        ports: &ports,
    };
    let (report, _) = bench.run(&mut Icarus::build(&source).unwrap(), 4, 20_000);
    assert_match(&report);
}

/// Breaks the Verilog and insists on a mismatch.
fn caught(from: &str, to: &str) {
    let bench = Bench::new(from, to);
    let (report, _) = bench.run(&mut bench.verilated(1), 1, 300_000);
    assert_eq!(report.result, Verdict::Mismatch, "`{to}` is not found");
}

#[test]
fn lockstep_catches_a_stop_that_is_too_strong() {
    caught("reverse > deceleration", "reverse < deceleration");
}

#[test]
fn lockstep_catches_a_velocity_that_is_added_before_it_is_new() {
    caught(
        "velocity_step = {{16{exact_velocity[47]}}",
        "velocity_step = {{16{exact_velocity[46]}}",
    );
}

#[test]
fn lockstep_catches_an_entry_that_is_taken_without_its_words() {
    caught("written[0] & written[1]", "written[0] | written[1]");
}

#[test]
fn lockstep_catches_an_underrun_that_holds_its_speed() {
    caught("state_q_next = STOP_STATE", "state_q_next = HOLD_STATE");
}

#[test]
fn lockstep_catches_an_acceleration_that_wraps() {
    caught(
        "next_acceleration_bits[40] == next_acceleration_bits[39]",
        "next_acceleration_bits[40] == next_acceleration_bits[40]",
    );
}
