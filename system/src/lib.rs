//! What posicast asks of the operating system: temporary folders, other programs, signals, files under a name that a user gave.
//!
//! ```text
//!  scratch ──┐ registers what must not outlive the process
//!  process ──┼─► interrupt ◄── SIGINT, SIGTERM, SIGHUP: ends the programs, removes the folders, exit status 128 + signal
//!  output ───┘
//! ```
//!
//! - [`scratch`]: temporary folders and files that go when their value does, and also when a signal ends the process.
//! - [`process`]: programs that run in a process group of their own, so that a program ends together with all that it started.
//! - [`tool`]: the executables of external tools, and how a run of one came to its end.
//! - [`interrupt`]: the list of both, and what happens on a signal.
//! - [`output`]: a file under a name that a user gave: complete or not at all, never in the place of an input, and in the place
//!   of another file only if posicast wrote that one.

pub mod interrupt;
pub mod output;
pub mod process;
pub mod scratch;
pub mod tool;
