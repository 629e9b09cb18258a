//! The line over SPI, with the host as its controller (`docs/spi_bridge.md`).
//!
//! Every byte goes in both directions. Written bytes are sent in one selection, by the flush; a read sends bytes 00 and returns the bytes
//! received meanwhile. Bytes 00 are empty frames to both ends.
//!
//! A [`Link`](crate::Link) writes the delimiter before a frame that it repeats. The line then first reads the rest of a reply from the
//! bridge, in a separate selection, and drops it, because the bridge repeats the reply.

use std::collections::VecDeque;
use std::io::{self, Read, Write};

use posicast_blocks::link::DELIMITER;

/// Bytes that a read sends to receive as many: the reply to a write, 10 bytes, and some for the time that the bridge needs.
const LOOK_BYTES: usize = 16;
/// Number of bytes that is enough to read any rest of a reply from the bridge.
const CLEAR_BYTES: usize = 200;

/// A controller of SPI, mode 0, most significant bit first.
pub trait SpiTransfer {
    /// Sends all bytes in one selection; the bytes received meanwhile replace them.
    ///
    /// # Errors
    /// Those of the operating system.
    fn transfer(&mut self, bytes: &mut [u8]) -> io::Result<()>;
}

/// A line over SPI.
#[derive(Debug)]
pub struct SpiLine<T> {
    controller: T,
    /// Bytes since the last flush.
    going: Vec<u8>,
    /// Bytes that were received and not read yet.
    coming: VecDeque<u8>,
}

impl<T: SpiTransfer> SpiLine<T> {
    /// A line at this controller.
    pub fn new(controller: T) -> Self {
        Self {
            controller,
            going: Vec::new(),
            coming: VecDeque::new(),
        }
    }

    /// The controller.
    pub fn controller(&mut self) -> &mut T {
        &mut self.controller
    }

    fn pass(&mut self, mut bytes: Vec<u8>) -> io::Result<()> {
        self.controller.transfer(&mut bytes)?;
        self.coming.extend(bytes);
        Ok(())
    }
}

impl<T: SpiTransfer> Write for SpiLine<T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.going.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let going = std::mem::take(&mut self.going);
        if going.is_empty() {
            return Ok(());
        }
        if going.first() == Some(&DELIMITER) {
            self.controller.transfer(&mut [DELIMITER; CLEAR_BYTES])?;
            self.coming.clear();
        }
        self.pass(going)
    }
}

impl<T: SpiTransfer> Read for SpiLine<T> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        if self.coming.is_empty() {
            self.pass(vec![DELIMITER; LOOK_BYTES])?;
        }
        self.coming.read(bytes)
    }
}
