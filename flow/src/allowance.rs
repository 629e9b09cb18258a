//! A reader that passes on a limited number of bytes and then an error, unless the caller renews its allowance.
//!
//! A CSV reader keeps a whole line in memory, however long it is. With an allowance per line, a file that is not a
//! table causes an error instead of using up the memory.

use std::io::{self, Read};

/// Passes on at most `bytes` of `inner` between two calls of [`Allowance::renew`].
pub(crate) struct Allowance<R> {
    inner: R,
    bytes: u64,
    left: u64,
}

impl<R: Read> Allowance<R> {
    /// Starts with this many bytes.
    pub(crate) fn new(inner: R, bytes: u64) -> Self {
        Self {
            inner,
            bytes,
            left: bytes,
        }
    }

    /// Renews the allowance, because what was read was valid.
    pub(crate) fn renew(&mut self) {
        self.left = self.bytes;
    }
}

impl<R: Read> Read for Allowance<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                format!("a line of more than {} bytes", self.bytes),
            ));
        }
        let read = self.inner.by_ref().take(self.left).read(buffer)?;
        self.left -= read as u64;
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reading_on_without_a_renewal_is_an_error() {
        let mut reader = Allowance::new(io::repeat(1), 10);
        let mut buffer = [0; 8];
        assert_eq!(reader.read(&mut buffer).unwrap(), 8);
        assert_eq!(reader.read(&mut buffer).unwrap(), 2);
        assert!(reader.read(&mut buffer).unwrap_err().to_string().contains("10 bytes"));
        reader.renew();
        assert_eq!(reader.read(&mut buffer).unwrap(), 8);
    }
}
