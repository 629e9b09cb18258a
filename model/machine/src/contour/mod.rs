//! Contours of two axes: where and by how much a machine leaves its commanded path.
//!
//! ```text
//! circle, square, points, G-code ─► Stroke ─► corners ─► plan ─► tap tables ─► modes ─► distance from the path
//!                                   lines,    speeds      ramps, samples   (design)    (plant)    along its normal
//!                                   arcs      without a   in time
//!                                             stop
//! ```
//!
//! - [`Stroke`]: a line or an arc, with its speed;
//! - [`shapes`] and [`gcode`]: strokes of a circle, a square, a list of points, a program, the last two line by line;
//! - [`CornerRules`]: how fast bends are passed;
//! - [`Survey`]: length, duration, stops and extent of a planned path; [`Contour`]: a planned path in memory;
//! - [`compare`]: the error of each kind of shaper, in memory that does not depend on the length of the path;
//!   [`follow`]: that of one machine.
//!
//! Lengths are in m, or rad, of the first two axes; times in s.

mod comparison;
mod corners;
mod envelope;
mod error;
mod follow;
pub mod gcode;
mod lines;
mod path;
mod plan;
mod ramp;
pub mod shapes;
mod stroke;

pub use comparison::{ContourRow, FREQUENCY_FACTORS, compare};
pub use corners::CornerRules;
pub use envelope::Envelope;
pub use error::ContourError;
pub use follow::{FollowedContour, follow, judged};
pub use plan::{Contour, ContourLimits, ContourSample, Survey};
pub use stroke::{PlanePoint, Shape, Stroke};
