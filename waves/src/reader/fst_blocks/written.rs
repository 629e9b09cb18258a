//! A change as it is written in a chain.

use super::Form;
use super::packing::varint;

/// Digits of a signal of one bit other than 0 and 1.
const DIGITS: &[u8; 8] = b"xzhuwl-?";

/// A value as it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Written<'a> {
    /// One bit: as in [`crate::reader::digits`]; from 4 on, 4 more than the place of one of VHDL's in [`digit_byte`].
    Digit(u8),
    /// Known bits, eight in a byte, the first in the upper bit.
    Known(&'a [u8]),
    /// Digits, one in a byte.
    Digits(&'a [u8]),
    /// The bytes of a real number.
    Real(&'a [u8]),
    Text(&'a [u8]),
}

/// Returns the character of [`Written::Digit`].
pub(super) fn digit_byte(digit: u8) -> u8 {
    match digit {
        0 | 1 => b'0' + digit,
        other => DIGITS[usize::from(other - 2) & 7],
    }
}

/// A change in a chain.
#[derive(Debug, Clone, Copy)]
pub(super) struct Change<'a> {
    /// How many times later it is than the one before.
    pub(super) step: u64,
    pub(super) value: Written<'a>,
    /// Number of its bytes.
    pub(super) length: usize,
}

/// Returns the first change of a chain; `None` if it is cut off or invalid.
#[inline(always)] // a call for each change takes as long as the rest of it
pub(super) fn change(chain: &[u8], form: Form) -> Option<Change<'_>> {
    let mut at = 0;
    let head = varint(chain, &mut at)?;
    let take = |at: usize, length: usize| Some((chain.get(at..at.checked_add(length)?)?, at + length));
    let step = match form {
        Form::Bits(1) => head >> (2 << (head & 1)),
        _ => head >> 1,
    };
    let (value, length) = match form {
        Form::Bits(1) => {
            let digit = match head & 1 {
                0 => head >> 1 & 1,
                _ => (head >> 1 & 7) + 2,
            };
            (Written::Digit(digit as u8), at)
        }
        Form::Bits(width) if head & 1 == 0 => {
            let (bytes, end) = take(at, width.div_ceil(8) as usize)?;
            (Written::Known(bytes), end)
        }
        Form::Bits(width) => {
            let (digits, end) = take(at, width as usize)?;
            (Written::Digits(digits), end)
        }
        Form::Real if head & 1 == 0 => return None,
        Form::Real => {
            let (bytes, end) = take(at, 8)?;
            (Written::Real(bytes), end)
        }
        Form::Text => {
            let length = usize::try_from(varint(chain, &mut at)?).ok()?;
            let (text, end) = take(at, length)?;
            (Written::Text(text), end)
        }
    };
    Some(Change { step, value, length })
}
