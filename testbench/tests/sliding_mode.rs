//! The controller's Verilog against its bit-exact model, every output in every clock.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use posicast_hdl::sliding_mode::emit;
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::sliding_mode::{Inputs, SlidingMode, ports};
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{Report, Verdict};
use posicast_testbench::lockstep::{self, Device, Instance, Options};
use posicast_testbench::stimuli::{SlidingModeCoverage, SlidingModeRandom, Stimuli};
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

    fn run(&self, device: &mut dyn Device, stimuli: &mut dyn Stimuli, cycles: u64) -> (Report, SlidingModeCoverage) {
        let mut model = SlidingMode::new();
        let instances = [Instance::whole("sliding_mode", "alone", model.ports())];
        let mut coverage = SlidingModeCoverage::default();
        let report = lockstep::run(
            &mut model,
            device,
            stimuli,
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
            top: "sliding_mode",
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
    assert_eq!(lint(&bench.files, "sliding_mode").unwrap(), [""; 0]);
    for seed in 1..=2 {
        let mut stimuli = SlidingModeRandom::new(seed);
        let (report, coverage) = bench.run(&mut bench.verilated(seed), &mut stimuli, 1_000_000);
        assert_match(&report);
        assert!(coverage.least() > 0, "{:?}", coverage.counts());
    }
}

#[test]
fn lockstep_a_command_that_is_cut_until_its_count_stops() {
    let bench = Bench::new("", "");
    let mut clock = 0;
    let mut stimuli = |seen: &[u64], inputs: &mut [u64]| {
        clock += 1;
        // Every gain is 1/2 and the limit 1: every reference velocity is too much.
        let setting = if seen[0] == 11 { 1 } else { 0x1_0000 };
        let now = Inputs {
            rst: clock < 3,
            start: seen[6] == 0,
            motion: posicast_model::rtl::sliding_mode::Motion {
                velocity_reference: 1 << 20,
                ..Default::default()
            },
            setting,
            ..Inputs::default()
        };
        inputs.copy_from_slice(&now.to_raw());
    };
    let (report, coverage) = bench.run(&mut bench.verilated(1), &mut stimuli, 65_545 * 210);
    assert_match(&report);
    let ticks = coverage.counts().into_iter().find(|(name, _)| name == "limited_ticks");
    assert_eq!(ticks.unwrap().1, 65_535);
}

#[test]
fn crosssim_icarus_agrees_with_the_model() {
    let bench = Bench::new("", "");
    let ports = ports();
    let source = Source {
        files: &bench.files,
        top: "sliding_mode",
        ports: &ports,
    };
    let mut stimuli = SlidingModeRandom::without_wind_up(4);
    let (report, _) = bench.run(&mut Icarus::build(&source).unwrap(), &mut stimuli, 20_000);
    assert_match(&report);
}
/// Breaks the Verilog and insists on a mismatch.
fn caught(from: &str, to: &str) {
    let bench = Bench::new(from, to);
    let mut stimuli = SlidingModeRandom::without_wind_up(1);
    let (report, _) = bench.run(&mut bench.verilated(1), &mut stimuli, 300_000);
    assert_eq!(report.result, Verdict::Mismatch, "`{to}` is not found");
}

#[test]
fn lockstep_catches_upper_ends_that_are_an_lsb_too_low() {
    caught("LARGEST_ERROR = 24'sd8388607", "LARGEST_ERROR = 24'sd8388606");
    caught("LARGEST_RATE = 32'sd2147483647", "LARGEST_RATE = 32'sd2147483646");
    caught("LARGEST_WORD = 32'd2147483647", "LARGEST_WORD = 32'd2147483646");
    caught("LARGEST_FRACTION = 32'd33554431", "LARGEST_FRACTION = 32'd33554430");
    caught("LARGEST_DUTY = 32'd131071", "LARGEST_DUTY = 32'd131070");
}

#[test]
fn lockstep_catches_lower_ends_that_are_an_lsb_too_high() {
    caught("LEAST_ERROR = 24'sh800000", "LEAST_ERROR = 24'sh800001");
    caught("LEAST_RATE = 32'sh80000000", "LEAST_RATE = 32'sh80000001");
    caught("$signed(~largest)", "$signed(~largest + 32'd1)");
    caught("as_fraction | as_duty", "as_fraction");
}

#[test]
fn lockstep_catches_an_integral_that_passes_its_ends() {
    for (from, to) in [
        (" LARGEST = 32'sd2147483647", " LARGEST = 32'sd2147483646"),
        (" LEAST = 32'sh80000000", " LEAST = 32'sh80000001"),
    ] {
        let bench = Bench::new(from, to);
        let mut device = bench.verilated(1);
        let (report, _) = bench.run(&mut device, &mut SlidingModeRandom::new(1), 200_000);
        assert_eq!(report.result, Verdict::Mismatch, "`{to}` is not found");
    }
}

#[test]
fn lockstep_catches_an_integral_that_winds_up() {
    caught("takes = update & !limited_high", "takes = update");
    caught("takes = update & !limited_low", "takes = update");
    caught("opposes ^ setting[17]", "opposes");
}

#[test]
fn lockstep_catches_flags_that_a_clear_swallows() {
    caught(
        "flags_q_next = ((kept | by_error) | by_rate) | by_sum",
        "flags_q_next = clear_flags ? 7'd0 : ((kept | by_error) | by_rate) | by_sum",
    );
}

#[test]
fn lockstep_catches_products_that_are_cut_instead_of_rounded() {
    caught("HALF = 53'd1", "HALF = 53'd0");
}

#[test]
fn lockstep_catches_a_limit_that_is_passed_by_an_lsb() {
    caught("({2'd0, limit} << 1) -", "({2'd0, limit} << 1) + 33'd2 -");
    caught("| borrow)", ")");
}

#[test]
fn lockstep_catches_a_rotary_axis_that_does_not_wrap() {
    caught("difference[31] & modulo", "difference[39] & modulo");
}
