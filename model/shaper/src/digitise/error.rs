//! Errors of digitising.

use thiserror::Error;

use crate::unit::{short, show_seconds};
use posicast_taps::{COEFFICIENT_FRACTION_MAX, COEFFICIENT_MAX, COEFFICIENT_MIN, TapTableError};

/// Longest delay in samples: the largest ring buffer has 2^14 words, of which writing and reading need two.
pub const DELAY_MAX_SAMPLES: u32 = (1 << 14) - 2;
/// Largest number of taps of a table.
pub const TAPS_MAX: usize = 256;

/// Reason why a shaper cannot become a tap table. Every message has the value that was found, the allowed ones and a
/// remedy.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DigitiseError {
    /// The shaper lasts longer than any ring buffer.
    #[error(
        "axis {axis}: the shaper lasts {}, {found} samples at {sample_hz} Hz; the ring buffer holds at most \
         {DELAY_MAX_SAMPLES}: lower sample_hz, or use a shorter kind",
        show_seconds(*.duration_s, 4)
    )]
    Delay {
        /// Name of the axis.
        axis: String,
        /// Longest delay in samples.
        found: f64,
        /// Duration of the shaper in seconds.
        duration_s: f64,
        /// Sample rate in Hz.
        sample_hz: f64,
    },
    /// Delayed to match the slowest axis, the shaper is longer than any ring buffer.
    #[error(
        "axis {axis}: to match the delay of axis {slowest} plus [stage] extra_delay_s, it needs {} more samples of delay, which reach \
         {found:.0} samples back at {sample_hz} Hz; the ring buffer holds at most {DELAY_MAX_SAMPLES}: lower stage.extra_delay_s, give \
         axis {slowest} a shorter kind, lower sample_hz, or leave the table [stage] out",
        short(*added_samples)
    )]
    MatchedDelay {
        /// Name of the axis.
        axis: String,
        /// Name of the axis with the largest delay of its own.
        slowest: String,
        /// Delay to add, in samples.
        added_samples: f64,
        /// Longest delay with it, in samples.
        found: f64,
        /// Sample rate in Hz.
        sample_hz: f64,
    },
    /// There are more taps than the largest table holds.
    #[error(
        "axis {axis}: {found} taps; a table holds at most {TAPS_MAX}: use a lower sample_hz, shorter kinds, fewer modes under one \
         shaper, or digitise = \"nearest\""
    )]
    Taps {
        /// Name of the axis.
        axis: String,
        /// Number of taps.
        found: usize,
    },
    /// A mode's frequency is too high for the sample rate.
    #[error(
        "axis {axis}: a mode of {} Hz cannot be shaped with {sample_hz} samples per second; \
         sample_hz must be more than twice the mode's frequency",
        short(*frequency_hz)
    )]
    Nyquist {
        /// Name of the axis.
        axis: String,
        /// Frequency of the mode in Hz.
        frequency_hz: f64,
        /// Sample rate in Hz.
        sample_hz: f64,
    },
    /// The taps cancel, or their numbers are out of all proportion, so that they cannot be scaled to the sum 1.
    #[error(
        "axis {axis}: on the sample grid the amplitudes sum to {}, too little to scale to 1; raise sample_hz, \
         or use digitise = \"linear\"",
        short(*sum)
    )]
    NoUnitSum {
        /// Name of the axis.
        axis: String,
        /// Sum of the taps.
        sum: f64,
    },
    /// 18 bits cannot hold a coefficient even with one fraction bit.
    #[error(
        "axis {axis}: a tap has the weight {}; coefficients of {COEFFICIENT_MIN} to {COEFFICIENT_MAX} with at least \
         one fraction bit reach ±65535: use smaller amplitudes or a higher sample_hz",
        short(*weight)
    )]
    Weight {
        /// Name of the axis.
        axis: String,
        /// Largest weight by magnitude.
        weight: f64,
    },
    /// The requested number of fraction bits does not fit the coefficients.
    #[error(
        "coefficient_fraction = {requested}: the coefficients of this machine fit 18 bits with 1 to {largest} fraction \
         bits; give at most {largest}, or leave the key out"
    )]
    Fraction {
        /// Fraction bits that the machine file asks for.
        requested: u32,
        /// Largest number that fits, at most [`COEFFICIENT_FRACTION_MAX`].
        largest: u32,
    },
    /// Half sums have no coefficients: a table of so few fraction bits would not be theirs.
    #[error(
        "coefficient_fraction = {fraction}: the impulses of axis {axis}, a cascade, are multiples of 2^-{least}; give at least {least}, \
         lower the `order` of that axis, or use fewer modes"
    )]
    HalfSums {
        /// Name of the axis.
        axis: String,
        /// Fraction bits of the table.
        fraction: u32,
        /// Fraction bits that its weights need.
        least: u32,
    },
    /// The rounded taps are not a valid table. This is a defect of this program, which is reported instead of hidden.
    #[error("axis {axis}: {cause}")]
    Table {
        /// Name of the axis.
        axis: String,
        /// The rule that the taps break.
        cause: TapTableError,
    },
}

const _: () = assert!(
    COEFFICIENT_FRACTION_MAX == 16,
    "the message of `Weight` gives the limit of one fraction bit"
);
