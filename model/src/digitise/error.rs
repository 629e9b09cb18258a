//! Why a shaper has no tap table.

use thiserror::Error;

use crate::taps::{COEFFICIENT_FRACTION_MAX, COEFFICIENT_MAX, COEFFICIENT_MIN, TapTableError};
use crate::unit::{short, show_seconds};

/// Longest delay in samples: the largest ring buffer, 2^14 words, less the two that writing and reading need.
pub const DELAY_MAX_SAMPLES: u32 = (1 << 14) - 2;
/// Most taps of a table.
pub const TAPS_MAX: usize = 256;

/// Why a shaper has no tap table. Every message says what was found, what is allowed, and what to do.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DigitiseError {
    /// Longer than any ring buffer.
    #[error(
        "axis {axis}: the shaper lasts {}, {found} samples at {sample_hz} Hz; the ring buffer holds at most \
         {DELAY_MAX_SAMPLES}: lower sample_hz, or use a shorter kind",
        show_seconds(*.duration_s, 4)
    )]
    Delay {
        /// The axis.
        axis: String,
        /// Longest delay in samples.
        found: f64,
        /// Duration in seconds.
        duration_s: f64,
        /// Sample rate.
        sample_hz: f64,
    },
    /// Too long once it is as late as the slowest axis.
    #[error(
        "axis {axis}: to be as late as axis {slowest} and [stage] extra_delay_s, it needs {} more samples of delay, \
         which reach {found:.0} samples back at {sample_hz} Hz; the ring buffer holds at most {DELAY_MAX_SAMPLES}: lower \
         stage.extra_delay_s, give axis {slowest} a shorter kind, lower sample_hz, or leave the table [stage] out",
        short(*added_samples)
    )]
    MatchedDelay {
        /// The axis.
        axis: String,
        /// The axis with the largest delay of its own.
        slowest: String,
        /// Delay that is missing, in samples.
        added_samples: f64,
        /// Longest delay in samples.
        found: f64,
        /// Sample rate.
        sample_hz: f64,
    },
    /// More taps than the largest table.
    #[error(
        "axis {axis}: {found} taps; a table holds at most {TAPS_MAX}: use a lower sample_hz, shorter kinds, fewer modes under one \
         shaper, or digitise = \"nearest\""
    )]
    Taps {
        /// The axis.
        axis: String,
        /// Taps found.
        found: usize,
    },
    /// A mode faster than the samples can follow.
    #[error(
        "axis {axis}: a mode of {} Hz cannot be shaped with {sample_hz} samples per second; \
         sample_hz must be more than twice the mode's frequency",
        short(*frequency_hz)
    )]
    Nyquist {
        /// The axis.
        axis: String,
        /// The mode's frequency.
        frequency_hz: f64,
        /// Sample rate.
        sample_hz: f64,
    },
    /// Taps that cancel, or numbers out of all proportion.
    #[error(
        "axis {axis}: on the sample grid the amplitudes sum to {}, too little to scale to 1; raise sample_hz, \
         or use digitise = \"linear\"",
        short(*sum)
    )]
    NoUnitSum {
        /// The axis.
        axis: String,
        /// The sum found.
        sum: f64,
    },
    /// A coefficient that 18 bits cannot hold even with one fraction bit.
    #[error(
        "axis {axis}: a tap has the weight {}; coefficients of {COEFFICIENT_MIN} to {COEFFICIENT_MAX} with at least \
         one fraction bit reach ±65535: use smaller amplitudes or a higher sample_hz",
        short(*weight)
    )]
    Weight {
        /// The axis.
        axis: String,
        /// Largest weight by magnitude.
        weight: f64,
    },
    /// A number of fraction bits that does not fit.
    #[error(
        "coefficient_fraction = {requested}: the coefficients of this machine fit 18 bits with 1 to {largest} fraction \
         bits; give at most {largest}, or leave the key out"
    )]
    Fraction {
        /// As in the machine file.
        requested: u32,
        /// Largest that fits, at most [`COEFFICIENT_FRACTION_MAX`].
        largest: u32,
    },
    /// Integers that are no table: a defect here, said instead of hidden.
    #[error("axis {axis}: {cause}")]
    Table {
        /// The axis.
        axis: String,
        /// The broken rule.
        cause: TapTableError,
    },
}

const _: () = assert!(
    COEFFICIENT_FRACTION_MAX == 16,
    "the message of `Weight` says what one fraction bit reaches"
);
