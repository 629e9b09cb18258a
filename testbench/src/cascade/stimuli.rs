//! Seeded random inputs for the cascade: strobes as fast as a pass allows, one clock earlier, in every clock, after
//! long pauses; commands that swing from end to end, ramp, rest or are noise; starts, clears and resets in any clock.

use posicast_blocks::cascade::{CascadeConfig, pass_clocks};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct CascadeRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    pass_clocks: i64,
    word_max: i64,
    word: i64,
    /// Distance of the strobes in clocks, and the number of strobes left at that distance.
    pace: (i64, u32),
    until_strobe: i64,
}

impl CascadeRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(config: &CascadeConfig, seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            pass_clocks: i64::from(pass_clocks(config.stages())),
            word_max: config.word_max(),
            word: 0,
            pace: (1, 0),
            until_strobe: 3,
        }
    }

    fn strobe_now(&mut self) -> bool {
        self.until_strobe -= 1;
        if self.until_strobe > 0 {
            return false;
        }
        if self.pace.1 == 0 {
            let pass = self.pass_clocks;
            let paces = [pass, pass, pass, pass, pass - 1, pass + 1, 2 * pass, 1, 10 * pass];
            self.pace = (*pick(&mut self.rng, &paces), self.rng.random_range(1..60));
        }
        self.pace.1 -= 1;
        self.until_strobe = self.pace.0;
        true
    }

    fn advance_word(&mut self) {
        let most = self.word_max;
        self.word = match self.rng.random_range(0..8) {
            0 => most,
            1 => -most - 1,
            2 => self.rng.random_range(-most - 1..=most),
            3 | 4 => self.word.saturating_add(most / 40).min(most),
            5 => self.rng.random_range(-3..=3),
            _ => self.word,
        };
    }
}

impl Stimuli for CascadeRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        let [rst, strobe, start, x, clear_flags] = inputs else {
            return;
        };
        let strobes = self.strobe_now();
        *rst = u64::from(self.clock < 2 || self.rng.random_range(0..5000) == 0);
        *strobe = u64::from(strobes);
        *start = u64::from(self.rng.random_range(0..600) == 0);
        // Between strobes the input is noise, so that a block that reads it then is found.
        *x = self.rng.next_u64();
        if strobes {
            self.advance_word();
            *x = self.word as u64;
        }
        *clear_flags = u64::from(self.rng.random_range(0..50) == 0);
        self.clock += 1;
    }
}

/// Counts of the events in a lockstep run of the cascade.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CascadeCoverage {
    /// Number of clocks with `rst`.
    pub resets: u64,
    /// Number of clocks with `start` and without `strobe`.
    pub starts: u64,
    /// Number of clocks with `start` and `strobe`.
    pub starts_with_sample: u64,
    /// Number of starts while `busy`.
    pub cut_off: u64,
    /// Number of clocks with `valid`.
    pub valid: u64,
    /// Number of strobes while `busy`, without `start`.
    pub overrun: u64,
    /// Number of clocks in which `overrun` was set and cleared at once; setting has priority.
    pub set_over_clear: u64,
    /// Number of clocks with `valid` in which `y` was at an end of the word.
    pub ends: u64,
}

impl CascadeCoverage {
    /// Adds a clock of a cascade with this configuration.
    pub fn observe(&mut self, config: &CascadeConfig, clock: &Clock<'_>) {
        let (&[rst, strobe, start, _, clear_flags], &[y, valid, busy, _]) = (clock.inputs, clock.expected) else {
            return;
        };
        let lost = strobe & busy & (start ^ 1);
        let most = config.word_max() as u64;
        self.resets += rst;
        self.starts += start & (strobe ^ 1);
        self.starts_with_sample += start & strobe;
        self.cut_off += start & busy;
        self.valid += valid;
        self.overrun += lost;
        self.set_over_clear += lost & clear_flags;
        self.ends += valid & u64::from(y == most || y == most + 1);
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); 8] {
        [
            ("resets", self.resets),
            ("starts", self.starts),
            ("starts with a sample", self.starts_with_sample),
            ("passes cut off", self.cut_off),
            ("valid", self.valid),
            ("overrun", self.overrun),
            ("overrun set over clear", self.set_over_clear),
            ("ends of the word", self.ends),
        ]
    }
}
