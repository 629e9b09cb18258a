//! Why a shaper cannot be designed.

use thiserror::Error;

use super::IMPULSES_MAX;
use super::joint_error::JointError;
use super::kind::ShaperKind;
use crate::digitise::DigitiseError;
use crate::impulse::ImpulseError;
use crate::mode::Mode;
use crate::unit::short;

/// Why a machine has no shapers. Every message names the axis or the mode, what is allowed, and what to do.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DesignError {
    /// A kind that this version parses and does not design.
    #[error("not built in this version: {kind}")]
    NotBuilt {
        /// The kind.
        kind: ShaperKind,
    },
    /// A kind per mode, and no mode.
    #[error(
        "axis {axis}: shaper {kind:?} needs at least one [[axis.mode]]; without modes use kind \"none\" or \"custom\""
    )]
    NoModes {
        /// The axis.
        axis: String,
        /// Its kind.
        kind: String,
    },
    /// A mode whose own shaper is one that serves whole axes.
    #[error(
        "axis {axis}, mode {hz} Hz: shaper \"{kind}\" treats all modes of an axis together; name it in [axis.shaper], \
         or give this mode a kind for one mode, such as zv, zvd or ei",
        hz = short(mode.frequency_hz)
    )]
    JointKindOfOneMode {
        /// The axis.
        axis: String,
        /// The kind.
        kind: ShaperKind,
        /// The mode.
        mode: Mode,
    },
    /// A frequency or damping that no mode has.
    #[error(
        "mode {hz} Hz with damping {damping}: the frequency must be positive and finite, the damping in [0, 1)",
        hz = short(mode.frequency_hz), damping = short(mode.damping)
    )]
    Mode {
        /// The mode.
        mode: Mode,
    },
    /// A tolerance that no EI shaper has.
    #[error("shaper \"{kind}\" at mode {hz} Hz: tolerance {tolerance} is none that it is solved for: take one above {least:e} and below {most}, \
         or \"zv\" or \"zvd\", which need none",
        hz = short(mode.frequency_hz))]
    Tolerance {
        /// The kind.
        kind: ShaperKind,
        /// The mode.
        mode: Mode,
        /// The tolerance found.
        tolerance: f64,
        /// Smallest that is solved.
        least: f64,
        /// Largest that is solved.
        most: f64,
    },
    /// An invalid bias-point shaper.
    #[error(
        "shaper \"{kind}\" with tolerance {tolerance} and order {order}: zv-ei, zv-ei-2, zvd-ei, multi-ei and chebyshev-ei \
         take a tolerance between 0 and 1, both excluded, chebyshev-ei an order of 1 to 5"
    )]
    BiasPoint {
        /// The kind.
        kind: ShaperKind,
        /// Its order.
        order: u32,
        /// The tolerance.
        tolerance: f64,
    },
    /// A damping beyond those that the kind is solved for.
    #[error(
        "shaper \"{kind}\" takes a damping of 0 to {most}; the mode at {hz} Hz has {damping}: use \"{instead}\" for this mode",
        hz = short(mode.frequency_hz), damping = short(mode.damping)
    )]
    Damping {
        /// The kind.
        kind: ShaperKind,
        /// The mode.
        mode: Mode,
        /// Largest damping of the kind.
        most: f64,
        /// A kind that takes this damping.
        instead: ShaperKind,
    },
    /// Newton's method lost the solution on the way to the damping and tolerance.
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
        /// Share of the way, 0 to 1.
        reached: f64,
    },
    /// No shaper of the kind leaves this tolerance at this damping.
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
        /// The tolerance.
        tolerance: f64,
        /// Damping up to which the kind exists for this tolerance.
        largest_damping: f64,
        /// Tolerance up to which the kind exists at this damping; `None` if it exists at none that is solved for.
        largest_tolerance: Option<f64>,
    },
    /// A design that does not do what its kind promises: numbers beyond what `f64` resolves.
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
    /// Impulses that are no shaper.
    #[error("{what}: {cause}")]
    NoSequence {
        /// Which shaper.
        what: String,
        /// The rule that they break.
        cause: ImpulseError,
    },
    /// A convolution beyond all tables.
    #[error(
        "axis {axis}: the shapers of its modes give {found} impulses, more than {IMPULSES_MAX}; \
         use fewer modes or shorter kinds"
    )]
    TooManyImpulses {
        /// The axis.
        axis: String,
        /// Impulses before coincident ones merge.
        found: usize,
    },
    /// Modes without a shaper in common.
    #[error("{0}")]
    Joint(#[from] JointError),
    /// The same, with the axis whose modes they are.
    #[error("axis {axis}: shaper \"{kind}\": {cause}")]
    JointOfAxis {
        /// The axis.
        axis: String,
        /// Its kind.
        kind: ShaperKind,
        /// What is wrong.
        cause: Box<DesignError>,
    },
    /// A family whose tables leave out a part of the range.
    #[error(
        "axis {axis}: no table keeps the residual within the tolerance from {low} to {high}; {needed} tables cover all points: {values}"
    )]
    FamilyGap {
        /// The axis.
        axis: String,
        /// Where the tables below end.
        low: String,
        /// Where the tables above begin.
        high: String,
        /// Tables that cover the range.
        needed: usize,
        /// What to write.
        values: String,
    },
    /// A family of more tables than a driver is to hold.
    #[error("axis {axis}: more than {most} tables would be needed to cover all points")]
    FamilySize {
        /// The axis.
        axis: String,
        /// Most tables.
        most: usize,
    },
    /// A table of a family that leaves too much at its own value.
    #[error(
        "axis {axis}: at {value} the table that is designed for just this value leaves more than the tolerance, or hardly less"
    )]
    FamilyUncovered {
        /// The axis.
        axis: String,
        /// Value of the variable.
        value: String,
    },
    /// A shaper without a tap table.
    #[error(transparent)]
    Table(#[from] DigitiseError),
}

impl DesignError {
    /// Impulses of a kind at a mode that are no shaper.
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

    /// What a design leaves, against what its kind promises.
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

    /// A mode that can be designed for, or the error.
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

/// A limit to four decimals, or as many digits if it is small, that still lies within it.
fn rounded_down(limit: f64) -> String {
    if limit >= 0.01 {
        format!("{}", (limit * 1e4).floor() / 1e4)
    } else {
        format!("{:.3e}", limit * (1.0 - 5e-4))
    }
}
