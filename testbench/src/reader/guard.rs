//! A reader that gives up when one command gets too long, before the parser's memory does.

use std::io::{self, Read};

/// Bytes that one command may have: a vector of 2^24 bits, twice over.
const COMMAND_BYTES: u64 = 1 << 25;

/// Counts bytes, and refuses more than [`COMMAND_BYTES`], and what the buffer above holds, since the last
/// [`Guard::refill`].
pub(super) struct Guard<R> {
    inner: R,
    bytes: u64,
    limit: u64,
}

impl<R> Guard<R> {
    pub(super) fn new(inner: R) -> Self {
        Self {
            inner,
            bytes: 0,
            limit: COMMAND_BYTES,
        }
    }

    /// A new command begins.
    pub(super) fn refill(&mut self) {
        self.limit = self.bytes + COMMAND_BYTES;
    }

    /// Bytes read so far.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl<R: Read> Read for Guard<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.bytes >= self.limit {
            return Err(io::Error::other(format!(
                "one command is longer than {COMMAND_BYTES} bytes: the file is damaged, or a signal is too wide to \
                 compare; leave it out when dumping"
            )));
        }
        let count = self.inner.read(buffer)?;
        self.bytes += count as u64;
        Ok(count)
    }
}
