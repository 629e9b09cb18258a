//! Compositions that are clocked only where something happens, compared with all blocks clocked in every clock.

use crate::support::plain;
use crate::support::random_inputs;
use crate::support::stage;
use crate::support::wrong;

use plain::Plain;
use posicast_blocks::component::Component;
use posicast_blocks::composition::{Composed, Composition, Part};
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::pwm::BridgeMode;
use posicast_blocks::sliding_mode::Law;
use posicast_blocks::{ClockedBlock, Direction, FOREVER, Moore, OutputKind, Port, StepError};
use proptest::prelude::*;
use random_inputs::{Hints, Random, RandomInputs, STAGE, TICK_CLOCKS};
use stage::{axis, pwm_config, settings, shaper_config, stage};
use wrong::Wrong;

const BUS: Hints = &[
    ("avs_read", &[0, 0, 0, 1]),
    ("avs_write", &[0, 0, 1]),
    ("avs_byteenable", &[15, 15, 15, 3]),
    (
        "avs_address",
        &[
            8, 9, 10, 11, 12, 16, 17, 18, 19, 20, 21, 22, 24, 25, 26, 27, 28, 32, 33, 34, 40, 41, 48, 64,
        ],
    ),
    (
        "avs_writedata",
        &[0, 1, 2, 3, 1 << 15, 0xffff_ffff, 100, 0x1_0000, 40_000],
    ),
    ("fault_n", &[1, 1, 1, 0]),
    ("pll_locked", &[1]),
    ("filtered_fault_n", &[3]),
    ("a", &[0, 1]),
    ("b", &[0, 1]),
];

type Whole = (Composition, Vec<Box<dyn Moore>>);

/// Name, input values, the fast composition, and the same composition block by block.
fn wholes() -> Vec<(String, Hints, Composed, Plain)> {
    let pwm = pwm_config();
    let counter = DividerConfig::new(300).unwrap();
    let components = [
        Component::shaper(shaper_config()).unwrap(),
        Component::pulse_counter(counter, 3, false).unwrap(),
        Component::sliding_mode(&settings(), Law::Pid, false).unwrap(),
        Component::pwm(pwm, BridgeMode::HalfBridge, 100).unwrap(),
    ];
    let fast = |(composition, blocks): Whole| Composed::new(composition, blocks);
    let component = |component: Component| {
        let name = component.blocks().last().unwrap().name().to_owned();
        let plain = (component.composition().clone(), component.block_models(1));
        (name, BUS, component.model(1), Plain::new(plain))
    };
    let mut wholes: Vec<_> = components.map(component).into();
    wholes.push((
        "axis".to_owned(),
        STAGE,
        fast(axis(TICK_CLOCKS)),
        Plain::new(axis(TICK_CLOCKS)),
    ));
    let nested = fast(stage(TICK_CLOCKS, |axis| Box::new(fast(axis))));
    wholes.push((
        "stage".to_owned(),
        STAGE,
        nested,
        Plain::new(stage(TICK_CLOCKS, |axis| Box::new(Plain::new(axis)))),
    ));
    wholes
}

fn inputs_of(block: &dyn ClockedBlock, hints: Hints) -> (RandomInputs, usize) {
    let outputs = block.ports().iter().filter(|port| port.direction == Direction::Output);
    (RandomInputs::new(block.ports(), hints), outputs.count())
}

/// Compares them with random inputs that are held; the fast one uses `step` or `hold`. Returns the number of clocks
/// per call, or the first difference.
fn compare(fast: &mut Composed, plain: &mut Plain, hints: Hints, seed: u64) -> Result<f64, String> {
    let mut random = Random(seed);
    let (mut inputs, outputs) = inputs_of(fast, hints);
    let (mut shown, mut expected) = (vec![0; outputs], vec![0; outputs]);
    let counter = {
        let mut outputs = fast.ports().iter().filter(|port| port.direction == Direction::Output);
        outputs.position(|port| fast.output_kind(&port.name) == OutputKind::Counter)
    };
    let (mut calls, mut all) = (0, 0);
    for change in 0..200 {
        let mut left = inputs.change(&mut random).min(500);
        while left > 0 {
            let by_step = change % 4 == 0;
            let ran = if by_step {
                fast.step(&inputs.values, &mut shown).unwrap();
                1
            } else {
                fast.hold(&inputs.values, left, &mut shown).unwrap()
            };
            if !(1..=left).contains(&ran) {
                return Err(format!("{ran} clocks of {left}"));
            }
            for clock in 0..ran {
                plain.step(&inputs.values, &mut expected).unwrap();
                // The stage's time stamp counts.
                if let Some(counter) = counter.filter(|_| clock > 0) {
                    shown[counter] = (shown[counter] + 1) & 0xffff_ffff;
                }
                if shown != expected {
                    let at = shown.iter().zip(&expected).position(|(a, b)| a != b).unwrap();
                    let mut ports = fast.ports().iter().filter(|port| port.direction == Direction::Output);
                    let name = &ports.nth(at).unwrap().name;
                    return Err(format!(
                        "clock {} ({clock} of {ran}): {name} {:#x} {:#x}",
                        all + clock,
                        shown[at],
                        expected[at]
                    ));
                }
            }
            left -= ran;
            all += ran;
            calls += 1;
        }
    }
    Ok(all as f64 / f64::from(calls))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    #[test]
    fn prop_step_and_hold_are_every_block_in_every_clock(seed: u64) {
        for (name, hints, mut fast, mut plain) in wholes() {
            let found = compare(&mut fast, &mut plain, hints, seed);
            prop_assert!(found.is_ok(), "{name}: {found:?}");
        }
    }
}

#[test]
fn a_part_that_says_something_wrong_is_found() {
    let wrong = [
        (1, "no pass"),
        (2, "one more"),
        (2, "ignores"),
        (3, "no pass"),
        (4, "one more"),
        (4, "ignores"),
        (6, "one more"),
        (7, "ignores"),
    ];
    for (part, what) in wrong {
        let found = (0..20).any(|seed| {
            let with_wrong_part = |(composition, mut blocks): Whole| -> Box<dyn Moore> {
                let block = blocks.remove(part);
                blocks.insert(part, Box::new(Wrong { block, what }));
                Box::new(Composed::new(composition, blocks))
            };
            let (composition, blocks) = stage(TICK_CLOCKS, with_wrong_part);
            let mut plain = Plain::new(stage(TICK_CLOCKS, |axis| Box::new(Plain::new(axis))));
            compare(&mut Composed::new(composition, blocks), &mut plain, STAGE, seed).is_err()
        });
        assert!(found, "part {part}: {what}");
    }
}

/// Keeps its data in every clock, and shows after a strobe what it kept in the clock before.
#[derive(Default)]
struct Keeper {
    ports: Vec<Port>,
    kept: u64,
    shown: u64,
}

impl Keeper {
    fn new() -> Self {
        let port = |name: &str, direction, width| Port {
            name: name.to_owned(),
            direction,
            width,
            signed: false,
        };
        Self {
            ports: vec![
                port("data", Direction::Input, 8),
                port("strobe", Direction::Input, 1),
                port("shown", Direction::Output, 8),
            ],
            ..Self::default()
        }
    }
}

impl ClockedBlock for Keeper {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        self.show(outputs);
        if inputs[1] != 0 {
            self.shown = self.kept;
        }
        self.kept = inputs[0];
        Ok(())
    }
}

impl Moore for Keeper {
    fn show(&self, outputs: &mut [u64]) {
        outputs[0] = self.shown;
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        if inputs[1] != 0 { 0 } else { FOREVER }
    }

    fn pass(&mut self, inputs: &[u64], _clocks: u64) {
        self.kept = inputs[0];
    }

    fn ignores(&self, input: &str) -> bool {
        input == "data"
    }
}

#[test]
fn a_sleeping_block_passes_with_the_value_before_an_ignored_change() {
    let keeper = || -> Whole {
        let part = Part::new("keeper", Keeper::new().ports());
        let composition = Composition::new(vec![part], &["data", "strobe"], &["shown"]).unwrap();
        (composition, vec![Box::new(Keeper::new())])
    };
    let nested = |inner: Whole| -> Whole { (inner.0.clone(), vec![Box::new(Composed::new(inner.0, inner.1))]) };
    for (depth, whole) in [keeper(), nested(keeper())].into_iter().enumerate() {
        let (mut fast, mut plain) = (Composed::new(whole.0, whole.1), Plain::new(keeper()));
        let (mut shown, mut expected) = ([0], [0]);
        // Data changes alone, with the strobe, and just before it; the block sleeps in between.
        for (data, strobe, clocks) in [
            (5, 0, 7),
            (6, 1, 1),
            (7, 0, 3),
            (8, 0, 1),
            (9, 1, 2),
            (9, 0, 4),
            (1, 1, 1),
            (1, 0, 2),
        ] {
            let mut left = clocks;
            while left > 0 {
                left -= fast.hold(&[data, strobe], left, &mut shown).unwrap();
            }
            (0..clocks).for_each(|_| plain.step(&[data, strobe], &mut expected).unwrap());
            fast.show_with(&[data, 0], &mut shown);
            plain.show(&mut expected);
            assert_eq!(shown, expected, "depth {depth}, data {data}, strobe {strobe}");
        }
    }
}

#[test]
fn a_wait_is_one_call() {
    // With no bus access and no pin that moves, the block advances from tick to tick.
    let counter = Component::pulse_counter(DividerConfig::new(5000).unwrap(), 3, false).unwrap();
    let mut fast = counter.model(1);
    let (inputs, outputs) = inputs_of(&fast, &[]);
    let mut shown = vec![0; outputs];
    let calls = (0..10).map(|_| fast.hold(&inputs.values, 1_000_000, &mut shown).unwrap());
    let calls: Vec<u64> = calls.collect();
    assert!(calls.iter().any(|clocks| *clocks > 4000), "{calls:?}");
    assert_eq!(fast.hold(&inputs.values, 0, &mut shown), Ok(0));
    assert!(fast.hold(&inputs.values[1..], 1, &mut shown).is_err());
}

#[test]
fn random_inputs_move_the_axes() {
    let (composition, blocks) = stage(TICK_CLOCKS, |(composition, blocks)| {
        Box::new(Composed::new(composition, blocks))
    });
    let mut fast = Composed::new(composition, blocks);
    let (mut inputs, outputs) = inputs_of(&fast, STAGE);
    let (mut shown, mut before, mut changes) = (vec![0; outputs], vec![0; outputs], vec![0; outputs]);
    let mut random = Random(3);
    for round in 0..1200 {
        let mut left = inputs.change(&mut random);
        if round % 4 == 0 {
            // The entries of both axes are written word by word: random words hardly ever come in a valid order.
            for (word, data) in [(0, 0), (1, 0), (2, 0), (3, 2)] {
                inputs.set("word", word);
                inputs.set("data", data);
                inputs.set("x_write", 1);
                inputs.set("y_write", 1);
                fast.hold(&inputs.values, 1, &mut shown).unwrap();
            }
        }
        while left > 0 {
            left -= fast.hold(&inputs.values, left, &mut shown).unwrap();
            for ((count, before), value) in changes.iter_mut().zip(&mut before).zip(&shown) {
                *count += u32::from(before != value);
                *before = *value;
            }
        }
    }
    let driven = fast.ports().iter().filter(|port| port.direction == Direction::Output);
    let moved = [
        "done",
        "count",
        "velocity_valid",
        "controlled",
        "a_high",
        "b_low",
        "started",
        "halted",
        "disabled",
        "faulted",
    ];
    for (port, count) in driven.zip(changes) {
        let must = port.name.split_once('_').is_some_and(|(_, name)| moved.contains(&name));
        assert!(!must || count > 0, "{}", port.name);
    }
}
