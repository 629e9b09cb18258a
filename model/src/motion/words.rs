//! Positions to command words: counts with `command_fraction` fraction bits, signed, `command_bits` wide.

use thiserror::Error;

/// Widths of a command word, in the order in which a message recommends them.
const WIDTHS: [u32; 3] = [16, 24, 32];

/// Why positions are no command words.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CommandError {
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
/// rounding half away from zero.
///
/// # Errors
/// [`CommandError`] names the first sample that is no number or does not fit, and the next size that is enough.
pub fn command_words(
    positions: &[f64],
    counts_per_unit: f64,
    command_bits: u32,
    command_fraction: u32,
) -> Result<Vec<i32>, CommandError> {
    let scale = counts_per_unit * 2f64.powi(command_fraction.min(64) as i32);
    let largest = largest_word(command_bits);
    positions
        .iter()
        .enumerate()
        .map(|(sample, &position)| {
            let word = (position * scale).round();
            if !word.is_finite() {
                Err(CommandError::NotFinite { sample, position })
            } else if (-largest - 1.0..=largest).contains(&word) {
                Ok(word as i32)
            } else {
                Err(CommandError::DoesNotFit {
                    sample,
                    position,
                    counts: position * counts_per_unit,
                    command_bits,
                    command_fraction,
                    largest_counts: largest / 2f64.powi(command_fraction.min(64) as i32),
                    remedy: remedy(word, command_bits),
                })
            }
        })
        .collect()
}

/// Largest word of a width, which is at most 32.
fn largest_word(command_bits: u32) -> f64 {
    2f64.powi(command_bits.clamp(1, 32) as i32 - 1) - 1.0
}

/// What makes a word fit.
fn remedy(word: f64, command_bits: u32) -> String {
    let enough = |width: &&u32| **width > command_bits && word.abs() <= largest_word(**width);
    match WIDTHS.iter().find(enough) {
        Some(width) => format!("set command_bits = {width}, lower command_fraction, or move less far"),
        None => "lower command_fraction, or move less far".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_counts_with_fraction_rounded_half_away_from_zero() {
        // 1000 counts per unit, 8 fraction bits: 256000 per unit.
        let words = command_words(&[0.0, 0.001, -0.001, 2.5 / 256_000.0, -2.5 / 256_000.0], 1000.0, 32, 8).unwrap();
        assert_eq!(words, [0, 256, -256, 3, -3]);
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
