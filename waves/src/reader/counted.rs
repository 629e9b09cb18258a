//! Counts how far a reader has come.

use std::fs::File;
use std::io::{self, Read};

/// A file that counts the bytes read from it.
pub(super) struct Counted {
    pub(super) file: File,
    pub(super) bytes: u64,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.bytes += count as u64;
        Ok(count)
    }
}
