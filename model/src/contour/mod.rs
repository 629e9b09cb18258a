//! Contours of two axes: where and by how much a machine leaves its commanded path.
//!
//! ```text
//! circle, square, points, G-code ─► Stroke ─► Contour ─► Plan ─► tap tables ─► modes ─► distance from the path
//!                                   lines,    runs        samples    (design)    (plant)    along its normal
//!                                   arcs      without a   in time
//!                                             stop
//! ```
//!
//! - [`Stroke`]: a line or an arc, with its speed;
//! - [`shapes`] and [`gcode`]: strokes of a circle, a square, a list of points, a program;
//! - [`Contour`]: the strokes as runs between stops, within the limits of both axes;
//! - [`follow`]: a simulated machine on the contour, and its error; [`compare`]: the error of each kind of shaper.
//!
//! Lengths are in m, or rad, of the first two axes; times in s.

mod comparison;
mod error;
mod follow;
pub mod gcode;
mod plan;
pub mod shapes;
mod stroke;

pub use comparison::{ContourRow, FREQUENCY_FACTORS, compare};
pub use error::ContourError;
pub use follow::{FollowedContour, command, follow, judged};
pub use plan::{Contour, ContourLimits, ContourSample};
pub use stroke::{PlanePoint, Shape, Stroke};
