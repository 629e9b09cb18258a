//! Motion commands: a jerk-limited move, its samples, and the integer words that the hardware gets.
//!
//! - [`Profile`]: a point-to-point move in up to seven segments, as fast as the limits allow;
//! - [`default_move`]: the 5 mm move that `run` and `simulate` use where no command file is given;
//! - [`Trajectory`]: steps, ramps, trapezoids and such moves as cubics of time, which a shaper keeps exact;
//! - [`resample`]: a command given as points in time, on the sample grid;
//! - [`command_words`]: positions to Q`command_fraction` counts, half up; what does not fit is an error.
//! - [`modulo_words`]: the same for a modulo axis, with whole turns.
//!
//! Positions are in the unit of the machine file (metres, or radians), times in seconds.

mod command;
mod profile;
mod trajectory;
mod words;

pub use command::{PointsError, resample, settle_s};
pub use profile::{Profile, ProfileError, SAMPLES_MAX, default_move};
pub use trajectory::{Cubic, Jump, Piece, Trajectory};
pub use words::{CommandError, command_words, modulo_words};
