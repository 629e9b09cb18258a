//! Lines of a VCD of the two commonest forms: one bit, `1!` or `x"a`, and a vector of at most 64 bits, `b10x0 $`.
//!
//! The time of a comparison grows with the number of changes, so these forms are recognised with few loads and one table for the id code.
//! All other lines are left to [`super::section`].

use super::digits::{DIGITS, extended, known_run, mixed_run, run_end};
use super::header::Kind;
use super::ids::Ids;

/// What a table has for an id code: the slot, shifted, and one of these.
const SHIFT: u32 = 3;
const FORM: u32 = 7;
/// A signal of one bit.
const BIT: u32 = 0;
/// The watched clock, of one bit.
const CLOCK: u32 = 1;
/// A vector of at most 64 bits.
const WORD: u32 = 2;
/// Anything else.
const OTHER: u32 = 3;
/// The slot of all signals that are left out.
const LEFT_OUT: u32 = 4;

/// Id codes of one to three characters have numbers below this.
const NUMBERS: u64 = 94 + 94 * 94 + 94 * 94 * 94 + 1;

/// Slots by id code.
pub(super) struct Lines {
    /// By the only character.
    one: [u32; 256],
    /// By number, see [`Ids`].
    more: Vec<u32>,
    /// By character: its part of a number as the first, second or third; beyond all numbers for a character that no id code may have.
    parts: [[u32; 256]; 3],
    /// Width by slot.
    widths: Vec<u32>,
    /// Whether any signal is left out.
    has_left_out: bool,
}

/// A line that changes one bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct BitLine {
    pub(super) slot: u32,
    /// Bit 0 is the value, bit 1 tells whether it is unknown.
    pub(super) digit: u8,
    pub(super) is_clock: bool,
    /// The byte after the id code, and the position after that byte.
    pub(super) end: u8,
    pub(super) next: usize,
}

/// A line that changes a vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct WordLine {
    pub(super) slot: u32,
    pub(super) word: u64,
    /// The unknown bits.
    pub(super) unknown: u64,
    /// The byte after the id code, and the position after that byte.
    pub(super) end: u8,
    pub(super) next: usize,
}

impl Lines {
    /// `kinds` has the kind by slot; `is_other` returns whether a slot's lines are always left to the general reader.
    pub(super) fn new(ids: &Ids, kinds: &[Kind], clock: Option<u32>, is_other: impl Fn(u32) -> bool) -> Self {
        let form = |slot: u32| match kinds[slot as usize] {
            _ if is_other(slot) => OTHER,
            _ if ids.left_out == Some(slot) => LEFT_OUT,
            Kind::Bits(1) if clock == Some(slot) => CLOCK,
            Kind::Bits(1) => BIT,
            Kind::Bits(2..=64) => WORD,
            _ => OTHER,
        };
        let entry = |number: u64| ids.get(number).map_or(OTHER, |slot| slot << SHIFT | form(slot));
        let character = |byte: usize| u8::try_from(byte).ok().filter(|byte| (b'!'..=b'~').contains(byte));
        let one = std::array::from_fn(|byte| character(byte).map_or(OTHER, |byte| entry(u64::from(byte - b' '))));
        let part = |byte: usize, scale: u32| character(byte).map_or(1 << 24, |byte| u32::from(byte - b' ') * scale);
        let parts = [1, 94, 94 * 94].map(|scale| std::array::from_fn(|byte| part(byte, scale)));
        let most = ids.most().map_or(0, |most| (most + 1).min(NUMBERS));
        let width = |kind: &Kind| match kind {
            Kind::Bits(width) => *width,
            Kind::Real | Kind::Text | Kind::Event | Kind::Any(_) => 0,
        };
        Self {
            one,
            more: (0..most).map(entry).collect(),
            parts,
            widths: kinds.iter().map(width).collect(),
            has_left_out: ids.left_out.is_some(),
        }
    }

    /// Returns the entry of the id code that these bytes begin with, and its length.
    #[inline(always)] // a call for each change takes as long as the rest of it
    fn entry(&self, bytes: u64) -> Option<(u32, usize)> {
        let byte = |at: u32| (bytes >> (8 * at)) as u8;
        if byte(1) <= b' ' {
            return Some((self.one[byte(0) as usize], 1));
        }
        let [first, second, third] = &self.parts;
        let number = first[byte(0) as usize] + second[byte(1) as usize];
        let (number, length) = if byte(2) <= b' ' {
            (number, 2)
        } else if byte(3) <= b' ' {
            (number + third[byte(2) as usize], 3)
        } else {
            return None;
        };
        Some((*self.more.get(number as usize)?, length))
    }

    /// Returns the line at `at` if it changes one bit, and at least eight bytes are left.
    #[inline(always)]
    pub(super) fn bit(&self, data: &[u8], at: usize) -> Option<BitLine> {
        let line = eight(data, at)?;
        let digit = DIGITS[line as u8 as usize];
        if digit > 3 {
            // Not a digit, or one of VHDL's states, which must be noted.
            return None;
        }
        let (entry, length) = self.entry(line >> 8)?;
        (entry & FORM <= CLOCK).then_some(BitLine {
            slot: entry >> SHIFT,
            digit,
            is_clock: entry & FORM == CLOCK,
            end: (line >> (8 * (1 + length))) as u8,
            next: at + 2 + length,
        })
    }

    /// Returns the position after the line at `at`, if it changes a signal that is left out, and enough bytes are left.
    #[inline]
    pub(super) fn left_out(&self, data: &[u8], at: usize) -> Option<usize> {
        if !self.has_left_out {
            return None;
        }
        let mut id_at = at + 1;
        if *data.get(at)? == b'b' {
            let space = run_end(data, at + 1);
            if space == at + 1 || *data.get(space)? != b' ' {
                return None;
            }
            id_at = space + 1;
        } else if DIGITS[usize::from(data[at])] > 3 {
            return None;
        }
        let (entry, length) = self.entry(eight(data, id_at)?)?;
        (entry & FORM == LEFT_OUT).then_some(id_at + length + 1)
    }

    /// Returns the line at `at` if it changes a vector, and enough bytes are left.
    #[inline(always)]
    pub(super) fn word(&self, data: &[u8], at: usize) -> Option<WordLine> {
        if *data.get(at)? != b'b' {
            return None;
        }
        let (mut word, mut space) = known_run(data, at + 1);
        let mut unknown = 0;
        let is_known = *data.get(space)? == b' ';
        if !is_known {
            ([word, unknown], space) = mixed_run(word, data, space);
            if *data.get(space)? != b' ' {
                return None;
            }
        }
        let id = eight(data, space + 1)?;
        let (entry, length) = self.entry(id)?;
        let (slot, digits) = (entry >> SHIFT, space - at - 1);
        let width = *self.widths.get(slot as usize)?;
        if entry & FORM != WORD || digits == 0 || digits > width as usize {
            return None;
        }
        if !is_known {
            [word, unknown] = extended([word, unknown], digits as u32, width);
        }
        Some(WordLine {
            slot,
            word,
            unknown,
            end: (id >> (8 * length)) as u8,
            next: space + 2 + length,
        })
    }
}

#[inline(always)]
fn eight(data: &[u8], at: usize) -> Option<u64> {
    let mut bytes = [0; 8];
    bytes.copy_from_slice(data.get(at..at + 8)?);
    Some(u64::from_le_bytes(bytes))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::reader::digits::{digit, is_state};

    proptest! {
        #[test]
        fn prop_lines_match_reading_byte_by_byte(
            known in prop::collection::btree_set("[!-~]{1,4}", 1..40),
            which: prop::sample::Index,
            first in prop::sample::select(b"01xXzZuU-b#$".to_vec()),
            digits in "[01x]{1,9} ?",
            other in "[ -~\n]{0,4}",
            is_other: bool,
            widths in prop::collection::vec(prop::sample::select(vec![1u32, 1, 2, 8, 64, 65]), 40),
            clock: prop::sample::Index,
            left_out in prop::option::of(any::<prop::sample::Index>()),
        ) {
            let known: Vec<String> = known.into_iter().collect();
            let mut ids = Ids::default();
            for (id, slot) in known.iter().zip(0..) {
                ids.insert(id.as_bytes(), slot);
            }
            let kinds: Vec<Kind> = widths.iter().map(|width| Kind::Bits(*width)).collect();
            ids.left_out = left_out.map(|at| at.index(known.len()) as u32);
            let is_left_out = |slot: u32| ids.left_out == Some(slot);
            let clock = clock.index(known.len()) as u32;
            let lines = Lines::new(&ids, &kinds, Some(clock), |_| false);
            let id = if is_other { &other } else { &known[which.index(known.len())] };

            let data = [&[first], id.as_bytes(), b"\n#1234567"].concat();
            let (slot, end) = ids.slot_at(&data, 1);
            let expected = slot.zip(digit(first)).filter(|_| end <= 4 && !is_state(first));
            if first != b'b' {
                let left_out = expected.filter(|(slot, _)| is_left_out(*slot));
                prop_assert_eq!(lines.left_out(&data, 0), left_out.map(|_| end + 1));
            }
            let expected = expected.filter(|(slot, _)| widths[*slot as usize] == 1 && !is_left_out(*slot));
            let expected = expected.map(|(slot, digit)| BitLine {
                slot,
                digit,
                is_clock: slot == clock,
                end: data[end],
                next: end + 1,
            });
            prop_assert_eq!(lines.bit(&data, 0), expected);

            let vector = [b"b", digits.as_bytes(), id.as_bytes(), b"\n#12345678"].concat();
            let id_at = 1 + digits.len();
            let (slot, end) = ids.slot_at(&vector, id_at);
            let word = digits.strip_suffix(' ').map(|digits| {
                let bits = |one: char| digits.chars().fold(0, |word, digit| word << 1 | u64::from(digit == one));
                [bits('1'), bits('x')]
            });
            let fits = |slot: u32| (2..=64).contains(&widths[slot as usize]) && digits.len() - 1 <= widths[slot as usize] as usize;
            let expected = slot.zip(word).filter(|_| end <= id_at + 3);
            let left_out = expected.filter(|(slot, _)| is_left_out(*slot));
            prop_assert_eq!(lines.left_out(&vector, 0), left_out.map(|_| end + 1));
            let expected = expected.filter(|(slot, _)| fits(*slot) && !is_left_out(*slot));
            let expected = expected.map(|(slot, [word, unknown])| WordLine {
                slot,
                word,
                unknown: if digits.starts_with('x') { unknown | u64::MAX << (digits.len() - 1) & u64::MAX >> (64 - widths[slot as usize]) } else { unknown },
                end: vector[end],
                next: end + 1,
            });
            prop_assert_eq!(lines.word(&vector, 0), expected);
            for short in 0..8 {
                prop_assert_eq!(lines.bit(&data[..short], 0), None);
                prop_assert_eq!(lines.word(&vector[..id_at + short], 0), None);
            }
        }
    }
}
