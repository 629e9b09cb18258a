//! The bytes of an FST, and the blocks in it.
//!
//! A damaged file may state any length, and the system kills a program that asks for too much memory. So each length is compared with what
//! the packed bytes can hold before memory is reserved for it. A file that is packed as a whole, as GHDL writes it, is unpacked here, in
//! memory.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::read::GzDecoder;

use super::fst_blocks::{Block, SKIPPED, Stop};
use crate::WaveError;

/// First byte of a file that is packed as a whole.
pub(super) const PACKED: u8 = 254;
/// Largest length of such a file after unpacking, in memory.
const PACKED_BYTES: u64 = 1 << 28;
/// Number of bytes of a block's beginning: kind and length.
const HEAD: u64 = 9;

/// A file, or what was unpacked from it, up to the end of its last complete block.
pub(super) struct Bytes {
    source: Source,
    at: u64,
    end: u64,
}

enum Source {
    File(File),
    Memory(Vec<u8>),
}

impl Bytes {
    /// Opens a file, and unpacks it if it is packed as a whole.
    pub(super) fn open(path: &Path) -> Result<Self, WaveError> {
        let read = || -> io::Result<Result<Self, Stop>> {
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
                return Ok(Err(Stop::Unknown(format!(
                    "the file is packed as a whole and holds {length} bytes; at most {PACKED_BYTES} are unpacked in memory: let its \
                     writer leave it unpacked, or dump fewer scopes"
                ))));
            }
            let mut unpacked = Vec::new();
            if let Err(cause) = GzDecoder::new(file).take(length).read_to_end(&mut unpacked) {
                return Ok(Err(Stop::Damaged(format!("it cannot be unpacked: {cause}"))));
            }
            let end = unpacked.len() as u64;
            if end != length {
                return Ok(Err(Stop::Damaged(format!(
                    "it unpacks to {end} bytes instead of {length}"
                ))));
            }
            let source = Source::Memory(unpacked);
            Ok(Ok(Self { source, at: 0, end }))
        };
        let opened = read().map_err(WaveError::file(path, "read"))?;
        opened.map_err(|stop| super::fst::refused(path, stop))
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

/// A place from which on a file has no complete block, and the reason.
pub(super) type Cut = (u64, String);

/// Returns the blocks that lie within the file, in its order, and the place at which it was cut off, if it was.
pub(super) fn blocks(bytes: &mut Bytes) -> io::Result<(Vec<Block>, Option<Cut>)> {
    let length = bytes.length();
    let mut blocks = Vec::new();
    let mut at = 0;
    while at < length {
        if length - at < HEAD {
            let what = format!("the file ends inside a block at byte {at}: it was cut off");
            return Ok((blocks, Some((at, what))));
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
            let what = match (block.kind, block.length) {
                (SKIPPED, 0) => {
                    format!("the block at byte {at} was never finished: the writer was stopped, or wrote no time")
                }
                (_, length) => {
                    format!("a block of {length} bytes at byte {at} does not end in the file: it was cut off")
                }
            };
            return Ok((blocks, Some((at, what))));
        };
        blocks.push(block);
        at = next;
    }
    Ok((blocks, None))
}

fn number(bytes: &[u8], at: usize) -> u64 {
    bytes[at..at + 8]
        .iter()
        .fold(0, |number, byte| number << 8 | u64::from(*byte))
}
