//! Seeded random inputs for an axis of the inline shaper: a count that stands, rides up to the limit and beyond, and jumps
//! while the axis does not follow; a count of the output that comes after it, or does not; ticks at every distance; `run`,
//! clears, causes and resets in any clock.
//!
//! Between the rests, the ticks are as short as the block allows, so that a long shaper settles within a run.

use posicast_blocks::inline_axis::{INPUT_PORTS, InlineAxisConfig, OUTPUT_PORTS};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Most clocks of a rest from tick to tick.
const REST_TICK_CLOCKS: u64 = 3;

/// What the count does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Act {
    /// It stands, with short ticks, until the axis can be settled.
    Rest,
    /// It moves by this in every tick.
    Ride(i64),
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct InlineAxisRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    limit: i64,
    settle_ticks: u64,
    act: Act,
    ticks_left: u64,
    clocks_to_tick: u64,
    count: i64,
    given: i64,
    /// Steps of the input less those of the output that the output tends to.
    gap: i64,
    run: bool,
    unshaped: bool,
    pins: u64,
}

/// Clocks in which the stimuli have exercised every flag.
pub(super) fn least_clocks(config: &InlineAxisConfig) -> u64 {
    20 * REST_TICK_CLOCKS * u64::from(config.settle_ticks()) + 20_000
}

impl InlineAxisRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(config: &InlineAxisConfig, seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            limit: config.limit_steps().into(),
            settle_ticks: config.settle_ticks().into(),
            act: Act::Rest,
            ticks_left: 2,
            clocks_to_tick: 4,
            count: 0,
            given: 0,
            gap: 0,
            run: false,
            unshaped: false,
            pins: 0,
        }
    }

    fn one_in(&mut self, chances: u64) -> bool {
        self.rng.random_range(0..chances) == 0
    }

    fn next_act(&mut self) -> (Act, u64) {
        let most = self.limit.min(1 << 16);
        let any = self.rng.random_range(-most..=most);
        let sign = *pick(&mut self.rng, &[1, -1]);
        let few = self.rng.random_range(1..6);
        let rest = self.settle_ticks + self.rng.random_range(0..4);
        *pick(
            &mut self.rng,
            &[
                (Act::Rest, rest),
                (Act::Ride(any), few),
                (Act::Ride(sign), few),
                (Act::Ride(sign * most), few),
                (Act::Ride(sign * (most + 1)), 1),
            ],
        )
    }

    /// The counts of the next clock.
    fn move_counts(&mut self, follows: bool, settled: bool) -> bool {
        self.clocks_to_tick -= 1;
        let tick = self.clocks_to_tick == 0;
        if tick {
            if self.ticks_left == 0 {
                (self.act, self.ticks_left) = self.next_act();
            }
            self.ticks_left -= 1;
            let rests = self.act == Act::Rest;
            let most = if rests { REST_TICK_CLOCKS } else { 12 };
            self.clocks_to_tick = self.rng.random_range(1..=most);
            if let Act::Ride(steps) = self.act {
                self.count += steps;
            }
        }
        if !follows && self.one_in(30) {
            let word = i64::from(self.rng.next_u32() as i32);
            let near = 1 << *pick(&mut self.rng, &[17, 18, 23, 24, 31]);
            self.count = *pick(&mut self.rng, &[word, near, near - 1, -near, -near - 1]);
            self.gap = self.count - self.given;
        }
        if settled && self.one_in(20) {
            self.count += *pick(&mut self.rng, &[1, -1]);
        }
        let misses = (self.count - self.gap) - self.given;
        if self.one_in(2) {
            self.given += misses.clamp(-(1 << 14), 1 << 14);
        }
        if self.one_in(400) {
            self.given += *pick(&mut self.rng, &[1, -1, 1 << 16, 1 << 30]);
        }
        tick
    }
}

impl Stimuli for InlineAxisRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let [
            rst,
            pin_a,
            pin_b,
            run,
            unshaped,
            clear,
            tick,
            count,
            illegal,
            shaped,
            given,
            too_fast,
            owed_exceeded,
        ] = inputs
        else {
            return;
        };
        let [follows, settled] = [6, 7].map(|output| seen.get(output).is_some_and(|level| *level == 1));
        if self.one_in(if self.run { 3000 } else { 30 }) {
            self.run = !self.run;
        }
        if self.one_in(300) {
            self.unshaped = !self.unshaped;
        }
        if self.one_in(3) {
            self.pins ^= 1 << self.rng.random_range(0..2);
        }
        *rst = u64::from(self.clock < 2 || self.one_in(20_000));
        *tick = self.move_counts(follows, settled).into();
        (*pin_a, *pin_b) = (self.pins & 1, self.pins >> 1);
        (*run, *unshaped) = (self.run.into(), self.unshaped.into());
        *clear = self.one_in(60).into();
        *illegal = self.one_in(2500).into();
        *too_fast = self.one_in(5000).into();
        *owed_exceeded = self.one_in(5000).into();
        *count = self.count as u64;
        *given = self.given as u64;
        *shaped = self.rng.next_u64();
        self.clock += 1;
    }
}

/// Counts of the events in a lockstep run of an axis of the inline shaper.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InlineAxisCoverage {
    limit: u64,
    /// Outputs of the clock before; `None` in the first clock and after a reset.
    before: Option<[u64; OUTPUT_PORTS]>,
    counts: [u64; EVENTS.len()],
}

/// The events, in the order of the counters.
const EVENTS: [&str; 11] = [
    "resets while following",
    "begins to follow",
    "stops without a cause",
    "settles",
    "unsettled without a tick",
    "ticks at the limit",
    "causes: input too fast",
    "causes: step generator",
    "causes: illegal transition",
    "causes in the clock of a clear",
    "unshaped positions while following",
];

impl InlineAxisCoverage {
    /// Creates the counters.
    pub fn new(config: &InlineAxisConfig) -> Self {
        Self {
            limit: config.limit_steps().into(),
            before: None,
            counts: [0; EVENTS.len()],
        }
    }

    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok(inputs), Ok(now)) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected),
        ) else {
            return;
        };
        let [rst, _, _, _, unshaped, clear, tick, count, ..] = *inputs;
        let [_, _, _, _, x, _, follow, settled, fault, too_fast, stopped, illegal] = *now;
        let moved = (count as u32).wrapping_sub((x as u32 as i32 >> 8) as u32) as i32;
        let events = self.before.map_or([false; EVENTS.len()], |before| {
            let [
                ..,
                follow_before,
                settled_before,
                fault_before,
                fast_before,
                stopped_before,
                illegal_before,
            ] = before;
            let rises = |now: u64, before: u64| now == 1 && before == 0;
            [
                rst == 1 && follow == 1,
                rises(follow, follow_before),
                rises(follow_before, follow) && fault == 0,
                rises(settled, settled_before),
                rises(settled_before, settled) && follow == 1 && tick == 0,
                tick == 1 && follow == 1 && u64::from(moved.unsigned_abs()) == self.limit,
                rises(too_fast, fast_before),
                rises(stopped, stopped_before),
                rises(illegal, illegal_before),
                rises(fault, fault_before) && clear == 1,
                unshaped == 1 && follow == 1,
            ]
        });
        for (count, event) in self.counts.iter_mut().zip(events) {
            *count += u64::from(event);
        }
        self.before = (rst == 0).then_some(*now);
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); EVENTS.len()] {
        std::array::from_fn(|at| (EVENTS[at], self.counts[at]))
    }
}
