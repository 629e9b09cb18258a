//! The hierarchy of an FST: scopes, signals and attributes, as bytes with texts that end with a zero.
//!
//! ```text
//!  254 │ kind │ name 0 │ component 0        scope         255        its end
//!  0 … 29 │ direction │ name 0 │ length │ alias           signal; an alias has the values of another one
//!  252 │ kind │ kind │ text 0 │ number      attribute     253        its end
//! ```
//!
//! Attributes give the origin of something or its type in its language; they are not compared.

use std::io::{self, Read};

use flate2::read::GzDecoder;

use super::layout::bytes_at;
use super::packing::{lz4, most_unpacked, varint, word};
use super::{Block, Stop, damaged};
use crate::reader::fst_file::Bytes;

/// Kinds of blocks: packed by gzip, by LZ4, and by LZ4 twice.
const GZIP: u8 = 4;
const LZ4: u8 = 6;
const LZ4_TWICE: u8 = 7;

/// Kinds of entries.
const ATTRIBUTE: u8 = 252;
const ATTRIBUTE_END: u8 = 253;
const SCOPE: u8 = 254;
const SCOPE_END: u8 = 255;
const LAST_SIGNAL: u8 = 29;

/// Bytes before the packed ones: the length of the block and that of the hierarchy.
const HEAD: usize = 16;
/// Largest number of bytes of a hierarchy.
const MOST_BYTES: u64 = 1 << 30;

pub(in crate::reader) enum Entry<'a> {
    Scope { name: &'a [u8] },
    End,
    Signal(Signal<'a>),
}

pub(in crate::reader) struct Signal<'a> {
    /// Type of the variable.
    pub(in crate::reader) kind: u8,
    pub(in crate::reader) name: &'a [u8],
    /// Number of bits; 0 for one of any length.
    pub(in crate::reader) bits: u32,
    pub(in crate::reader) handle: usize,
    pub(in crate::reader) is_alias: bool,
}

/// Whether a block is a hierarchy.
pub(in crate::reader) fn is_hierarchy(block: &Block) -> bool {
    matches!(block.kind, GZIP | LZ4 | LZ4_TWICE)
}

/// Unpacks a hierarchy.
pub(in crate::reader) fn unpack(file: &mut Bytes, block: Block) -> Result<Vec<u8>, Stop> {
    let wrong = || damaged("the hierarchy cannot be unpacked");
    let bytes = bytes_at(file, block, 0, block.length)?;
    let length = word(&bytes, 8).ok_or_else(wrong)?;
    let packed = bytes.get(HEAD..).ok_or_else(wrong)?;
    if length > MOST_BYTES {
        return Err(Stop::Unknown(format!(
            "a hierarchy of {length} bytes, and at most {MOST_BYTES} are read: dump fewer scopes"
        )));
    }
    if length > most_unpacked(packed.len() as u64) {
        return Err(damaged("the hierarchy is longer than its packing can be"));
    }
    let unpacked = match block.kind {
        GZIP => {
            let mut unpacked = Vec::new();
            let read = GzDecoder::new(packed).take(length + 1).read_to_end(&mut unpacked);
            read.ok().filter(|count| *count as u64 == length).map(|_| unpacked)
        }
        LZ4 => lz4(packed, length),
        _ => {
            let mut at = 0;
            let once = varint(packed, &mut at).ok_or_else(wrong)?;
            lz4(&packed[at..], once).and_then(|once| lz4(&once, length))
        }
    };
    unpacked.ok_or_else(wrong)
}

/// Calls `each` for the scopes and signals.
pub(in crate::reader) fn each(bytes: &[u8], mut each: impl FnMut(Entry<'_>) -> Result<(), Stop>) -> Result<(), Stop> {
    let mut rest = Rest { bytes, at: 0 };
    let mut signals = 0;
    while let Some(kind) = rest.byte() {
        let short = || damaged("the hierarchy ends in the middle of an entry");
        match kind {
            SCOPE => {
                rest.byte().ok_or_else(short)?;
                let name = rest.text().ok_or_else(short)?;
                rest.text().ok_or_else(short)?;
                each(Entry::Scope { name })?;
            }
            SCOPE_END => each(Entry::End)?,
            ATTRIBUTE => {
                rest.byte().and_then(|_| rest.byte()).ok_or_else(short)?;
                rest.text().and_then(|_| rest.number()).ok_or_else(short)?;
            }
            ATTRIBUTE_END => {}
            ..=LAST_SIGNAL => {
                rest.byte().ok_or_else(short)?;
                let name = rest.text().ok_or_else(short)?;
                let bits = rest.number().ok_or_else(short)?;
                let alias = rest.number().ok_or_else(short)?;
                let bits = u32::try_from(bits).map_err(|_| damaged("the width of a signal is too large"))?;
                let handle = match usize::try_from(alias).unwrap_or(usize::MAX).checked_sub(1) {
                    None => {
                        signals += 1;
                        signals - 1
                    }
                    Some(other) if other < signals => other,
                    Some(_) => return Err(damaged("a signal aliases one that is declared later or never")),
                };
                each(Entry::Signal(Signal {
                    kind,
                    name,
                    bits,
                    handle,
                    is_alias: alias > 0,
                }))?;
            }
            kind => {
                return Err(Stop::Unknown(format!(
                    "found an entry of unknown kind {kind} in the hierarchy: the file is damaged, or from a newer writer"
                )));
            }
        }
    }
    Ok(())
}

struct Rest<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Rest<'a> {
    fn byte(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.at)?;
        self.at += 1;
        Some(byte)
    }

    fn text(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.at..)?;
        let length = memchr::memchr(0, rest)?;
        self.at += length + 1;
        Some(&rest[..length])
    }

    fn number(&mut self) -> Option<u64> {
        varint(self.bytes, &mut self.at)
    }
}

/// Reads the hierarchy that a writer keeps in a file of its own until it appends it.
pub(in crate::reader) fn beside(file: std::fs::File) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(MOST_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}
