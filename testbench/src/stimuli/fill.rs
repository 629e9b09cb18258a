//! The first phase of a shaper's stimuli: noise, a sample per pass, until every tap has been seen in the output.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{Layout, Stimuli};

/// Clocks of reset before the first strobe.
const RESET_CLOCKS: u64 = 2;
/// Clocks from a strobe to the first in which `busy` shows that its pass is over, beyond those of the pass; and one to spare.
const TURN_CLOCKS: u64 = 3;
/// Samples behind the one with which the delay line is full: each of them shows every tap in the output.
const SAMPLES_BEHIND: u64 = 24;
/// Words are this part of full scale, so that no table of usual coefficients saturates: what is clamped shows no tap.
const PART_OF_FULL_SCALE: i64 = 4;

/// A reset and a `start`, then a strobe as soon as no pass is under way, each with a random word. The word differs from
/// sample to sample, so that a tap at another delay, or with another coefficient, gives another output.
#[derive(Debug, Clone)]
pub struct Fill {
    layout: Layout,
    rng: Xoshiro256PlusPlus,
    clock: u64,
    since_strobe: u64,
}

impl Fill {
    /// Equal seeds give equal words.
    pub fn new(layout: &Layout, seed: u64) -> Self {
        Self {
            layout: layout.clone(),
            rng: Xoshiro256PlusPlus::seed_from_u64(seed.rotate_left(17)),
            clock: 0,
            since_strobe: 0,
        }
    }

    /// Clocks until every tap up to `longest_delay_samples` was seen more than once, where a pass lasts `pass_clocks`.
    pub fn clocks(longest_delay_samples: u32, pass_clocks: u32) -> u64 {
        let samples = u64::from(longest_delay_samples) + 2 + SAMPLES_BEHIND;
        RESET_CLOCKS + samples * (u64::from(pass_clocks) + TURN_CLOCKS)
    }
}

impl Stimuli for Fill {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        inputs.fill(0);
        self.clock += 1;
        if self.clock <= RESET_CLOCKS {
            inputs[self.layout.rst] = 1;
            return;
        }
        let first = self.clock == RESET_CLOCKS + 1;
        self.since_strobe += 1;
        let busy = self.layout.axes.iter().any(|axis| seen[axis.busy] != 0);
        // `busy` of a strobe is seen from the second clock behind it on.
        if !first && (busy || self.since_strobe < 3) {
            return;
        }
        self.since_strobe = 0;
        inputs[self.layout.strobe] = 1;
        for axis in &self.layout.axes {
            let most = axis.largest_word() / PART_OF_FULL_SCALE;
            for x in &mut inputs[axis.x..axis.x + axis.channels] {
                *x = self.rng.random_range(-most..=most) as u64;
            }
            inputs[axis.start] = first.into();
        }
    }
}
