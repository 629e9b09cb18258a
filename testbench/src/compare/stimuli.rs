//! Seeded random inputs for the position compare: counts that run, stand, turn and jitter by one count per clock at most, that
//! jump now and then and reach both ends of their word; rows and lists of positions near the count; every setting.

use posicast_blocks::compare::{Inputs, LIST_POSITIONS};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct CompareRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    count: i32,
    /// Direction, and the count moves once in this many clocks.
    direction: i32,
    pace: u32,
    settings: Inputs,
    /// Entries that are still to be written, and the next of them.
    entries_left: u32,
    entry: i32,
}

impl CompareRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            count: 0,
            direction: 1,
            pace: 1,
            settings: Inputs::default(),
            entries_left: 0,
            entry: 0,
        }
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks) == 0
    }

    fn move_count(&mut self) {
        if self.one_in(60) {
            self.pace = *pick(&mut self.rng, &[1, 1, 1, 2, 3, 7]);
            // A direction of 0 jitters.
            self.direction = *pick(&mut self.rng, &[1, 1, -1, -1, 0]);
        }
        if self.one_in(3000) {
            let any = self.rng.next_u32() as i32;
            let near = self.count.wrapping_add(self.rng.random_range(-40..=40));
            self.count = *pick(&mut self.rng, &[any, near, near, 0, i32::MAX - 20, i32::MIN + 20]);
        } else if self.one_in(self.pace) {
            let step = match self.direction {
                0 => self.rng.random_range(-1..=1),
                direction => direction,
            };
            self.count = self.count.wrapping_add(step);
        }
    }

    /// Settings with positions around the count.
    fn set(&mut self) {
        let wild = self.one_in(8);
        let any = self.rng.next_u32();
        let reach = self.rng.random_range(-60..=60);
        let spacings = [0, 1, 1, 2, 3, 5, 8, 20, any >> 1, u32::MAX];
        let numbers = [0, 1, 1, 2, 3, 5, 9, 40, 200, any];
        let widths = [0, 1, 2, 3, 10, 40];
        let margins = [0, 0, 1, 1, 2, 3, 6, any as u16];
        self.settings = Inputs {
            use_list: self.one_in(2),
            first: if wild {
                any as i32
            } else {
                self.count.wrapping_add(reach)
            },
            spacing: *pick(&mut self.rng, &spacings),
            positions: *pick(&mut self.rng, &numbers),
            rises: !self.one_in(4),
            falls: !self.one_in(4),
            hysteresis: *pick(&mut self.rng, &margins),
            pulse_clocks: *pick(&mut self.rng, &widths),
            ..Inputs::default()
        };
    }

    /// The next entry of a list around the count; some are too near the one before.
    fn next_entry(&mut self) -> i32 {
        let distance = *pick(&mut self.rng, &[4, 4, 4, 4, 5, 6, 9, 30, 3, -1]);
        self.entry = self.entry.wrapping_add(distance);
        self.entry
    }
}

impl Stimuli for CompareRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        self.move_count();
        let mut now = Inputs {
            rst: self.clock < 2 || self.one_in(20_000),
            count: self.count,
            clear_flags: self.one_in(100),
            entry: self.rng.next_u32() as i32,
            ..self.settings
        };
        if self.one_in(700) {
            self.set();
            now = Inputs {
                arm: true,
                rst: now.rst,
                count: now.count,
                entry: now.entry,
                ..self.settings
            };
        } else if self.one_in(400) {
            // Settings count in the clock of `arm` alone.
            self.set();
        }
        now.disarm = self.one_in(1200);
        if self.entries_left == 0 && self.one_in(1500) {
            // A fifth of the entries is refused.
            let long = 2 * LIST_POSITIONS as u32;
            self.entries_left = *pick(&mut self.rng, &[1, 2, 3, 10, 30, long]);
            self.entry = self.count.wrapping_add(self.rng.random_range(-80..=20));
            (now.disarm, now.entries_clear) = (true, false);
        } else if self.entries_left > 0 {
            now.entries_clear = self.one_in(200);
            if self.one_in(2) {
                self.entries_left -= 1;
                now.entry_write = true;
                now.entry = self.next_entry();
            }
        } else {
            now.entry_write = self.one_in(900);
            now.entries_clear = self.one_in(2500);
        }
        inputs.copy_from_slice(&now.to_raw());
        self.clock += 1;
    }
}

/// Counts of the events in a lockstep run of the position compare.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CompareCoverage {
    before: Option<[u64; 10]>,
    by_list: bool,
    passed: [[u64; 2]; 2],
    merged: u64,
    jumped: u64,
    refused: u64,
    full: u64,
    ready: u64,
    held_back: u64,
    ends: u64,
}

impl CompareCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let Ok(now) = <[u64; 10]>::try_from(clock.expected) else {
            return;
        };
        let [pulse, passed, upward, _, _, ready, entries, merged, jumped, refused] = now;
        if passed == 1 {
            self.passed[usize::from(self.by_list)][upward as usize] += 1;
        }
        let [_, count, arm, _, use_list, ..] = clock.inputs else {
            return;
        };
        let before = self.before.unwrap_or_default();
        let rose = |place: usize| u64::from(now[place] > before[place]);
        self.ready += rose(5);
        self.merged += passed & pulse & before[0] & merged;
        self.jumped += u64::from(jumped > before[8]);
        self.refused += u64::from(refused > before[9]);
        self.full += u64::from(entries == LIST_POSITIONS as u64);
        self.held_back += u64::from(ready == 0 && before[5] == 1);
        self.ends += u64::from(ready == 1 && matches!(*count as u32 as i32, i32::MIN | i32::MAX));
        if *arm == 1 {
            self.by_list = *use_list == 1;
        }
        self.before = Some(now);
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); 11] {
        let [[row_down, row_up], [list_down, list_up]] = self.passed;
        [
            ("positions of a row upward", row_up),
            ("positions of a row downward", row_down),
            ("positions of a list upward", list_up),
            ("positions of a list downward", list_down),
            ("merged pulses", self.merged),
            ("jumps", self.jumped),
            ("refused entries", self.refused),
            ("clocks with a full list", self.full),
            ("ready", self.ready),
            ("no longer ready", self.held_back),
            ("ends of the count", self.ends),
        ]
    }
}
