//! Files with names that a user gave.
//!
//! ```text
//!  OutputFiles::claim   before the work: may this name be written?      no: OutputError, exit status 2
//!  Draft            while the work is done: a temporary file beside the name
//!  Draft::put       at the end: sealed and renamed, complete or not at all
//! ```
//!
//! - **An input is never replaced**, whatever its name: another path, a link, a hard link.
//! - **Another file is replaced only if posicast wrote it** and nobody has changed it since, which its [`seal`]
//!   proves. `--force` replaces it all the same.
//! - A link is followed: the file to which it leads is replaced, and the link stays.
//! - `-` is the standard output. That, a pipe or a device is written to at the end; nothing is replaced there.
//!
//! ```
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("plot.svg");
//! # let machine = folder.path().join("machine.toml");
//! # std::fs::write(&machine, "")?;
//! use posicast_system::output::{self, OutputFiles};
//!
//! let mut outputs = OutputFiles::new(false);
//! outputs.input("the machine file", &machine);
//! outputs.claim("--plot", &path)?;
//! assert!(outputs.claim("--plot", &machine).is_err());
//! output::write_text(&path, "<svg></svg>\n")?;
//! assert!(output::is_ours(&path)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod claim;
mod draft;
pub mod seal;
mod target;

pub use claim::{OutputError, OutputFiles};
pub use draft::{Draft, write_text};
pub use seal::is_ours;
