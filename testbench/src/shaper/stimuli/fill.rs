//! The first phase of a shaper's stimuli: noise, one sample per pass, until every tap has been seen in the output.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::shaper::Layout;
use crate::stimuli::Stimuli;

/// Number of clocks of reset before the first strobe.
const RESET_CLOCKS: u64 = 2;
/// Number of clocks, beyond those of the pass, from a strobe until `busy` shows that its pass is over, plus one to
/// spare.
const TURN_CLOCKS: u64 = 3;
/// Number of samples after the one that fills the delay line: each of them shows every tap in the output.
const SAMPLES_BEHIND: u64 = 24;
/// Words use this part of full scale, so that no table of usual coefficients saturates: a saturated result shows no
/// tap.
const PART_OF_FULL_SCALE: i64 = 4;

/// Gives a reset and a `start`, then a strobe with a random word as soon as no pass is under way. The word differs
/// from sample to sample, so that a wrong delay or coefficient of a tap changes the output.
#[derive(Debug, Clone)]
pub struct Fill {
    layout: Layout,
    rng: Xoshiro256PlusPlus,
    clock: u64,
    since_strobe: u64,
}

impl Fill {
    /// Creates the generator. Equal seeds give equal words.
    pub fn new(layout: &Layout, seed: u64) -> Self {
        Self {
            layout: layout.clone(),
            rng: Xoshiro256PlusPlus::seed_from_u64(seed.rotate_left(17)),
            clock: 0,
            since_strobe: 0,
        }
    }

    /// Returns the number of clocks until every tap up to `longest_delay_samples` was seen more than once, if a pass
    /// takes `pass_clocks`.
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
        // `busy` is visible from the second clock after a strobe.
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
