//! Seeded random inputs for the step generator: rides at every speed and at the largest, reversals, creeping by less than
//! a step per tick, dithering round a half, jumps; ticks in time, late and early; `enable` that falls at any time and in a
//! pulse; clears and resets in any clock.
//!
//! A run begins with a list of acts that drives every flag within a few ticks.

use posicast_blocks::step_generator::{INPUT_PORTS, StepGeneratorConfig};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// What the position does for some ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Act {
    /// It moves by this in every tick.
    Ride(i64),
    /// It is a little above and a little below a half in turn.
    Dither,
    /// It is anywhere at the next tick, and stands there.
    Jump,
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct StepGeneratorRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    tick_clocks: u64,
    fraction_bits: u32,
    /// Largest change of the position that is not too fast.
    largest: i64,
    off_a: u64,
    position: i64,
    act: Act,
    acts: u64,
    ticks_left: u64,
    clocks_to_tick: u64,
    disabled_clocks: u64,
    clears: bool,
}

impl StepGeneratorRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(config: &StepGeneratorConfig, seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            tick_clocks: config.tick_clocks().into(),
            fraction_bits: config.fraction_bits(),
            largest: config.largest_difference().into(),
            off_a: config.lines_active_low().a.into(),
            position: 0,
            act: Act::Ride(0),
            acts: 0,
            ticks_left: 2,
            clocks_to_tick: 4,
            disabled_clocks: 0,
            clears: false,
        }
    }

    fn one_in(&mut self, chances: u64) -> bool {
        self.rng.random_range(0..chances) == 0
    }

    /// Returns the next act, and for how many ticks.
    fn next_act(&mut self) -> (Act, u64) {
        let largest = self.largest;
        let begun = [
            (Act::Ride(largest), 2),
            (Act::Ride(-largest), 3),
            (Act::Jump, 2),
            (Act::Ride(-largest), 2),
        ];
        if let Some(first) = begun.get(self.acts as usize) {
            return *first;
        }
        let any = self.rng.random_range(-largest..=largest);
        let slow = self.rng.random_range(-5..=5);
        let back = match self.act {
            Act::Ride(speed) => -speed,
            _ => any,
        };
        let sign = *pick(&mut self.rng, &[1, -1]);
        let few = self.rng.random_range(1..5);
        let many = self.rng.random_range(5..60);
        *pick(
            &mut self.rng,
            &[
                (Act::Ride(sign * largest), few),
                (Act::Ride(sign * (largest - 1)), few),
                (Act::Ride(sign * (largest + 1)), 1),
                (Act::Ride(sign * largest / 2), few),
                (Act::Ride(back), few),
                (Act::Ride(back), few),
                (Act::Ride(any), few),
                (Act::Ride(any), 1),
                (Act::Ride(slow), many),
                (Act::Ride(0), 2),
                (Act::Dither, few + 2),
                (Act::Jump, 1),
            ],
        )
    }

    /// The position of the next tick.
    fn moved(&mut self) -> i64 {
        if self.ticks_left == 0 {
            (self.act, self.ticks_left) = self.next_act();
            self.acts += 1;
        }
        self.ticks_left -= 1;
        let half = (1 << self.fraction_bits) >> 1;
        match self.act {
            Act::Ride(speed) => self.position + speed,
            Act::Dither => {
                let below = (self.position >> self.fraction_bits << self.fraction_bits) + half - 1;
                below + i64::from(self.position <= below)
            }
            Act::Jump => {
                let shift = self.rng.random_range(0..32);
                self.act = Act::Ride(0);
                // A single bit too much is rare among random words.
                let single = self.rng.random::<bool>();
                let bits = if single {
                    1 << shift
                } else {
                    self.rng.next_u32() as i32 >> shift
                };
                self.position ^ i64::from(bits)
            }
        }
    }

    /// Clocks from this tick to the next: mostly those of the build.
    fn tick_after(&mut self) -> u64 {
        let settled = self.acts < 6;
        match self.rng.random_range(0..16) {
            0 if !settled => self.tick_clocks + self.rng.random_range(1..=self.tick_clocks),
            1 if !settled => self.rng.random_range(1..=self.tick_clocks),
            _ => self.tick_clocks,
        }
    }
}

impl Stimuli for StepGeneratorRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let Ok([rst, enable, tick, position, clear_flags]) = <&mut [u64; INPUT_PORTS]>::try_from(inputs) else {
            return;
        };
        let in_pulse = seen.first().is_some_and(|a| *a != self.off_a);
        let calm = self.acts < 6;
        *rst = u64::from(self.clock < 2 || self.one_in(40 * self.tick_clocks));

        if self.disabled_clocks > 0 {
            self.disabled_clocks -= 1;
        } else if !calm && (self.one_in(10 * self.tick_clocks) || (in_pulse && self.one_in(100))) {
            let longest = *pick(&mut self.rng, &[1, 3, 40, self.tick_clocks]);
            self.disabled_clocks = self.rng.random_range(1..=longest);
        }
        *enable = u64::from(self.disabled_clocks == 0);

        self.clocks_to_tick -= 1;
        *tick = u64::from(self.clocks_to_tick == 0);
        if self.clocks_to_tick == 0 {
            self.position = i64::from(self.moved() as i32);
            self.clocks_to_tick = self.tick_after();
            *position = self.position as u64;
        } else {
            // Between ticks the word may be anything.
            *position = self.rng.next_u64();
        }

        // Most causes are cleared soon, some in the clock in which they come.
        if self.one_in(self.tick_clocks) {
            self.clears = self.one_in(4);
        }
        *clear_flags = u64::from(self.clears || self.one_in(self.tick_clocks / 3 + 1));
        self.clock += 1;
    }
}
