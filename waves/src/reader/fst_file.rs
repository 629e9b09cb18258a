//! The bytes of an FST, and a check of all lengths in it before anything relies on them.
//!
//! The crate `fst-reader` reserves as much memory as a file says that it will need. A damaged file may say anything, and
//! a program that cannot get its memory is ended by the system, so each length is compared here with what the packed
//! bytes can hold. A file that is packed as a whole, as GHDL writes it, is unpacked here for the same reason.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

use flate2::read::GzDecoder;

use super::fst_blocks::{self, Block};
use crate::WaveError;

/// First byte of a file that is packed as a whole.
pub(super) const PACKED: u8 = 254;
/// Largest length of such a file after unpacking, in memory.
const PACKED_BYTES: u64 = 1 << 28;
/// Number of bytes of a block's beginning: kind and length.
const HEAD: u64 = 9;
/// Length of the first block.
const HEADER_LENGTH: u64 = 329;

/// A file, or what was unpacked from it, up to the end of its last complete block.
pub(super) struct Bytes {
    source: Source,
    at: u64,
    end: u64,
}

enum Source {
    File(File),
    Memory(Arc<[u8]>),
}

impl Bytes {
    /// Opens a file, and unpacks it if it is packed as a whole.
    pub(super) fn open(path: &Path) -> Result<Self, WaveError> {
        let read = || -> io::Result<Result<Self, String>> {
            let mut file = File::open(path)?;
            let end = file.metadata()?.len();
            let mut head = [0; 2 * HEAD as usize - 1];
            let count = file.read(&mut head)?;
            if count < head.len() || head[0] != PACKED {
                file.seek(SeekFrom::Start(0))?;
                let source = Source::File(file);
                return Ok(Ok(Self { source, at: 0, end }));
            }
            let length = number(&head, HEAD as usize);
            if length > PACKED_BYTES {
                return Ok(Err(format!(
                    "the file is packed as a whole, {length} bytes, and at most {PACKED_BYTES} are unpacked in memory"
                )));
            }
            let mut unpacked = Vec::new();
            if let Err(cause) = GzDecoder::new(file).take(length).read_to_end(&mut unpacked) {
                return Ok(Err(format!("it cannot be unpacked: {cause}")));
            }
            let end = unpacked.len() as u64;
            if end != length {
                return Ok(Err(format!("it unpacks to {end} bytes instead of {length}")));
            }
            let source = Source::Memory(unpacked.into());
            Ok(Ok(Self { source, at: 0, end }))
        };
        let opened = read().map_err(WaveError::file(path, "read"))?;
        opened.map_err(|what| super::fst::damaged(path, &what))
    }

    /// Returns the same bytes, up to `end`, to be read independently.
    pub(super) fn again(&self, path: &Path, end: u64) -> Result<Self, WaveError> {
        let source = match &self.source {
            Source::File(_) => Source::File(File::open(path).map_err(WaveError::file(path, "open"))?),
            Source::Memory(bytes) => Source::Memory(Arc::clone(bytes)),
        };
        Ok(Self { source, at: 0, end })
    }

    /// Returns the number of bytes.
    pub(super) fn length(&self) -> u64 {
        self.end
    }
}

impl Read for Bytes {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = usize::try_from(self.end.saturating_sub(self.at)).unwrap_or(usize::MAX);
        let room = left.min(buffer.len());
        let count = match &mut self.source {
            Source::File(file) => file.read(&mut buffer[..room])?,
            Source::Memory(bytes) => {
                let from = usize::try_from(self.at).unwrap_or(usize::MAX).min(bytes.len());
                (&bytes[from..]).read(&mut buffer[..room])?
            }
        };
        self.at += count as u64;
        Ok(count)
    }
}

impl Seek for Bytes {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let at = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::End(by) => self.end.checked_add_signed(by),
            SeekFrom::Current(by) => self.at.checked_add_signed(by),
        };
        self.at = at.ok_or(io::ErrorKind::InvalidInput)?;
        if let Source::File(file) = &mut self.source {
            file.seek(SeekFrom::Start(self.at))?;
        }
        Ok(self.at)
    }
}

/// Byte of a block that does not lie within its file, and the reason.
pub(super) type Cut = (u64, String);

/// Walks through all blocks. Returns the first one that does not lie within the file, if there is one. With `chains`, the
/// lengths of the chains of changes are checked, too, which [`fst_blocks::Blocks`] does itself.
///
/// # Errors
/// What is wrong with a length.
pub(super) fn check(bytes: &mut Bytes, chains: bool) -> io::Result<Result<Option<Cut>, String>> {
    let length = bytes.length();
    let mut at = 0;
    while at < length {
        if length - at < HEAD {
            let what = format!("the file ends inside a block at byte {at}: it was cut off");
            return Ok(Ok(Some((at, what))));
        }
        let mut head = [0; HEAD as usize];
        bytes.seek(SeekFrom::Start(at))?;
        bytes.read_exact(&mut head)?;
        let block = Block {
            kind: head[0],
            at: at + 1,
            length: number(&head, 1),
        };
        let next = block.at.checked_add(block.length);
        let Some(next) = next.filter(|next| block.length >= 8 && *next <= length) else {
            // A block that is still being written is marked to be skipped.
            let what = format!(
                "a block of {} bytes at byte {at} does not end in the file: it was cut off",
                block.length
            );
            return Ok(Ok(Some((at, what))));
        };
        let problem = match block.kind {
            0 => (block.length != HEADER_LENGTH).then(|| "the header has another length".to_owned()),
            PACKED => Some("a packed file inside another".to_owned()),
            _ => fst_blocks::problem(bytes, block, chains)?,
        };
        if let Some(what) = problem {
            return Ok(Err(format!("{what}, in the block at byte {at}")));
        }
        at = next;
    }
    Ok(Ok(None))
}

fn number(bytes: &[u8], at: usize) -> u64 {
    bytes[at..at + 8]
        .iter()
        .fold(0, |number, byte| number << 8 | u64::from(*byte))
}
