//! Build parameters of a cascade.

use posicast_taps::{Tap, TapTable, TapTableError};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Widths of a command word in bits that a cascade may have.
pub const WORD_BITS: RangeInclusive<u32> = 8..=32;
/// Sizes of a stage's ring buffer as address bits: 64 … 4096 samples.
pub const RING_ADDRESS_BITS: RangeInclusive<u32> = 6..=12;
/// Numbers of stages as bits of their index: up to 4, 8 and 16 stages.
pub const STAGE_INDEX_BITS: RangeInclusive<u32> = 2..=4;
/// Clocks of a sample in addition to two per stage: one takes it into the sum, one rounds.
pub const PASS_OVERHEAD_CLOCKS: u32 = 2;

/// Clocks from a strobe to its `valid`, which is also the smallest distance of two strobes without `overrun`.
pub fn pass_clocks(stages: u32) -> u32 {
    stages.saturating_mul(2).saturating_add(PASS_OVERHEAD_CLOCKS)
}

/// Build parameters of a cascade: the word width, the delay of each stage, and the sizes that hold them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CascadeConfig {
    word_bits: u32,
    ring_address_bits: u32,
    stage_index_bits: u32,
    delays_samples: Vec<u32>,
}

/// Why a cascade cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CascadeConfigError {
    /// The word width is not in [`WORD_BITS`].
    #[error("command words of {0} bits: a cascade has 8 to 32")]
    WordBits(u32),
    /// There is no stage, or there are too many.
    #[error("{0} half sums: a cascade has 1 to 16; choose a lower order or fewer modes")]
    Stages(usize),
    /// A delay is zero, or longer than the largest ring buffer.
    #[error(
        "stage {stage} has a delay of {found} samples, but a half sum has 1 to 4094: choose another sample rate or a higher order"
    )]
    Delay {
        /// Number of the stage, from 1.
        stage: usize,
        /// Its delay in samples.
        found: u32,
    },
}

impl CascadeConfig {
    /// The smallest cascade for these delays in samples, one per stage: the smallest ring buffer that has the longest
    /// delay + 2 samples, and the fewest stages.
    ///
    /// # Errors
    /// [`CascadeConfigError`] for a width that is not in [`WORD_BITS`], other than 1 to 16 stages, or a delay that is not
    /// 1 to 2^12 − 2 samples.
    pub fn new(word_bits: u32, delays_samples: Vec<u32>) -> Result<Self, CascadeConfigError> {
        if !WORD_BITS.contains(&word_bits) {
            return Err(CascadeConfigError::WordBits(word_bits));
        }
        let stages = delays_samples.len();
        let holds = |bits: &u32| 1usize << bits >= stages;
        let smallest = STAGE_INDEX_BITS.into_iter().find(holds).filter(|_| stages > 0);
        let stage_index_bits = smallest.ok_or(CascadeConfigError::Stages(stages))?;
        let mut ring_address_bits = *RING_ADDRESS_BITS.start();
        for (index, &found) in delays_samples.iter().enumerate() {
            let stage = index + 1;
            let reaches = |bits: &u32| 1u64 << bits >= u64::from(found) + 2;
            let smallest = RING_ADDRESS_BITS.into_iter().find(reaches).filter(|_| found > 0);
            ring_address_bits = ring_address_bits.max(smallest.ok_or(CascadeConfigError::Delay { stage, found })?);
        }
        Ok(Self {
            word_bits,
            ring_address_bits,
            stage_index_bits,
            delays_samples,
        })
    }

    /// Width W of a command word in bits.
    pub fn word_bits(&self) -> u32 {
        self.word_bits
    }

    /// Address bits A: the ring buffer of each stage holds 2^A samples.
    pub fn ring_address_bits(&self) -> u32 {
        self.ring_address_bits
    }

    /// Index bits I: there is room for 2^I stages.
    pub fn stage_index_bits(&self) -> u32 {
        self.stage_index_bits
    }

    /// The delay of each stage in samples.
    pub fn delays_samples(&self) -> &[u32] {
        &self.delays_samples
    }

    /// Number of stages n, 1 to 16.
    pub fn stages(&self) -> u32 {
        self.delays_samples.len() as u32
    }

    /// Width of the sum and of a word of the ring buffers in bits: W + 2^I.
    pub fn sum_bits(&self) -> u32 {
        self.word_bits + (1 << self.stage_index_bits)
    }

    /// Smallest command word, −2^(W−1).
    pub fn word_min(&self) -> i64 {
        -(1 << (self.word_bits - 1))
    }

    /// Largest command word, 2^(W−1) − 1.
    pub fn word_max(&self) -> i64 {
        -self.word_min() - 1
    }

    /// The tap table with the same result as this cascade, bit by bit: an impulse of 2^−n at the sum of each subset
    /// of the delays, with equal delays added up.
    ///
    /// # Errors
    /// [`TapTableError::Fraction`] where F = `coefficient_fraction` is above 16 or below the number of stages.
    pub fn tap_table(&self, coefficient_fraction: u32) -> Result<TapTable, TapTableError> {
        let too_fine = || TapTableError::Fraction(coefficient_fraction);
        let spare_bits = coefficient_fraction.checked_sub(self.stages()).ok_or_else(too_fine)?;
        let mut impulses = BTreeMap::from([(0, 1i32)]);
        for delay in &self.delays_samples {
            for (at, number) in impulses.clone() {
                *impulses.entry(at + delay).or_default() += number;
            }
        }
        let unit = 1i32.checked_shl(spare_bits).ok_or_else(too_fine)?;
        let tap = |(delay_samples, number): (u32, i32)| {
            Some(Tap {
                delay_samples,
                coefficient: number.checked_mul(unit)?,
            })
        };
        let taps: Option<Vec<Tap>> = impulses.into_iter().map(tap).collect();
        TapTable::new(coefficient_fraction, taps.ok_or_else(too_fine)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_sizes_are_chosen() {
        for (delay, bits) in [(1, 6), (62, 6), (63, 7), (1022, 10), (1023, 11), (4094, 12)] {
            let config = CascadeConfig::new(32, vec![1, delay]).unwrap();
            assert_eq!(config.ring_address_bits(), bits, "delay {delay}");
        }
        for (stages, bits) in [(1, 2), (4, 2), (5, 3), (8, 3), (9, 4), (16, 4)] {
            let config = CascadeConfig::new(32, vec![3; stages]).unwrap();
            assert_eq!(config.stage_index_bits(), bits, "{stages} stages");
        }
    }

    #[test]
    fn settings_beyond_the_cascade_are_errors() {
        let error = |word, delays: Vec<u32>| CascadeConfig::new(word, delays).unwrap_err();
        assert_eq!(error(7, vec![1]), CascadeConfigError::WordBits(7));
        assert_eq!(error(33, vec![1]), CascadeConfigError::WordBits(33));
        assert_eq!(error(16, vec![]), CascadeConfigError::Stages(0));
        assert_eq!(error(16, vec![1; 17]), CascadeConfigError::Stages(17));
        assert_eq!(error(16, vec![5, 0]), CascadeConfigError::Delay { stage: 2, found: 0 });
        for found in [4095, u32::MAX] {
            assert_eq!(error(16, vec![found]), CascadeConfigError::Delay { stage: 1, found });
        }
    }

    #[test]
    fn equal_delays_give_binomial_taps() {
        let table = CascadeConfig::new(16, vec![7; 3]).unwrap().tap_table(4).unwrap();
        let taps: Vec<(u32, i32)> = table.taps().iter().map(|t| (t.delay_samples, t.coefficient)).collect();
        assert_eq!(taps, [(0, 2), (7, 6), (14, 6), (21, 2)]);
    }

    #[test]
    fn a_table_too_coarse_or_too_fine_is_refused() {
        let config = CascadeConfig::new(16, vec![7; 3]).unwrap();
        for fraction in [0, 2, 17, 40, u32::MAX] {
            assert_eq!(config.tap_table(fraction), Err(TapTableError::Fraction(fraction)));
        }
    }
}
