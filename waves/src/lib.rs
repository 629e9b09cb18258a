//! Compares waveforms of hardware simulations: VCD and FST, of any tools.
//!
//! ```text
//!  a ─► reader ─┐                                            ┌─► text, JSON, JUnit
//!               ├─► diff: which signals, when, how strictly ─┤
//!  b ─► reader ─┘                                            └─► merge, picture: both sides in one file, a drawing
//! ```
//!
//! - [`diff`] compares two files and reports which signals differ, since when, and how often.
//! - [`sample`] reads given signals from a file, clock by clock.
//! - [`merge`] puts several files into one, with their differences, for a viewer.
//! - [`files`] lets the caller decide which files may be written.
//! - [`wording`] writes counts and times for people.

pub mod diff;
mod error;
pub mod files;
pub mod merge;
mod reader;
pub mod unit;
pub mod wording;

pub use diff::sample;
pub use error::WaveError;
