//! Whether what a block says of its lengths can be true, before memory is reserved for it.

use std::io;

use super::layout::{Layout, MOST_HANDLES, bytes_at};
use super::packing::{most_unpacked, varint, word};
use super::{Block, CHANGES, CHANGES_ALIAS, CHANGES_ALIAS_2, GEOMETRY, Stop};
use crate::reader::fst_file::Bytes;

/// Kinds of blocks, beside those of [`super`].
const BLACKOUT: u8 = 2;
const HIERARCHY_GZIP: u8 = 4;
const HIERARCHY_LZ4: u8 = 6;
const HIERARCHY_LZ4_TWICE: u8 = 7;
const SKIPPED: u8 = 255;

/// Returns what is wrong with the lengths in a block that lies within the file; `None` if they can be true. With `chains`,
/// the chains of changes are checked, too.
pub(in crate::reader) fn problem(file: &mut Bytes, block: Block, chains: bool) -> io::Result<Option<String>> {
    let short = || Ok(Some("it ends too early".to_owned()));
    let head = bytes_at(file, block, 0, 40)?;
    let unpacked = word(&head, 8).unwrap_or(0);
    let fits = |unpacked: u64, packed: u64| unpacked <= most_unpacked(packed);
    let right = match block.kind {
        CHANGES | CHANGES_ALIAS | CHANGES_ALIAS_2 => return changes(file, block, chains),
        BLACKOUT => {
            let mut at = 8;
            varint(&head, &mut at).is_some_and(|count| count <= block.length)
        }
        GEOMETRY => {
            let Some(packed) = block.length.checked_sub(24) else {
                return short();
            };
            // Each signal takes a byte at least.
            fits(unpacked, packed) && word(&head, 16).is_some_and(|handles| handles <= unpacked.min(MOST_HANDLES))
        }
        HIERARCHY_GZIP | HIERARCHY_LZ4 => {
            let Some(packed) = block.length.checked_sub(16 + 10) else {
                return short();
            };
            fits(unpacked, packed)
        }
        HIERARCHY_LZ4_TWICE => {
            let mut at = 16;
            let (Some(once), Some(packed)) = (varint(&head, &mut at), block.length.checked_sub(16)) else {
                return short();
            };
            fits(once, packed) && fits(unpacked, once)
        }
        SKIPPED => true,
        kind => return Ok(Some(format!("a kind of block that is not known, {kind}"))),
    };
    Ok((!right).then(|| "it says that it holds more than it can".to_owned()))
}

fn changes(file: &mut Bytes, block: Block, chains: bool) -> io::Result<Option<String>> {
    let Some(layout) = Layout::read(file, block)? else {
        return Ok(Some("it ends too early".to_owned()));
    };
    match layout.check(file, chains) {
        Ok(()) => Ok(None),
        Err(Stop::Io(cause)) => Err(cause),
        Err(Stop::Damaged(what)) => Ok(Some(what)),
        Err(Stop::Unheard) => Ok(None),
    }
}
