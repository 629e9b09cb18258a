//! The cascade sample by sample, without the clocks.

use super::config::CascadeConfig;
use super::rounded;
use crate::shaper::wrap;
use std::collections::VecDeque;

/// The cascade sample by sample. It gives the results of [`super::Cascade`] where strobes come slowly enough.
///
/// Unlike that model, this one fills its history at a start instead of knowing its age, and keeps no more of it than
/// each delay.
#[derive(Debug, Clone)]
pub struct SampleCascade {
    word_bits: u32,
    /// Inputs of each stage: the last d_k samples, the oldest first.
    histories: Vec<VecDeque<i64>>,
}

impl SampleCascade {
    /// A cascade after reset: start value 0.
    pub fn new(config: &CascadeConfig) -> Self {
        let history = |&delay: &u32| VecDeque::from(vec![0; delay as usize]);
        Self {
            word_bits: config.word_bits(),
            histories: config.delays_samples().iter().map(history).collect(),
        }
    }

    /// Restarts: all samples before now count as `x` (wrapped to the word width), which is also the output after
    /// that.
    pub fn start(&mut self, x: i64) -> i64 {
        let x = wrap(x, self.word_bits);
        for (stage, history) in self.histories.iter_mut().enumerate() {
            history.iter_mut().for_each(|word| *word = x << stage);
        }
        x
    }

    /// Takes one sample and returns the shaped one. `x` is wrapped to the word width, as a port of that width would
    /// do.
    pub fn push(&mut self, x: i64) -> i64 {
        let mut sum = wrap(x, self.word_bits);
        for history in &mut self.histories {
            let delayed = history.pop_front().unwrap_or(sum);
            history.push_back(sum);
            sum += delayed;
        }
        rounded(sum, self.histories.len() as u32)
    }
}
