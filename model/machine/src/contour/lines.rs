//! Lines of a file of any size, in bounded memory.

use super::ContourError;
use std::io::{BufRead, Read};

/// Largest number of bytes that are kept of a line.
pub(super) const LINE_BYTES: u64 = 1 << 16;

/// Lines of bounded length.
pub(super) struct Lines<R> {
    source: R,
    /// The last line, with its end.
    pub(super) text: Vec<u8>,
    /// Its number, from 1.
    pub(super) number: u64,
    /// Whether the line is longer than what was kept of it.
    pub(super) is_cut: bool,
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(source: R) -> Self {
        Self {
            source,
            text: Vec::new(),
            number: 0,
            is_cut: false,
        }
    }

    /// Reads the next line; returns whether there is one.
    pub(super) fn next(&mut self) -> Result<bool, ContourError> {
        self.text.clear();
        let read = (&mut self.source).take(LINE_BYTES).read_until(b'\n', &mut self.text);
        let mut found = read.map_err(|error| self.failed(&error))?;
        if found == 0 {
            return Ok(false);
        }
        self.number += 1;
        self.is_cut = found as u64 == LINE_BYTES && self.text.last() != Some(&b'\n');
        let mut rest = Vec::new();
        while self.is_cut && found > 0 && rest.last() != Some(&b'\n') {
            rest.clear();
            let read = (&mut self.source).take(LINE_BYTES).read_until(b'\n', &mut rest);
            found = read.map_err(|error| self.failed(&error))?;
        }
        Ok(true)
    }

    fn failed(&self, error: &std::io::Error) -> ContourError {
        ContourError::Read {
            line: self.number,
            found: error.to_string(),
        }
    }
}
