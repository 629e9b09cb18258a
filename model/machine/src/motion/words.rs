//! Converts positions to command words: signed counts with `command_fraction` fraction bits, `command_bits` wide.

use thiserror::Error;

use posicast_blocks::shaper::WORD_BITS;
use posicast_blocks::word::{WordError, WordFormat};
use posicast_taps::TapTable;

/// Largest word of a modulo axis with its whole turns, as a power of two: up to it, positions keep their fraction in
/// an `f64`.
const TURNED_WORD_BITS: i32 = 50;

/// Why positions cannot become command words.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CommandError {
    /// The number format is not valid for a command.
    #[error(transparent)]
    Format(#[from] WordError),
    /// A position is NaN or infinite.
    #[error("sample {sample}: position {position} is not a finite number")]
    NotFinite {
        /// Index of the sample, from 0.
        sample: usize,
        /// The position.
        position: f64,
    },
    /// A position does not fit the word; the hardware would saturate.
    #[error(
        "sample {sample}: position {position} is {counts} counts, beyond a word of {command_bits} bits with \
         {command_fraction} fraction bits (±{largest_counts} counts): {remedy}"
    )]
    DoesNotFit {
        /// Index of the sample, from 0.
        sample: usize,
        /// The position.
        position: f64,
        /// The position in counts.
        counts: f64,
        /// Width of the word.
        command_bits: u32,
        /// Fraction bits of the word.
        command_fraction: u32,
        /// Range of the word in counts.
        largest_counts: f64,
        /// The next size that is large enough, or what else to do.
        remedy: String,
    },
    /// A modulo axis turns so far within the shaper's delay that its word is ambiguous.
    #[error(
        "sample {sample}: the position moves by {counts} counts within the shaper's delay of {delay_samples} samples, and the \
         words of a modulo axis must stay below half a turn of the word ({largest_counts} counts): move slower, or set more \
         command_bits or a lower command_fraction"
    )]
    TurnsTooFast {
        /// Index of the sample, from 0.
        sample: usize,
        /// Distance that the position moves, in counts.
        counts: f64,
        /// Delay of the tap, in samples.
        delay_samples: u32,
        /// Half a turn of the word, in counts.
        largest_counts: f64,
    },
}

/// Converts positions (in units of the machine file) to words of `command_bits` bits with `command_fraction` fraction
/// bits, rounded half up as the hardware does.
///
/// # Errors
/// [`CommandError`] names the first sample that is not finite or does not fit, and the next size that is large
/// enough.
pub fn command_words(
    positions: &[f64],
    counts_per_unit: f64,
    command_bits: u32,
    command_fraction: u32,
) -> Result<Vec<i64>, CommandError> {
    let format = WordFormat::new(command_bits, command_fraction)?;
    let word = |(sample, &position): (usize, &f64)| {
        let counts = position * counts_per_unit;
        if !counts.is_finite() {
            return Err(CommandError::NotFinite { sample, position });
        }
        format.to_word(counts).map_err(|_| CommandError::DoesNotFit {
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

/// Converts positions of a modulo axis to words that include the whole turns; the hardware gets their lowest
/// `command_bits`. `table` is the shaper that they pass.
///
/// # Errors
/// [`CommandError`] names the first sample that is not finite, is beyond 2^50, or at which the position has moved by
/// half a turn of the word or more since a sample that the shaper still uses: the differences that it shapes would be
/// ambiguous.
pub fn modulo_words(
    positions: &[f64],
    counts_per_unit: f64,
    command_bits: u32,
    command_fraction: u32,
    table: &TapTable,
) -> Result<Vec<i64>, CommandError> {
    let format = WordFormat::new(command_bits, command_fraction)?;
    let (lsb_per_count, most) = (f64::from(command_fraction).exp2(), f64::from(TURNED_WORD_BITS).exp2());
    let word = |(sample, &position): (usize, &f64)| {
        let counts = position * counts_per_unit;
        let word = (counts * lsb_per_count + 0.5).floor();
        if !counts.is_finite() {
            return Err(CommandError::NotFinite { sample, position });
        }
        if word.abs() > most {
            return Err(CommandError::DoesNotFit {
                sample,
                position,
                counts,
                command_bits,
                command_fraction,
                largest_counts: most / lsb_per_count,
                remedy: "turn less far".to_owned(),
            });
        }
        Ok(word as i64)
    };
    let words: Vec<i64> = positions.iter().enumerate().map(word).collect::<Result<_, _>>()?;
    let half_turn = 1i64 << (command_bits - 1);
    for delay_samples in table.taps().iter().map(|tap| tap.delay_samples) {
        let now = words.iter().enumerate().skip(delay_samples as usize);
        for ((sample, now), before) in now.zip(&words) {
            if (now - before).abs() >= half_turn {
                return Err(CommandError::TurnsTooFast {
                    sample,
                    counts: (now - before) as f64 / lsb_per_count,
                    delay_samples,
                    largest_counts: format.largest_counts(),
                });
            }
        }
    }
    Ok(words)
}

/// The remedy for a word that does not fit.
fn remedy(counts: f64, command_bits: u32, command_fraction: u32) -> String {
    let enough = |width: &u32| {
        let format = WordFormat::new(*width, command_fraction);
        *width > command_bits && format.is_ok_and(|format| format.to_word(counts).is_ok())
    };
    match WORD_BITS.into_iter().find(enough) {
        Some(width) => format!("set command_bits = {width}, lower command_fraction, or move less far"),
        None => "lower command_fraction, or move less far".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_taps::Tap;

    #[test]
    fn counts_with_fraction_rounded_half_up() {
        // 1000 counts per unit, 8 fraction bits: 256000 per unit.
        let words = command_words(&[0.0, 0.001, -0.001, 2.5 / 256_000.0, -2.5 / 256_000.0], 1000.0, 32, 8).unwrap();
        assert_eq!(words, [0, 256, -256, 3, -2]);
    }

    #[test]
    fn the_ends_of_the_word_fit_and_no_more() {
        let at = |word: f64, bits| command_words(&[word], 1.0, bits, 0);
        assert_eq!(at(32767.0, 16), Ok(vec![32767]));
        assert_eq!(at(-32768.0, 16), Ok(vec![-32768]));
        assert_eq!(at(2_147_483_647.0, 32), Ok(vec![i64::from(i32::MAX)]));
        assert_eq!(at(-2_147_483_648.0, 32), Ok(vec![i64::from(i32::MIN)]));
        let message = |word: f64, bits| at(word, bits).unwrap_err().to_string();
        assert!(message(32768.0, 16).contains("command_bits = 17"));
        assert!(message(-40_000_000.0, 16).contains("command_bits = 27"));
        assert!(message(2_147_483_648.0, 32).contains("lower command_fraction"));
    }

    #[test]
    fn numbers_that_are_not_finite_are_errors() {
        for bad in [f64::NAN, f64::INFINITY, f64::MAX] {
            let error = command_words(&[0.0, bad], 1e6, 32, 8).unwrap_err();
            assert!(matches!(error, CommandError::NotFinite { sample: 1, .. }));
            let error = modulo_words(&[0.0, bad], 1e6, 32, 8, &halves()).unwrap_err();
            assert!(matches!(error, CommandError::NotFinite { sample: 1, .. }));
        }
    }

    fn halves() -> TapTable {
        let half = |delay_samples| Tap {
            delay_samples,
            coefficient: 1 << 15,
        };
        TapTable::new(16, vec![half(0), half(2)]).unwrap()
    }

    #[test]
    fn a_modulo_axis_turns_on_as_long_as_the_shaper_can_tell() {
        let words = |step: f64| {
            let positions: Vec<f64> = (0..100).map(|sample| step * f64::from(sample)).collect();
            modulo_words(&positions, 1.0, 24, 8, &halves())
        };
        // Half a turn of 24 bits with 8 fraction bits is 32768 counts, and the longest delay is 2 samples.
        assert_eq!(words(16383.0).map(|words| words[99]), Ok(16383 * 256 * 99));
        let error = words(-16384.0).unwrap_err();
        assert!(
            matches!(
                error,
                CommandError::TurnsTooFast {
                    sample: 2,
                    counts: -32768.0,
                    delay_samples: 2,
                    ..
                }
            ),
            "{error}"
        );
        let far = modulo_words(&[1e300], 1.0, 24, 8, &halves()).unwrap_err();
        assert!(far.to_string().contains("turn less far"), "{far}");
    }
}
