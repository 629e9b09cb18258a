//! Numbers and packed bytes in a block.

use flate2::{Decompress, FlushDecompress};

use super::{Stop, damaged, fastlz};

/// Largest number of bytes that LZ4 or FastLZ make of one.
const MOST_BY_LZ: u64 = 256;

/// Returns the largest number of bytes to which so many can unpack: zlib packs by a factor of 1000 at most, LZ4 and FastLZ
/// by less than 300.
pub(super) fn most_unpacked(packed: u64) -> u64 {
    packed.saturating_add(64).saturating_mul(1100)
}

/// Unpacks a chain and appends it.
pub(super) fn unpack_chain(chain: &[u8], packing: u8, out: &mut Vec<u8>) -> Result<(), Stop> {
    let mut at = 0;
    let length = varint(chain, &mut at).ok_or_else(|| damaged("a chain of changes is empty"))?;
    if length == 0 {
        out.extend_from_slice(&chain[at..]);
    } else if packing == b'4' || packing == b'F' {
        let from = out.len();
        let to = from as u64 + length;
        if to > u64::from(u32::MAX) || length > MOST_BY_LZ * (chain.len() as u64 + 64) {
            return Err(damaged("a chain of changes is longer than its packing can be"));
        }
        let wrong = || damaged("a chain of changes cannot be unpacked");
        if packing == b'F' {
            fastlz::unpack(&chain[at..], length as usize, out).ok_or_else(wrong)?;
        } else {
            out.resize(to as usize, 0);
            let count = lz4_flex::block::decompress_into(&chain[at..], &mut out[from..]);
            count.ok().filter(|count| *count as u64 == length).ok_or_else(wrong)?;
        }
    } else {
        // The length of a chain includes this number, but its packed bytes begin after it.
        out.extend(unpacked(&chain[at..], length, false)?);
    }
    if u32::try_from(out.len()).is_err() {
        return Err(damaged("a block unpacks to more than 4 GiB"));
    }
    Ok(())
}

/// Unpacks `length` bytes that LZ4 packed; `None` if it cannot.
pub(super) fn lz4(packed: &[u8], length: u64) -> Option<Vec<u8>> {
    let most = MOST_BY_LZ * (packed.len() as u64 + 64);
    let mut out = vec![0; usize::try_from(length).ok().filter(|_| length <= most)?];
    let count = lz4_flex::block::decompress_into(packed, &mut out).ok()?;
    (count == out.len()).then_some(out)
}

/// Unpacks `length` bytes that zlib packed; where allowed, they may also be stored without packing.
pub(super) fn unpacked(bytes: &[u8], length: u64, may_be_plain: bool) -> Result<Vec<u8>, Stop> {
    if may_be_plain && length == bytes.len() as u64 {
        return Ok(bytes.to_vec());
    }
    let room = usize::try_from(length)
        .ok()
        .filter(|_| length <= most_unpacked(bytes.len() as u64));
    let room = room.ok_or_else(|| damaged("packed data is longer than its packing can be"))?;
    let mut out = Vec::with_capacity(room);
    let unpacked = Decompress::new(true).decompress_vec(bytes, &mut out, FlushDecompress::Finish);
    match unpacked {
        Ok(_) if out.len() == room => Ok(out),
        _ => Err(damaged("packed data cannot be unpacked")),
    }
}

pub(super) fn word(bytes: &[u8], at: usize) -> Option<u64> {
    let mut word = [0; 8];
    word.copy_from_slice(bytes.get(at..at.checked_add(8)?)?);
    Some(u64::from_be_bytes(word))
}

/// A number in seven bits a byte, the lowest first.
#[inline(always)] // most have one byte or two
pub(super) fn varint(bytes: &[u8], at: &mut usize) -> Option<u64> {
    let first = *bytes.get(*at)?;
    *at += 1;
    if first & 0x80 == 0 {
        return Some(u64::from(first));
    }
    let second = *bytes.get(*at)?;
    if second & 0x80 == 0 {
        *at += 1;
        return Some(u64::from(first & 0x7f) | u64::from(second) << 7);
    }
    long_varint(first, bytes, at)
}

fn long_varint(first: u8, bytes: &[u8], at: &mut usize) -> Option<u64> {
    let mut number = u64::from(first & 0x7f);
    let (mut byte, mut shift) = (first, 7);
    while byte & 0x80 != 0 {
        if shift > 63 {
            return None;
        }
        byte = *bytes.get(*at)?;
        *at += 1;
        number |= u64::from(byte & 0x7f) << shift;
        shift += 7;
    }
    Some(number)
}

pub(super) fn signed_varint(bytes: &[u8], at: &mut usize) -> Option<i64> {
    let from = *at;
    let number = varint(bytes, at)?;
    let bits = 7 * (*at - from) as u32;
    let negative = bytes[*at - 1] & 0x40 != 0;
    let sign = if negative { u64::MAX.unbounded_shl(bits) } else { 0 };
    Some((number | sign) as i64)
}
