//! Consistent overhead byte stuffing (S. Cheshire, M. Baker, *Consistent Overhead Byte Stuffing*, 1999): bytes without
//! the byte 0, which is then free to end a frame.
//!
//! ```text
//! 11 22 00 33  ─►  03 11 22 02 33        each 0 becomes the distance to the next; the first byte is that to the first
//! ```
//!
//! A frame has at most [`MOST_BYTES`] bytes, so that no distance exceeds 254, and the code 255 (254 bytes without a 0
//! behind them) never occurs: a decoder refuses it.

/// Most bytes that [`encode`] takes.
pub const MOST_BYTES: usize = 253;
/// The code that never occurs.
pub const UNUSED_CODE: u8 = 0xff;

/// Encodes bytes: one more, none of them 0.
///
/// `None` for more than [`MOST_BYTES`].
pub fn encode(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut encoded = vec![0];
    let mut code_at = 0;
    for byte in bytes {
        if *byte == 0 {
            encoded[code_at] = u8::try_from(encoded.len() - code_at).ok()?;
            code_at = encoded.len();
        }
        encoded.push(*byte);
    }
    encoded[code_at] = u8::try_from(encoded.len() - code_at).ok()?;
    (bytes.len() <= MOST_BYTES).then_some(encoded)
}

/// Decodes what [`encode`] gave. `None` for anything else.
pub fn decode(encoded: &[u8]) -> Option<Vec<u8>> {
    let mut decoded = Vec::new();
    let mut rest = encoded;
    loop {
        let (&code, behind) = rest.split_first()?;
        let taken = behind.get(..usize::from(code).checked_sub(1)?)?;
        if code == UNUSED_CODE || taken.contains(&0) {
            return None;
        }
        decoded.extend_from_slice(taken);
        rest = &behind[taken.len()..];
        if rest.is_empty() {
            return (decoded.len() <= MOST_BYTES).then_some(decoded);
        }
        decoded.push(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of the paper and of its article in Wikipedia, as far as they have at most 253 bytes.
    #[test]
    fn golden_examples_of_others() {
        let examples: [(&[u8], &[u8]); 7] = [
            (&[], &[1]),
            (&[0], &[1, 1]),
            (&[0, 0], &[1, 1, 1]),
            (&[0, 0x11, 0], &[1, 2, 0x11, 1]),
            (&[0x11, 0x22, 0, 0x33], &[3, 0x11, 0x22, 2, 0x33]),
            (&[0x11, 0x22, 0x33, 0x44], &[5, 0x11, 0x22, 0x33, 0x44]),
            (&[0x11, 0, 0, 0], &[2, 0x11, 1, 1, 1]),
        ];
        for (bytes, encoded) in examples {
            assert_eq!(encode(bytes).as_deref(), Some(encoded));
            assert_eq!(decode(encoded).as_deref(), Some(bytes));
        }
    }

    #[test]
    fn the_longest_frame_and_one_byte_more() {
        let longest = [7; MOST_BYTES];
        let encoded = encode(&longest).unwrap();
        assert_eq!((encoded.len(), encoded[0]), (MOST_BYTES + 1, 254));
        assert_eq!(decode(&encoded).unwrap(), longest);
        assert_eq!(encode(&[7; MOST_BYTES + 1]), None);
        assert_eq!(decode(&[7; MOST_BYTES + 2]), None);
    }

    #[test]
    fn invalid_encodings_are_refused() {
        for wrong in [&[][..], &[0], &[3, 1], &[2, 0], &[1, 3, 5], &[255]] {
            assert_eq!(decode(wrong), None, "{wrong:?}");
        }
    }
}
