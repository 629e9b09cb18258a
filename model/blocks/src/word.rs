//! Command words: encoder counts as two's complement fixed-point numbers of the hardware.
//!
//! ```
//! use posicast_blocks::word::WordFormat;
//!
//! let position = WordFormat::new(32, 8)?;
//! assert_eq!(position.to_word(2.5)?, 640);
//! assert_eq!(position.to_counts(-640), -2.5);
//! assert!(position.to_word(1e9).is_err());
//! # Ok::<(), posicast_blocks::word::WordError>(())
//! ```

/// A signed format of `bits` bits, the lowest `fraction` of which are behind the binary point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WordFormat {
    bits: u32,
    fraction: u32,
}

/// Why a command word cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum WordError {
    /// The format is not valid for a command.
    #[error("words of {bits} bits with {fraction} fraction bits: 2 to 32 bits, fewer fraction bits than bits")]
    Format {
        /// Width in bits.
        bits: u32,
        /// Number of fraction bits.
        fraction: u32,
    },
    /// The word does not hold the number.
    #[error(
        "{found} counts do not fit: words of {bits} bits with {fraction} fraction bits hold {smallest} to {largest}; \
         choose more bits or fewer fraction bits"
    )]
    Range {
        /// The number in counts.
        found: f64,
        /// Width in bits.
        bits: u32,
        /// Number of fraction bits.
        fraction: u32,
        /// Smallest number that fits.
        smallest: f64,
        /// Largest number that fits.
        largest: f64,
    },
}

impl WordFormat {
    /// A format of 2 to 32 bits with 0 to `bits − 1` fraction bits.
    ///
    /// # Errors
    /// [`WordError::Format`] for any other.
    pub fn new(bits: u32, fraction: u32) -> Result<Self, WordError> {
        if !(2..=32).contains(&bits) || fraction >= bits {
            return Err(WordError::Format { bits, fraction });
        }
        Ok(Self { bits, fraction })
    }

    /// The word nearest to `counts`; halfway between two words, the larger one.
    ///
    /// # Errors
    /// [`WordError::Range`] for counts that are too large for the word, or not a number.
    pub fn to_word(self, counts: f64) -> Result<i64, WordError> {
        let (smallest, largest) = self.ends();
        // A power of two and a difference of less than one change no digit. `(scaled + 0.5).floor()` would: it rounds the number
        // below one half up.
        let scaled = counts * self.one();
        let below = scaled.floor();
        let nearest = if scaled - below < 0.5 { below } else { below + 1.0 };
        if (smallest as f64..=largest as f64).contains(&nearest) {
            Ok(nearest as i64)
        } else {
            Err(WordError::Range {
                found: counts,
                bits: self.bits,
                fraction: self.fraction,
                smallest: self.to_counts(smallest),
                largest: self.to_counts(largest),
            })
        }
    }

    /// The counts that a word stands for, exactly.
    pub fn to_counts(self, word: i64) -> f64 {
        word as f64 / self.one()
    }

    /// The word of one count.
    fn one(self) -> f64 {
        f64::from(1u32 << self.fraction)
    }

    /// The largest number that a word holds, in counts.
    pub fn largest_counts(self) -> f64 {
        self.to_counts(self.ends().1)
    }

    fn ends(self) -> (i64, i64) {
        let half = 1 << (self.bits - 1);
        (-half, half - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_half_up() {
        let format = WordFormat::new(16, 2).unwrap();
        let words = [-0.375, -0.25, -0.125, 0.0, 0.1249, 0.125, 0.375].map(|counts| format.to_word(counts).unwrap());
        assert_eq!(words, [-1, -1, 0, 0, 0, 1, 2]);

        let beside_half = [
            (-0.125_f64).next_up(),
            (-0.125_f64).next_down(),
            0.125_f64.next_down(),
            -1e-300,
            1e-300,
        ];
        let words = beside_half.map(|counts| format.to_word(counts).unwrap());
        assert_eq!(words, [0, -1, 0, 0, 0]);
    }

    #[test]
    fn every_word_of_16_bits_comes_back() {
        let format = WordFormat::new(16, 8).unwrap();
        for word in -32768..=32767 {
            assert_eq!(format.to_word(format.to_counts(word)).unwrap(), word);
        }
    }

    #[test]
    fn the_ends_and_what_lies_beyond() {
        let format = WordFormat::new(32, 31).unwrap();
        assert_eq!(format.to_word(-1.0).unwrap(), -(1 << 31));
        for beyond in [
            1.0,
            -1.1,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN,
        ] {
            assert!(format.to_word(beyond).is_err(), "{beyond}");
        }
        assert!(WordFormat::new(33, 0).is_err());
        assert!(WordFormat::new(8, 8).is_err());
    }
}
