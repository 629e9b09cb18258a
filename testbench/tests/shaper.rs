//! The shaper's Verilog against its bit-exact model, every output in every clock.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

use std::path::{Path, PathBuf};

use posicast_hdl::emit::{Header, Instance as Placed, Module, compose};
use posicast_hdl::shaper::{emit, simulate};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::shaper::{Motion as ForMotion, Shaper, ShaperConfig, pass_clocks};
use posicast_model::taps::{Tap, TapTable};
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{Report, Verdict};
use posicast_testbench::lockstep::{self, Device, Instance, Joined, Options, TwoValued};
use posicast_testbench::stimuli::{Coverage, Directed, Layout, Motion, Random, Stimuli, cases, corners, motion_cases};
use posicast_testbench::verilator::{Source, Verilated};
use tempfile::TempDir;

/// A ZVD shaper in the manner of the XY stage: three impulses, two taps each.
fn zvd(fraction: u32) -> TapTable {
    let taps = [(0, 388), (38, 280), (39, 190), (77, 100), (78, 42)];
    let mut taps = taps.map(|(delay_samples, permille)| Tap {
        delay_samples,
        coefficient: permille * (1 << fraction) / 1000,
    });
    let sum: i32 = taps.iter().map(|tap| tap.coefficient).sum();
    taps[0].coefficient += (1 << fraction) - sum;
    TapTable::new(fraction, taps.to_vec()).unwrap()
}

/// Negative impulses: swings beyond full scale.
fn negative(fraction: u32) -> TapTable {
    let one = 1 << fraction;
    let taps = [(0, one), (7, -2 * one), (15, 2 * one)].map(|(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    });
    TapTable::new(fraction, taps.to_vec()).unwrap()
}

fn config(word_bits: u32, table: TapTable, delay: u32, taps: usize) -> ShaperConfig {
    ShaperConfig::new(word_bits, table)
        .unwrap()
        .with_room_for(delay, taps)
        .unwrap()
}

fn standard() -> ShaperConfig {
    config(32, zvd(16), 0, 0)
}

fn write(folder: &Path, modules: &[Module]) -> Vec<PathBuf> {
    let file = |module: &Module| {
        let path = folder.join(format!("{}.v", module.name));
        std::fs::write(&path, &module.text).unwrap();
        path
    };
    modules.iter().map(file).collect()
}

struct Bench {
    config: ShaperConfig,
    files: Vec<PathBuf>,
    layout: Layout,
    _folder: TempDir,
}

impl Bench {
    fn new(config: ShaperConfig) -> Self {
        Self::broken(config, "", "")
    }

    /// With the first `from` in the Verilog replaced by `to`.
    fn broken(config: ShaperConfig, from: &str, to: &str) -> Self {
        let mut modules = emit(&config, "").unwrap();
        let found = modules.iter_mut().find(|module| module.text.contains(from));
        let module = found.unwrap_or_else(|| panic!("the Verilog no longer has `{from}`: adapt the test"));
        module.text = module.text.replacen(from, to, 1);
        let folder = tempfile::tempdir().unwrap();
        Self {
            files: write(folder.path(), &modules),
            layout: Layout::new(
                &posicast_model::rtl::shaper::ports(&config),
                config.coefficient_fraction(),
            )
            .unwrap(),
            config,
            _folder: folder,
        }
    }

    fn verilated(&self, seed: u64) -> Verilated {
        let model = Shaper::new(&self.config, 0);
        let source = Source {
            files: &self.files,
            top: "shaper",
            ports: model.ports(),
        };
        Verilated::build(&source, seed).unwrap()
    }

    fn icarus(&self) -> Icarus {
        let model = Shaper::new(&self.config, 0);
        let source = Source {
            files: &self.files,
            top: "shaper",
            ports: model.ports(),
        };
        Icarus::build(&source).unwrap()
    }

    fn run(&self, device: &mut dyn Device, stimuli: &mut dyn Stimuli, cycles: u64) -> (Report, Coverage) {
        let mut model = Shaper::new(&self.config, 99);
        let instances = [Instance::whole("shaper", "alone", model.ports())];
        let mut coverage = Coverage::default();
        let report = lockstep::run(
            &mut model,
            device,
            stimuli,
            &instances,
            &Options::cycles(cycles),
            &mut |clock| coverage.observe(&self.layout, clock),
            &mut |_| {},
        );
        (report.unwrap(), coverage)
    }
}

fn assert_match(report: &Report, what: &str) {
    for block in &report.blocks {
        if let Some(first) = &block.first {
            panic!("{what}, {}: {} mismatches\n{first}", block.instance, block.mismatches);
        }
    }
    assert_eq!(report.result, Verdict::Match, "{what}");
}

fn for_motion(config: ShaperConfig, channels: u32, modulo: bool) -> ShaperConfig {
    config.for_motion(ForMotion { channels, modulo }).unwrap()
}

/// As for the plain shaper; with `modulo` and one channel nothing saturates.
fn million_random_clocks_of_motion(config: ShaperConfig, seed: u64) {
    let bench = Bench::new(config.clone());
    let mut random = Random::new(&bench.layout, seed);
    let (report, coverage) = bench.run(&mut bench.verilated(seed), &mut random, 1_000_000);
    assert_match(&report, &format!("seed {seed}"));
    let never_saturates = matches!(
        config.motion(),
        Some(ForMotion {
            channels: 1,
            modulo: true
        })
    );
    assert_eq!(coverage.missing().len(), usize::from(never_saturates), "{coverage}");
    assert!(coverage.handovers > 20 && coverage.handovers_over > 20, "{coverage:?}");
}

#[test]
fn lockstep_a_million_random_clocks_of_motion_with_one_channel() {
    million_random_clocks_of_motion(for_motion(config(24, negative(15), 0, 0), 1, false), 11);
}

#[test]
fn lockstep_a_million_random_clocks_of_motion_with_three_channels() {
    million_random_clocks_of_motion(for_motion(config(32, zvd(16), 0, 0), 3, false), 12);
}

#[test]
fn lockstep_a_million_random_clocks_of_a_rotary_axis() {
    million_random_clocks_of_motion(for_motion(config(32, negative(15), 0, 0), 1, true), 13);
}

#[test]
fn lockstep_a_million_random_clocks_of_a_rotary_axis_with_velocity() {
    million_random_clocks_of_motion(for_motion(config(24, negative(14), 0, 0), 2, true), 14);
}

#[test]
fn lockstep_every_directed_case_of_motion() {
    for config in [
        for_motion(standard(), 3, false),
        for_motion(config(24, negative(15), 0, 0), 1, true),
    ] {
        let bench = Bench::new(config);
        for (name, script) in cases().into_iter().chain(motion_cases()) {
            let mut directed = Directed::new(&bench.layout, script);
            let clocks = directed.clocks(bench.config.pass_clocks(6 * bench.config.most_taps()));
            let (report, coverage) = bench.run(&mut bench.verilated(5), &mut directed, clocks);
            assert_match(&report, name);
            match name {
                "handover_while_moving" => assert_eq!((coverage.handovers, coverage.handovers_over), (2, 2)),
                "handover_refuses_what_comes_in_it" => assert_eq!(coverage.refused, 3, "{coverage}"),
                "swap_when_settled" => assert_eq!((coverage.swaps, coverage.handovers), (2, 0), "{coverage}"),
                _ => {}
            }
        }
    }
}

fn million_random_clocks(config: ShaperConfig, seed: u64) {
    let bench = Bench::new(config);
    let mut random = Random::new(&bench.layout, seed);
    let (report, coverage) = bench.run(&mut bench.verilated(seed), &mut random, 1_000_000);
    assert_match(&report, &format!("seed {seed}"));
    assert_eq!(coverage.missing(), Vec::<&str>::new(), "{coverage}");
    assert!(
        report.samples > 3_000 && coverage.swaps > 20 && coverage.saturated > 20,
        "{coverage}"
    );
}

#[test]
fn lockstep_a_million_random_clocks_of_32_bits() {
    million_random_clocks(standard(), 1);
}

#[test]
fn lockstep_a_million_random_clocks_of_16_bits_with_negative_taps() {
    million_random_clocks(config(16, negative(15), 0, 0), 2);
}

#[test]
fn lockstep_a_million_random_clocks_of_24_bits_with_256_taps() {
    million_random_clocks(config(24, zvd(12), 500, 256), 3);
}

#[test]
fn lockstep_a_million_random_clocks_with_the_longest_ring() {
    million_random_clocks(config(32, negative(1), 16_000, 64), 4);
}

#[test]
fn lockstep_every_directed_case() {
    for config in [standard(), config(16, negative(15), 0, 0)] {
        let bench = Bench::new(config);
        for (name, script) in cases().into_iter().chain(corners(&bench.layout.axes[0])) {
            let mut directed = Directed::new(&bench.layout, script);
            let clocks = directed.clocks(pass_clocks(bench.config.most_taps()));
            let (report, _) = bench.run(&mut bench.verilated(5), &mut directed, clocks);
            assert_match(&report, name);
        }
    }
}

#[test]
fn unit_directed_cases_reach_what_they_are_named_after() {
    let bench = Bench::new(standard());
    let reached = |wanted: &str| {
        let (_, script) = cases().into_iter().find(|(name, _)| *name == wanted).unwrap();
        let mut directed = Directed::new(&bench.layout, script);
        let clocks = directed.clocks(pass_clocks(64));
        let mut itself = TwoValued(Box::new(Shaper::new(&bench.config, 1)));
        bench.run(&mut itself, &mut directed, clocks).1
    };
    assert_eq!(reached("step_to_full_scale").valid, 41);
    assert!(reached("strobes_back_to_back").overrun > 0);
    assert_eq!(reached("start_at_any_time").starts, 3);
    assert_eq!(reached("reset_at_any_time").resets, 24);
    let swaps = reached("swap_in_flight");
    assert_eq!((swaps.swaps, swaps.refused), (2, 0), "{swaps}");
    let saturation = reached("saturation");
    assert!(saturation.saturated >= 2, "{saturation}");
    assert!(reached("flag_clear_races").flags_cleared > 1);
    assert!(reached("illegal_writes").refused >= 9, "{}", reached("illegal_writes"));
    assert!(reached("reload_after_reset").refused > 0);
}

/// Position words of a move there and back with limited jerk, in steps of a smooth polynomial.
fn smooth_moves(samples: usize, distance: f64) -> Vec<i64> {
    let there = (0..samples).map(|n| {
        let s = n as f64 / (samples - 1) as f64;
        (distance * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)).round() as i64
    });
    let there: Vec<i64> = there.collect();
    there
        .iter()
        .chain(there.iter().rev())
        .chain(&[0; 100])
        .copied()
        .collect()
}

#[test]
fn lockstep_real_motion_of_a_machine_with_two_axes() {
    let (x, y) = (config(32, zvd(15), 0, 0), config(32, negative(15), 78, 64));
    let [mut of_x, mut of_y] = [("stage_x", &x), ("stage_y", &y)].map(|(prefix, c)| emit(c, prefix).unwrap());
    let placed = [("x", &of_x), ("y", &of_y)].map(|(name, modules)| Placed {
        name,
        module: modules.last().unwrap(),
    });
    let top = compose("stage", &Header::default(), &["rst", "strobe"], &placed).unwrap();
    let folder = tempfile::tempdir().unwrap();
    of_x.append(&mut of_y);
    of_x.push(top);
    let files = write(folder.path(), &of_x);

    let joined = || {
        let block = |c: &ShaperConfig| -> Box<dyn ClockedBlock> { Box::new(Shaper::new(c, 3)) };
        Joined::new(vec![("x".to_owned(), block(&x)), ("y".to_owned(), block(&y))])
    };
    let mut model = joined();
    let ports = model.ports().to_vec();
    let layout = Layout::new(&ports, 15).unwrap();
    let source = Source {
        files: &files,
        top: "stage",
        ports: &ports,
    };
    let mut device = Verilated::build(&source, 1).unwrap();
    let instances = model.instances("shaper");

    let words = [smooth_moves(1000, 5000.0 * 256.0), smooth_moves(800, -3e6)];
    let mut motion = Motion::new(&layout, &words, 100);
    let options = Options::cycles(motion.clocks());
    let (mut watch, mut progress) = (|_: &lockstep::Clock<'_>| {}, |_| {});
    let report = lockstep::run(
        &mut model,
        &mut device,
        &mut motion,
        &instances,
        &options,
        &mut watch,
        &mut progress,
    )
    .unwrap();
    assert_match(&report, "motion");
    assert_eq!((report.samples, report.cycles), (2 * 2100, 2 + 2100 * 100));

    let mut device = Verilated::build(&source, 2).unwrap();
    let mut random = Random::new(&layout, 6);
    let options = Options::cycles(300_000);
    let mut coverage = Coverage::default();
    let report = lockstep::run(
        &mut joined(),
        &mut device,
        &mut random,
        &instances,
        &options,
        &mut |clock| coverage.observe(&layout, clock),
        &mut progress,
    )
    .unwrap();
    assert_match(&report, "two axes at random");
    assert_eq!(coverage.missing(), Vec::<&str>::new(), "{coverage}");
}

#[test]
fn crosssim_icarus_and_rusthdl_agree_with_the_model() {
    let bench = Bench::new(standard());
    let (report, _) = bench.run(&mut bench.icarus(), &mut Random::new(&bench.layout, 7), 30_000);
    assert_match(&report, "Icarus");
    let mut rusthdl = TwoValued(simulate(&bench.config).unwrap());
    let (report, _) = bench.run(&mut rusthdl, &mut Random::new(&bench.layout, 8), 3_000);
    assert_match(&report, "RustHDL");
}

/// Breaks the Verilog and insists on a mismatch with all its particulars.
fn caught(from: &str, to: &str) {
    caught_in(standard(), from, to);
}

fn caught_in(config: ShaperConfig, from: &str, to: &str) {
    let bench = Bench::broken(config, from, to);
    let (report, _) = bench.run(&mut bench.verilated(1), &mut Random::new(&bench.layout, 1), 100_000);
    assert_eq!(report.result, Verdict::Mismatch, "`{to}` is not found");
    let first = report.blocks[0].first.as_ref().unwrap();
    assert_eq!(first.expected.len(), first.actual.len());
    assert_ne!(first.expected, first.actual);
    let text = first.to_string();
    assert!(
        text.contains(&first.time.to_string()) && text.contains("(device)"),
        "{text}"
    );
}

#[test]
fn lockstep_catches_a_broken_multiplier_bit() {
    caught("product <= a_q * b_q;", "product <= (a_q * b_q) ^ 50'sd1048576;");
}

#[test]
fn lockstep_catches_a_handover_that_goes_wrong() {
    let motion = || for_motion(standard(), 3, false);
    caught_in(motion(), "tap_delay < since_q", "tap_delay <= since_q");
    caught_in(motion(), "next_since > reach", "next_since >= reach");
    caught_in(motion(), "still >= reach", "still > reach");
}

#[test]
fn lockstep_catches_a_broken_address_bit() {
    caught(
        "assign ring_read_address = head - delay;",
        "assign ring_read_address = (head - delay) & 7'h7e;",
    );
}

#[test]
fn lockstep_catches_a_history_that_ages_a_sample_late() {
    caught("delay >= age", "delay > age");
}

/// Faults that ten million random clocks did not show, each with the corner that shows it.
#[test]
fn crosssim_corners_catch_what_random_stimuli_miss() {
    for (corner, from, to) in [
        ("rounding", "HALF = 56'sd32768", "HALF = 56'sd32769"),
        ("rounding", "HALF = 56'sd32768", "HALF = 56'sd32767"),
        ("longest_delay", "FULL_AGE = 7'd127", "FULL_AGE = 7'd126"),
        (
            "largest_products",
            "{6{multiplier_product[49]}}",
            "{6{multiplier_product[48]}}",
        ),
        ("sums_beside_one", "sum_2 == UNITY", "sum_2[18:0] == UNITY[18:0]"),
        ("sums_beside_one", "sum_1 == UNITY", "sum_1[22:0] == UNITY[22:0]"),
        ("reset_empties_both_banks", "taps_2 <= 7'd0;", ""),
        (
            "start_and_strobe_across_a_pass",
            "(done & !start) & !strobe",
            "done & !strobe",
        ),
    ] {
        let bench = Bench::broken(standard(), from, to);
        let (_, script) = corners(&bench.layout.axes[0])
            .into_iter()
            .find(|(name, _)| *name == corner)
            .unwrap();
        let mut directed = Directed::new(&bench.layout, script);
        let clocks = directed.clocks(pass_clocks(bench.config.most_taps()));
        let (report, _) = bench.run(&mut bench.icarus(), &mut directed, clocks);
        assert_eq!(report.result, Verdict::Mismatch, "{corner} does not find `{to}`");
    }
}
