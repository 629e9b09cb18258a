//! Errors of contours.

use posicast_shaper::unit::short;
use thiserror::Error;

/// Why a machine cannot follow a contour.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ContourError {
    /// A line of a program or of a list of points is invalid.
    #[error("line {line}: {found}")]
    Line {
        /// Number of the line, from 1.
        line: u64,
        /// Description of the problem.
        found: String,
        /// Remedy.
        remedy: String,
    },
    /// There is no path.
    #[error("no path: {0}")]
    Empty(String),
    /// The machine has no plane of two axes.
    #[error("a contour needs two linear axes, but {0}")]
    Axes(String),
    /// The path leaves the travel of an axis.
    #[error("axis {axis} would go to {found}; its travel is {low} to {high}")]
    Travel {
        /// Name of the axis.
        axis: String,
        /// Coordinate that the path reaches.
        found: String,
        /// Lower end of the axis's travel.
        low: String,
        /// Upper end of the axis's travel.
        high: String,
    },
    /// The speed exceeds the limit of an axis.
    #[error("a speed of {found}: the velocity limit of the slower axis is {most}")]
    Speed {
        /// The speed that was asked for.
        found: String,
        /// The largest speed.
        most: String,
    },
    /// The file of the path cannot be read.
    #[error("cannot continue to read after line {line}: {found}")]
    Read {
        /// Number of lines that were read.
        line: u64,
        /// The operating system's message.
        found: String,
    },
    /// A radius, a side or a speed is not a positive number.
    #[error("{what} is {}: it must be above 0", short(*.found))]
    Size {
        /// Name of the quantity.
        what: &'static str,
        /// Value that was found.
        found: f64,
    },
    /// The contour has more samples than are simulated.
    #[error("the contour lasts {seconds:.1} s, more than {most} samples; drive a part of it, or faster")]
    TooLong {
        /// Its duration.
        seconds: f64,
        /// Largest number of samples.
        most: u64,
    },
}

impl ContourError {
    /// Remedy, if the message does not contain it.
    pub fn remedy(&self) -> Option<&str> {
        match self {
            Self::Line { remedy, .. } => Some(remedy),
            _ => None,
        }
    }
}
