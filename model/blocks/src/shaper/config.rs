//! Build parameters of a shaper.

use posicast_taps::{Tap, TapTable};
use std::ops::RangeInclusive;

/// Widths of a command word in bits that a shaper may have.
pub const WORD_BITS: RangeInclusive<u32> = 8..=32;
/// Widths of a command word that a motion shaper may have: a product takes two multipliers, the second for the bits
/// above the 17th.
pub const MOTION_WORD_BITS: RangeInclusive<u32> = 18..=32;
/// Sizes of the ring buffer as address bits: 64 … 16384 samples. (Fewer would take the same memory blocks.)
pub const RING_ADDRESS_BITS: RangeInclusive<u32> = 6..=14;
/// Sizes of the table as index bits: 64, 128 and 256 taps. (Fewer would take the same memory blocks.)
pub const TAP_INDEX_BITS: RangeInclusive<u32> = 6..=8;
/// Largest number of channels: position, velocity, acceleration.
pub const CHANNELS_MAX: usize = 3;
/// Address bits of the largest ring buffer with more than one channel.
const SHARED_RING_ADDRESS_BITS_MAX: u32 = 12;
/// Clocks of a pass in addition to one per tap: two for the table, one for the ring, three for the multiplier, one
/// each for accumulator and rounding.
pub const PASS_OVERHEAD_CLOCKS: u32 = 8;
/// Further clocks of a pass of a motion shaper, for the handover and the choice of the channel's sample. There is one
/// more between two channels.
pub const MOTION_OVERHEAD_CLOCKS: u32 = 2;

/// Clocks from a strobe to its `valid`, which is also the smallest distance of two strobes without `overrun`.
///
/// `products` is the number of taps of the table; for [`ShaperMotion`] see [`ShaperConfig::pass_clocks`].
pub fn pass_clocks(products: u32) -> u32 {
    products.saturating_add(PASS_OVERHEAD_CLOCKS)
}

/// Features of a motion shaper: channels that share table and multiplier, a `swap_how` that can hand over during
/// motion, and positions that wrap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShaperMotion {
    /// Number of channels, 1 to 3: position, velocity, acceleration.
    pub channels: u32,
    /// Whether the position wraps modulo 2^W, as on a rotary axis, and never saturates.
    pub modulo: bool,
}

/// Build parameters of a shaper: its sizes, and the table in its ROM (bank 0).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShaperConfig {
    word_bits: u32,
    ring_address_bits: u32,
    tap_index_bits: u32,
    table: TapTable,
    /// Largest number of taps of the machine's table and of the tables announced for loading.
    largest_taps: u32,
    motion: Option<ShaperMotion>,
}

/// Why a shaper cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ShaperConfigError {
    /// The word width is not in [`WORD_BITS`].
    #[error("command words of {0} bits: the shaper has 8 to 32")]
    WordBits(u32),
    /// The sizes are outside the range of shapers.
    #[error(
        "a shaper of {word_bits}-bit words, 2^{ring_address_bits} samples and 2^{tap_index_bits} taps: words have 4 to 32 bits, \
         rings 2^2 to 2^14 samples, tables 2^1 to 2^8 taps"
    )]
    Sizes {
        /// Width of a word in bits.
        word_bits: u32,
        /// Address bits: the ring buffer holds 2 to the power of this samples.
        ring_address_bits: u32,
        /// Index bits: a table holds 2 to the power of this taps.
        tap_index_bits: u32,
    },
    /// A delay is longer than the largest ring buffer.
    #[error(
        "the longest delay is {found} samples, but the largest ring reaches back {allowed}: choose a lower sample rate or a shorter shaper"
    )]
    Delay {
        /// Longest delay of the table, in samples.
        found: u32,
        /// Longest delay that is possible, in samples.
        allowed: u32,
    },
    /// There are more taps than the largest table holds.
    #[error(
        "{found} taps, but the largest table holds {allowed}: choose a kind with fewer impulses or digitise `nearest`"
    )]
    Taps {
        /// Number of taps of the table.
        found: usize,
        /// Largest number of taps.
        allowed: u32,
    },
    /// The number of channels is not 1 to 3.
    #[error("{0} channels: a shaper for motion has 1 (position), 2 (and velocity) or 3 (and acceleration)")]
    Channels(u32),
    /// The word width is not in [`MOTION_WORD_BITS`].
    #[error("command words of {0} bits: a shaper for motion has 18 to 32")]
    MotionWordBits(u32),
    /// The ring buffer is too large for more than one channel.
    #[error(
        "a delay of {found} samples with {channels} channels: more than one channel reach back at most {allowed} samples; choose one \
         channel, a lower sample rate or a shorter shaper"
    )]
    SharedDelay {
        /// Longest delay for which the ring buffer was sized, in samples.
        found: u32,
        /// Number of channels.
        channels: u32,
        /// Longest delay, in samples, that is possible with this many channels.
        allowed: u32,
    },
}

/// A pass over the table takes longer than a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "a pass over {taps} taps takes {needed} clocks, but a sample lasts {available}: choose a lower sample rate, a faster clock or fewer taps"
)]
pub struct PassError {
    /// Taps of the table times channels; in a handover, taps of both tables.
    pub taps: u32,
    /// Clocks that the pass takes.
    pub needed: u32,
    /// Clocks from sample to sample.
    pub available: u64,
}

impl ShaperConfig {
    /// The smallest shaper for `table`: the smallest ring buffer that has the longest delay + 2 samples, and the
    /// smallest table.
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
            largest_taps: table.taps().len() as u32,
            table,
            motion: None,
        })
    }

    /// The shaper with exactly these sizes: words of `word_bits`, a ring buffer of 2^`ring_address_bits` samples,
    /// tables of up to 2^`tap_index_bits` taps. A proof that includes the memories needs smaller ones than
    /// [`ShaperConfig::new`] chooses.
    ///
    /// # Errors
    /// [`ShaperConfigError`] for words of other than 4 to 32 bits, a ring buffer of other than 2^2 to 2^14 samples, a
    /// table of other than 2^1 to 2^8 taps, and for a `table` that does not fit.
    pub fn of_sizes(
        word_bits: u32,
        ring_address_bits: u32,
        tap_index_bits: u32,
        table: TapTable,
    ) -> Result<Self, ShaperConfigError> {
        if !(4..=32).contains(&word_bits)
            || !(2..=14).contains(&ring_address_bits)
            || !(1..=8).contains(&tap_index_bits)
        {
            return Err(ShaperConfigError::Sizes {
                word_bits,
                ring_address_bits,
                tap_index_bits,
            });
        }
        let config = Self {
            word_bits,
            ring_address_bits,
            tap_index_bits,
            largest_taps: table.taps().len() as u32,
            table,
            motion: None,
        };
        config.holds(config.table.taps())?;
        Ok(config)
    }

    /// Makes it a motion shaper.
    ///
    /// # Errors
    /// [`ShaperConfigError`] for other than 1 to 3 channels, a width that is not in [`MOTION_WORD_BITS`], and a ring
    /// buffer above 2^12 samples with more than one channel.
    pub fn for_motion(mut self, motion: ShaperMotion) -> Result<Self, ShaperConfigError> {
        if !(1..=CHANNELS_MAX as u32).contains(&motion.channels) {
            return Err(ShaperConfigError::Channels(motion.channels));
        }
        if !MOTION_WORD_BITS.contains(&self.word_bits) {
            return Err(ShaperConfigError::MotionWordBits(self.word_bits));
        }
        self.motion = Some(motion);
        self.check_shared_ring(self.table.longest_delay_samples())?;
        Ok(self)
    }

    /// Makes room for tables that are loaded later: delays of up to `delay_samples`, up to `taps` taps.
    ///
    /// # Errors
    /// [`ShaperConfigError`] where that exceeds the largest sizes.
    pub fn with_room_for(mut self, delay_samples: u32, taps: usize) -> Result<Self, ShaperConfigError> {
        self.ring_address_bits = self.ring_address_bits.max(ring_for(delay_samples)?);
        self.tap_index_bits = self.tap_index_bits.max(index_for(taps)?);
        self.largest_taps = self.largest_taps.max(taps as u32);
        self.check_shared_ring(delay_samples)?;
        Ok(self)
    }

    fn check_shared_ring(&self, delay_samples: u32) -> Result<(), ShaperConfigError> {
        let allowed = (1 << SHARED_RING_ADDRESS_BITS_MAX) - 2;
        match self.channels() as u32 {
            2.. if self.ring_address_bits > SHARED_RING_ADDRESS_BITS_MAX => Err(ShaperConfigError::SharedDelay {
                found: delay_samples.max(allowed + 1),
                channels: self.channels() as u32,
                allowed,
            }),
            _ => Ok(()),
        }
    }

    /// Its motion features; `None` for a plain shaper.
    pub fn motion(&self) -> Option<ShaperMotion> {
        self.motion
    }

    /// Number of channels, 1 to 3.
    pub fn channels(&self) -> usize {
        self.motion.map_or(1, |motion| motion.channels as usize)
    }

    /// Whether the arithmetic of `channel` is modulo 2^W, as for the position of a modulo axis.
    pub(crate) fn wraps(&self, channel: usize) -> bool {
        channel == 0 && self.motion.is_some_and(|motion| motion.modulo)
    }

    /// Number of input and output ports.
    pub(crate) fn port_counts(&self) -> (usize, usize) {
        let how = usize::from(self.motion.is_some());
        (12 + how + self.channels(), 10 + self.channels())
    }

    /// Width W of a command word in bits.
    pub fn word_bits(&self) -> u32 {
        self.word_bits
    }

    /// Address bits A: the ring buffer holds 2^A samples.
    pub fn ring_address_bits(&self) -> u32 {
        self.ring_address_bits
    }

    /// Index bits T: a table holds up to 2^T taps.
    pub fn tap_index_bits(&self) -> u32 {
        self.tap_index_bits
    }

    /// Fraction bits F: in every bank a coefficient `c` stands for `c / 2^F`.
    pub fn coefficient_fraction(&self) -> u32 {
        self.table.coefficient_fraction()
    }

    /// The machine's table, in bank 0.
    pub fn table(&self) -> &TapTable {
        &self.table
    }

    /// Longest delay that a table may have, in samples: 2^A − 2. A delay of one more would read the word that a
    /// strobe writes.
    pub fn longest_delay_samples(&self) -> u32 {
        (1 << self.ring_address_bits) - 2
    }

    /// Largest number of taps that a table may have: 2^T.
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

    /// Number of products of the longest pass: over the machine's table; for a motion shaper over all channels of a
    /// handover between two tables, each as long as the longest that is in the ROM or for which
    /// [`Self::with_room_for`] made room.
    pub fn most_products(&self) -> u32 {
        match self.motion {
            None => self.table.taps().len() as u32,
            Some(motion) => 2 * motion.channels * self.largest_taps + 1,
        }
    }

    /// Clocks from a strobe to its `valid`, which is also the smallest distance of two strobes without `overrun`, for
    /// a pass with this many products. A motion shaper takes [`MOTION_OVERHEAD_CLOCKS`] more than [`pass_clocks`],
    /// and one between two channels.
    pub fn pass_clocks(&self, products: u32) -> u32 {
        let overhead = |motion: ShaperMotion| MOTION_OVERHEAD_CLOCKS + motion.channels - 1;
        let of_motion = self.motion.map_or(0, overhead);
        pass_clocks(products).saturating_add(of_motion)
    }

    /// Checks that the longest pass, that with [`Self::most_products`], ends before the next sample.
    ///
    /// # Errors
    /// [`PassError`] with both clock counts.
    pub fn fits(&self, clocks_per_sample: u64) -> Result<(), PassError> {
        let taps = self.most_products();
        let needed = self.pass_clocks(taps);
        if u64::from(needed) > clocks_per_sample {
            return Err(PassError {
                taps,
                needed,
                available: clocks_per_sample,
            });
        }
        Ok(())
    }

    /// Checks that the memories hold these taps.
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

/// Address bits of the smallest ring buffer with a delay of `delay_samples`.
fn ring_for(delay_samples: u32) -> Result<u32, ShaperConfigError> {
    let reaches = |bits: &u32| (1u64 << bits) >= u64::from(delay_samples) + 2;
    RING_ADDRESS_BITS
        .into_iter()
        .find(reaches)
        .ok_or(ShaperConfigError::Delay {
            found: delay_samples,
            allowed: (1 << RING_ADDRESS_BITS.end()) - 2,
        })
}

/// Index bits of the smallest table that holds `taps`.
fn index_for(taps: usize) -> Result<u32, ShaperConfigError> {
    let holds = |bits: &u32| (1usize << bits) >= taps;
    TAP_INDEX_BITS.into_iter().find(holds).ok_or(ShaperConfigError::Taps {
        found: taps,
        allowed: 1 << TAP_INDEX_BITS.end(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table with `taps` taps: coefficient 1 except for the last, which has the rest; delays 0, 1, … and `longest`
    /// for the last.
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
    fn the_smallest_sizes_are_chosen() {
        for (delay, bits) in [(0, 6), (62, 6), (63, 7), (4094, 12), (4095, 13), (16382, 14)] {
            let config = ShaperConfig::new(32, table(1, delay)).unwrap();
            assert_eq!(config.ring_address_bits(), bits, "delay {delay}");
        }
        for (taps, bits) in [(1, 6), (64, 6), (65, 7), (129, 8), (256, 8)] {
            let config = ShaperConfig::new(32, table(taps, 300)).unwrap();
            assert_eq!(config.tap_index_bits(), bits, "{taps} taps");
        }
    }

    #[test]
    fn settings_beyond_the_shaper_are_errors() {
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
        for word_bits in [7, 33] {
            let refused = ShaperConfig::new(word_bits, table(1, 0));
            assert_eq!(refused, Err(ShaperConfigError::WordBits(word_bits)));
        }
    }

    #[test]
    fn given_sizes_are_kept_and_checked() {
        let config = ShaperConfig::of_sizes(20, 13, 7, table(65, 300)).unwrap();
        let sizes = (config.word_bits(), config.ring_address_bits(), config.tap_index_bits());
        assert_eq!(sizes, (20, 13, 7));
        for (word, ring, index) in [(3, 6, 6), (33, 6, 6), (16, 1, 6), (16, 15, 6), (16, 6, 0), (16, 6, 9)] {
            let refused = ShaperConfig::of_sizes(word, ring, index, table(1, 0));
            assert!(
                matches!(refused, Err(ShaperConfigError::Sizes { .. })),
                "{word}, {ring}, {index}"
            );
        }
        let refused = |ring, index, table| ShaperConfig::of_sizes(6, ring, index, table).unwrap_err();
        assert_eq!(
            refused(2, 2, table(2, 3)),
            ShaperConfigError::Delay { found: 3, allowed: 2 }
        );
        assert_eq!(
            refused(6, 2, table(5, 9)),
            ShaperConfigError::Taps { found: 5, allowed: 4 }
        );
    }

    #[test]
    fn room_never_shrinks_the_memories() {
        let config = ShaperConfig::new(16, table(17, 100)).unwrap();
        let roomy = config.clone().with_room_for(500, 65).unwrap();
        assert_eq!((roomy.ring_address_bits(), roomy.tap_index_bits()), (9, 7));
        assert_eq!(config.clone().with_room_for(0, 0).unwrap(), config);
        assert!(config.with_room_for(16383, 1).is_err());
    }

    #[test]
    fn a_pass_that_does_not_fit_states_both_clock_counts() {
        let config = ShaperConfig::new(32, table(60, 100)).unwrap();
        let needed = 60 + PASS_OVERHEAD_CLOCKS;
        assert_eq!(config.fits(needed.into()), Ok(()));
        let error = config.fits(u64::from(needed) - 1).unwrap_err();
        assert_eq!((error.needed, error.available), (needed, u64::from(needed) - 1));
        assert!(error.to_string().contains(&format!("{needed} clocks")), "{error}");
        assert_eq!(pass_clocks(u32::MAX), u32::MAX);
    }
}
