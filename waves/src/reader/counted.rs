//! Counts how far a reader has come.

use std::io::{self, Read};

/// A file, or its unpacked contents, that counts the bytes read from it.
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
