//! Stimuli of a real motion: one command word per sample, at a steady rate.

use crate::shaper::Layout;
use crate::stimuli::Stimuli;

/// Gives a reset, then one strobe every `clocks_per_sample` clocks, the first with `start`. Each word stays until the
/// next; the last one stays for ever.
#[derive(Debug, Clone)]
pub struct MotionStimuli<'a> {
    layout: Layout,
    words: &'a [Vec<i64>],
    clocks_per_sample: u64,
    clock: u64,
}

/// Number of clocks of reset before the first strobe.
const RESET_CLOCKS: u64 = 2;

impl<'a> MotionStimuli<'a> {
    /// Creates the stimuli. `words` holds one sequence of command words per axis of the layout; an axis whose
    /// sequence is missing or empty stays at 0.
    pub fn new(layout: &Layout, words: &'a [Vec<i64>], clocks_per_sample: u64) -> Self {
        Self {
            layout: layout.clone(),
            words,
            clocks_per_sample: clocks_per_sample.max(1),
            clock: 0,
        }
    }

    /// Returns the clock of the first strobe, which comes with `start`.
    pub fn first_strobe(&self) -> u64 {
        RESET_CLOCKS
    }

    /// Returns the number of clocks until the pass of the last word has had its full sample period.
    pub fn clocks(&self) -> u64 {
        let samples = self.words.iter().map(Vec::len).max().unwrap_or(0) as u64;
        RESET_CLOCKS.saturating_add(samples.saturating_mul(self.clocks_per_sample))
    }
}

impl Stimuli for MotionStimuli<'_> {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        inputs.fill(0);
        let clock = self.clock;
        self.clock += 1;
        let Some(moving) = clock.checked_sub(RESET_CLOCKS) else {
            inputs[self.layout.rst] = 1;
            return;
        };
        let strobe = moving.is_multiple_of(self.clocks_per_sample);
        inputs[self.layout.strobe] = u64::from(strobe);
        let sample = usize::try_from(moving / self.clocks_per_sample).unwrap_or(usize::MAX);
        for (axis, words) in self.layout.axes.iter().zip(self.words) {
            let word = words.get(sample).or_else(|| words.last());
            inputs[axis.x..axis.x + axis.channels].fill(word.copied().unwrap_or(0) as u64);
            inputs[axis.start] = u64::from(strobe && sample == 0);
        }
    }
}
