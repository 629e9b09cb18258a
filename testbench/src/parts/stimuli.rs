//! Seeded random inputs for the small blocks between others: every input changes at its own pace, which varies. A deviation
//! also lasts for as long as its block can count.

use posicast_blocks::lasting_deviation::{INPUT_PORTS, Inputs, ports};
use posicast_blocks::{Direction, Port};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// An input and its pace: it changes once in this many clocks.
#[derive(Debug, Clone)]
struct Pin {
    width: u32,
    pace: u32,
    value: u64,
}

/// An endless random mixture of all inputs. The first input is the reset, which is rare.
#[derive(Debug, Clone)]
pub struct PartRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    pins: Vec<Pin>,
}

impl PartRandom {
    /// Creates the generator for a block with these ports. Equal seeds give equal inputs.
    pub fn new(ports: &[Port], seed: u64) -> Self {
        let inputs = ports.iter().filter(|port| port.direction == Direction::Input);
        let pin = |port: &Port| Pin {
            width: port.width,
            pace: 2,
            value: 0,
        };
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            pins: inputs.map(pin).collect(),
        }
    }
}

impl Stimuli for PartRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        for (pin, input) in self.pins.iter_mut().zip(inputs.iter_mut()) {
            if self.rng.random_range(0..2000) == 0 {
                pin.pace = *pick(&mut self.rng, &[1, 2, 5, 40, 300]);
            }
            if self.rng.random_range(0..pin.pace) == 0 {
                let random = self.rng.next_u64();
                let shifted = random >> self.rng.random_range(0..64);
                let next = pin.value.wrapping_add(1);
                pin.value = *pick(&mut self.rng, &[random, random, shifted, next]);
            }
            *input = pin.value & (u64::MAX >> (64 - pin.width.clamp(1, 64)));
        }
        if let Some(reset) = inputs.first_mut() {
            *reset = (self.clock < 2 || self.rng.random_range(0..5000) == 0).into();
        }
        self.clock += 1;
    }
}

/// Inputs of the lasting deviation: those of [`PartRandom`] and, in turn with them, a deviation that stays beyond its limit
/// at a tick in every clock, until the count of ticks is at its largest or for fewer ticks. `ticks` is about the count then,
/// or about its largest value, so that every bit of the count matters.
#[derive(Debug, Clone)]
pub struct LastingRandom {
    mixture: PartRandom,
    rng: Xoshiro256PlusPlus,
    /// Clocks that are left of the stretch, and those since its start.
    left: u32,
    past: u32,
    lasts: bool,
    ticks: u16,
}

impl LastingRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            mixture: PartRandom::new(&ports(), seed),
            rng: Xoshiro256PlusPlus::seed_from_u64(seed ^ 1),
            left: 10_000,
            past: 0,
            lasts: false,
            ticks: 0,
        }
    }
}

impl Stimuli for LastingRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        if self.left == 0 {
            self.lasts = !self.lasts;
            self.past = 0;
            self.left = if self.lasts {
                *pick(&mut self.rng, &[70_000, 70_000, 20_000, 2000])
            } else {
                10_000
            };
        }
        self.left -= 1;
        self.past += 1;
        self.mixture.fill(seen, inputs);
        if !self.lasts {
            return;
        }
        if self.rng.random_range(0..4) == 0 {
            let count = self.past.min(u16::MAX.into()) as u16;
            let near = self.rng.random_range(0..16);
            let below = self.rng.random::<u16>() >> self.rng.random_range(0..16);
            self.ticks = *pick(
                &mut self.rng,
                &[(count - count.min(8)).saturating_add(near), u16::MAX - below],
            );
        }
        let random = self.rng.random::<i32>();
        let lasting = Inputs {
            rst: false,
            tick: true,
            deviation: if random.unsigned_abs() > 100 { random } else { 101 },
            limit: 99,
            ticks: self.ticks,
        };
        let raw: [u64; INPUT_PORTS] = lasting.to_raw();
        inputs.copy_from_slice(&raw);
    }
}
