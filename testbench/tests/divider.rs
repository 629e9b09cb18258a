//! The divider's Verilog against its bit-exact model, every output in every clock.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use posicast_hdl::divider::emit;
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::divider::{Divider, DividerConfig, ports};
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{Report, Verdict};
use posicast_testbench::lockstep::{self, Device, Instance, Options};
use posicast_testbench::stimuli::DividerRandom;
use posicast_testbench::verilator::{Source, Verilated, lint};
use std::path::PathBuf;
use tempfile::TempDir;

struct Bench {
    config: DividerConfig,
    files: Vec<PathBuf>,
    _folder: TempDir,
}

/// What a run reached: quotients, of them clamped, of them negative; clocks with `overrun`.
#[derive(Debug, Default)]
struct Coverage {
    done: u64,
    clamped: u64,
    negative: u64,
    overrun: u64,
}

impl Bench {
    /// With the first `from` in the Verilog replaced by `to`.
    fn new(tick_clocks: u64, from: &str, to: &str) -> Self {
        let config = DividerConfig::new(tick_clocks).unwrap();
        let modules = emit(&config, "").unwrap();
        let text = &modules[0].text;
        assert!(
            text.contains(from),
            "the Verilog no longer has `{from}`: adapt the test"
        );
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("divider.v");
        std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
        Self {
            config,
            files: vec![file],
            _folder: folder,
        }
    }

    fn run(&self, device: &mut dyn Device, seed: u64, cycles: u64) -> (Report, Coverage) {
        let mut model = Divider::new(&self.config);
        let instances = [Instance::whole("divider", "alone", model.ports())];
        let mut coverage = Coverage::default();
        let report = lockstep::run(
            &mut model,
            device,
            &mut DividerRandom::new(&self.config, seed),
            &instances,
            &Options::cycles(cycles),
            &mut |clock| {
                let &[quotient, done, _, clamped, overrun] = clock.expected else {
                    return;
                };
                coverage.done += done;
                coverage.clamped += done & clamped;
                coverage.negative += done & (quotient >> 31);
                coverage.overrun += overrun;
            },
            &mut |_| {},
        );
        (report.unwrap(), coverage)
    }

    fn verilated(&self) -> Verilated {
        let ports = ports();
        let source = Source {
            files: &self.files,
            top: "divider",
            ports: &ports,
        };
        Verilated::build(&source, 1).unwrap()
    }
}

fn assert_match(report: &Report) {
    if let Some(first) = &report.blocks[0].first {
        panic!("{} mismatches\n{first}", report.blocks[0].mismatches);
    }
    assert_eq!(report.result, Verdict::Match);
}

fn million_random_clocks(tick_clocks: u64) {
    let bench = Bench::new(tick_clocks, "", "");
    assert_eq!(lint(&bench.files, "divider").unwrap(), [""; 0]);
    let (report, coverage) = bench.run(&mut bench.verilated(), tick_clocks, 1_000_000);
    assert_match(&report);
    let Coverage {
        done,
        clamped,
        negative,
        overrun,
    } = coverage;
    assert!(done > 6_000 && clamped.min(negative).min(overrun) > 100, "{coverage:?}");
    assert!(done - clamped > 1_000, "{coverage:?}");
}

#[test]
fn lockstep_a_million_random_clocks_of_5000_per_tick() {
    million_random_clocks(5000);
}

#[test]
fn lockstep_a_million_random_clocks_of_the_longest_tick() {
    million_random_clocks(131_071);
}

#[test]
fn lockstep_a_million_random_clocks_of_97_per_tick() {
    million_random_clocks(97);
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    let bench = Bench::new(5000, "", "");
    let ports = ports();
    let source = Source {
        files: &bench.files,
        top: "divider",
        ports: &ports,
    };
    let (report, _) = bench.run(&mut Icarus::build(&source).unwrap(), 4, 20_000);
    assert_match(&report);
}

#[test]
fn lockstep_catches_a_quotient_that_is_clamped_a_bit_too_late() {
    let bench = Bench::new(5000, "FITS_PHASE = 7'd65", "FITS_PHASE = 7'd64");
    let (report, _) = bench.run(&mut bench.verilated(), 1, 200_000);
    assert_eq!(report.result, Verdict::Mismatch);
}
