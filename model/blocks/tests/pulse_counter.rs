//! What a motion engineer expects of the pulse counter, alone and with its divider.

use posicast_blocks::divider::{self, Divider, DividerConfig};
use posicast_blocks::pulse_counter::{Inputs, PulseCounter};
use proptest::prelude::*;
use serde_json::Value;

/// Number of clocks per tick in these tests.
const TICK_CLOCKS: u32 = 200;
/// Levels of A and B in the order of counting up.
const STATES: [(bool, bool); 4] = [(false, false), (true, false), (true, true), (false, true)];

/// A counter with its divider, ticks and time stamps.
struct Bench {
    counter: PulseCounter,
    divider: Divider,
    inputs: Inputs,
    angle: usize,
    until_tick: u32,
    /// Number of latched indices.
    indices: u32,
}

impl Bench {
    fn new(inputs: Inputs) -> Self {
        let mut bench = Self {
            counter: PulseCounter::new(),
            divider: Divider::new(&DividerConfig::new(u64::from(TICK_CLOCKS)).unwrap()),
            inputs: Inputs { timeout: 4, ..inputs },
            angle: 0,
            until_tick: TICK_CLOCKS,
            indices: 0,
        };
        bench.idle(10);
        bench
    }

    fn clock(&mut self) {
        self.until_tick -= 1;
        self.inputs.tick = self.until_tick == 0;
        let shown = self.counter.outputs();
        let quotient = self.divider.step(&divider::Inputs {
            start: self.until_tick == TICK_CLOCKS - 1,
            steps: shown.steps,
            elapsed: shown.elapsed,
            ..divider::Inputs::default()
        });
        self.inputs.quotient = quotient.quotient as i32;
        self.inputs.quotient_valid = quotient.done;
        self.indices += u32::from(self.counter.step(&self.inputs).index_seen);
        self.inputs.time_stamp = (self.inputs.time_stamp + 1) & 0xff_ffff;
        if self.inputs.tick {
            self.until_tick = TICK_CLOCKS;
        }
    }

    fn idle(&mut self, clocks: u32) {
        (0..clocks).for_each(|_| self.clock());
    }

    /// Makes one quadrature step up or down, then waits this many clocks.
    fn turn(&mut self, up: bool, clocks: u32) {
        self.angle = if up { self.angle + 1 } else { self.angle + 3 } % 4;
        (self.inputs.a, self.inputs.b) = STATES[self.angle];
        self.idle(clocks);
    }

    fn velocity(&self) -> i32 {
        self.counter.outputs().velocity
    }

    /// Runs until right after the velocity of a tick, and returns it.
    fn next_velocity(&mut self) -> i32 {
        while !self.counter.outputs().velocity_valid {
            self.clock();
        }
        self.clock();
        self.velocity()
    }
}

/// Returns the velocity in Q16.16 counts per tick for this many clocks per count.
fn exact(clocks_per_count: u32, up: bool) -> i32 {
    let size = (u64::from(TICK_CLOCKS) << 16) / u64::from(clocks_per_count);
    if up { size as i32 } else { -(size as i32) }
}

#[test]
fn golden_quadrature() {
    let golden: Value = serde_json::from_str(include_str!("golden/quadrature.json")).unwrap();
    let mut counter = PulseCounter::new();
    let mut inputs = Inputs::default();
    counter.hold(&inputs, 10);
    let rows = golden["trace"].as_array().unwrap();
    assert_eq!(rows.len(), 15);
    for row in rows {
        let levels = row[0].as_str().unwrap().as_bytes();
        (inputs.b, inputs.a) = (levels[0] == b'1', levels[1] == b'1');
        counter.hold(&inputs, 10);
        let shown = counter.outputs();
        assert_eq!(i64::from(shown.count), row[2].as_i64().unwrap(), "{row}");
        assert_eq!(u64::from(shown.illegal_count), row[3].as_u64().unwrap(), "{row}");
    }
}

#[test]
fn coarser_counts_are_the_same_there_and_back() {
    for (mode, counts) in [(0, 40), (1, 20), (2, 10)] {
        let mut bench = Bench::new(Inputs {
            mode,
            ..Inputs::default()
        });
        let mut there = vec![];
        for _ in 0..40 {
            there.push(bench.counter.outputs().count);
            bench.turn(true, 9);
        }
        assert_eq!(bench.counter.outputs().count, counts);
        for count in there.into_iter().rev() {
            bench.turn(false, 9);
            assert_eq!(bench.counter.outputs().count, count, "mode {mode}");
        }
        assert_eq!(bench.counter.outputs().illegal_count, 0);
    }
}

#[test]
fn levels_at_reset_are_no_steps() {
    for (a, b) in STATES {
        let mut counter = PulseCounter::new();
        let inputs = Inputs {
            a,
            b,
            z: true,
            index_always: true,
            filter_clocks: 63,
            ..Inputs::default()
        };
        counter.hold(&inputs, 1000);
        assert_eq!((counter.outputs().count, counter.outputs().illegal), (0, false));
    }
}

#[test]
fn a_pulse_of_filter_clocks_is_ignored_and_one_more_is_not() {
    for filter_clocks in [0, 1, 8, 63] {
        for (more, count) in [(0, 0), (1, 1)] {
            let mut inputs = Inputs {
                mode: 4,
                filter_clocks,
                ..Inputs::default()
            };
            let mut counter = PulseCounter::new();
            counter.hold(&inputs, 200);
            inputs.a = true;
            for _ in 0..u64::from(filter_clocks) + more {
                counter.step(&inputs);
            }
            inputs.a = false;
            counter.hold(&inputs, 200);
            assert_eq!(counter.outputs().count, count, "filter {filter_clocks}");
        }
    }
}

#[test]
fn the_index_latches_the_count_after_the_step_of_its_clock_and_presets_the_origin() {
    let mut bench = Bench::new(Inputs {
        filter_clocks: 2,
        index_presets: true,
        preset_value: 1000,
        ..Inputs::default()
    });
    bench.inputs.index_arm = true;
    bench.clock();
    bench.inputs.index_arm = false;
    bench.turn(true, 20);
    bench.inputs.z = true;
    bench.turn(true, 20);
    let shown = bench.counter.outputs();
    assert_eq!((shown.index_count, shown.count, shown.position), (2, 2, 1000));
    assert!(bench.indices == 1 && !shown.index_armed && !shown.index_seen);
    // It latches once: the next index changes nothing.
    bench.inputs.z = false;
    bench.turn(true, 20);
    bench.inputs.z = true;
    bench.turn(true, 20);
    let shown = bench.counter.outputs();
    assert_eq!((shown.index_count, shown.count, shown.position), (2, 4, 1002));
    assert_eq!(bench.indices, 1);
}

#[test]
fn a_pair_that_stays_equal_is_flagged_and_counts_nothing() {
    let mut inputs = Inputs {
        differential: true,
        filter_clocks: 3,
        a_n: true,
        b_n: true,
        z_n: true,
        ..Inputs::default()
    };
    let mut counter = PulseCounter::new();
    counter.hold(&inputs, 50);
    inputs.a = true;
    counter.hold(&inputs, 50);
    let shown = counter.outputs();
    assert_eq!((shown.count, shown.level_a, shown.disagreement), (0, false, true));
    inputs.a_n = false;
    inputs.clear_flags = true;
    counter.hold(&inputs, 50);
    let shown = counter.outputs();
    assert_eq!((shown.count, shown.level_a, shown.disagreement), (1, true, false));
}

#[test]
fn a_reversal_gives_zero_then_the_new_speed() {
    let mut bench = Bench::new(Inputs::default());
    (0..20).for_each(|_| bench.turn(true, 50));
    assert_eq!(bench.velocity(), exact(50, true));
    let mut seen = vec![];
    for _ in 0..20 {
        bench.turn(false, 50);
        seen.push(bench.velocity());
    }
    seen.dedup();
    assert_eq!(seen, [exact(50, true), 0, exact(50, false)]);
}

#[test]
fn at_standstill_the_velocity_falls_with_the_time_and_ends_at_zero() {
    let mut bench = Bench::new(Inputs::default());
    (0..40).for_each(|_| bench.turn(false, 50));
    let mut last = i64::from(bench.velocity());
    assert_eq!(last, i64::from(exact(50, false)));
    for ticks in 1..40u32 {
        let velocity = i64::from(bench.next_velocity());
        assert!((last..0).contains(&velocity), "{velocity}");
        // By then the last edge was at least three ticks ago.
        if ticks > 3 {
            assert!(
                velocity >= i64::from(exact((ticks - 3) * TICK_CLOCKS, false)),
                "{velocity}"
            );
        }
        last = velocity;
    }
    bench.inputs.time_stamp += 4 << 16;
    bench.next_velocity();
    assert_eq!(bench.next_velocity(), 0);
}

#[test]
fn a_tick_without_answer_is_flagged() {
    let mut counter = PulseCounter::new();
    let tick = Inputs {
        tick: true,
        ..Inputs::default()
    };
    counter.step(&tick);
    assert!(counter.outputs().velocity_pending && !counter.outputs().velocity_missed);
    counter.step(&tick);
    assert!(counter.outputs().velocity_missed);
}

proptest! {
    #[test]
    fn prop_a_steady_speed_is_measured_exactly(clocks_per_count in 3u32..3000, up: bool, smoothing in 0u8..=3) {
        let mut bench = Bench::new(Inputs { smoothing, ..Inputs::default() });
        let counts = 12 * TICK_CLOCKS / clocks_per_count + 4;
        (0..counts).for_each(|_| bench.turn(up, clocks_per_count));
        if smoothing == 0 {
            for _ in 0..30 {
                bench.turn(up, clocks_per_count);
                prop_assert_eq!(bench.velocity(), exact(clocks_per_count, up));
            }
        }
    }

    #[test]
    fn prop_smoothing_settles_on_its_input_exactly(from: i32, to: i32, smoothing in 0u8..=3) {
        let mut counter = PulseCounter::new();
        let mut feed = |quotient, smoothing| {
            let settings = Inputs { velocity_m: true, smoothing, quotient, ..Inputs::default() };
            counter.step(&Inputs { tick: true, ..settings });
            counter.step(&Inputs { quotient_valid: true, ..settings });
            counter.outputs().velocity
        };
        prop_assert_eq!(feed(from, 0), from);
        let mut velocity = from;
        for _ in 0..300 {
            let next = feed(to, smoothing);
            prop_assert!((i64::from(next) - i64::from(to)).abs() <= (i64::from(velocity) - i64::from(to)).abs());
            velocity = next;
        }
        prop_assert_eq!(velocity, to);
    }

    #[test]
    fn prop_the_count_never_jumps_and_a_preset_sets_the_position(
        clocks in proptest::collection::vec((any::<[u64; 26]>(), 0u32..10), 1..400),
    ) {
        let mut counter = PulseCounter::new();
        let mut presets = false;
        for (mut raw, dice) in clocks {
            raw[0] = 0;
            raw[8] = u64::from(dice & 1);
            let inputs = Inputs::from_raw(&raw);
            let before = counter.step(&inputs);
            let after = counter.outputs();
            prop_assert!(after.count.wrapping_sub(before.count).abs() <= 1);
            // In the clock after the preset, the step of the preset is added to the count, not that of this clock.
            if presets {
                prop_assert_eq!(before.count.wrapping_sub(after.origin), inputs.preset_value);
            }
            presets = inputs.preset;
        }
    }

    #[test]
    fn prop_hold_is_as_many_steps(runs in proptest::collection::vec((any::<[u64; 26]>(), 1u64..200), 1..60)) {
        let mut both = Both::default();
        for (mut raw, clocks) in runs {
            raw[0] &= raw[1] & raw[2] & raw[3];
            both.hold(&Inputs::from_raw(&raw), clocks)?;
        }
    }

    #[test]
    fn prop_hold_is_as_many_steps_of_a_turning_encoder(
        steps in proptest::collection::vec((0u32..12, any::<bool>(), 1u64..900, any::<i32>()), 1..60),
        filter_clocks in 0u8..20,
        velocity_m: bool,
        smoothing in 0u8..4,
        timeout in 0u8..3,
    ) {
        let mut both = Both::default();
        let mut inputs = Inputs { filter_clocks, velocity_m, smoothing, timeout, time_stamp: 0xff_ff00, ..Inputs::default() };
        let mut angle = 0;
        for (what, up, clocks, quotient) in steps {
            let (once, pause) = match what {
                0 | 1 => (Inputs { tick: true, ..inputs }, 0),
                2 => (Inputs { quotient_valid: true, quotient, ..inputs }, 0),
                3 => (Inputs { index_arm: true, clear_flags: up, ..inputs }, 0),
                4 => (inputs, 100 * clocks),
                _ => {
                    angle += if up { 1 } else { 3 };
                    (inputs.a, inputs.b) = STATES[angle % 4];
                    inputs.z = angle % 10 == 0;
                    (inputs, 0)
                }
            };
            both.hold(&once, 1)?;
            inputs.time_stamp = inputs.time_stamp.wrapping_add(1);
            both.hold(&inputs, clocks + pause)?;
            inputs.time_stamp = inputs.time_stamp.wrapping_add((clocks + pause) as u32);
        }
    }
}

/// A counter advanced by `hold` and one by `step`.
#[derive(Default)]
struct Both {
    fast: PulseCounter,
    slow: PulseCounter,
}

impl Both {
    fn hold(&mut self, inputs: &Inputs, clocks: u64) -> Result<(), TestCaseError> {
        self.fast.hold(inputs, clocks);
        for clock in 0..clocks {
            let time_stamp = inputs.time_stamp.wrapping_add(clock as u32);
            self.slow.step(&Inputs { time_stamp, ..*inputs });
        }
        prop_assert_eq!(self.fast.outputs(), self.slow.outputs());
        Ok(())
    }
}
