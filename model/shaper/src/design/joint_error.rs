//! Errors of the kinds that treat all modes of an axis together.

use thiserror::Error;

use super::kind::ShaperKind;
use crate::mode::Mode;
use crate::unit::{short, show_seconds};

/// Why the modes of an axis have no common shaper. Modes are counted from 1, in the order of the file.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum JointError {
    /// Two modes are equal.
    #[error("modes {first} and {second} coincide at {hz} Hz: leave one of them out", hz = short(mode.frequency_hz))]
    Coincident {
        /// Number of the first mode.
        first: usize,
        /// Number of the second mode.
        second: usize,
        /// The mode.
        mode: Mode,
    },
    /// The kind cannot be the base of `periodic`.
    #[error("\"{0}\" cannot be the base: choose zv-ei, multi-ei or chebyshev-ei")]
    Base(ShaperKind),
    /// The search limit is invalid.
    #[error(
        "lowest_frequency_hz {lowest} with these modes means more than {most} periods to search; \
         raise lowest_frequency_hz to {least} or above",
        lowest = short(*lowest_hz), least = short(*least_hz)
    )]
    SearchRange {
        /// The search limit of the file.
        lowest_hz: f64,
        /// Most odd multiples per mode that are searched.
        most: u32,
        /// Smallest search limit that is allowed.
        least_hz: f64,
    },
    /// No frequency has odd multiples close enough to every mode.
    #[error(
        "no periodic solution above lowest_frequency_hz {lowest}: no frequency has an odd multiple near every mode, within {lambda:.4} \
         of the frequency; use a wider base (\"chebyshev-ei\" with order 5), a larger tolerance, a smaller lowest_frequency_hz, or a \
         kind for each mode such as \"zv\"",
        lowest = short(*lowest_hz)
    )]
    NoPeriodicSolution {
        /// The search limit.
        lowest_hz: f64,
        /// One-sided relative width of the base's insensitivity.
        lambda: f64,
    },
    /// Damping raises the residual of a mode above its tolerance.
    #[error(
        "the mode at {hz} Hz, damping {damping}, keeps a residual of {found:.6}, above its tolerance {tolerance}: the \
         amplitudes are those of undamped modes; raise the tolerance, or use a kind for each mode such as \"zvd\"",
        hz = short(mode.frequency_hz), damping = short(mode.damping)
    )]
    AboveTolerance {
        /// The mode.
        mode: Mode,
        /// Its residual.
        found: f64,
        /// Its tolerance.
        tolerance: f64,
    },
    /// The frequencies have no usable common divisor.
    #[error(
        "the damped frequencies {frequencies_hz} Hz have no common divisor whose multiples stay below {most}, so there is no antiperiod \
         for a shaper; set ratio_tolerance to the accuracy of the frequencies, or use a kind for each mode such as \"zv\""
    )]
    NoCommonDivisor {
        /// The damped frequencies in Hz, as text.
        frequencies_hz: String,
        /// Largest multiple of the divisor that the lowest mode may have.
        most: u64,
    },
    /// No two modes share an antiperiod.
    #[error(
        "no antisymmetry: the damped frequencies {frequencies_hz} Hz are {multiples} times {divisor} Hz, and no two of these multiples \
         contain the same power of two; use a kind for each mode such as \"zv\", or set ratio_tolerance so that nearby odd multiples \
         count",
        divisor = short(*divisor_hz)
    )]
    NoAntisymmetry {
        /// The damped frequencies in Hz, as text.
        frequencies_hz: String,
        /// The multiples of the common divisor, as text.
        multiples: String,
        /// Common divisor in Hz.
        divisor_hz: f64,
    },
    /// Newton's method found no three impulses.
    #[error(
        "the equations of method \"three-impulse\" have no solution with ordered impulses near the antiperiod of {antiperiod}: \
         use method \"exact\"",
        antiperiod = show_seconds(*antiperiod_s, 4)
    )]
    ThreeImpulse {
        /// Antiperiod in seconds.
        antiperiod_s: f64,
    },
    /// A mode is too high a multiple of the common divisor for the sums of `three-impulse`.
    #[error(
        "a mode at {multiple} times the common divisor: method \"three-impulse\" takes multiples up to {most}: \
         use method \"exact\", or a kind for each mode such as \"zv\""
    )]
    ThreeImpulseMultiple {
        /// Multiple of the mode.
        multiple: u64,
        /// Largest multiple that is allowed.
        most: u64,
    },
    /// The kind cannot be a mode's constraint.
    #[error("a mode with shaper \"{0}\": under \"simultaneous\" a mode takes zv or zvd")]
    Constraint(ShaperKind),
    /// There are more modes than can be solved together.
    #[error("{found} modes: this kind takes 1 to {most} modes; use a kind for each mode such as \"ps-zv\"")]
    TooManyModes {
        /// Number of modes of the axis.
        found: usize,
        /// Largest number of modes.
        most: usize,
    },
    /// No sequence of impulses with bounded partial sums was found.
    #[error(
        "no {impulses} impulses of amplitudes {amplitudes} were found that meet all constraints of these modes: frequencies \
         far apart need more impulses than constraints; use a kind for each mode such as \"ps-zv\" or \"zv\""
    )]
    NoSimultaneous {
        /// Number of impulses.
        impulses: usize,
        /// Their amplitudes, as text.
        amplitudes: &'static str,
    },
    /// The bound or the order of `vibrationless` is not solved.
    #[error(
        "shaper \"vibrationless\" with order {order} and epsilon {epsilon}: the supported orders are 1 to {most}, and this order needs \
         an epsilon from {least:e} to {largest}; take such an epsilon, a lower order, or \"zvdd\""
    )]
    Vibrationless {
        /// Order that was asked for.
        order: u32,
        /// Bound that was asked for.
        epsilon: f64,
        /// Largest order.
        most: u32,
        /// Smallest bound that is solved.
        least: f64,
        /// Largest bound that is solved.
        largest: f64,
    },
    /// No shortest shaper.
    #[error(transparent)]
    Optimal(#[from] posicast_optimal::OptimalError),
    /// A start control without a length.
    #[error("a start of {0} s: its length must be a positive, finite number")]
    StartLength(f64),
    /// The start of a command is not longer than its filter.
    #[error(
        "a start of {start_s} s is not longer than the {filter_s} s of its half sums: the peak falls below that of the \
         start, and R and K no longer describe it; use a longer start, or fewer frequencies"
    )]
    ShortStart {
        /// Length of the start in seconds.
        start_s: f64,
        /// Sum of the delays of the half sums in seconds.
        filter_s: f64,
    },
}

/// Checks that no two modes are equal to the rounding of decimals.
pub(super) fn check_distinct(modes: &[Mode]) -> Result<(), JointError> {
    const SAME: f64 = 1e-9;
    for (second, mode) in modes.iter().enumerate() {
        let same = |other: &Mode| {
            (other.frequency_hz / mode.frequency_hz - 1.0).abs() < SAME && (other.damping - mode.damping).abs() < SAME
        };
        if let Some(first) = modes[..second].iter().position(same) {
            return Err(JointError::Coincident {
                first: first + 1,
                second: second + 1,
                mode: *mode,
            });
        }
    }
    Ok(())
}

/// Writes frequencies as messages list them.
pub(super) fn list(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|value| short(*value)).collect();
    texts.join(", ")
}
