//! Seeded random inputs for the position capture: a line that bounces and stays around the length of the filter; positions
//! that stand and move at the edges of the window; entries that are taken at every pace, also in the clock of an edge;
//! clears, resets and changes of all settings in any clock.

use posicast_blocks::capture::{AXES, Inputs};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Clocks of a filter that the line seldom satisfies, and that reaches every bit of its counter.
const LONGEST_FILTER: u16 = u16::MAX;

/// In every other run of 2^17 clocks there is no reset and no clear, so that many edges are counted.
const UNBROKEN_BITS: u32 = 17;

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct CaptureRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    /// Number of clocks until the next mood.
    mood_clocks: u32,
    /// Number of clocks for which the line stays.
    line_clocks: u32,
    /// One entry is taken in about this many clocks.
    take_pace: u32,
    /// The positions move in one of so many clocks.
    move_pace: u32,
    /// A setting changes in one of so many clocks.
    setting_pace: u32,
    /// Flags are cleared in one of so many clocks.
    flags_pace: u32,
    now: Inputs,
}

impl CaptureRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            mood_clocks: 0,
            line_clocks: 1,
            take_pace: 1,
            move_pace: 1,
            setting_pace: 1,
            flags_pace: 1,
            now: Inputs::default(),
        }
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks) == 0
    }

    fn new_mood(&mut self) {
        let rng = &mut self.rng;
        self.mood_clocks = rng.random_range(1..2000);
        let few = rng.random_range(2..40);
        self.now.filter_clocks = *pick(rng, &[0, 1, 1, 2, 3, 4, few]);
        self.take_pace = *pick(rng, &[1, 2, 7, 60, 60, 400, 1000, 1000]);
        self.move_pace = *pick(rng, &[1, 3, 50]);
        self.setting_pace = *pick(rng, &[2, 20, 60, 300]);
        self.flags_pace = *pick(rng, &[1, 4, 40, 200]);
        // Any place, so that every bit of the positions and of the stamp changes.
        if self.one_in(2) {
            let axis = self.rng.random_range(0..AXES);
            self.now.count[axis] = self.rng.next_u32() as i32;
            self.now.stamp = self.rng.next_u32();
        }
        if self.one_in(400) {
            self.now.filter_clocks = LONGEST_FILTER;
            self.mood_clocks = u32::from(LONGEST_FILTER) + 100;
            self.line_clocks = self.mood_clocks;
            self.now.line = !self.now.line;
        }
    }

    fn change_setting(&mut self) {
        let rng = &mut self.rng;
        let any = rng.next_u64();
        // Mostly wanted edges, of every kind.
        match any % 6 {
            0 => self.now.enable = any >> 8 & 7 != 0,
            1 => self.now.rises = any >> 8 & 3 != 0,
            2 => self.now.falls = any >> 8 & 3 != 0,
            3 => self.now.windowed = any >> 8 & 1 != 0,
            4 => self.now.window_axis = (any >> 8 & 3) as u8,
            _ => {
                let count = self.now.count[usize::from(self.now.window_axis)];
                let near = |offset: u64| count.wrapping_add((offset % 5) as i32 - 2);
                let far = (any >> 16) as i32;
                let wide = [i32::MIN, i32::MIN, i32::MAX];
                self.now.window_first = *pick(rng, &[near(any >> 8), near(any >> 8), far, wide[0], wide[1]]);
                self.now.window_last = *pick(rng, &[near(any >> 32), near(any >> 32), (any >> 24) as i32, wide[2]]);
                if any >> 60 == 0 {
                    (self.now.window_first, self.now.window_last) = (i32::MAX, i32::MIN);
                }
            }
        }
    }

    /// The line stays for about the clocks of the filter.
    fn move_line(&mut self) {
        self.line_clocks -= 1;
        if self.line_clocks > 0 {
            return;
        }
        self.now.line = !self.now.line;
        let filter = u32::from(self.now.filter_clocks).clamp(1, 100);
        let long = self.rng.random_range(1..40);
        self.line_clocks = *pick(
            &mut self.rng,
            &[1, (filter - 1).max(1), filter, filter, filter + 1, filter + long, long],
        );
    }
}

impl Stimuli for CaptureRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        if self.mood_clocks == 0 {
            self.new_mood();
        }
        self.mood_clocks -= 1;
        if self.one_in(self.setting_pace) {
            self.change_setting();
        }
        if self.one_in(self.move_pace) {
            for count in &mut self.now.count {
                *count = count.wrapping_add(self.rng.random_range(-1..=1));
            }
        }
        self.move_line();
        self.now.stamp = self.now.stamp.wrapping_add(1);
        let begins_anew = self.clock >> UNBROKEN_BITS & 1 == 0;
        let is_long = self.now.filter_clocks == LONGEST_FILTER;
        self.now.rst = self.clock < 2 || (begins_anew && !is_long && self.one_in(1500));
        self.now.take = self.one_in(self.take_pace);
        self.now.clear = begins_anew && self.one_in(600);
        self.now.clear_flags = self.one_in(self.flags_pace);
        self.clock += 1;
        for (input, value) in inputs.iter_mut().zip(self.now.to_raw()) {
            *input = value;
        }
    }
}
