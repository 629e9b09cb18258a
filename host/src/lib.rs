//! The host's end of the link: reads and writes the registers of a stage over a serial line.
//!
//! The frames are those of [`posicast_model::link`], the other end is the block of `docs/uart_bridge.md`.
//!
//! - A request that gets no reply in time is sent again with the same sequence number; the bridge executes it once. After
//!   [`LinkOptions::attempts`] the call fails, and it is not known whether a write has been executed.
//! - Calls block. One host, one line: nothing is sent while a reply is awaited.
//! - [`Link::open`] takes a port of the operating system; [`Link::new`] any line that reads and writes bytes.
//!
//! ```no_run
//! use posicast_host::{Link, LinkOptions};
//!
//! let mut link = Link::open("/dev/ttyUSB0", 3_000_000, LinkOptions::default())?;
//! let words = link.read(0, 4)?;
//! link.write_list(&[(16, 1), (20, 7)])?;
//! # Ok::<(), posicast_host::LinkError>(())
//! ```

mod error;
mod link;

pub use error::LinkError;
pub use link::{Link, LinkOptions, LinkStatistics};
