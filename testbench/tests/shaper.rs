//! Compares the shaper's Verilog with its bit-exact model, every output in every clock.

use crate::support;

use posicast_blocks::axis_shaper::AxisShaperConfig;
use posicast_blocks::shaper::{Shaper, ShaperConfig, ShaperMotion as ForMotion, pass_clocks};
use posicast_hdl::machine::AxisShaper;
use posicast_taps::{Tap, TapTable};
use posicast_testbench::blocks::{Block, Sources};
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use posicast_testbench::lockstep::{self, Device, LockstepOptions, TwoValued};
use posicast_testbench::shaper::{
    Action, Coverage, Directed, Layout, MotionStimuli, Random, TableLayout, cases, corners, motion_cases,
};
use posicast_testbench::shaper::{MachineShapers, ShaperBlock};
use posicast_testbench::stimuli::Stimuli;
use posicast_testbench::verilator::Verilated;
use support::{assert_match, broken};

/// A ZVD shaper like that of the XY stage: three impulses with two taps each.
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

/// Taps of negative impulses, whose output swings beyond full scale.
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

struct Bench {
    block: ShaperBlock,
    sources: Sources,
}

impl Bench {
    fn new(config: ShaperConfig) -> Self {
        Self::broken(config, "", "")
    }

    /// Compiles the shaper with the first `from` in the Verilog replaced by `to`.
    fn broken(config: ShaperConfig, from: &str, to: &str) -> Self {
        let block = ShaperBlock::new(config, "", "alone").unwrap();
        let sources = Sources::of_modules(&broken(&block.modules().unwrap(), from, to)).unwrap();
        Self { block, sources }
    }

    fn tables(&self) -> &TableLayout {
        self.layout().axes[0].tables.as_ref().unwrap()
    }

    fn layout(&self) -> &Layout {
        self.block.layout()
    }

    fn directed(&self, script: Vec<Action>) -> Directed {
        Directed::new(self.layout(), script)
    }

    fn verilated(&self, seed: u64) -> Verilated {
        self.sources.verilated(&self.block, seed).unwrap()
    }

    fn icarus(&self) -> Icarus {
        self.sources.icarus(&self.block).unwrap()
    }

    fn run(&self, device: &mut dyn Device, stimuli: &mut dyn Stimuli, cycles: u64) -> (LockstepReport, Coverage) {
        run(&self.block, self.layout(), device, stimuli, cycles)
    }
}

/// A lock step with its coverage by name.
fn run(
    block: &dyn Block,
    layout: &Layout,
    device: &mut dyn Device,
    stimuli: &mut dyn Stimuli,
    cycles: u64,
) -> (LockstepReport, Coverage) {
    let mut model = block.model(99);
    let instances = block.instances(model.ports());
    let mut coverage = Coverage::default();
    let report = lockstep::run(
        model.as_mut(),
        device,
        stimuli,
        &instances,
        &LockstepOptions::cycles(cycles),
        &mut |clock| coverage.observe(layout, clock),
        &mut |_| {},
    );
    (report.unwrap(), coverage)
}

fn for_motion(config: ShaperConfig, channels: u32, modulo: bool) -> ShaperConfig {
    config.for_motion(ForMotion { channels, modulo }).unwrap()
}

#[test]
fn lockstep_every_directed_case_of_motion() {
    for config in [
        for_motion(standard(), 3, false),
        for_motion(config(24, negative(15), 0, 0), 1, true),
    ] {
        let bench = Bench::new(config);
        for (name, script) in cases().into_iter().chain(motion_cases()) {
            let mut directed = bench.directed(script);
            let clocks = directed.clocks(bench.block.config().pass_clocks(6 * bench.block.config().most_taps()));
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

#[test]
fn lockstep_every_directed_case() {
    for config in [standard(), config(16, negative(15), 0, 0)] {
        let bench = Bench::new(config);
        for (name, script) in cases().into_iter().chain(corners(bench.tables())) {
            let mut directed = bench.directed(script);
            let clocks = directed.clocks(pass_clocks(bench.block.config().most_taps()));
            let (report, _) = bench.run(&mut bench.verilated(5), &mut directed, clocks);
            assert_match(&report, name);
        }
    }
}

#[test]
fn directed_cases_reach_what_they_are_named_after() {
    let bench = Bench::new(standard());
    let reached = |wanted: &str| {
        let (_, script) = cases().into_iter().find(|(name, _)| *name == wanted).unwrap();
        let mut directed = bench.directed(script);
        let clocks = directed.clocks(pass_clocks(64));
        let mut itself = TwoValued(Box::new(Shaper::new(bench.block.config(), 1)));
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
    assert_eq!(reached("taps_read_back").taps_read_back, 5);
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
    let shapers = [("x", x), ("y", y)].map(|(axis, config)| AxisShaper {
        axis: axis.to_owned(),
        config: AxisShaperConfig::Taps(config),
    });
    let words = vec![smooth_moves(1000, 5000.0 * 256.0), smooth_moves(800, -3e6)];
    let block = MachineShapers::new("stage", shapers.to_vec(), words).unwrap();
    let sources = Sources::write(&block).unwrap();

    let mut motion = MotionStimuli::new(block.layout(), block.words(), 100);
    let clocks = motion.clocks();
    let mut device = sources.verilated(&block, 1).unwrap();
    let (report, _) = run(&block, block.layout(), &mut device, &mut motion, clocks);
    assert_match(&report, "motion");
    assert_eq!((report.samples, report.cycles), (2 * 2100, 2 + 2100 * 100));

    let mut device = sources.verilated(&block, 2).unwrap();
    let mut random = Random::new(block.layout(), 6);
    let (report, coverage) = run(&block, block.layout(), &mut device, &mut random, 300_000);
    assert_match(&report, "two axes at random");
    assert_eq!(coverage.missing(), Vec::<&str>::new(), "{coverage}");
}

/// Faults that ten million random clocks did not reveal, each with the directed case that does.
#[test]
fn crosssim_corners_catch_what_random_stimuli_miss() {
    for (corner, from, to) in [
        ("rounding", "HALF = 56'sd32768", "HALF = 56'sd32769"),
        ("rounding", "HALF = 56'sd32768", "HALF = 56'sd32767"),
        ("longest_delay", "FULL_AGE = 7'd127", "FULL_AGE = 7'd125"),
        (
            "largest_products",
            "{6{product_product[49]}}",
            "{6{product_product[48]}}",
        ),
        ("sums_beside_one", "sum_2 == UNITY", "sum_2[18:0] == UNITY[18:0]"),
        ("sums_beside_one", "sum_1 == UNITY", "sum_1[22:0] == UNITY[22:0]"),
        ("reset_empties_both_banks", "taps_2 <= 7'd0;", ""),
        (
            "start_and_strobe_across_a_pass",
            "done & !start & !strobe",
            "done & !strobe",
        ),
    ] {
        let bench = Bench::broken(standard(), from, to);
        let (_, script) = corners(bench.tables())
            .into_iter()
            .find(|(name, _)| *name == corner)
            .unwrap();
        let mut directed = bench.directed(script);
        let clocks = directed.clocks(pass_clocks(bench.block.config().most_taps()));
        let (report, _) = bench.run(&mut bench.icarus(), &mut directed, clocks);
        assert_eq!(
            report.result,
            LockstepVerdict::Mismatch,
            "{corner} does not find `{to}`"
        );
    }
}
