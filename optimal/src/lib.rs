//! Finds the shortest input shaper on a sample grid by cone programming.
//!
//! A shaper of `N` samples has one amplitude `a_i` per sample `0…N`, with sum 1. At a mode of angular frequency `ω` and
//! damping ratio `ζ` it leaves, measured at its last sample,
//!
//! ```text
//! V(p) = |Σ a_i z^(N−i)|,   z = e^(−p),   p = ω(ζ + j√(1−ζ²))/sample_hz
//! ```
//!
//! which is the modulus of a linear function of the amplitudes: `V(p) ≤ tolerance` is a second-order cone. A band of
//! frequency and damping is a cone at each of its points. The bounds of the command are linear too ([`Command`]). So
//! for one `N` the least residual is a cone program, and the least `N` at which it is within the tolerance is found by
//! bisection: if `N` samples are enough, so are `N + 1`.
//!
//! ```text
//! bands ─► search: bisection over N ─► refine: worst points of the bands join the program ─► program ─► cone solver
//!            │
//!            ├─► LowerBound: the multipliers of N − 1, with which plain arithmetic proves that no shorter shaper exists
//!            ├─► prefer: fewest taps, least residual or least delay at that N
//!            └─► together: shapers of several axes with one delay
//! ```
//!
//! `V` is the modulus of an analytic function of `p`, so its maximum over a band lies on the band's edge ([`Band`]):
//! only four curves are searched. Rounding to integers is [`round_taps`].
//!
//! The crate knows neither machine files nor hardware. The proofs are checked elsewhere, by code that shares nothing with this crate.

mod band;
mod cone;
mod front;
mod integer;
mod prefer;
mod program;
mod refine;
mod search;
mod together;

pub use band::Band;
pub use front::{FrontPoint, front, least_ratio_at};
pub use integer::round_taps;
pub use search::{Shortest, shortest};
pub use together::{Partner, Shorter, Together, TogetherError, together};

/// Bounds of the shaped command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// No amplitude is negative: the shaped command moves forward only, between the ends of the command.
    Positive,
    /// The partial sums of the amplitudes, which are the shaped unit step, stay within these bounds.
    PartialSums {
        /// Lower bound, at most 1.
        low: f64,
        /// Upper bound, at least 1.
        high: f64,
    },
    /// Each amplitude, a jump of the shaped unit step, stays within these bounds.
    Amplitudes {
        /// Lower bound, at most 0: a sample may also have no amplitude.
        low: f64,
        /// Upper bound, above 0.
        high: f64,
    },
}

impl Command {
    /// Returns whether no amplitude may be negative.
    pub fn is_positive(self) -> bool {
        match self {
            Self::Positive => true,
            Self::PartialSums { .. } => false,
            Self::Amplitudes { low, .. } => low >= 0.0,
        }
    }

    /// Returns whether amplitudes on this many samples can have the sum 1.
    pub(crate) fn reaches_one(self, samples: usize) -> bool {
        match self {
            Self::Positive | Self::PartialSums { .. } => samples > 0,
            Self::Amplitudes { high, .. } => samples as f64 * high >= 1.0,
        }
    }
}

/// Choice among the shapers of least duration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Prefer {
    /// Few taps. The search reweights and leaves out taps one by one; it does not prove that their number is the
    /// smallest.
    #[default]
    FewestTaps,
    /// The least mean square of the residual over the bands.
    LeastResidual,
    /// The least mean delay `Σ a_i i`.
    LeastDelay,
}

/// Requirements of a shaper.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Samples per second.
    pub sample_hz: f64,
    /// The modes with their uncertainty and tolerances; at least one.
    pub bands: Vec<Band>,
    /// Bounds of the shaped command.
    pub command: Command,
    /// Preference among the shortest shapers.
    pub prefer: Prefer,
    /// Largest number of taps.
    pub most_taps: usize,
    /// Longest duration that is tried, in samples.
    pub longest_samples: u32,
    /// Required mean delay in samples, if the shaper must have the same delay as others.
    pub delay_samples: Option<f64>,
}

/// A tap: the amplitude at a sample.
pub type Tap = (u32, f64);

/// A lower bound of the residual of every shaper of `samples` samples, as weights of the residuals at some points of
/// the bands.
///
/// Let `c_p` be the sum `Σ a_i z_p^(N−i)`, and `y_p` weights with `Σ tolerance_p |y_p| = 1`. Then the largest ratio of a residual to its
/// tolerance is at least `Re Σ ȳ_p c_p`; and that is at least its minimum over all amplitudes that the command allows, which is found
/// sample by sample. Without points the bound is infinite: amplitudes on so few samples cannot sum to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct LowerBound {
    /// `N`.
    pub samples: u32,
    /// The points.
    pub points: Vec<WeightedPoint>,
    /// Lower bound of the largest ratio of residual to tolerance, as the solver found it.
    pub ratio: f64,
}

/// A bound of the mean delay `Σ a_i i` of every shaper of at most `samples` samples that meets a request, as weights of
/// the residuals at some points of the bands.
///
/// With `c_p` and `y_p` as in [`LowerBound`], but not scaled, `Σ a_i i ≥ Σ a_i i + Re Σ ȳ_p c_p − Σ tolerance_p |y_p|` for
/// every shaper within the tolerances, and the right side has a minimum over all amplitudes that the command allows. For
/// an upper bound, `−i` takes the place of `i`.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayBound {
    /// Longest duration in samples of the shapers to which the bound applies.
    pub samples: u32,
    /// Whether it is an upper bound.
    pub is_upper: bool,
    /// The points.
    pub points: Vec<WeightedPoint>,
    /// The bound in samples, as the solver found it.
    pub delay_samples: f64,
}

/// A point of a band, with its weight in a [`LowerBound`] or a [`DelayBound`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedPoint {
    /// Index of the band.
    pub band: usize,
    /// Undamped natural frequency in Hz.
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Real and imaginary part of `y`.
    pub weight: [f64; 2],
}

/// Why there is no shaper.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OptimalError {
    /// A band reaches 0 Hz or half the sample rate, or has the damping of a mode that does not ring.
    #[error(
        "the band of mode {} reaches from {low_hz} to {high_hz} Hz: it must lie above 0 and below {half_sample_hz} Hz, half the sample rate",
        band + 1
    )]
    Band {
        /// Index of the band.
        band: usize,
        /// Its lowest frequency.
        low_hz: f64,
        /// Its highest frequency.
        high_hz: f64,
        /// Half the sample rate.
        half_sample_hz: f64,
    },
    /// A tolerance is out of range.
    #[error("the tolerance {tolerance} of mode {} must lie above 0 and below 1", band + 1)]
    Tolerance {
        /// Index of the band.
        band: usize,
        /// The tolerance.
        tolerance: f64,
    },
    /// Amplitudes within the bounds do not sum to 1.
    #[error("amplitudes of at most {high} at {samples} samples sum to less than 1")]
    Amplitudes {
        /// Upper bound of the amplitudes.
        high: f64,
        /// Samples of the longest duration that is tried.
        samples: u32,
    },
    /// No shaper within the longest duration meets the tolerances.
    #[error(
        "no shaper of up to {longest_samples} samples ({:.6} s) stays within the tolerances: the best leaves {ratio:.4} times what is allowed",
        f64::from(*longest_samples) / sample_hz
    )]
    TooLong {
        /// The longest duration that was tried.
        longest_samples: u32,
        /// Sample rate.
        sample_hz: f64,
        /// Smallest worst ratio of residual to tolerance.
        ratio: f64,
    },
    /// The budget of taps was not met.
    #[error(
        "no shaper of up to {longest_samples} samples was found with {budget} taps: the fewest found is {fewest}, with a duration of {samples} \
         samples"
    )]
    TapBudget {
        /// Taps allowed.
        budget: usize,
        /// Smallest number of taps found.
        fewest: usize,
        /// Duration in samples of the shaper with these taps.
        samples: u32,
        /// The longest duration that was tried.
        longest_samples: u32,
    },
    /// The axes of a joint design have no common delay.
    #[error(
        "no shapers of up to {longest_samples} samples have one delay: the earliest that one axis can be is {gap_samples:.3} samples later than the \
         latest that another can be"
    )]
    Apart {
        /// The longest duration that was tried.
        longest_samples: u32,
        /// Samples between the two ranges of delays.
        gap_samples: f64,
    },
    /// The solver ended without a solution.
    #[error("the cone program of {samples} samples did not converge: {status}")]
    Solver {
        /// Duration.
        samples: u32,
        /// Message of the solver.
        status: String,
    },
}
