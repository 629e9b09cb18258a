//! Finds vibration modes in logs of a machine's motion.
//!
//! ```text
//! log (CSV) ─► log ─┬─► sweep      accelerometer, driven by a known sweep ─┐
//!                   ├─► position   time, command, response                ─┼─► FoundMode with its uncertainty ─► recommend
//!                   └─► position::motor   drive and its own motor          ─┘
//! ```
//!
//! Every method states the uncertainty of each mode ([`FoundMode::frequency_sd_hz`]), and what the log does not
//! determine, with the reason.

pub mod found;
pub mod log;
pub mod modal;
pub mod output_only;
mod parallel;
pub mod position;
pub mod recommend;
pub mod ring_down;
mod separable;
pub mod signal;
pub mod spectrum;
pub mod sweep;
pub mod synthetic;
pub mod trial;

pub use found::{FoundMode, Interval};
pub use signal::{AccelerationLog, Between, DriveLog, PositionLog};
