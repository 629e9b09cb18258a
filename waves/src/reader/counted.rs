//! How far a reader has come.

use std::io::{self, Read};

/// A file, or what is unpacked of one, that knows how much of it was read.
pub(super) struct Counted {
    pub(super) input: Box<dyn Read + Send>,
    pub(super) bytes: u64,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(buffer)?;
        self.bytes += count as u64;
        Ok(count)
    }
}
