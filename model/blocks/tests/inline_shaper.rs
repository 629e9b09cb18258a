//! The inline shaper against a controller and a drive that know only their lines.

use posicast_blocks::composition::Composed;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::inline_axis::{INLINE_FRACTION, InlineAxisConfig, InlineLinesActiveLow};
use posicast_blocks::inline_shaper::{INLINE_MOTION, InlineConfig, InlineError, InlineShaper, InlineShaperAxis};
use posicast_blocks::shaper::{MotionShaper, ShaperConfig};
use posicast_blocks::step_generator::{StepGeneratorConfig, StepMode, StepTimes};
use posicast_blocks::{ClockedBlock, Direction};
use posicast_taps::{Tap, TapTable};
use proptest::prelude::*;

const TICK_CLOCKS: u64 = 200;
/// Clocks from step to step of the fastest command.
const FASTEST_CLOCKS: u64 = 22;
const POSITIVE: &[(u32, i32)] = &[(0, 100), (3, 56), (7, 100)];
const NEGATIVE: &[(u32, i32)] = &[(0, 160), (2, -64), (5, 160)];

fn table(fraction: u32, taps: &[(u32, i32)]) -> TapTable {
    let tap = |&(delay_samples, coefficient): &(u32, i32)| Tap {
        delay_samples,
        coefficient,
    };
    TapTable::new(fraction, taps.iter().map(tap).collect()).unwrap()
}

fn axis(modes: [StepMode; 2], taps: &[(u32, i32)], low: InlineLinesActiveLow) -> InlineShaperAxis {
    let times = StepTimes {
        pulse_clocks: 3,
        space_clocks: 4,
        direction_setup_clocks: 12,
        direction_hold_clocks: 8,
    };
    let shaper = ShaperConfig::new(32, table(8, taps)).unwrap();
    let settle = u64::from(shaper.table().longest_delay_samples()) + 1;
    InlineShaperAxis {
        name: "x".to_owned(),
        input: modes[0],
        filter_clocks: 2,
        follower: InlineAxisConfig::new(10, settle).unwrap().active_low(low),
        shaper: shaper.for_motion(INLINE_MOTION).unwrap(),
        steps: StepGeneratorConfig::new(TICK_CLOCKS, INLINE_FRACTION, modes[1], times, 100).unwrap(),
        trace: None,
    }
}

fn config(axes: Vec<InlineShaperAxis>) -> InlineConfig {
    InlineConfig {
        tick: DividerConfig::new(TICK_CLOCKS).unwrap(),
        axes,
    }
}

/// A step interface as its receiver reads it: from two levels to a count.
struct Reader {
    mode: StepMode,
    levels: Option<[bool; 2]>,
    count: i64,
}

impl Reader {
    fn new(mode: StepMode) -> Self {
        Self {
            mode,
            levels: None,
            count: 0,
        }
    }

    fn reads(&mut self, [a, b]: [bool; 2]) {
        let [a_before, b_before] = self.levels.replace([a, b]).unwrap_or([a, b]);
        let rises = |now: bool, before: bool| i64::from(now && !before);
        let code = |a: bool, b: bool| i64::from(b) * 2 + i64::from(a != b);
        self.count += match self.mode {
            StepMode::StepDirection => rises(a, a_before) * if b { 1 } else { -1 },
            StepMode::UpDown => rises(a, a_before) - rises(b, b_before),
            StepMode::Quadrature => match (code(a, b) - code(a_before, b_before)) & 3 {
                1 => 1,
                3 => -1,
                _ => 0,
            },
        };
    }
}

/// A controller, an inline shaper of one axis, and a drive.
struct Chain {
    model: Composed,
    outputs: Vec<String>,
    seen: Vec<u64>,
    low: InlineLinesActiveLow,
    mode: StepMode,
    /// Lines of the controller before their polarity.
    levels: [bool; 2],
    code: i64,
    drive: Reader,
    /// Steps that the controller has given.
    sent: i64,
    enable: bool,
    bypass: bool,
    emergency: bool,
    clear: bool,
}

impl Chain {
    fn new(of: InlineShaperAxis) -> Self {
        let (low, mode, output) = (of.follower.lines_active_low(), of.input, of.steps.mode());
        let model = InlineShaper::new(&config(vec![of])).unwrap().model(7);
        let ports = model.ports().iter().filter(|port| port.direction == Direction::Output);
        let outputs: Vec<String> = ports.map(|port| port.name.clone()).collect();
        Self {
            seen: vec![0; outputs.len()],
            outputs,
            model,
            low,
            mode,
            levels: [false; 2],
            code: 0,
            drive: Reader::new(output),
            sent: 0,
            enable: true,
            bypass: false,
            emergency: false,
            clear: false,
        }
    }

    fn output(&self, name: &str) -> bool {
        let at = self.outputs.iter().position(|output| output == name).unwrap();
        self.seen[at] == 1
    }

    fn clock(&mut self) {
        let pins = [self.levels[0] != self.low.a, self.levels[1] != self.low.b];
        let inputs = [
            false,
            self.enable,
            !self.emergency,
            self.bypass,
            self.clear,
            pins[0],
            pins[1],
        ];
        let inputs = inputs.map(u64::from);
        self.model.step(&inputs, &mut self.seen).unwrap();
        let first = self.outputs.iter().position(|output| output.starts_with("x_")).unwrap();
        self.drive.reads([self.seen[first] == 1, self.seen[first + 1] == 1]);
    }

    fn wait(&mut self, clocks: u64) {
        for _ in 0..clocks {
            self.clock();
        }
    }

    /// Gives steps, this many clocks apart; the direction changes in the clock of the first step.
    fn send(&mut self, steps: i64, apart: u64) {
        let up = steps > 0;
        for _ in 0..steps.abs() {
            self.sent += steps.signum();
            let pulse = apart / 2;
            match self.mode {
                StepMode::StepDirection => self.levels = [true, up],
                StepMode::UpDown => self.levels[usize::from(!up)] = true,
                StepMode::Quadrature => {
                    self.code = (self.code + steps.signum()) & 3;
                    self.levels = [matches!(self.code, 1 | 2), self.code >= 2];
                }
            }
            self.wait(pulse);
            match self.mode {
                StepMode::StepDirection => self.levels[0] = false,
                StepMode::UpDown => self.levels = [false; 2],
                StepMode::Quadrature => {}
            }
            self.wait(apart - pulse);
        }
    }

    /// Waits until it is settled; returns the clocks that took.
    fn settle(&mut self) -> u64 {
        for clocks in 0..100 * TICK_CLOCKS {
            if self.output("settled") {
                return clocks;
            }
            self.clock();
        }
        panic!("never settled");
    }
}

/// Clocks from the last step of a command to `settled`, at most: filter, wait for a tick, the shaper, the interpolation,
/// the steps that a reversal owes.
fn settle_clocks(of: &InlineShaperAxis) -> u64 {
    let ticks = u64::from(of.follower.settle_ticks()) + 3;
    let owed = of.steps.reversal_steps() * of.steps.period_clocks() + 60;
    ticks * TICK_CLOCKS + owed
}

const KINDS: [StepMode; 3] = [StepMode::StepDirection, StepMode::UpDown, StepMode::Quadrature];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever the controller sends, at rest as many steps have come out as went in, and it says so in bounded time.
    #[test]
    fn prop_at_rest_the_drive_has_got_every_step(
        kinds in (0..3_usize, 0..3_usize),
        low in (any::<bool>(), any::<bool>()),
        negative in any::<bool>(),
        rides in prop::collection::vec((-60..60_i64, FASTEST_CLOCKS..300, any::<bool>(), 0..2000_u64), 1..10),
    ) {
        let taps = if negative { NEGATIVE } else { POSITIVE };
        let of = axis([KINDS[kinds.0], KINDS[kinds.1]], taps, InlineLinesActiveLow { a: low.0, b: low.1 });
        let most = settle_clocks(&of);
        let mut chain = Chain::new(of);
        chain.wait(3 * TICK_CLOCKS);
        let before = (chain.sent, chain.drive.count);
        for (steps, apart, bypass, pause) in rides {
            chain.bypass = bypass;
            chain.send(steps, apart);
            chain.wait(pause);
            prop_assert!(!chain.output("fault"));
        }
        prop_assert!(chain.settle() <= most);
        prop_assert_eq!(chain.drive.count - before.1, chain.sent - before.0);
    }

    /// With positive taps no two positions of successive ticks are further apart than two of the command have been within the
    /// shaper's duration.
    #[test]
    fn prop_positive_taps_are_never_faster_than_the_command(
        parts in prop::collection::btree_map(0..40_u32, 1..400_i32, 1..12),
        moves in prop::collection::vec(-2000..2000_i64, 1..200),
    ) {
        let sum: i32 = parts.values().sum();
        let mut taps: Vec<(u32, i32)> = parts.iter().map(|(delay, part)| (*delay, part * (1 << 14) / sum)).collect();
        let rest = (1 << 14) - taps.iter().map(|(_, coefficient)| coefficient).sum::<i32>();
        taps[0].1 += rest;
        taps.retain(|(_, coefficient)| *coefficient > 0);
        let longest = taps.iter().map(|(delay, _)| *delay as usize).max().unwrap();
        let shaper = ShaperConfig::new(32, table(14, &taps)).unwrap().for_motion(INLINE_MOTION).unwrap();
        let mut shaper = MotionShaper::new(&shaper);
        let (mut x, mut y) = (0, shaper.start([0; 3])[0]);
        for (at, by) in moves.iter().enumerate() {
            x += by << INLINE_FRACTION;
            let next = shaper.push([x, 0, 0])[0];
            let window = &moves[at.saturating_sub(longest)..=at];
            let most = window.iter().copied().fold(0, i64::max) << INLINE_FRACTION;
            let least = window.iter().copied().fold(0, i64::min) << INLINE_FRACTION;
            prop_assert!((least..=most).contains(&(next - y)), "{} of {least} to {most}", next - y);
            y = next;
        }
    }

    /// Negative taps exceed the command by at most Σ|c| / 2^F, and by a unit of rounding.
    #[test]
    fn prop_negative_taps_stay_within_their_overshoot(
        parts in prop::collection::btree_map(0..40_u32, -400..400_i32, 1..12),
        moves in prop::collection::vec(-2000..2000_i64, 1..200),
    ) {
        let rest = (1 << 10) - parts.values().sum::<i32>();
        let mut taps: Vec<(u32, i32)> = parts.into_iter().chain([(41, rest)]).collect();
        taps.retain(|(_, coefficient)| *coefficient != 0);
        let size: i64 = taps.iter().map(|(_, coefficient)| i64::from(coefficient.abs())).sum();
        let shaper = ShaperConfig::new(32, table(10, &taps)).unwrap().for_motion(INLINE_MOTION).unwrap();
        let mut shaper = MotionShaper::new(&shaper);
        let (mut x, mut y) = (0, shaper.start([0; 3])[0]);
        let most = moves.iter().map(|by| by.abs()).max().unwrap() << INLINE_FRACTION;
        for by in moves {
            x += by << INLINE_FRACTION;
            let next = shaper.push([x, 0, 0])[0];
            prop_assert!((next - y).abs() <= (most * size + (1 << 10) - 1) / (1 << 10) + 1);
            y = next;
        }
    }
}

fn plain() -> InlineShaperAxis {
    let step = StepMode::StepDirection;
    axis([step, step], POSITIVE, InlineLinesActiveLow::default())
}

#[test]
fn an_axis_that_is_enabled_in_a_ride_begins_where_the_input_stands() {
    let mut chain = Chain::new(plain());
    chain.enable = false;
    chain.send(50, 40);
    assert_eq!(chain.drive.count, 0);
    chain.enable = true;
    // The lines are synchronised, and the axis begins at the next tick: at most 6 more steps are dropped.
    chain.send(40, 40);
    chain.settle();
    assert!((34..=40).contains(&chain.drive.count), "{}", chain.drive.count);
}

#[test]
fn a_bypass_waits_for_rest_and_then_delays_by_the_stated_clocks() {
    let of = plain();
    let delay = u64::from(config(vec![of.clone()]).unshaped_clocks(&of));
    let mut chain = Chain::new(of);
    chain.wait(3 * TICK_CLOCKS);
    chain.bypass = true;
    chain.send(60, 40);
    chain.settle();
    chain.wait(2 * TICK_CLOCKS);
    assert!(chain.output("bypassed"));
    // An even speed: the steps come out as evenly, this much later, to a step.
    chain.send(100, 40);
    let sent = chain.sent;
    let before = chain.drive.count;
    let behind = delay.div_ceil(40) as i64;
    assert!((sent - before - behind).abs() <= 1, "{sent} {before} {behind}");
    chain.bypass = false;
    chain.send(10, 40);
    assert!(chain.output("bypassed"), "not while it moves");
    chain.settle();
    chain.wait(2 * TICK_CLOCKS);
    assert!(!chain.output("bypassed"));
    assert_eq!(chain.drive.count, chain.sent);
}

#[test]
fn a_command_beyond_the_limit_stops_with_a_fault_until_it_is_cleared() {
    let mut chain = Chain::new(plain());
    chain.wait(3 * TICK_CLOCKS);
    chain.send(60, 15);
    assert!(chain.output("fault") && chain.output("x_input_too_fast"));
    chain.wait(5 * TICK_CLOCKS);
    let stood = chain.drive.count;
    assert!(stood < chain.sent, "the steps beyond the limit are not given");
    chain.send(20, 40);
    assert_eq!(chain.drive.count, stood);
    chain.clear = true;
    chain.wait(3 * TICK_CLOCKS);
    assert!(!chain.output("fault"));
    chain.send(20, 40);
    chain.settle();
    assert_eq!(chain.drive.count, stood + 20);
}

#[test]
fn an_emergency_stop_acts_without_a_clock_and_stays() {
    let mut chain = Chain::new(plain());
    chain.wait(3 * TICK_CLOCKS);
    assert!(chain.output("drive_enable"));
    chain.send(30, 30);
    chain.emergency = true;
    chain.clock();
    assert!(!chain.output("drive_enable"), "in the same clock");
    chain.wait(20);
    let stood = chain.drive.count;
    chain.emergency = false;
    chain.send(30, 40);
    assert!(!chain.output("drive_enable") && chain.output("fault"));
    assert_eq!(chain.drive.count, stood);
    chain.clear = true;
    chain.wait(10);
    assert!(chain.output("drive_enable"));
}

#[test]
fn a_fault_of_one_axis_stops_the_other() {
    let other = InlineShaperAxis {
        name: "z".to_owned(),
        ..plain()
    };
    let mut model = InlineShaper::new(&config(vec![plain(), other])).unwrap().model(1);
    let ports = model.ports().iter().filter(|port| port.direction == Direction::Output);
    let names: Vec<String> = ports.map(|port| port.name.clone()).collect();
    let at = |name: &str| names.iter().position(|other| other == name).unwrap();
    let mut outputs = vec![0; names.len()];
    let mut edges = 0;
    for clock in 0..40 * TICK_CLOCKS {
        // x rides too fast from the 20th tick on, z evenly.
        let step_x = u64::from(clock > 20 * TICK_CLOCKS && clock % 14 < 7);
        let step_z = u64::from(clock % 50 < 25);
        let before = outputs[at("z_step")];
        model
            .step(&[0, 1, 1, 0, 0, step_x, 1, step_z, 1], &mut outputs)
            .unwrap();
        if clock > 25 * TICK_CLOCKS {
            edges += u64::from(before != outputs[at("z_step")]);
        }
    }
    assert_eq!((outputs[at("fault")], outputs[at("x_input_too_fast")]), (1, 1));
    assert_eq!((outputs[at("z_input_too_fast")], edges), (0, 0));
}

#[test]
fn what_cannot_be_built_is_refused() {
    let refused = |axes: Vec<InlineShaperAxis>, tick: u64| {
        let tick = DividerConfig::new(tick).unwrap();
        InlineShaper::new(&InlineConfig { tick, axes }).unwrap_err()
    };
    assert_eq!(refused(vec![], 200), InlineError::Axes(0));
    assert!(matches!(refused(vec![plain()], 300), InlineError::Steps { .. }));
    assert!(matches!(
        refused(vec![plain(), plain()], 200),
        InlineError::Composition(_)
    ));
    let filtered = InlineShaperAxis {
        filter_clocks: 64,
        ..plain()
    };
    assert!(matches!(refused(vec![filtered], 200), InlineError::Filter { .. }));
    assert!(InlineAxisConfig::new(0, 1).is_err() && InlineAxisConfig::new(1, 0).is_err());
}

/// Lines for two million steps per second at 50 MHz: 12 + 13 clocks in, 12 + 12 out.
fn fast() -> InlineConfig {
    let times = StepTimes {
        pulse_clocks: 12,
        space_clocks: 12,
        direction_setup_clocks: 12,
        direction_hold_clocks: 12,
    };
    let tick_clocks = 1000;
    let steps = StepGeneratorConfig::new(tick_clocks, INLINE_FRACTION, StepMode::StepDirection, times, 100).unwrap();
    InlineConfig {
        tick: DividerConfig::new(tick_clocks).unwrap(),
        axes: vec![InlineShaperAxis {
            filter_clocks: 8,
            follower: InlineAxisConfig::new(41, 8).unwrap(),
            steps,
            ..plain()
        }],
    }
}

/// Rides up by this many steps at two million a second, and stands; returns what the drive has counted, and whether there was a
/// fault.
fn rides(steps: u64) -> (i64, bool) {
    let mut model = InlineShaper::new(&fast()).unwrap().model(3);
    let ports = model.ports().iter().filter(|port| port.direction == Direction::Output);
    let names: Vec<String> = ports.map(|port| port.name.clone()).collect();
    let at = |name: &str| names.iter().position(|other| other == name).unwrap();
    let (step, direction, fault) = (at("x_step"), at("x_direction"), at("fault"));
    let mut drive = Reader::new(StepMode::StepDirection);
    let (mut seen, mut faulty) = (vec![0; names.len()], false);
    let mut hold = |level: u64, clocks: u64| {
        let mut left = clocks;
        while left > 0 {
            left -= model.hold(&[0, 1, 1, 0, 0, level, 1], left, &mut seen).unwrap();
            drive.reads([seen[step] == 1, seen[direction] == 1]);
            faulty |= seen[fault] == 1;
        }
    };
    hold(0, 5000);
    for _ in 0..steps {
        hold(1, 12);
        hold(0, 13);
    }
    hold(0, 20_000);
    (drive.count, faulty)
}

#[test]
fn two_million_steps_per_second_come_out() {
    assert_eq!(rides(20_000), (20_000, false));
}

/// Positions have 24 bits of whole steps.
#[test]
fn long_a_ride_beyond_the_end_of_the_position_loses_no_step() {
    let steps = (1 << 23) + 50_000;
    assert_eq!(rides(steps), (steps as i64, false));
}

/// Every history of a small shaper: all tables of positive taps with coefficients of two fraction bits and delays of up to 2, and
/// every command of four changes of -2 to 2. No change of the output is outside those of the command within the shaper's duration.
#[test]
fn every_command_of_every_small_positive_shaper_is_never_faster() {
    let mut tables = Vec::new();
    for first in 0..=4_i32 {
        for second in 0..=4 - first {
            let parts = [(0, first), (1, second), (2, 4 - first - second)];
            tables.push(parts.into_iter().filter(|(_, part)| *part > 0).collect::<Vec<_>>());
        }
    }
    assert_eq!(tables.len(), 15);
    for taps in tables {
        let longest = taps.iter().map(|(delay, _)| *delay as usize).max().unwrap();
        let shaper = ShaperConfig::new(32, table(2, &taps)).unwrap();
        let shaper = shaper.for_motion(INLINE_MOTION).unwrap();
        for command in 0..5_u32.pow(4) {
            let moves: Vec<i64> = (0..4).map(|at| i64::from(command / 5_u32.pow(at) % 5) - 2).collect();
            let mut shaper = MotionShaper::new(&shaper);
            let (mut x, mut y) = (0, shaper.start([0; 3])[0]);
            for at in 0..moves.len() + longest {
                let by = moves.get(at).copied().unwrap_or(0);
                x += by;
                let next = shaper.push([x, 0, 0])[0];
                let window = (at.saturating_sub(longest)..=at).map(|at| moves.get(at).copied().unwrap_or(0));
                // Before the command, it stood.
                let most = window.clone().fold(0, i64::max);
                let least = window.fold(0, i64::min);
                assert!(
                    (least..=most).contains(&(next - y)),
                    "{taps:?} {moves:?} at {at}: {}",
                    next - y
                );
                y = next;
            }
            assert_eq!(y, x, "{taps:?} {moves:?}");
        }
    }
}
