//! Compares waveforms of hardware simulations: VCD and FST, of whatever tools.
//!
//! ```text
//!  a ─► reader ─┐                                            ┌─► text, JSON, JUnit
//!               ├─► diff: which signals, when, how strictly ─┤
//!  b ─► reader ─┘                                            └─► merge, picture: both sides in one file, a drawing
//! ```
//!
//! - [`diff`] compares two files and says which signals differ, since when, and how often.
//! - [`sample`] reads signals of one's own out of a file, clock by clock.
//! - [`merge`] puts several files into one, with their differences, for a viewer.
//! - [`files`] is where the caller says which files may be written.
//! - [`wording`] counts things and writes times for people.

pub mod diff;
mod error;
pub mod files;
pub mod merge;
mod reader;
pub mod unit;
pub mod wording;

pub use diff::sample;
pub use error::WaveError;
