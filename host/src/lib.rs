//! The host's end of the link: reads and writes the registers of a stage over a serial line, SPI or a network, and operates its axes.
//!
//! The frames are those of [`posicast_blocks::link`]; the block of `docs/uart_bridge.md` or `docs/spi_bridge.md` is at the other end.
//!
//! - A request that gets no reply in time is sent again with the same sequence number; the bridge executes it once. After
//!   [`LinkOptions::attempts`] the call fails, and it is not known whether a write has been executed.
//! - Calls block. One host, one line: nothing is sent while a reply is awaited.
//! - [`Link::open`] takes a port of the operating system, [`Link::open_udp`] the address of a server in the network; [`Link::new`] any line
//!   that reads and writes bytes, such as an [`SpiLine`].
//!
//! ```no_run
//! use posicast_host::{Link, LinkOptions};
//!
//! let mut link = Link::open("/dev/ttyUSB0", 3_000_000, LinkOptions::default())?;
//! let words = link.read(0, 4)?;
//! link.write_list(&[(16, 1), (20, 7)])?;
//! # Ok::<(), posicast_host::LinkError>(())
//! ```
//!
//! [`HostedStage`] is the stage of a machine file at the other end: it refuses any other stage, and knows the registers by their names.
//!
//! | call | what it does |
//! |---|---|
//! | [`HostedStage::status`] | states, causes and positions of all axes; writes nothing |
//! | [`HostedStage::switch_on`], [`HostedStage::switch_off`] | outputs on and off |
//! | [`HostedStage::move_axes`] | a jerk-limited move of several axes that start together |
//! | [`HostedStage::home`] | homing by a probe |
//! | [`HostedStage::probe`] | a move that ends at an edge of the capture line |
//! | [`HostedStage::correct`] | the steps that a motor has lost, as its scale shows them |
//! | [`HostedStage::arm_compare`], [`HostedStage::disarm_compare`], [`HostedStage::compare_state`] | the position compare |
//! | [`HostedStage::trace`] | signals of an axis, tick by tick |
//! | [`HostedStage::load_table`], [`HostedStage::read_table`] | another tap table, while the axis stands or moves; the table in a bank |
//!
//! [`HostedInline`] is the inline shaper of a machine file: status and counts, no shaping on request, tables.
//!
//! Calls that wait kick the watchdogs of all axes. If the host stops or the link fails, the watchdog stops the machine (`watchdog_s` of the
//! machine file).

mod compare;
mod correct;
mod error;
mod home;
mod host_error;
mod inline;
mod link;
mod moves;
mod probe;
mod spi;
#[cfg(target_os = "linux")]
mod spidev;
mod stage;
mod tables;
mod trace;
mod udp;

pub use compare::CompareState;
pub use correct::HostCorrection;
pub use error::LinkError;
pub use host_error::HostError;
pub use inline::{HostedInline, InlineAxisStatus, InlineStatus};
pub use link::{Line, Link, LinkOptions, LinkStatistics};
pub use moves::HostMove;
pub use probe::{CapturedPositions, Probing};
pub use serialport::SerialPort;
pub use spi::{SpiLine, SpiTransfer};
#[cfg(target_os = "linux")]
pub use spidev::LinuxSpi;
pub use stage::{AxisStatus, HostedStage, causes};
pub use trace::{RecordedSignal, RecordedTrace, Shake, TraceRequest};
pub use udp::UdpLine;
