//! Why a contour cannot be driven.

use thiserror::Error;

/// Why a contour cannot be driven.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ContourError {
    /// Something on a line of a program or of a list of points.
    #[error("line {line}: {found}")]
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// What is there.
        found: String,
        /// What to do about it.
        remedy: String,
    },
    /// Nothing to drive.
    #[error("no path: {0}")]
    Empty(String),
    /// A machine without a plane.
    #[error("a contour takes two axes that move along lengths, and {0}")]
    Axes(String),
    /// A place that an axis does not reach.
    #[error("axis {axis} would go to {found}; its travel is {low} to {high}")]
    Travel {
        /// The axis.
        axis: String,
        /// Where.
        found: String,
        /// The lower end of its travel.
        low: String,
        /// The upper end.
        high: String,
    },
    /// A speed that an axis does not have.
    #[error("a speed of {found}: the slower axis has {most}")]
    Speed {
        /// The speed that is asked for.
        found: String,
        /// The largest.
        most: String,
    },
    /// A radius, a side or a speed that is not a positive number.
    #[error("{what} is {found}: it must be above 0")]
    Size {
        /// What.
        what: &'static str,
        /// The number.
        found: f64,
    },
    /// More samples than are simulated.
    #[error("the contour lasts {seconds:.1} s, more than {most} samples; drive a part of it, or faster")]
    TooLong {
        /// Its duration.
        seconds: f64,
        /// Samples at most.
        most: usize,
    },
}

impl ContourError {
    /// What to do about it, where the message alone does not say.
    pub fn remedy(&self) -> Option<&str> {
        match self {
            Self::Line { remedy, .. } => Some(remedy),
            _ => None,
        }
    }
}
