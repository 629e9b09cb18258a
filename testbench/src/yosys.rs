//! Yosys and its ABC, for the crates that examine a netlist with scripts of their own.

use std::path::Path;
use std::time::Duration;

use crate::Error;
use crate::formal::{ABC, YOSYS, asserted};
pub use crate::tool::WAITED;

/// Runs the Yosys script `script`, a file in `folder`. `doing` describes the task in an error.
///
/// # Errors
/// [`Error::ToolMissing`] without Yosys, [`Error::ToolFailed`] where it stops with an error.
pub fn run_script(folder: &Path, script: &str, doing: &'static str) -> Result<(), Error> {
    let mut yosys = YOSYS.command_in(folder);
    yosys.args(["-q", script]);
    YOSYS.run(&mut yosys, doing).map(drop)
}

/// Runs ABC's commands in `folder` and returns its output; `None` if ABC used more than `limit` of processor time, or took [`WAITED`] times
/// as long.
///
/// # Errors
/// [`Error::ToolMissing`] without ABC, [`Error::ToolFailed`] where it stops with an error.
pub fn abc_within(
    folder: &Path,
    commands: &str,
    doing: &'static str,
    limit: Duration,
) -> Result<Option<String>, Error> {
    ABC.run_within(folder, &["-c", commands], doing, limit)
}

/// Clock of the first counterexample in ABC's output; `None` without one.
pub fn counterexample_clock(printed: &str) -> Option<u32> {
    asserted(printed).next().map(|(_, clock)| clock)
}
