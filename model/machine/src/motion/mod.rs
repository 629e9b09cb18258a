//! Motion commands: a jerk-limited move, its samples, and the integer words that the hardware gets.
//!
//! - [`Profile`]: a point-to-point move in up to seven segments, as fast as the limits allow;
//! - [`AxisMove`]: the move that `run` and `simulate` use where no command file is given: its distance and velocity;
//! - [`compare_move`]: one move behind a shaper, beside one whose jerk time is a period of a mode;
//! - [`Trajectory`]: steps, ramps, trapezoids and such moves as cubics of time, which a shaper keeps exact;
//! - [`resample`]: a command given as points in time, on the sample grid;
//! - [`command_figures`]: peak and rms of a command;
//! - [`command_words`]: positions as Q`command_fraction` counts, rounded half up; a position that does not fit is an
//!   error;
//! - [`modulo_words`]: the same for a modulo axis, including whole turns;
//! - [`plan_move`], [`plan_to_and_fro`], [`plan_circle`], [`plan_places`]: moves as entries of the command FIFO;
//! - [`TickLimits`]: the limits of such moves.
//!
//! The planner works in counts and ticks. Everything else has positions in metres or radians and times in seconds.

mod axis_move;
mod by_period;
mod command;
mod figures;
mod planner;
mod profile;
mod tick_limits;
mod trajectory;
mod words;

pub use axis_move::{AxisMove, AxisMoveError};
pub use by_period::{BetterMove, MoveComparison, MoveFigures, PeriodMove, compare_move};
pub use command::{PointsError, beyond_limits, end_velocity, resample, settle_s};
pub use figures::{CommandFigures, Quantity, command_figures};
pub use planner::{POINTS_MAX, PlanError, plan_circle, plan_move, plan_places, plan_to_and_fro};
pub(crate) use profile::motion_limits;
pub use profile::{Profile, ProfileError, SAMPLES_MAX};
pub use tick_limits::TickLimits;
pub use trajectory::{Cubic, Jump, Piece, Trajectory};
pub use words::{CommandError, command_words, modulo_words};
