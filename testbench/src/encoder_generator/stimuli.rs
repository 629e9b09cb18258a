//! Seeded random inputs for the internal encoder: rates of every size and both signs, constant or changing in every
//! clock; turns of every length; pins that change at any time; changes between pins and generator, and resets, in any
//! clock.

use posicast_blocks::encoder_generator::INPUT_PORTS;
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct EncoderGeneratorRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    loop_back: bool,
    rate: i32,
    index_every: u16,
    pins: u64,
    /// The rate changes once in this many clocks.
    unrest: u32,
}

impl EncoderGeneratorRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            loop_back: false,
            rate: 0,
            index_every: 0,
            pins: 0,
            unrest: 100,
        }
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks) == 0
    }

    fn change(&mut self) {
        if self.one_in(2000) {
            self.unrest = *pick(&mut self.rng, &[1, 3, 100, 1000, 5000]);
        }
        if self.one_in(self.unrest) {
            let any = self.rng.next_u32() as i32;
            let small = any >> self.rng.random_range(0..32);
            let turned = self.rate.wrapping_neg();
            self.rate = *pick(
                &mut self.rng,
                &[any, any, small, turned, turned, i32::MIN, i32::MAX, 1 << 30],
            );
        }
        if self.one_in(1500) {
            let any = self.rng.next_u32() as u16;
            let small = any & 63;
            // A power of two of periods, or one more, exercises each bit alone in the turns and in the first step
            // below the index.
            let bit = (self.rng.random_range(0..2_u16) + (1 << self.rng.random_range(0..13))) << 2;
            self.index_every = *pick(
                &mut self.rng,
                &[any, any, bit, bit, bit, bit, bit, bit, small, small, 3, 4, 8, 0],
            );
        }
        if self.one_in(700) {
            self.loop_back = !self.loop_back;
        }
        if self.one_in(4) {
            self.pins ^= 1 << self.rng.random_range(0..6);
        }
    }
}

impl Stimuli for EncoderGeneratorRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        let [rst, loop_back, rate, index_every, pins @ ..] = inputs else {
            return;
        };
        self.change();
        *rst = u64::from(self.clock < 2 || self.one_in(6000));
        *loop_back = u64::from(self.loop_back);
        *rate = self.rate as u64;
        *index_every = u64::from(self.index_every);
        for (place, pin) in pins.iter_mut().enumerate() {
            *pin = self.pins >> place & 1;
        }
        self.clock += 1;
    }
}

/// Counts of the events in a lockstep run of the internal encoder.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct EncoderGeneratorCoverage {
    /// Count, Z and `loop_back` of the previous clock; `None` in the first clock and after a reset.
    before: Option<(i32, u64, u64)>,
    resets: u64,
    looped_resets: u64,
    up: u64,
    down: u64,
    turned_back: u64,
    wrapped_below_zero: u64,
    fastest: u64,
    looped: u64,
    unlooped: u64,
    indices_up: u64,
    indices_down: u64,
    /// Whether the last count went up.
    rising: bool,
    moved: bool,
}

impl EncoderGeneratorCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok([rst, loop_back, rate, ..]), &[_, _, z, _, _, _, count]) =
            (<&[u64; INPUT_PORTS]>::try_from(clock.inputs), clock.expected)
        else {
            return;
        };
        let (rst, loop_back, count) = (*rst, *loop_back, count as u32 as i32);
        self.resets += rst;
        self.looped_resets += rst & loop_back;
        self.fastest += u64::from(*rate as u32 as i32 == i32::MIN);
        if let Some((count_before, z_before, loop_before)) = self.before {
            let change = count.wrapping_sub(count_before);
            self.up += u64::from(change == 1);
            self.down += u64::from(change == -1);
            self.wrapped_below_zero += u64::from(count_before == 0 && change == -1);
            let rising = if change == 0 { self.rising } else { change > 0 };
            self.turned_back += u64::from(self.moved && change != 0 && rising != self.rising);
            (self.rising, self.moved) = (rising, change != 0);
            self.looped += u64::from(loop_back > loop_before);
            self.unlooped += u64::from(loop_back < loop_before);
            let index = loop_back == 1 && loop_before == 1 && z > z_before;
            self.indices_up += u64::from(index && rising);
            self.indices_down += u64::from(index && !rising);
        }
        self.before = (rst == 0).then_some((count, z, loop_back));
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); 11] {
        [
            ("resets", self.resets),
            ("resets while looped back", self.looped_resets),
            ("counts up", self.up),
            ("counts down", self.down),
            ("counts taken back in the next clock", self.turned_back),
            ("counts below zero", self.wrapped_below_zero),
            ("clocks at the fastest rate", self.fastest),
            ("changes to the generator", self.looped),
            ("changes to the pins", self.unlooped),
            ("indices going up", self.indices_up),
            ("indices going down", self.indices_down),
        ]
    }
}
