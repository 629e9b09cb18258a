//! Inputs for shapers, one row of values per clock, without allocation in a clock.
//!
//! - [`Fill`] fills the delay line, one sample per pass, until every tap has been seen.
//! - [`Directed`] plays scripts: the directed cases ([`cases`]) and the corner cases of each size ([`corners`]).
//! - [`Random`] mixes everything at random from a seed, to find what nobody thought of.
//! - [`MotionStimuli`] strobes real command words at a steady rate.
//! - [`ShaperExercise`] lists the taps, banks and flags that a run has not exercised.
//! - [`Coverage`] counts what a run reached, so that a test can require it.
//!
//! All of them work on one shaper (`x`, `valid`, …) and on a machine's top module (`<axis>_x`, …; `rst` and `strobe`
//! shared): [`Layout`] finds the axes by their port names.

mod corners;
mod coverage;
mod directed;
mod exercise;
mod fill;
mod layout;
mod motion;
mod random;

pub use self::corners::corners;
pub use self::coverage::Coverage;
pub use self::directed::{Action, Directed, cases, motion_cases};
pub use self::exercise::ShaperExercise;
pub use self::fill::Fill;
pub use self::layout::{AxisLayout, Layout, TableLayout};
pub use self::motion::MotionStimuli;
pub use self::random::Random;
