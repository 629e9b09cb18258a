//! Why a call on the link fails.

use posicast_blocks::link::{LinkStatus, RequestError};
use std::time::Duration;

/// Why a call on the link fails.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The port cannot be opened.
    #[error("{port}: {reason}: is the name right, and may you use it (group dialout)?")]
    Open {
        /// Name of the port.
        port: String,
        /// Reason that the operating system gives.
        reason: String,
    },
    /// The SPI device cannot be opened.
    #[error("{device}: {reason}: {remedy}")]
    Spi {
        /// Name of the device.
        device: String,
        /// Reason that the operating system gives.
        reason: String,
        /// What to check.
        remedy: &'static str,
    },
    /// There is no server for this host.
    #[error("{address}: {reason}")]
    Server {
        /// Address of the server.
        address: String,
        /// Reason that the operating system or the server gives.
        reason: String,
    },
    /// The line fails.
    #[error("the line fails: {0}")]
    Line(#[from] std::io::Error),
    /// No reply, or only damaged ones.
    #[error(
        "no reply in {attempts} attempts of {} ms, {damaged} damaged frames: is the hardware powered, are the wires and the speed of the line right?{}",
        .timeout.as_millis(), if *.written { " A write may have been executed." } else { "" }
    )]
    NoReply {
        /// Number of times that the request was sent.
        attempts: u32,
        /// Time for which each reply was awaited.
        timeout: Duration,
        /// Number of frames that were not a reply.
        damaged: u64,
        /// Whether the request writes.
        written: bool,
    },
    /// The bridge refuses the request. Nothing was read or written.
    #[error("the bridge refuses the request: {0}")]
    Refused(LinkStatus),
    /// The reply has another number of words than requested.
    #[error("received {found} words instead of {asked}: is the other end a bridge of this version?")]
    Words {
        /// Number of words requested.
        asked: usize,
        /// Number of words received.
        found: usize,
    },
    /// The request cannot be sent.
    #[error(transparent)]
    Request(#[from] RequestError),
}
