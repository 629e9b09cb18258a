//! Why there is no bitstream, or no comparison.

use std::path::{Path, PathBuf};
use std::time::Duration;

/// Why there is no bitstream, or no comparison.
#[derive(Debug, thiserror::Error)]
pub enum BitstreamError {
    /// No board has this name.
    #[error("--board {found}: there is no such board; allowed: {known}")]
    UnknownBoard {
        /// The name.
        found: String,
        /// The names of all boards.
        known: String,
    },
    /// The shaper of the axis of this name has no tap tables, by which the bits are compared.
    #[error(
        "axis {0} is a cascade of half sums; allowed: shapers with taps, by whose tables the bits are compared: remove `structure` from its \
         [axis.shaper]"
    )]
    Cascade(String),
    /// The results do not fit between two samples on the serial line.
    #[error(
        "the serial line of {board} cannot carry every sample: a frame takes {frame_clocks} clocks, and samples are {sample_clocks} \
         clocks apart; allowed: at most {highest_hz} Hz with {axes} axes of {word_bits} bits"
    )]
    LineTooSlow {
        /// Name of the board.
        board: &'static str,
        /// Clocks of a frame.
        frame_clocks: u32,
        /// Clocks between two samples.
        sample_clocks: u32,
        /// Highest sample rate at which the frame fits.
        highest_hz: u32,
        /// Number of axes.
        axes: usize,
        /// Width of a command word.
        word_bits: u32,
    },
    /// The synthesised design needs more of a resource than the device has.
    #[error("does not fit {device}: {needed} {resource} needed, {available} available, {} too few", .needed - .available)]
    TooLarge {
        /// Name of the device.
        device: &'static str,
        /// Name of the resource.
        resource: &'static str,
        /// Amount that the design needs.
        needed: u64,
        /// Amount that the device has.
        available: u64,
    },
    /// The board's headers have too few pins for the top's ports.
    #[error("does not fit {board}: {needed} pins needed, {available} available on its headers")]
    TooManyPins {
        /// Name of the board.
        board: &'static str,
        /// Pins that the top needs.
        needed: usize,
        /// Pins that the headers have.
        available: usize,
    },
    /// Programs are not installed.
    #[error("{}", .0.iter().map(|name| format!("{name}: not found; a bitstream needs it: `posicast doctor` says how to install it")).collect::<Vec<_>>().join("\n"))]
    Missing(Vec<&'static str>),
    /// A program failed.
    #[error("{tool} failed while {doing}:\n{last_lines}")]
    ToolFailed {
        /// Name of the program.
        tool: &'static str,
        /// Its task.
        doing: &'static str,
        /// Last lines of its output.
        last_lines: String,
    },
    /// A program did not finish in time.
    #[error("{tool} did not finish within {} s while {doing}", .limit.as_secs())]
    TimeOut {
        /// Name of the program.
        tool: &'static str,
        /// Its task.
        doing: &'static str,
        /// Its time limit.
        limit: Duration,
    },
    /// A result of a program is not what this crate knows.
    #[error("the result of {tool} is not of the known form: {reason}")]
    Unreadable {
        /// Name of the program.
        tool: &'static str,
        /// What was found.
        reason: String,
    },
    /// The netlist of the bits has something that this crate does not know.
    #[error("the netlist of the bits has something that is not known here, so nothing is compared: {0}")]
    UnknownCell(String),
    /// A packed file that was given is not of this design.
    #[error("{}: {reason}", .path.display())]
    NotThisDesign {
        /// The file.
        path: PathBuf,
        /// What it is, and what is expected.
        reason: String,
    },
    /// The operating system reported an error.
    #[error("{}: {source}", .path.display())]
    Io {
        /// File or program.
        path: PathBuf,
        /// The error.
        source: std::io::Error,
    },
}

/// Adds the path to an error of the operating system.
pub(crate) fn at(path: &Path) -> impl FnOnce(std::io::Error) -> BitstreamError {
    let path = path.to_owned();
    move |source| BitstreamError::Io { path, source }
}
