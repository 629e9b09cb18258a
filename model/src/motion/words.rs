//! Positions to command words: counts with `command_fraction` fraction bits, signed, `command_bits` wide.

use thiserror::Error;

use crate::rtl::shaper::WORD_BITS;
use crate::rtl::word::{WordError, WordFormat};

/// Why positions are no command words.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CommandError {
    /// A format that no command has.
    #[error(transparent)]
    Format(#[from] WordError),
    /// A position that is NaN or infinite.
    #[error("sample {sample}: position {position} is no finite number")]
    NotFinite {
        /// Index of the sample, from 0.
        sample: usize,
        /// The position found.
        position: f64,
    },
    /// A position beyond the word. The hardware would saturate.
    #[error(
        "sample {sample}: position {position} is {counts} counts, beyond a word of {command_bits} bits with \
         {command_fraction} fraction bits (±{largest_counts} counts): {remedy}"
    )]
    DoesNotFit {
        /// Index of the sample, from 0.
        sample: usize,
        /// The position found.
        position: f64,
        /// The same in counts.
        counts: f64,
        /// Width of the word.
        command_bits: u32,
        /// Fraction bits of the word.
        command_fraction: u32,
        /// What the word reaches.
        largest_counts: f64,
        /// The next size that is enough, or what else to do.
        remedy: String,
    },
}

/// Converts positions (in units of the machine file) to words of `command_bits` bits with `command_fraction` fraction bits,
/// rounded half up as the hardware rounds.
///
/// # Errors
/// [`CommandError`] names the first sample that is no number or does not fit, and the next size that is enough.
pub fn command_words(
    positions: &[f64],
    counts_per_unit: f64,
    command_bits: u32,
    command_fraction: u32,
) -> Result<Vec<i32>, CommandError> {
    let format = WordFormat::new(command_bits, command_fraction)?;
    let word = |(sample, &position): (usize, &f64)| {
        let counts = position * counts_per_unit;
        if !counts.is_finite() {
            return Err(CommandError::NotFinite { sample, position });
        }
        // A word has at most 32 bits.
        let word = format.to_word(counts).map(|word| word as i32);
        word.map_err(|_| CommandError::DoesNotFit {
            sample,
            position,
            counts,
            command_bits,
            command_fraction,
            largest_counts: format.largest_counts(),
            remedy: remedy(counts, command_bits, command_fraction),
        })
    };
    positions.iter().enumerate().map(word).collect()
}

/// What makes a word fit.
fn remedy(counts: f64, command_bits: u32, command_fraction: u32) -> String {
    let enough = |width: &&u32| {
        let format = WordFormat::new(**width, command_fraction);
        **width > command_bits && format.is_ok_and(|format| format.to_word(counts).is_ok())
    };
    match WORD_BITS.iter().find(enough) {
        Some(width) => format!("set command_bits = {width}, lower command_fraction, or move less far"),
        None => "lower command_fraction, or move less far".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_counts_with_fraction_rounded_half_up() {
        // 1000 counts per unit, 8 fraction bits: 256000 per unit.
        let words = command_words(&[0.0, 0.001, -0.001, 2.5 / 256_000.0, -2.5 / 256_000.0], 1000.0, 32, 8).unwrap();
        assert_eq!(words, [0, 256, -256, 3, -2]);
    }

    #[test]
    fn unit_the_ends_of_the_word_fit_and_no_more() {
        let at = |word: f64, bits| command_words(&[word], 1.0, bits, 0);
        assert_eq!(at(32767.0, 16), Ok(vec![32767]));
        assert_eq!(at(-32768.0, 16), Ok(vec![-32768]));
        assert_eq!(at(2_147_483_647.0, 32), Ok(vec![i32::MAX]));
        assert_eq!(at(-2_147_483_648.0, 32), Ok(vec![i32::MIN]));
        let message = |word: f64, bits| at(word, bits).unwrap_err().to_string();
        assert!(message(32768.0, 16).contains("command_bits = 24"));
        assert!(message(-40_000_000.0, 16).contains("command_bits = 32"));
        assert!(message(2_147_483_648.0, 32).contains("lower command_fraction"));
    }

    #[test]
    fn unit_numbers_that_are_none() {
        for bad in [f64::NAN, f64::INFINITY, f64::MAX] {
            let error = command_words(&[0.0, bad], 1e6, 32, 8).unwrap_err();
            assert!(matches!(error, CommandError::NotFinite { sample: 1, .. }));
        }
    }
}
