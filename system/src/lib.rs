//! Services of the operating system: temporary folders, other programs, signals, and files with names that a user
//! gave.
//!
//! ```text
//!  scratch ──┐ registers what must not outlive the process
//!  process ──┼─► interrupt ◄── SIGINT, SIGTERM, SIGHUP: ends the programs, removes the folders, exit status 128 + signal
//!  output ───┘
//! ```
//!
//! - [`scratch`]: temporary folders and files that are removed when their value is dropped, and also when a signal
//!   ends the process.
//! - [`process`]: programs in a process group of their own, so that a program ends together with all that it started.
//! - [`tool`]: the executables of external tools, and how a run of one ended.
//! - [`interrupt`]: the list of temporary resources and programs, and the handling of signals.
//! - [`output`]: a file with a name that a user gave. It is written completely or not at all, never replaces an
//!   input, and replaces another file only if posicast wrote that one.
//! - [`kept`]: files that later runs use again, each with its checksum.
//! - [`cores`]: independent pieces of work on all cores.

pub mod cores;
pub mod interrupt;
pub mod kept;
pub mod output;
pub mod process;
pub mod scratch;
pub mod tool;
