//! What is fixed when a shaper is built.

use crate::taps::{Tap, TapTable};

/// Word widths that the shaper is built for (16 for the stand-alone shaper).
pub const WORD_BITS: [u32; 3] = [16, 24, 32];
/// Ring sizes that the shaper is built for, as bits of address: 2^6 … 2^12 and 2^14 samples.
pub const RING_ADDRESS_BITS: [u32; 8] = [6, 7, 8, 9, 10, 11, 12, 14];
/// Table sizes that the shaper is built for, as bits of index: 64 and 256 taps. (16 would take the same memory blocks.)
pub const TAP_INDEX_BITS: [u32; 2] = [6, 8];
/// Clocks of a pass beyond one per tap: table, ring, multiplier (two), accumulator, rounding.
pub const PASS_OVERHEAD_CLOCKS: u32 = 6;

/// Clocks from a strobe to its `valid`, and the smallest distance of two strobes without `overrun`.
pub fn pass_clocks(taps: u32) -> u32 {
    taps.saturating_add(PASS_OVERHEAD_CLOCKS)
}

/// What is fixed when a shaper is built: sizes from the lists above, and the table in its ROM (bank 0).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShaperConfig {
    word_bits: u32,
    ring_address_bits: u32,
    tap_index_bits: u32,
    table: TapTable,
}

/// Why no shaper can be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ShaperConfigError {
    /// A word width that is not in [`WORD_BITS`].
    #[error("command words of {0} bits: the shaper is built for 16, 24 or 32")]
    WordBits(u32),
    /// A delay that the largest ring does not reach.
    #[error(
        "the longest delay is {found} samples, the largest ring reaches back {allowed}: \
         choose a lower sample rate or a shorter shaper"
    )]
    Delay {
        /// Longest delay found, in samples.
        found: u32,
        /// Longest delay possible, in samples.
        allowed: u32,
    },
    /// More taps than the largest table holds.
    #[error("{found} taps, the largest table holds {allowed}: choose a kind with fewer impulses or digitise `nearest`")]
    Taps {
        /// Taps found.
        found: usize,
        /// Taps possible.
        allowed: u32,
    },
}

/// A pass over the table takes longer than a sample lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "a pass over {taps} taps takes {needed} clocks, a sample lasts {available}: \
     choose a lower sample rate, a faster clock or fewer taps"
)]
pub struct PassError {
    /// Taps of the table.
    pub taps: u32,
    /// Clocks that a pass takes.
    pub needed: u32,
    /// Clocks from sample to sample.
    pub available: u64,
}

impl ShaperConfig {
    /// The smallest shaper for `table`: the smallest ring that has the longest delay + 2 samples, the smallest table.
    ///
    /// # Errors
    /// [`ShaperConfigError`] for a width that is not in [`WORD_BITS`], a delay above 2^14 − 2 samples, or more than
    /// 256 taps.
    pub fn new(word_bits: u32, table: TapTable) -> Result<Self, ShaperConfigError> {
        if !WORD_BITS.contains(&word_bits) {
            return Err(ShaperConfigError::WordBits(word_bits));
        }
        let ring_address_bits = ring_for(table.longest_delay_samples())?;
        let tap_index_bits = index_for(table.taps().len())?;
        Ok(Self {
            word_bits,
            ring_address_bits,
            tap_index_bits,
            table,
        })
    }

    /// The same shaper with room for tables that are loaded later: delays up to `delay_samples`, up to `taps` taps.
    ///
    /// # Errors
    /// [`ShaperConfigError`] where that is more than the largest sizes hold.
    pub fn with_room_for(mut self, delay_samples: u32, taps: usize) -> Result<Self, ShaperConfigError> {
        self.ring_address_bits = self.ring_address_bits.max(ring_for(delay_samples)?);
        self.tap_index_bits = self.tap_index_bits.max(index_for(taps)?);
        Ok(self)
    }

    /// W: width of a command word in bits.
    pub fn word_bits(&self) -> u32 {
        self.word_bits
    }

    /// A: the ring holds 2^A samples.
    pub fn ring_address_bits(&self) -> u32 {
        self.ring_address_bits
    }

    /// T: a table holds up to 2^T taps.
    pub fn tap_index_bits(&self) -> u32 {
        self.tap_index_bits
    }

    /// F: a coefficient `c` stands for `c / 2^F`, in every bank.
    pub fn coefficient_fraction(&self) -> u32 {
        self.table.coefficient_fraction()
    }

    /// The machine's table, in bank 0.
    pub fn table(&self) -> &TapTable {
        &self.table
    }

    /// Longest delay that a table may have, in samples: 2^A − 2. One more would read the word that a strobe writes.
    pub fn longest_delay_samples(&self) -> u32 {
        (1 << self.ring_address_bits) - 2
    }

    /// Most taps that a table may have: 2^T.
    pub fn most_taps(&self) -> u32 {
        1 << self.tap_index_bits
    }

    /// Smallest command word, −2^(W−1).
    pub fn word_min(&self) -> i64 {
        -(1 << (self.word_bits - 1))
    }

    /// Largest command word, 2^(W−1) − 1.
    pub fn word_max(&self) -> i64 {
        -self.word_min() - 1
    }

    /// Whether a pass over the machine's table ends before the next sample.
    ///
    /// # Errors
    /// [`PassError`] with both clock counts.
    pub fn fits(&self, clocks_per_sample: u64) -> Result<(), PassError> {
        let taps = self.table.taps().len() as u32;
        let needed = pass_clocks(taps);
        if u64::from(needed) > clocks_per_sample {
            return Err(PassError {
                taps,
                needed,
                available: clocks_per_sample,
            });
        }
        Ok(())
    }

    /// Whether the memories hold these taps.
    pub(crate) fn holds(&self, taps: &[Tap]) -> Result<(), ShaperConfigError> {
        let found = taps.iter().map(|t| t.delay_samples).max().unwrap_or(0);
        let allowed = self.longest_delay_samples();
        if found > allowed {
            return Err(ShaperConfigError::Delay { found, allowed });
        }
        let allowed = self.most_taps();
        if taps.len() > allowed as usize {
            let found = taps.len();
            return Err(ShaperConfigError::Taps { found, allowed });
        }
        Ok(())
    }
}

/// Address bits of the smallest ring that reaches back `delay_samples`.
fn ring_for(delay_samples: u32) -> Result<u32, ShaperConfigError> {
    let reaches = |bits: &u32| (1u64 << bits) >= u64::from(delay_samples) + 2;
    RING_ADDRESS_BITS
        .into_iter()
        .find(reaches)
        .ok_or(ShaperConfigError::Delay {
            found: delay_samples,
            allowed: (1 << RING_ADDRESS_BITS[RING_ADDRESS_BITS.len() - 1]) - 2,
        })
}

/// Index bits of the smallest table that holds `taps`.
fn index_for(taps: usize) -> Result<u32, ShaperConfigError> {
    let holds = |bits: &u32| (1usize << bits) >= taps;
    TAP_INDEX_BITS.into_iter().find(holds).ok_or(ShaperConfigError::Taps {
        found: taps,
        allowed: 1 << TAP_INDEX_BITS[TAP_INDEX_BITS.len() - 1],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `taps` taps of coefficient 1, the rest on the last; delays 0, 1, … and the last at `longest`.
    fn table(taps: usize, longest: u32) -> TapTable {
        let mut list: Vec<Tap> = (0..taps as u32)
            .map(|delay_samples| Tap {
                delay_samples,
                coefficient: 1,
            })
            .collect();
        list[taps - 1] = Tap {
            delay_samples: longest,
            coefficient: 65536 - (taps as i32 - 1),
        };
        TapTable::new(16, list).unwrap()
    }

    #[test]
    fn unit_the_smallest_sizes_are_chosen() {
        for (delay, bits) in [(0, 6), (62, 6), (63, 7), (4094, 12), (4095, 14), (16382, 14)] {
            let config = ShaperConfig::new(32, table(1, delay)).unwrap();
            assert_eq!(config.ring_address_bits(), bits, "delay {delay}");
        }
        for (taps, bits) in [(1, 6), (64, 6), (65, 8), (256, 8)] {
            let config = ShaperConfig::new(32, table(taps, 300)).unwrap();
            assert_eq!(config.tap_index_bits(), bits, "{taps} taps");
        }
    }

    #[test]
    fn unit_what_no_shaper_holds_is_named() {
        let delay = ShaperConfig::new(24, table(1, 16383)).unwrap_err();
        assert_eq!(
            delay,
            ShaperConfigError::Delay {
                found: 16383,
                allowed: 16382
            }
        );
        assert!(matches!(
            ShaperConfig::new(24, table(1, u32::MAX)),
            Err(ShaperConfigError::Delay { .. })
        ));
        let taps = ShaperConfig::new(24, table(257, 300)).unwrap_err();
        assert_eq!(
            taps,
            ShaperConfigError::Taps {
                found: 257,
                allowed: 256
            }
        );
        assert_eq!(ShaperConfig::new(20, table(1, 0)), Err(ShaperConfigError::WordBits(20)));
    }

    #[test]
    fn unit_room_only_grows() {
        let config = ShaperConfig::new(16, table(17, 100)).unwrap();
        let roomy = config.clone().with_room_for(500, 65).unwrap();
        assert_eq!((roomy.ring_address_bits(), roomy.tap_index_bits()), (9, 8));
        assert_eq!(config.clone().with_room_for(0, 0).unwrap(), config);
        assert!(config.with_room_for(16383, 1).is_err());
    }

    #[test]
    fn unit_a_pass_that_does_not_fit_states_both_clock_counts() {
        let config = ShaperConfig::new(32, table(60, 100)).unwrap();
        assert_eq!(config.fits(66), Ok(()));
        let error = config.fits(65).unwrap_err();
        assert_eq!((error.needed, error.available), (66, 65));
        assert!(error.to_string().contains("66 clocks"), "{error}");
        assert_eq!(pass_clocks(u32::MAX), u32::MAX);
    }
}
