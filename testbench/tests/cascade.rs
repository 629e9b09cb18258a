//! The cascade's Verilog against its bit-exact model, every output in every clock.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use posicast_hdl::cascade::emit;
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::cascade::{Cascade, CascadeConfig, ports};
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{Report, Verdict};
use posicast_testbench::lockstep::{self, Device, Instance, Options};
use posicast_testbench::stimuli::{CascadeCoverage, CascadeRandom};
use posicast_testbench::verilator::{Source, Verilated, lint};
use std::path::PathBuf;
use tempfile::TempDir;

struct Bench {
    config: CascadeConfig,
    files: Vec<PathBuf>,
    _folder: TempDir,
}

impl Bench {
    /// With the first `from` in the Verilog replaced by `to`.
    fn new(config: CascadeConfig, from: &str, to: &str) -> Self {
        let mut modules = emit(&config, "").unwrap();
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
            config,
            _folder: folder,
        }
    }

    fn run(&self, device: &mut dyn Device, seed: u64, cycles: u64) -> (Report, CascadeCoverage) {
        let mut model = Cascade::new(&self.config, 99);
        let instances = [Instance::whole("cascade", "alone", model.ports())];
        let mut coverage = CascadeCoverage::default();
        let report = lockstep::run(
            &mut model,
            device,
            &mut CascadeRandom::new(&self.config, seed),
            &instances,
            &Options::cycles(cycles),
            &mut |clock| coverage.observe(&self.config, clock),
            &mut |_| {},
        );
        (report.unwrap(), coverage)
    }

    fn verilated(&self, seed: u64) -> Verilated {
        let ports = ports(&self.config);
        let source = Source {
            files: &self.files,
            top: "cascade",
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

fn million_random_clocks(word_bits: u32, delays: Vec<u32>, seed: u64) {
    let bench = Bench::new(CascadeConfig::new(word_bits, delays).unwrap(), "", "");
    assert_eq!(lint(&bench.files, "cascade").unwrap(), [""; 0]);
    let (report, coverage) = bench.run(&mut bench.verilated(seed), seed, 1_000_000);
    assert_match(&report);
    assert!(coverage.least() > 10 && report.samples > 3_000, "{coverage:?}");
}

#[test]
fn lockstep_a_million_random_clocks_of_one_stage() {
    million_random_clocks(16, vec![1], 1);
}

#[test]
fn lockstep_a_million_random_clocks_of_5_stages() {
    million_random_clocks(32, vec![38, 31, 26, 62, 1], 2);
}

#[test]
fn lockstep_a_million_random_clocks_of_16_stages() {
    million_random_clocks(24, (1..=16).map(|stage| 7 * stage).collect(), 3);
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    let bench = Bench::new(CascadeConfig::new(32, vec![5, 3, 62]).unwrap(), "", "");
    let ports = ports(&bench.config);
    let source = Source {
        files: &bench.files,
        top: "cascade",
        ports: &ports,
    };
    let (report, _) = bench.run(&mut Icarus::build(&source).unwrap(), 4, 20_000);
    assert_match(&report);
}

/// Breaks the Verilog and insists on a mismatch.
fn caught(from: &str, to: &str) {
    let bench = Bench::new(CascadeConfig::new(32, vec![38, 31, 26, 62]).unwrap(), from, to);
    let (report, _) = bench.run(&mut bench.verilated(1), 1, 100_000);
    assert_eq!(report.result, Verdict::Mismatch, "`{to}` is not found");
}

#[test]
fn lockstep_catches_a_history_that_ages_a_sample_late() {
    caught(">= age", "> age");
}

#[test]
fn lockstep_catches_rounding_down() {
    caught("HALF = 36'sd8", "HALF = 36'sd7");
}
