//! The shaper of an axis in a machine's top module: a table of taps, or half sums in series.

use crate::cascade::{self, Cascade, CascadeConfig};
use crate::shaper::{self, Shaper, ShaperConfig};
use crate::{ClockedBlock, Port};

/// Build parameters of the shaper of an axis.
#[derive(Debug, Clone, PartialEq)]
pub enum AxisShaperConfig {
    /// A table of taps.
    Taps(ShaperConfig),
    /// Half sums in series, without a multiplier.
    Cascade(CascadeConfig),
}

impl AxisShaperConfig {
    /// The build parameters of a table of taps; `None` for half sums.
    pub fn taps(&self) -> Option<&ShaperConfig> {
        match self {
            Self::Taps(config) => Some(config),
            Self::Cascade(_) => None,
        }
    }

    /// The ports without `clk`.
    pub fn ports(&self) -> Vec<Port> {
        match self {
            Self::Taps(config) => shaper::ports(config),
            Self::Cascade(config) => cascade::ports(config.word_bits() as usize),
        }
    }

    /// Name of the position's port `word`, which is `x` or `y`: a shaper for motion has several channels.
    pub fn position(&self, word: &str) -> String {
        match self.taps().and_then(ShaperConfig::motion) {
            Some(_) => format!("{word}_0"),
            None => word.to_owned(),
        }
    }

    /// Whether the result is clamped where it leaves the word: a mean of words, as half sums are, never leaves it.
    pub fn saturates(&self) -> bool {
        self.taps().is_some_and(|config| {
            // A position that wraps around never saturates.
            !config
                .motion()
                .is_some_and(|motion| motion.modulo && motion.channels == 1)
        })
    }

    /// Width of a command word in bits.
    pub fn word_bits(&self) -> u32 {
        match self {
            Self::Taps(config) => config.word_bits(),
            Self::Cascade(config) => config.word_bits(),
        }
    }

    /// Delay of the last impulse in samples.
    pub fn longest_delay_samples(&self) -> u32 {
        match self {
            Self::Taps(config) => config.table().longest_delay_samples(),
            Self::Cascade(config) => config.delays_samples().iter().sum(),
        }
    }

    /// Clocks from a strobe to its `valid`, with the table that is built in.
    pub fn pass_clocks(&self) -> u32 {
        match self {
            Self::Taps(config) => config.pass_clocks((config.channels() * config.table().taps().len()) as u32),
            Self::Cascade(config) => cascade::pass_clocks(config.stages()),
        }
    }

    /// The most clocks from a strobe to its `valid`, with any table that can be loaded, and in a handover.
    pub fn most_pass_clocks(&self) -> u32 {
        match self {
            Self::Taps(config) => config.pass_clocks(config.most_products()),
            Self::Cascade(_) => self.pass_clocks(),
        }
    }

    /// The bit-exact model after power-up. `seed` determines the arbitrary contents of its memory, which no output ever shows.
    pub fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        match self {
            Self::Taps(config) => Box::new(Shaper::new(config, seed)),
            Self::Cascade(config) => Box::new(Cascade::new(config, seed)),
        }
    }
}
