//! Errors of shaper design.

use thiserror::Error;

use super::IMPULSES_MAX;
use super::joint_error::JointError;
use super::kind::ShaperKind;
use crate::digitise::DigitiseError;
use crate::impulse::ImpulseError;
use crate::mode::Mode;
use crate::unit::short;

/// Why a machine cannot get shapers. Every message names the axis or the mode, what is allowed, and what to do.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DesignError {
    /// A function that designs some kinds was called with another.
    #[error("shaper \"{kind}\" is of another family than this function designs")]
    OtherFamily {
        /// The kind.
        kind: ShaperKind,
    },
    /// The kind designs one shaper per mode, and the axis has no mode.
    #[error(
        "axis {axis}: shaper {kind:?} needs at least one [[axis.mode]]; without modes use kind \"none\" or \"custom\""
    )]
    NoModes {
        /// Name of the axis.
        axis: String,
        /// Kind of its shaper.
        kind: String,
    },
    /// A mode's own shaper is of a kind that serves whole axes.
    #[error(
        "axis {axis}, mode {hz} Hz: shaper \"{kind}\" treats all modes of an axis together; name it in [axis.shaper], \
         or give this mode a kind for one mode, such as zv, zvd or ei",
        hz = short(mode.frequency_hz)
    )]
    JointKindOfOneMode {
        /// Name of the axis.
        axis: String,
        /// The kind that treats all modes together.
        kind: ShaperKind,
        /// The mode.
        mode: Mode,
    },
    /// The mode has an invalid frequency or damping ratio.
    #[error(
        "mode {hz} Hz with damping {damping}: the frequency must be positive and finite, the damping in [0, 1)",
        hz = short(mode.frequency_hz), damping = short(mode.damping)
    )]
    Mode {
        /// The invalid mode.
        mode: Mode,
    },
    /// The tolerance is outside the range that the EI kind is solved for.
    #[error("shaper \"{kind}\" at mode {hz} Hz: tolerance {tolerance} is outside the supported range: take a tolerance above {least:e} \
             and below {most}, or \"zv\" or \"zvd\", which need no tolerance",
        hz = short(mode.frequency_hz))]
    Tolerance {
        /// The kind.
        kind: ShaperKind,
        /// The mode.
        mode: Mode,
        /// The tolerance found.
        tolerance: f64,
        /// Smallest tolerance that is solved.
        least: f64,
        /// Largest tolerance that is solved.
        most: f64,
    },
    /// Tolerance, order or kind of a bias-point shaper is invalid.
    #[error(
        "shaper \"{kind}\" with tolerance {tolerance} and order {order}: zv-ei, zv-ei-2, zvd-ei, multi-ei and chebyshev-ei \
         take a tolerance between 0 and 1, both excluded, chebyshev-ei an order of 1 to 5"
    )]
    BiasPoint {
        /// The kind.
        kind: ShaperKind,
        /// Order that was asked for.
        order: u32,
        /// Tolerance that was asked for.
        tolerance: f64,
    },
    /// The damping ratio is larger than the kind is solved for.
    #[error(
        "shaper \"{kind}\" takes a damping of 0 to {most}; the mode at {hz} Hz has {damping}: use \"{instead}\" for this mode",
        hz = short(mode.frequency_hz), damping = short(mode.damping)
    )]
    Damping {
        /// The kind.
        kind: ShaperKind,
        /// The mode.
        mode: Mode,
        /// Largest damping ratio of the kind.
        most: f64,
        /// A kind that allows this damping ratio.
        instead: ShaperKind,
    },
    /// Newton's method lost the solution on the way to this damping and tolerance.
    #[error(
        "shaper \"{kind}\" at mode {hz} Hz, damping {damping}: no solution found beyond {percent:.0} % of the way from the \
         undamped shaper; use \"zv\" or \"zvd\" for this mode",
        hz = short(mode.frequency_hz), damping = short(mode.damping), percent = 100.0 * reached
    )]
    NotSolved {
        /// The kind.
        kind: ShaperKind,
        /// The mode.
        mode: Mode,
        /// Fraction of the way that was reached, 0 to 1.
        reached: f64,
    },
    /// No shaper of the kind has this tolerance at this damping ratio.
    #[error(
        "shaper \"{kind}\" with tolerance {tolerance} exists up to damping {}; the mode at {hz} Hz has \
         {damping}{}use \"zv\" or \"zvd\" for this mode",
        rounded_down(*largest_damping), tolerance_limit(*largest_tolerance),
        hz = short(mode.frequency_hz), damping = short(mode.damping)
    )]
    NoSolution {
        /// The kind.
        kind: ShaperKind,
        /// The mode.
        mode: Mode,
        /// Tolerance that was asked for.
        tolerance: f64,
        /// Largest damping ratio at which the kind exists for this tolerance.
        largest_damping: f64,
        /// Largest tolerance for which the kind exists at this damping ratio; `None` if it exists for none that is
        /// solved.
        largest_tolerance: Option<f64>,
    },
    /// The finished design does not do what its kind promises, because `f64` cannot resolve its numbers.
    #[error(
        "shaper \"{kind}\" at mode {hz} Hz, damping {damping}: its residual is {found:e} instead of {promised}; \
         the mode is too extreme to compute with",
        hz = short(mode.frequency_hz), damping = short(mode.damping)
    )]
    Unverified {
        /// The kind.
        kind: ShaperKind,
        /// The mode.
        mode: Mode,
        /// Residual of the design.
        found: f64,
        /// Residual that the kind promises.
        promised: f64,
    },
    /// The impulses are not a valid sequence.
    #[error("{what}: {cause}")]
    NoSequence {
        /// The shaper that has these impulses.
        what: String,
        /// The rule that they break.
        cause: ImpulseError,
    },
    /// A convolution has more impulses than any table holds.
    #[error(
        "axis {axis}: the shapers of its modes give {found} impulses, more than {IMPULSES_MAX}; \
         use fewer modes or shorter kinds"
    )]
    TooManyImpulses {
        /// Name of the axis.
        axis: String,
        /// Number of impulses before coincident ones are merged.
        found: usize,
    },
    /// The modes have no common shaper.
    #[error("{0}")]
    Joint(#[from] JointError),
    /// An error about all modes of an axis, with the axis.
    #[error("axis {axis}: shaper \"{kind}\": {cause}")]
    JointOfAxis {
        /// Name of the axis.
        axis: String,
        /// Kind of its shaper.
        kind: ShaperKind,
        /// The error.
        cause: Box<DesignError>,
    },
    /// The listed tables of a family do not cover a part of the range.
    #[error(
        "axis {axis}: no table keeps the residual within the tolerance from {low} to {high}; {needed} tables cover all points: {values}"
    )]
    FamilyGap {
        /// Name of the axis.
        axis: String,
        /// Value at which the range of the tables below ends.
        low: String,
        /// Value at which the range of the tables above begins.
        high: String,
        /// Number of tables that cover the range.
        needed: usize,
        /// Values to write into the file.
        values: String,
    },
    /// A family needs more tables than a driver may hold.
    #[error("axis {axis}: more than {most} tables would be needed to cover all points")]
    FamilySize {
        /// Name of the axis.
        axis: String,
        /// Largest number of tables.
        most: usize,
    },
    /// A table of a family leaves more than the tolerance at its own value, or hardly less.
    #[error(
        "axis {axis}: at {value} the table that is designed for just this value leaves more than the tolerance, or hardly less"
    )]
    FamilyUncovered {
        /// Name of the axis.
        axis: String,
        /// Value of the variable for which the table was designed.
        value: String,
    },
    /// The shaper has no tap table.
    #[error(transparent)]
    Table(#[from] DigitiseError),
}

impl DesignError {
    /// Makes the error for a kind whose impulses at a mode are not a valid sequence.
    pub(super) fn no_sequence(kind: ShaperKind, mode: &Mode, cause: ImpulseError) -> Self {
        DesignError::NoSequence {
            what: format!(
                "shaper \"{kind}\" at mode {} Hz, damping {}",
                short(mode.frequency_hz),
                short(mode.damping)
            ),
            cause,
        }
    }

    /// Checks the residual of a design against what its kind promises.
    pub(super) fn verify(kind: ShaperKind, mode: &Mode, found: f64, promised: f64, accuracy: f64) -> Result<(), Self> {
        if (found - promised).abs() <= accuracy {
            Ok(())
        } else {
            Err(DesignError::Unverified {
                kind,
                mode: *mode,
                found,
                promised,
            })
        }
    }

    /// Checks that a mode can be designed for.
    pub(super) fn check_mode(mode: &Mode) -> Result<(), Self> {
        let frequency = mode.frequency_hz.is_finite() && mode.frequency_hz > 0.0;
        if frequency && (0.0..1.0).contains(&mode.damping) {
            Ok(())
        } else {
            Err(DesignError::Mode { mode: *mode })
        }
    }
}

fn tolerance_limit(largest: Option<f64>) -> String {
    largest.map_or_else(
        || ", with which it exists for no tolerance: ".to_owned(),
        |tolerance| {
            format!(
                ", with which it exists up to tolerance {}: lower the tolerance, or ",
                rounded_down(tolerance)
            )
        },
    )
}

/// Rounds a limit down to four decimals, or to more where it is small, so that the result is still within it.
fn rounded_down(limit: f64) -> String {
    if limit >= 0.01 {
        format!("{}", (limit * 1e4).floor() / 1e4)
    } else {
        format!("{:.3e}", limit * (1.0 - 5e-4))
    }
}
