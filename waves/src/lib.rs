//! Compares waveforms of hardware simulations: VCD and FST, of any tools.
//!
//! ```text
//!  a ─► reader ─┐                                            ┌─► text, JSON, JUnit
//!               ├─► diff: which signals, when, how strictly ─┤
//!  b ─► reader ─┘                                            └─► merge, picture: both sides in one file, a drawing
//! ```
//!
//! ```
//! use wavecmp::diff::{self, DiffOptions, DiffVerdict};
//! # let folder = tempfile::tempdir()?;
//! # let [a, b] = ["a.vcd", "b.vcd"].map(|name| folder.path().join(name));
//! # let vcd = |y| format!("$scope module t $end $var wire 1 ! clk $end $var wire 4 \" y $end $upscope $end \
//! #     $enddefinitions $end\n#0\n0!\nb{y} \"\n#5\n1!\n");
//! # std::fs::write(&a, vcd("1010"))?;
//! # std::fs::write(&b, vcd("1011"))?;
//!
//! let result = diff::compare(&a, &b, &DiffOptions::default(), &mut |_progress| {})?;
//! assert_eq!(result.result, DiffVerdict::Different);
//! assert_eq!(result.differences[0].signal, "t.y");
//! println!("{result}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - [`diff`] compares two files and reports which signals differ, since when, and how often.
//! - [`sample`] reads given signals from a file, clock by clock.
//! - [`merge`] puts several files into one, with their differences, for a viewer.
//! - [`files`] lets the caller decide which files may be written.
//! - `damage`, with the feature of this name, damages recordings at random, to test who reads them.
//! - [`wording`] writes counts and times for people.

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "damage")]
pub mod damage;
pub mod diff;
mod error;
pub mod files;
pub mod merge;
mod pile;
mod quiet;
mod reader;
pub mod unit;
pub mod wording;

pub use diff::sample;
pub use error::WaveError;

/// The examples of the README are run, too.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
