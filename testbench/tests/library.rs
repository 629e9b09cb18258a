//! A module's name identifies its content: in the packages of all machines, modules of the same name are the same file.
//!
//! Every size that the registry has is compared, and blocks with many sizes at random ones.

use posicast_blocks::absolute_encoder::{
    AbsoluteEncoderConfig, AbsoluteFrame, AbsoluteLimits, AbsoluteProtocol, AbsoluteTimes, FrameCheck, FrameStatusBit,
};
use posicast_blocks::cascade::CascadeConfig;
use posicast_blocks::component::Component;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::inline_axis::{InlineAxisConfig, InlineLinesActiveLow};
use posicast_blocks::inline_group::InlineGroupConfig;
use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_blocks::schedule::ScheduleConfig;
use posicast_blocks::shaper::{ShaperConfig, ShaperMotion};
use posicast_blocks::sliding_mode::{Law, Settings};
use posicast_blocks::step_generator::{StepGeneratorConfig, StepLinesActiveLow, StepMode, StepTimes};
use posicast_blocks::trace::TraceConfig;
use posicast_hdl::emit::{LIBRARY, Module};
use posicast_hdl::{
    absolute_encoder, cascade, component, divider, divider_share, group, inline_axis, inline_group, pwm, registers,
    sample_select, schedule, setting_banks, shaper, step_generator, time_base, trace,
};
use posicast_taps::{Tap, TapTable};
use posicast_testbench::blocks::{self, BenchSizes, Block};
use std::collections::BTreeMap;

/// Number of random configurations.
const MACHINES: u64 = 12;

/// A reproducible source of random numbers (SplitMix64).
struct Chance(u64);

impl Chance {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) % end
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len() as u64) as usize]
    }

    fn is(&mut self) -> bool {
        self.below(2) == 1
    }
}

fn table(chance: &mut Chance) -> TapTable {
    let fraction = 8 + chance.below(9) as u32;
    let (longest, taps) = (
        chance.one_of(&[3, 40, 61, 62, 63, 125, 126, 127, 900]),
        1 + chance.below(12),
    );
    let one = 1i32 << fraction;
    let part = one / (taps as i32 + 1);
    let mut delays: Vec<u32> = (0..taps)
        .map(|_| chance.below(longest) as u32)
        .chain([longest as u32])
        .collect();
    delays.sort_unstable();
    delays.dedup();
    let last = delays.len() as i32 - 1;
    let coefficient = |place: usize| if place == 0 { one - part * last } else { part };
    let taps = delays.iter().enumerate().map(|(place, &delay_samples)| Tap {
        delay_samples,
        coefficient: coefficient(place),
    });
    TapTable::new(fraction, taps.collect()).unwrap()
}

fn shaper_config(chance: &mut Chance) -> ShaperConfig {
    let word_bits = chance.one_of(&[16, 24, 32]);
    let plain = ShaperConfig::new(word_bits, table(chance)).unwrap();
    let motion = ShaperMotion {
        channels: 1 + chance.below(3) as u32,
        modulo: chance.is(),
    };
    if chance.is() {
        plain.clone().for_motion(motion).unwrap_or(plain)
    } else {
        plain
    }
}

fn pwm_config(chance: &mut Chance) -> PwmConfig {
    let off = ActiveLow {
        a_high: chance.is(),
        a_low: chance.is(),
        b_high: chance.is(),
        b_low: chance.is(),
    };
    let config = PwmConfig::new(off, 1 + chance.below(3), 1 + chance.below(3)).unwrap();
    if chance.is() { config.on_time_base() } else { config }
}

fn step_generator_config(chance: &mut Chance) -> StepGeneratorConfig {
    let times = StepTimes {
        pulse_clocks: 12 + chance.below(2),
        space_clocks: 13,
        direction_setup_clocks: chance.one_of(&[10, 250]),
        direction_hold_clocks: 25,
    };
    let mode = chance.one_of(&[StepMode::StepDirection, StepMode::UpDown, StepMode::Quadrature]);
    let tick_clocks = chance.one_of(&[1000, 2500, 5000, 5001]);
    let low = StepLinesActiveLow {
        a: chance.is(),
        b: chance.is(),
    };
    StepGeneratorConfig::new(tick_clocks, 7 + chance.below(2) as u32, mode, times, 100)
        .unwrap()
        .active_low(low)
}

fn absolute_encoder_config(chance: &mut Chance) -> AbsoluteEncoderConfig {
    let protocol = chance.one_of(&[AbsoluteProtocol::Ssi, AbsoluteProtocol::BissC]);
    let status = |chance: &mut Chance| {
        let bit = FrameStatusBit {
            place: chance.below(2) as u32,
            active_low: chance.is(),
        };
        chance.is().then_some(bit)
    };
    let frame = AbsoluteFrame {
        leading_bits: chance.below(2) as u32,
        position_bits: 12 + chance.below(2) as u32,
        trailing_bits: 2 + chance.below(2) as u32,
        gray: chance.is(),
        check: match protocol {
            AbsoluteProtocol::Ssi => chance.one_of(&[FrameCheck::None, FrameCheck::EvenParity, FrameCheck::OddParity]),
            AbsoluteProtocol::BissC => FrameCheck::Crc6,
        },
        error: status(chance),
        warning: status(chance),
    };
    let times = AbsoluteTimes {
        half_period_clocks: 4 + chance.below(2),
        pause_clocks: chance.one_of(&[500, 1000]),
        answer_clocks: chance.one_of(&[200, 300]),
    };
    let limits = AbsoluteLimits {
        largest_jump: chance.one_of(&[50, 100]),
        tolerated: 2 + chance.below(2),
    };
    AbsoluteEncoderConfig::new(protocol, frame, times, limits).unwrap()
}

fn inline_axis_config(chance: &mut Chance) -> InlineAxisConfig {
    let low = InlineLinesActiveLow {
        a: chance.is(),
        b: chance.is(),
    };
    InlineAxisConfig::new(20 + chance.below(2), 300 + chance.below(2))
        .unwrap()
        .active_low(low)
}

/// Returns the Verilog of every size of every block in the registry, for a machine of this name, each with its top last.
fn registered(prefix: &str) -> Vec<Vec<Module>> {
    let sizes = BenchSizes {
        prefix: prefix.to_owned(),
        ..blocks::library_sizes().unwrap()
    };
    let modules = |block: &dyn Block| block.modules().unwrap();
    let mut all: Vec<_> = blocks::benches(&sizes)
        .unwrap()
        .iter()
        .map(|bench| modules(bench.as_ref()))
        .collect();
    all.extend(
        blocks::small_benches()
            .unwrap()
            .iter()
            .map(|small| modules(small.block.as_ref())),
    );
    let trials = blocks::trials().unwrap().into_iter().flat_map(|block| block.trials);
    all.extend(trials.map(|trial| modules(trial.block.as_ref())));
    all.extend(blocks::areas().unwrap().into_iter().map(|row| row.modules));
    all
}

/// Returns the Verilog of the blocks that have sizes, at random ones, for the machine `prefix`.
fn sized(prefix: &str, chance: &mut Chance) -> Vec<Vec<Module>> {
    let tick = DividerConfig::new(chance.one_of(&[1000, 2500, 5000, 5001])).unwrap();
    let (shaper, pwm) = (shaper_config(chance), pwm_config(chance));
    let mut settings = Settings::default();
    settings.set_limit(chance.below(4) as u32);
    let axes = 1 + chance.below(4) as usize;
    let delays = (0..1 + chance.below(4)).map(|_| 1 + chance.below(60) as u32).collect();
    let cascade = CascadeConfig::new(chance.one_of(&[16, 24, 32]), delays).unwrap();
    let trace = TraceConfig::new(chance.one_of(&[256, 512, 1024, 2048])).unwrap();
    let schedule = ScheduleConfig::new(100 + chance.below(4) as u32).unwrap();
    let (word_bits, channels) = chance.one_of(&[(17, 1), (32, 3), (32, 5)]);
    let mut all = vec![
        shaper::emit(&shaper, prefix),
        pwm::emit(&pwm, prefix),
        divider::emit(&tick, prefix),
        time_base::emit(&tick, prefix),
        schedule::emit(&schedule, prefix),
        trace::emit(&trace, prefix),
        cascade::emit(&cascade, prefix),
        group::emit(axes, prefix),
        inline_group::emit(InlineGroupConfig::without_registers(axes), prefix),
        inline_group::emit(
            InlineGroupConfig {
                axes,
                with_registers: true,
            },
            prefix,
        ),
        inline_axis::emit(&inline_axis_config(chance), prefix),
        divider_share::emit(axes, prefix),
        sample_select::emit(word_bits, channels, prefix),
        setting_banks::emit(&settings, prefix),
        step_generator::emit(&step_generator_config(chance), prefix),
        absolute_encoder::emit(&absolute_encoder_config(chance), prefix),
    ];
    let components = [
        Component::shaper(shaper).unwrap(),
        Component::pwm(pwm, BridgeMode::HalfBridge, chance.one_of(&[1000, 2500])).unwrap(),
        Component::pulse_counter(tick, chance.below(4) as u32, chance.is()).unwrap(),
        Component::sliding_mode(&settings, chance.one_of(&[Law::Pd, Law::Pid]), chance.is()).unwrap(),
    ];
    for one in &components {
        all.push(registers::emit(one.map(), prefix).map(|bank| vec![bank]));
        all.push(component::emit(one, &format!("{prefix}_{}_avalon", one.name()), prefix));
    }
    all.into_iter().map(Result::unwrap).collect()
}

#[test]
fn every_size_of_the_registry_has_a_name_of_its_own() {
    let mut library: BTreeMap<String, Module> = BTreeMap::new();
    let all = ["one", "another"].map(registered);
    let [one, another] = all.each_ref().map(Vec::len);
    assert!(one == another && one > 100, "{one}");
    for module in all.into_iter().flatten().flatten() {
        // Some Verilog tools cannot read other characters, which the documentation of kernels has.
        assert!(module.text.is_ascii(), "{}", module.name);
        if module.name.starts_with(&format!("{LIBRARY}_")) {
            let known = library.entry(module.name.clone()).or_insert_with(|| module.clone());
            assert_eq!(*known, module, "twice in one library, and not the same");
        }
    }
    assert!(library.len() > 50, "{}", library.len());
}

#[test]
fn a_name_stands_for_one_content_in_all_machines() {
    let mut library: BTreeMap<String, String> = BTreeMap::new();
    let mut variants: BTreeMap<String, usize> = BTreeMap::new();
    for number in 0..MACHINES {
        let prefix = format!("machine{number}_x");
        let mut own: BTreeMap<String, Module> = BTreeMap::new();
        for module in sized(&prefix, &mut Chance(number)).into_iter().flatten() {
            let there = own.entry(module.name.clone()).or_insert_with(|| module.clone());
            assert_eq!(*there, module, "twice in one package, and not the same");
            let Some(base) = module.name.strip_prefix(&format!("{LIBRARY}_")) else {
                assert!(module.name.starts_with(&prefix), "{}", module.name);
                continue;
            };
            assert!(!module.text.contains(&prefix), "{} names its machine", module.name);
            if library.insert(module.name.clone(), module.text.clone()).is_none() {
                *variants
                    .entry(
                        base.split(|c: char| c.is_ascii_digit())
                            .next()
                            .unwrap_or(base)
                            .to_owned(),
                    )
                    .or_default() += 1;
            }
            assert_eq!(library[&module.name], module.text, "{}", module.name);
        }
    }
    // The comparison above is meaningful only if each block with sizes occurred at several of them.
    for sized in [
        "history_",
        "weighted_sum_",
        "channel_sums_",
        "handover_",
        "product_",
        "pwm_",
        "pwm_timing_",
        "pwm_gates_",
        "divider_",
        "time_base_",
        "schedule_",
        "trace_",
        "trace_memory_",
        "group_",
        "divider_share_",
        "sample_select_",
    ] {
        assert!(
            variants.get(sized).is_some_and(|count| *count > 1),
            "{sized} {variants:?}"
        );
    }
}
