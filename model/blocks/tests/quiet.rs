//! What a block says about its quiet clocks, compared with the block clock by clock. A new block needs a line in
//! `blocks`.

use crate::support::random_inputs;
use crate::support::stage;
use crate::support::wrong;

use posicast_blocks::absolute_encoder::{
    AbsoluteEncoder, AbsoluteEncoderConfig, AbsoluteFrame, AbsoluteLimits, AbsoluteProtocol, AbsoluteTimes,
};
use posicast_blocks::absolute_feedback::AbsoluteFeedback;
use posicast_blocks::axis::Axis;
use posicast_blocks::capture::Capture;
use posicast_blocks::compare::Compare;
use posicast_blocks::component::Component;
use posicast_blocks::composition::{Composed, Composition};
use posicast_blocks::divider::{Divider, DividerConfig};
use posicast_blocks::divider_share::DividerShare;
use posicast_blocks::drive_command::DriveCommand;
use posicast_blocks::encoder_generator::EncoderGenerator;
use posicast_blocks::error_table::{EntryUnit, ErrorTable, ErrorTableConfig, ErrorTableFormat};
use posicast_blocks::excitation::Excitation;
use posicast_blocks::group::Group;
use posicast_blocks::inline_axis::{InlineAxis, InlineAxisConfig};
use posicast_blocks::inline_group::{InlineGroup, InlineGroupConfig};
use posicast_blocks::lasting_deviation::LastingDeviation;
use posicast_blocks::linear_scale::LinearScale;
use posicast_blocks::probe_line::ProbeLine;
use posicast_blocks::pulse_counter::PulseCounter;
use posicast_blocks::pwm::{BridgeMode, Pwm};
use posicast_blocks::realign::Realign;
use posicast_blocks::registers::{RegisterBank, RegisterMap, maps};
use posicast_blocks::sample_select::SampleSelect;
use posicast_blocks::schedule::{Schedule, ScheduleConfig};
use posicast_blocks::segments::Segments;
use posicast_blocks::setting_banks::SettingBanks;
use posicast_blocks::shaper::Shaper;
use posicast_blocks::sliding_mode::SlidingMode;
use posicast_blocks::step_generator::{StepGenerator, StepGeneratorConfig, StepMode, StepTimes};
use posicast_blocks::time_base::TimeBase;
use posicast_blocks::trace::{Trace, TraceConfig};
use posicast_blocks::{Direction, Moore, OutputKind, Port};
use proptest::prelude::*;
use random_inputs::{Hints, Random, RandomInputs, STAGE, TICK_CLOCKS};
use stage::{axis, pwm_config, settings, shaper_config, stage};
use wrong::Wrong;

/// A block to be tested, and values for its inputs.
struct Tried {
    name: &'static str,
    make: Box<dyn Fn() -> Box<dyn Moore>>,
    hints: Hints,
}

fn tried<B: Moore + 'static>(name: &'static str, hints: Hints, make: impl Fn() -> B + 'static) -> Tried {
    Tried {
        name,
        make: Box::new(move || Box::new(make())),
        hints,
    }
}

fn composed((composition, blocks): (Composition, Vec<Box<dyn Moore>>)) -> Composed {
    Composed::new(composition, blocks)
}

fn bank() -> RegisterBank {
    let divider = DividerConfig::new(300).unwrap();
    RegisterBank::new(&RegisterMap::new(maps::pulse_counter(&divider, 3, false)).unwrap())
}

fn staged_bank() -> RegisterBank {
    RegisterBank::new(&RegisterMap::new(maps::sliding_mode(0, false)).unwrap())
}

const RARE: &[u64] = &[0, 0, 0, 0, 0, 0, 0, 0, 0, 1];

const ABSOLUTE_TICKS: [u64; 60] = {
    let mut values = [0; 60];
    values[0] = 1;
    values
};

const BUS: Hints = &[
    ("avs_read", &[0, 0, 0, 1]),
    ("avs_write", &[0, 0, 0, 1]),
    ("avs_byteenable", &[15, 15, 15, 3]),
    (
        "avs_address",
        &[
            8, 9, 16, 17, 18, 20, 21, 22, 24, 25, 26, 27, 28, 32, 33, 34, 40, 41, 48, 64,
        ],
    ),
];

const SHAPER: Hints = &[
    ("tap_index", &[0, 1]),
    ("tap_bank", &[1, 2]),
    ("tap_coefficient", &[1 << 15]),
    ("tap_delay", &[0, 2, 7]),
    ("swap_how", &[0, 1, 2]),
];

const ERROR_TABLE: Hints = &[
    ("valid", &[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]),
    ("rst", &[0]),
    ("drive_enable", &[1]),
    ("homed", &[1]),
    ("error_enable", &[1]),
    ("error_write", RARE),
    ("error_read", RARE),
    ("error_index", &[0, 1, 2]),
    ("error_entry", &[5, 10]),
    // Tied.
    ("coarse", &[0]),
];

const SEGMENTS: Hints = &[
    ("word", &[0, 1, 2, 3]),
    ("write", &[0, 0, 1]),
    ("tick", &[0, 0, 0, 1]),
    ("flush", RARE),
    ("quick_stop", RARE),
    ("restart", RARE),
    ("preset", RARE),
    ("enable", &[0, 1, 1, 1]),
    ("data", &[0, 0, 3, 1 << 31 | 2, 1 << 30 | 1, 5]),
    ("rst", &[0]),
];

const STEPS: Hints = &[
    ("rst", &[0]),
    ("enable", &[1, 1, 1, 1, 1, 0]),
    ("tick", RARE),
    ("position", &[0, 8, 20, 60]),
    ("clear_flags", RARE),
];

const INLINE: Hints = &[
    ("rst", &[0]),
    ("run", &[1, 1, 1, 1, 0]),
    ("tick", RARE),
    ("count", &[5, 5, 5, 6]),
    ("given", &[5]),
    ("illegal", RARE),
    ("too_fast", RARE),
    ("owed_exceeded", RARE),
];

const COUNTER: Hints = &[
    ("a", &[0, 1]),
    ("b", &[0, 1]),
    ("z", &[0, 1]),
    ("a_n", &[0, 1]),
    ("mode", &[0, 0, 0, 1, 2, 3, 4, 7]),
    ("filter_clocks", &[0, 1, 8, 63]),
    ("clear_flags", &[0, 0, 1]),
];

const PWM: Hints = &[
    ("enable", &[1, 1, 1, 0]),
    ("period", &[100, 101, 400]),
    ("duty", &[0, 50, 90, 0x1_ffc0]),
    ("max_duty", &[400]),
    ("dead_time", &[3, 5]),
    ("minimum_pulse", &[4]),
    ("trigger_phase", &[7, 60]),
    ("fault_n", &[1, 1, 1, 1, 1, 1, 0]),
    ("pll_locked", &[1, 1, 1, 1, 1, 1, 0]),
    ("filtered_fault_n", &[3, 3, 3, 3, 1]),
    ("watchdog_periods", &[0, 0, 3]),
    ("mask_pins", &[0, 0, 1]),
    ("clear_flags", &[0, 0, 1]),
];

const AXIS: Hints = &[
    ("emergency_stop_n", &[1, 1, 1, 1, 1, 0]),
    ("limit_plus_n", &[1, 1, 1, 1, 0]),
    ("limit_minus_n", &[1, 1, 1, 1, 0]),
    ("drive_ready", &[1, 1, 1, 1, 0]),
    ("filter_clocks", &[0, 5]),
    ("enable", &[0, 1, 1]),
    ("group_emergency_stop", &[0]),
    ("pwm_tripped", &[0, 0, 0, 0, 0, 1]),
    ("off_causes", &[0]),
    ("brake_release_ticks", &[0, 2]),
    ("brake_apply_ticks", &[0, 2]),
    ("settle_ticks", &[0, 2]),
    ("following_error_limit", &[0]),
    ("kick_word", &[0x4b49_434b]),
];

fn blocks() -> Vec<Tried> {
    let divider = DividerConfig::new(300).unwrap();
    let pwm = pwm_config();
    vec![
        tried("divider", &[], move || Divider::new(&divider)),
        tried("time_base", &[], move || TimeBase::new(&divider)),
        tried("sample_select", &[], || SampleSelect::new(16, 2)),
        tried("setting_banks", &[], || SettingBanks::new(&settings())),
        tried("registers", BUS, bank),
        tried("registers, staged", BUS, staged_bank),
        tried("shaper", SHAPER, || Shaper::new(&shaper_config(), 1)),
        tried("segments", SEGMENTS, || Segments::new(1)),
        tried("pulse_counter", COUNTER, PulseCounter::new),
        tried("pwm", PWM, move || Pwm::new(&pwm)),
        tried("sliding_mode", &[], SlidingMode::new),
        tried("axis", AXIS, Axis::new),
        tried("schedule", &[("tick", RARE), ("rst", RARE)], || {
            Schedule::new(&ScheduleConfig::new(40).unwrap())
        }),
        tried("divider_share", &[("divide", RARE), ("rst", RARE)], || {
            DividerShare::new(3)
        }),
        tried("drive_command", &[("tick", RARE), ("rst", RARE)], DriveCommand::new),
        tried(
            "encoder_generator",
            &[("rate", &[0, 0, 0, 1 << 20])],
            EncoderGenerator::new,
        ),
        tried("step_generator", STEPS, || {
            let times = StepTimes {
                pulse_clocks: 3,
                space_clocks: 4,
                direction_setup_clocks: 9,
                direction_hold_clocks: 6,
            };
            StepGenerator::new(&StepGeneratorConfig::new(40, 4, StepMode::StepDirection, times, 3).unwrap())
        }),
        tried("inline_axis", INLINE, || {
            InlineAxis::new(&InlineAxisConfig::new(3, 4).unwrap())
        }),
        tried(
            "inline_group",
            &[("tick", RARE), ("rst", RARE), ("axis_fault_1", RARE)],
            || InlineGroup::new(InlineGroupConfig::without_registers(2)),
        ),
        tried(
            "absolute_encoder",
            &[
                ("rst", &[0]),
                // A reading takes some hundred clocks: the block rests only where ticks are rarer than that.
                ("tick", &ABSOLUTE_TICKS),
                ("data", &[1, 1, 0]),
                ("clear_flags", RARE),
            ],
            || {
                let times = AbsoluteTimes {
                    half_period_clocks: 2,
                    pause_clocks: 8,
                    answer_clocks: 16,
                };
                let limits = AbsoluteLimits {
                    largest_jump: 9,
                    tolerated: 1,
                };
                let frame = AbsoluteFrame::biss_c(8);
                AbsoluteEncoder::new(
                    &AbsoluteEncoderConfig::new(AbsoluteProtocol::BissC, frame, times, limits).unwrap(),
                )
            },
        ),
        tried(
            "absolute_feedback",
            &[
                ("rst", RARE),
                ("tick", RARE),
                ("reading_valid", RARE),
                ("preset", RARE),
                ("sign_bit", &[1 << 11, 1 << 31]),
            ],
            AbsoluteFeedback::new,
        ),
        tried(
            "capture",
            &[
                ("rst", RARE),
                ("filter_clocks", &[0, 3, 40]),
                ("enable", &[1]),
                ("take", RARE),
                ("clear", RARE),
            ],
            Capture::new,
        ),
        tried(
            "linear_scale",
            &[("tick", RARE), ("velocity_valid", RARE), ("align", RARE), ("rst", RARE)],
            LinearScale::new,
        ),
        tried(
            "lasting_deviation",
            &[
                ("tick", RARE),
                ("rst", RARE),
                ("deviation", &[0, 4, 7]),
                ("limit", &[5]),
                ("ticks", &[2]),
            ],
            LastingDeviation::new,
        ),
        tried(
            "realign",
            &[("rst", RARE), ("enabled", RARE), ("correct", RARE)],
            Realign::new,
        ),
        tried(
            "probe_line",
            &[("rst", RARE), ("filter_clocks", &[0, 5, 40])],
            ProbeLine::new,
        ),
        tried(
            "compare",
            &[
                ("rst", RARE),
                ("arm", RARE),
                ("disarm", RARE),
                ("count", &[0, 1, 2, 3, 4]),
                ("first", &[1, 3]),
                ("spacing", &[2, 4]),
                ("positions", &[3]),
                ("hysteresis", &[0, 2]),
                ("pulse_clocks", &[1, 9]),
                ("entry", &[0, 4, 9]),
                ("entry_write", RARE),
                ("entries_clear", RARE),
            ],
            || Compare::new(1),
        ),
        tried("error_table", ERROR_TABLE, || {
            let format = ErrorTableFormat {
                first_counts: 0,
                spacing_bits: 4,
                unit: EntryUnit::Fine,
            };
            ErrorTable::new(&ErrorTableConfig::new(format, vec![0, 200, -50]).unwrap())
        }),
        tried("excitation", &[("valid", RARE), ("rst", RARE)], Excitation::new),
        tried(
            "trace",
            &[("strobe", RARE), ("arm", RARE), ("halt", RARE), ("rst", RARE)],
            || Trace::new(&TraceConfig::new(256).unwrap()),
        ),
        tried("group", &[("start", RARE), ("rst", RARE)], || Group::new(3)),
        tried("an axis", STAGE, || composed(axis(TICK_CLOCKS))),
        tried("a stage", STAGE, || {
            composed(stage(TICK_CLOCKS, |axis| Box::new(composed(axis))))
        }),
        tried("a component", PWM, move || {
            Component::pwm(pwm, BridgeMode::HalfBridge, 100).unwrap().model(1)
        }),
    ]
}

/// Two instances of a block: one is clocked, the other skips its quiet clocks.
struct Pair {
    clocked: Box<dyn Moore>,
    passed: Box<dyn Moore>,
    outputs: Vec<(Port, OutputKind)>,
    ignored: Vec<usize>,
    inputs: RandomInputs,
    random: Random,
}

impl Pair {
    fn new(tried: &Tried, seed: u64) -> Self {
        let (clocked, passed) = ((tried.make)(), (tried.make)());
        let inputs = RandomInputs::new(clocked.ports(), tried.hints);
        let outputs = clocked
            .ports()
            .iter()
            .filter(|port| port.direction == Direction::Output);
        let names = inputs.ports.iter().enumerate();
        Self {
            outputs: outputs
                .map(|port| (port.clone(), clocked.output_kind(&port.name)))
                .collect(),
            ignored: names
                .filter(|(_, port)| clocked.ignores(&port.name))
                .map(|(at, _)| at)
                .collect(),
            inputs,
            clocked,
            passed,
            random: Random(seed),
        }
    }

    /// Returns what the skipping instance shows with the inputs, with its counters advanced by this many clocks.
    fn expected(&mut self, clocks: u64) -> Vec<u64> {
        let mut shown = vec![0; self.outputs.len()];
        self.passed.show_with(&self.inputs.values, &mut shown);
        for (value, (port, kind)) in shown.iter_mut().zip(&self.outputs) {
            if *kind == OutputKind::Counter {
                *value = value.wrapping_add(clocks) & u64::MAX >> (64 - port.width);
            }
        }
        shown
    }

    fn compare(&self, what: &str, expected: &[u64], shown: &[u64]) -> Result<(), String> {
        let differs = expected.iter().zip(shown).position(|(a, b)| a != b);
        differs.map_or(Ok(()), |at| {
            let name = &self.outputs[at].0.name;
            Err(format!("{what}: {name} {:#x}, clocked {:#x}", expected[at], shown[at]))
        })
    }

    /// Plays some clocks with the same inputs, except for those that are ignored; returns how many of them were
    /// skipped.
    fn hold(&mut self, clocks: u64) -> Result<u64, String> {
        let (mut left, mut quiet) = (clocks, 0);
        let mut shown = vec![0; self.outputs.len()];
        while left > 0 {
            let most = self.passed.quiet_clocks(&self.inputs.values).min(left);
            let passes = if most == 0 { 0 } else { 1 + self.random.below(most) };
            for clock in 0..passes.max(1) {
                for at in 0..self.ignored.len() * usize::from(clock > 0) {
                    self.inputs.change_one(self.ignored[at], &mut self.random);
                }
                let expected = self.expected(clock);
                self.clocked.step(&self.inputs.values, &mut shown).unwrap();
                self.compare("quiet", &expected, &shown)?;
            }
            if passes > 0 {
                self.passed.pass(&self.inputs.values, passes);
            } else {
                self.passed.step(&self.inputs.values, &mut shown).unwrap();
            }
            left -= passes.max(1);
            quiet += passes;
        }
        Ok(quiet)
    }

    /// Returns the share of quiet clocks.
    fn run(&mut self, changes: u64) -> Result<f64, String> {
        let (mut quiet, mut all) = (0, 0);
        for _ in 0..changes {
            let clocks = self.inputs.change(&mut self.random);
            quiet += self.hold(clocks)?;
            all += clocks;
        }
        Ok(quiet as f64 / all as f64)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    #[test]
    fn prop_quiet_clocks_are_what_they_are_said_to_be(seed: u64) {
        for tried in blocks() {
            let share = Pair::new(&tried, seed).run(250);
            let share = share.map_err(|error| TestCaseError::fail(format!("{}: {error}", tried.name)))?;
            prop_assert!(share > 0.0, "{}: no clock is quiet", tried.name);
        }
    }
}

#[test]
fn what_is_wrong_is_found() {
    let wrong: [(&str, &[&str]); 4] = [
        (
            "one more",
            &["divider", "time_base", "shaper", "pulse_counter", "pwm", "sliding_mode"],
        ),
        (
            "no pass",
            &["divider", "time_base", "shaper", "pulse_counter", "pwm", "sliding_mode"],
        ),
        (
            "ignores",
            &[
                "divider",
                "sample_select",
                "setting_banks",
                "registers",
                "shaper",
                "segments",
                "axis",
                "pwm",
            ],
        ),
        ("kind", &["time_base"]),
    ];
    for (what, names) in wrong {
        for mut tried in blocks().into_iter().filter(|tried| names.contains(&tried.name)) {
            let make = tried.make;
            tried.make = Box::new(move || Box::new(Wrong { block: make(), what }));
            let found = (0..20).any(|seed| Pair::new(&tried, seed).run(400).is_err());
            assert!(found, "{}: {what}", tried.name);
        }
    }
}
