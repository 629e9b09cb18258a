//! Unpacks FastLZ, which GTKWave's converters use with `-F`.
//!
//! ```text
//!  000nnnnn                      n + 1 bytes follow that are copied
//!  lllooooo [more] oooooooo      l + 2 bytes from o + 1 bytes ago; l = 7 goes on in the next byte
//! ```
//!
//! The upper bits of the first byte are the level: at the second one, a length goes on as long as its bytes are 255, and
//! the largest distance has two more bytes.

/// Largest distance that the second level writes in 13 bits.
const NEAR: usize = 8191;

/// Unpacks exactly `length` bytes and appends them; `None` if they cannot be unpacked.
pub(super) fn unpack(packed: &[u8], length: usize, out: &mut Vec<u8>) -> Option<()> {
    let from = out.len();
    let mut bytes = packed.iter().copied();
    let first = bytes.next()?;
    let is_second_level = match first >> 5 {
        0 => false,
        1 => true,
        _ => return None,
    };
    let mut control = first & 31;
    loop {
        if control < 32 {
            for _ in 0..=control {
                out.push(bytes.next()?);
            }
        } else {
            let mut count = usize::from(control >> 5) + 2;
            let upper = usize::from(control & 31) << 8;
            if count == 9 {
                loop {
                    let more = bytes.next()?;
                    count += usize::from(more);
                    if !is_second_level || more != 255 {
                        break;
                    }
                }
            }
            let lower = bytes.next()?;
            let mut distance = upper + usize::from(lower) + 1;
            if is_second_level && lower == 255 && upper == 31 << 8 {
                distance = NEAR + 1 + usize::from(u16::from_be_bytes([bytes.next()?, bytes.next()?]));
            }
            if distance > out.len() - from || out.len() - from + count > length {
                return None;
            }
            for _ in 0..count {
                out.push(out[out.len() - distance]);
            }
        }
        if out.len() - from > length {
            return None;
        }
        match bytes.next() {
            Some(next) => control = next,
            None => return (out.len() - from == length).then_some(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_levels_unpack_to_hand_computed_bytes() {
        let unpacked = |packed: &[u8], length| {
            let mut out = b"before".to_vec();
            unpack(packed, length, &mut out).map(|()| out.split_off(6))
        };
        // Two bytes, then five from two bytes ago.
        assert_eq!(unpacked(&[1, b'a', b'b', 3 << 5, 1], 7).unwrap(), b"abababa");
        // Nine and three more bytes from one byte ago, then a byte.
        let long = unpacked(&[0, b'a', 7 << 5, 3, 0, 0, b'z'], 14).unwrap();
        assert_eq!(long, b"aaaaaaaaaaaaaz");
        // The second level: 9 + 255 + 1 bytes.
        assert_eq!(unpacked(&[1 << 5, b'a', 7 << 5, 255, 1, 0], 266).unwrap(), [b'a'; 266]);
        // A reference before the beginning, a cut and a wrong length are refused.
        for wrong in [
            &[1, b'a', b'b', 3 << 5, 2][..],
            &[1, b'a', b'b', 3 << 5],
            &[1, b'a'],
            &[3 << 5],
        ] {
            assert_eq!(unpacked(wrong, 7), None);
        }
        assert_eq!(unpacked(&[1, b'a', b'b', 3 << 5, 1], 6), None);
        assert_eq!(unpacked(&[1, b'a', b'b', 3 << 5, 1], 8), None);
    }
}
