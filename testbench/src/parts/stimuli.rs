//! Seeded random inputs for the small blocks between others: every input changes at its own pace, which varies.

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
