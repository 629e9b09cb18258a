//! Seeded random inputs for the divider: operands of every size, at the ends, and such that the quotient just fits or
//! just does not; starts at the pace of a division and in any clock; clears and resets.

use posicast_blocks::divider::{DIVISION_CLOCKS, DividerConfig};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct DividerRandom {
    rng: Xoshiro256PlusPlus,
    tick_clocks: i64,
    clock: u64,
    until_start: u32,
}

impl DividerRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(config: &DividerConfig, seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            tick_clocks: i64::from(config.tick_clocks()),
            clock: 0,
            until_start: 3,
        }
    }

    fn operands(&mut self) -> (i64, i64) {
        let rng = &mut self.rng;
        let few = rng.random_range(-3i64..=3);
        let any = rng.random_range(-131_072i64..=131_071);
        let small = any >> rng.random_range(0..18);
        let steps: i64 = *pick(rng, &[few, any, small, small, small, -131_072, 131_071]);
        let random = rng.random_range(0..1i64 << 24);
        let about_a_tick = self.tick_clocks + rng.random_range(-2..=2);
        // The range of Q16.16 ends at 2^15 counts per tick.
        let about_the_end = steps.abs() * self.tick_clocks / 32_768 + rng.random_range(-1..=1);
        let shifted = random >> rng.random_range(0..24);
        let choices = [0, 1, random, shifted, shifted, about_a_tick, about_the_end, 0xff_ffff];
        (steps, *pick(rng, &choices))
    }
}

impl Stimuli for DividerRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        let [rst, start, steps, elapsed, clear_flags] = inputs else {
            return;
        };
        self.until_start -= 1;
        *rst = u64::from(self.clock < 2 || self.rng.random_range(0..700) == 0);
        *start = u64::from(self.until_start == 0);
        (*steps, *elapsed) = (self.rng.next_u64(), self.rng.next_u64());
        *clear_flags = u64::from(self.rng.random_range(0..40) == 0);
        if self.until_start == 0 {
            let (count, clocks) = self.operands();
            (*steps, *elapsed) = (count as u64, clocks as u64);
            let any = self.rng.random_range(1..2 * DIVISION_CLOCKS);
            let paces = [DIVISION_CLOCKS, DIVISION_CLOCKS, DIVISION_CLOCKS - 1, any];
            self.until_start = *pick(&mut self.rng, &paces);
        }
        self.clock += 1;
    }
}

/// Counts of the events in a lockstep run of the divider.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct DividerCoverage {
    resets: u64,
    fitting: u64,
    clamped: u64,
    negative: u64,
    overrun: u64,
}

impl DividerCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (&[rst, ..], &[quotient, done, _, clamped, overrun]) = (clock.inputs, clock.expected) else {
            return;
        };
        self.resets += rst;
        self.fitting += done & (clamped ^ 1);
        self.clamped += done & clamped;
        self.negative += done & (quotient >> 31);
        self.overrun += overrun;
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); 5] {
        [
            ("resets", self.resets),
            ("quotients that fit", self.fitting),
            ("quotients clamped", self.clamped),
            ("negative quotients", self.negative),
            ("clocks with overrun", self.overrun),
        ]
    }
}
