//! A reader that gives up when one command gets too long, before the parser's memory does.

use std::io::{self, BufRead, Read};

/// Bytes that one command may have: a vector of 2^24 bits, twice over.
const COMMAND_BYTES: u64 = 1 << 25;

/// Counts bytes, and refuses more than [`COMMAND_BYTES`] since the last [`Guard::refill`].
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

    fn check(&self) -> io::Result<()> {
        if self.bytes < self.limit {
            return Ok(());
        }
        Err(io::Error::other(format!(
            "one command is longer than {COMMAND_BYTES} bytes: the file is damaged, or a signal is too wide to compare; \
             leave it out when dumping"
        )))
    }
}

impl<R: Read> Read for Guard<R> {
    #[inline]
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.check()?;
        let count = self.inner.read(buffer)?;
        self.bytes += count as u64;
        Ok(count)
    }
}

impl<R: BufRead> BufRead for Guard<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.check()?;
        self.inner.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.bytes += count as u64;
        self.inner.consume(count);
    }
}
