//! Packs digits into words: one bit each for the value, and one that tells whether it is unknown.
//!
//! | digit | bit | unknown |
//! |---|---|---|
//! | `0`, VHDL's weak `L` | 0 | 0 |
//! | `1`, `H` | 1 | 0 |
//! | `x`, and what VHDL has beside it: `U`, `W`, `-`; `?` | 0 | 1 |
//! | `z` | 1 | 1 |
//!
//! If a value has one of VHDL's additional states, its original states are kept separately ([`state`]), so that the comparison can report
//! where it treated two different states as equal.

use super::values::hash;

/// Meaning of a byte: bit 0 is the value, bit 1 unknown, bit 2 one of VHDL's additional states, [`NO_DIGIT`] for any
/// other byte.
pub(super) static DIGITS: [u8; 256] = {
    let mut table = [NO_DIGIT; 256];
    let digits = [
        (b"000", 0),
        (b"111", 1),
        (b"xXx", 2),
        (b"zZz", 3),
        (b"Ll0", 4),
        (b"Hh1", 5),
        (b"-??", 6),
        (b"uUu", 6),
        (b"wWw", 6),
    ];
    let mut row = 0;
    while row < digits.len() {
        let mut at = 0;
        while at < 3 {
            let byte = digits[row].0[at] as usize;
            if table[byte] == NO_DIGIT {
                table[byte] = digits[row].1;
            }
            at += 1;
        }
        row += 1;
    }
    table
};
const NO_DIGIT: u8 = 0xff;
/// The flag of VHDL's additional states.
const STATE: u8 = 4;
/// The digit `x`.
pub(super) const UNKNOWN: u8 = 2;

/// Returns the digit of a byte: bit 0 is the value, bit 1 tells whether it is unknown.
pub(super) fn digit(byte: u8) -> Option<u8> {
    let digit = DIGITS[byte as usize];
    (digit != NO_DIGIT).then_some(digit & 3)
}

/// Returns whether a byte is one of VHDL's additional states.
pub(super) fn is_state(byte: u8) -> bool {
    let digit = DIGITS[byte as usize];
    digit != NO_DIGIT && digit & STATE != 0
}

/// Returns a number, never 0, for digits among which is one of VHDL's additional states. Equal states give equal numbers, however often the
/// leading state is repeated.
pub(super) fn state(digits: &[u8]) -> u64 {
    let plain = digits.to_ascii_uppercase();
    let repeated = plain
        .windows(2)
        .take_while(|pair| pair[0] == pair[1] && pair[0] != b'H')
        .count();
    hash(&plain[repeated..]) | 1
}

/// Packs up to 64 known digits, most significant first; `None` if one is anything but `0` or `1`.
#[inline]
pub(super) fn known_word(digits: &[u8]) -> Option<u64> {
    const ZEROS: u64 = u64::from_le_bytes([b'0'; 8]);
    const ONES: u64 = u64::from_le_bytes([1; 8]);
    let mut word = 0;
    let mut eights = digits.chunks_exact(8);
    for eight in &mut eights {
        let raw = u64::from_le_bytes(eight.try_into().ok()?) ^ ZEROS;
        if raw & !ONES != 0 {
            return None;
        }
        // Byte 0 goes to bit 7, byte 7 to bit 0: no two products overlap.
        word = word << 8 | raw.wrapping_mul(0x8040_2010_0804_0201) >> 56;
    }
    for byte in eights.remainder() {
        let bit = byte ^ b'0';
        if bit > 1 {
            return None;
        }
        word = word << 1 | u64::from(bit);
    }
    Some(word)
}

/// Returns the number that the known digits at `at` make, or its last 64 bits, and the position after them. Eight bytes
/// must follow the last digit, or the run ends too early.
#[inline]
pub(super) fn known_run(data: &[u8], at: usize) -> (u64, usize) {
    const ZEROS: u64 = u64::from_le_bytes([b'0'; 8]);
    const OTHER: u64 = u64::from_le_bytes([0xfe; 8]);
    const HIGH: u64 = u64::from_le_bytes([0x80; 8]);
    const LOW: u64 = u64::from_le_bytes([0x7f; 8]);
    let (mut word, mut end) = (0u64, at);
    while let Some(eight) = data.get(end..end + 8) {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(eight);
        let digits = u64::from_le_bytes(bytes) ^ ZEROS;
        let other = digits & OTHER;
        // Byte 0 goes to bit 7, byte 7 to bit 0: no two products overlap.
        if other == 0 {
            word = word << 8 | digits.wrapping_mul(0x8040_2010_0804_0201) >> 56;
            end += 8;
            continue;
        }
        let first = (((other & LOW) + LOW) | other) & HIGH;
        let count = first.trailing_zeros() / 8;
        // The digits before the other byte come after zeros.
        let digits = digits.unbounded_shl(64 - 8 * count);
        word = word << count | digits.wrapping_mul(0x8040_2010_0804_0201) >> 56;
        return (word, end + count as usize);
    }
    (word, end)
}

/// Returns, byte by byte, the bits of eight digits `0`, `1`, `x` or `z` and whether they are unknown; the third word is not zero in a byte
/// that is no such digit.
#[inline]
fn eight_mixed(eight: u64) -> [u64; 3] {
    const EACH: u64 = u64::from_le_bytes([1; 8]);
    let unknown = eight >> 6 & EACH;
    let all = unknown * 0xff;
    // `0` and `1` become 0 and 1, `x` and `z` of either case 0 and 2.
    let digits = (eight | all & (0x20 * EACH)) ^ (0x30 * EACH) ^ all & (0x48 * EACH);
    let other = digits & !(EACH ^ all & (3 * EACH));
    [(digits | digits >> 1) & EACH, unknown, other]
}

/// Returns the bits and the unknown bits that the digits `0`, `1`, `x` and `z` at `at` make after `known` ones, or the last 64,
/// and the position after them. Eight bytes must follow the last digit, or the run ends too early.
#[inline]
pub(super) fn mixed_run(known: u64, data: &[u8], at: usize) -> ([u64; 2], usize) {
    const HIGH: u64 = u64::from_le_bytes([0x80; 8]);
    const LOW: u64 = u64::from_le_bytes([0x7f; 8]);
    let (mut words, mut end) = ([known, 0], at);
    while let Some(eight) = data.get(end..end + 8) {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(eight);
        let [bits, unknown, other] = eight_mixed(u64::from_le_bytes(bytes));
        let count = match other {
            0 => 8,
            _ => ((((other & LOW) + LOW) | other) & HIGH).trailing_zeros() / 8,
        };
        for (word, lanes) in words.iter_mut().zip([bits, unknown]) {
            // The digits before the other byte come after zeros.
            let lanes = lanes.unbounded_shl(64 - 8 * count);
            *word = *word << count | lanes.wrapping_mul(0x8040_2010_0804_0201) >> 56;
        }
        end += count as usize;
        if count < 8 {
            break;
        }
    }
    (words, end)
}

/// Returns the end of the digits `0`, `1`, `x` and `z` at `at`. Eight bytes must follow the last digit, or they end too early.
#[inline]
pub(super) fn run_end(data: &[u8], at: usize) -> usize {
    const HIGH: u64 = u64::from_le_bytes([0x80; 8]);
    const LOW: u64 = u64::from_le_bytes([0x7f; 8]);
    let mut end = at;
    while let Some(eight) = data.get(end..end + 8) {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(eight);
        let [.., other] = eight_mixed(u64::from_le_bytes(bytes));
        if other != 0 {
            return end + ((((other & LOW) + LOW) | other) & HIGH).trailing_zeros() as usize / 8;
        }
        end += 8;
    }
    end
}

/// Extends `count` digits to a vector of `width` bits, at most 64, as in VCD: with zeros, or with the first digit if that is
/// unknown.
#[inline]
pub(super) fn extended([bits, unknown]: [u64; 2], count: u32, width: u32) -> [u64; 2] {
    let first = 1u64.unbounded_shl(count.wrapping_sub(1));
    if unknown & first == 0 {
        return [bits, unknown];
    }
    let missing = u64::MAX.unbounded_shl(count) & u64::MAX.unbounded_shr(64 - width);
    [if bits & first == 0 { bits } else { bits | missing }, unknown | missing]
}

/// Returns the decimal number at `at` and the position after it; `None` without a digit, or beyond 64 bits.
#[inline]
pub(super) fn decimal(data: &[u8], at: usize) -> Option<(u64, usize)> {
    const ZEROS: u128 = u128::from_le_bytes([b'0'; 16]);
    /// With this added, a byte from 10 on has its upper bit set.
    const ABOVE_9: u128 = u128::from_le_bytes([0x80 - 10; 16]);
    const HIGH: u128 = u128::from_le_bytes([0x80; 16]);
    let Some(sixteen) = data.get(at..at + 16) else {
        return decimal_by_digit(data, at);
    };
    let mut bytes = [0; 16];
    bytes.copy_from_slice(sixteen);
    let digits = u128::from_le_bytes(bytes) ^ ZEROS;
    // Only the first byte that is not a digit is certain to be found.
    let count = ((digits.wrapping_add(ABOVE_9) | digits) & HIGH).trailing_zeros() / 8;
    if count == 0 || count == 16 {
        return decimal_by_digit(data, at);
    }
    // The shift drops the bytes after the digits, and puts zeros before the digits.
    let digits = digits << (128 - 8 * count);
    let [upper, lower] = [digits as u64, (digits >> 64) as u64].map(eight_digits);
    Some((upper * 100_000_000 + lower, at + count as usize))
}

/// Returns the number that eight digits make, each in a byte from 0 to 9.
#[inline]
fn eight_digits(digits: u64) -> u64 {
    let pairs = (digits.wrapping_mul(10).wrapping_add(digits >> 8)) & 0x00ff_00ff_00ff_00ff;
    let fours = (pairs.wrapping_mul(100).wrapping_add(pairs >> 16)) & 0x0000_ffff_0000_ffff;
    fours.wrapping_mul(10_000).wrapping_add(fours >> 32) & 0xffff_ffff
}

fn decimal_by_digit(data: &[u8], at: usize) -> Option<(u64, usize)> {
    let (mut number, mut end) = (0u64, at);
    while let Some(digit @ 0..=9) = data.get(end).map(|byte| byte.wrapping_sub(b'0')) {
        number = number.checked_mul(10)?.checked_add(digit.into())?;
        end += 1;
    }
    (end > at).then_some((number, end))
}

/// Packs `digits`, most significant first, into `bits` and `unknown`, which hold `width` bits, least significant word
/// first. Missing digits are as in VCD: zeros, or the first digit if that is unknown. There must not be more digits
/// than `width`. Returns whether VHDL's additional states are among them.
///
/// # Errors
/// The first byte that is not a digit.
pub(super) fn pack(digits: &[u8], width: u32, bits: &mut [u64], unknown: &mut [u64]) -> Result<bool, u8> {
    let mut has_states = false;
    let words = bits.iter_mut().zip(unknown.iter_mut());
    let mut chunks = digits.rchunks(64);
    for (bits, unknown) in words {
        let chunk = chunks.next().unwrap_or(&[]);
        (*bits, *unknown) = match known_word(chunk) {
            Some(word) => (word, 0),
            None => {
                let (word, states) = mixed_word(chunk)?;
                has_states |= states;
                word
            }
        };
        if chunk.len() < 64 {
            let first = digits.first().and_then(|byte| digit(*byte)).unwrap_or(0);
            if first >= 2 {
                let missing = u64::MAX.checked_shl(chunk.len() as u32).unwrap_or(0);
                *unknown |= missing;
                *bits |= if first == 3 { missing } else { 0 };
            }
        }
    }
    trim(width, bits);
    trim(width, unknown);
    Ok(has_states)
}

/// Clears the bits above the width in the last word.
fn trim(width: u32, words: &mut [u64]) {
    if let (Some(last), 1..) = (words.last_mut(), width % 64) {
        *last &= u64::MAX >> (64 - width % 64);
    }
}

/// Returns bits and unknown bits, and whether VHDL's additional states are among the digits.
fn mixed_word(digits: &[u8]) -> Result<((u64, u64), bool), u8> {
    let (mut bits, mut unknown, mut flags) = (0, 0, 0);
    let mut rest = digits;
    while let Some((eight, behind)) = rest.split_first_chunk() {
        let [of_eight, unknown_of_eight, other] = eight_mixed(u64::from_le_bytes(*eight));
        if other != 0 {
            break;
        }
        bits = bits << 8 | of_eight.wrapping_mul(0x8040_2010_0804_0201) >> 56;
        unknown = unknown << 8 | unknown_of_eight.wrapping_mul(0x8040_2010_0804_0201) >> 56;
        rest = behind;
    }
    for byte in rest {
        let digit = DIGITS[*byte as usize];
        if digit == NO_DIGIT {
            return Err(*byte);
        }
        flags |= digit;
        bits = bits << 1 | u64::from(digit & 1);
        unknown = unknown << 1 | u64::from(digit >> 1 & 1);
    }
    Ok(((bits, unknown), flags & STATE != 0))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn prop_packing_matches_one_digit_at_a_time(digits in "[01xzXZULHW-]{1,200}", more in 0u32..100) {
            let width = digits.len() as u32 + more;
            let words = width.div_ceil(64) as usize;
            let (mut bits, mut unknown) = (vec![7; words], vec![7; words]);
            let states = pack(digits.as_bytes(), width, &mut bits, &mut unknown).unwrap();
            prop_assert_eq!(states, digits.contains(['U', 'L', 'H', 'W', '-']));
            let first = digit(digits.as_bytes()[0]).unwrap();
            for at in 0..64 * words {
                let expected = match digits.bytes().rev().nth(at) {
                    Some(byte) => digit(byte).unwrap(),
                    None if at < width as usize && first >= 2 => first,
                    None => 0,
                };
                let got = (unknown[at / 64] >> (at % 64) & 1) << 1 | bits[at / 64] >> (at % 64) & 1;
                prop_assert_eq!(got, u64::from(expected), "bit {}", at);
            }
        }

        #[test]
        fn prop_known_digits_are_a_binary_number(number: u64, width in 1usize..=64) {
            let number = number >> (64 - width);
            prop_assert_eq!(known_word(format!("{number:0width$b}").as_bytes()), Some(number));
        }

        #[test]
        fn prop_known_digits_end_at_another_byte(digits in "[01]{0,64}", next in 0u8..=255, rest in any::<[u8; 7]>()) {
            prop_assume!(!b"01".contains(&next));
            let data = [digits.as_bytes(), &[next], &rest].concat();
            let expected = u64::from_str_radix(&digits, 2).unwrap_or(0);
            prop_assert_eq!(known_run(&data, 0), (expected, digits.len()));
        }

        #[test]
        fn prop_a_run_of_digits_ends_at_another_byte(
            digits in "[01xzXZ]{1,64}", next in 0u8..=255, rest in any::<[u8; 7]>(), more in 0u32..64,
        ) {
            prop_assume!(!b"01xzXZ".contains(&next));
            let data = [digits.as_bytes(), &[next], &rest].concat();
            let (words, end) = mixed_run(0, &data, 0);
            prop_assert_eq!(end, digits.len());
            prop_assert_eq!(run_end(&data, 0), digits.len());
            let (known, behind) = known_run(&data, 0);
            prop_assert_eq!(mixed_run(known, &data, behind), (words, end));
            let count = digits.len() as u32;
            let width = (count + more).min(64);
            let (mut bits, mut unknown) = ([0], [0]);
            pack(digits.as_bytes(), width, &mut bits, &mut unknown).unwrap();
            prop_assert_eq!(extended(words, count, width), [bits[0], unknown[0]]);
        }

        #[test]
        fn prop_decimal_number_ends_at_another_byte(zeros in "0{0,12}", number: u64, next in 0u8..=255, rest in any::<[u8; 17]>()) {
            prop_assume!(!next.is_ascii_digit());
            let digits = format!("{zeros}{number}");
            for behind in 0..=rest.len() {
                let data = [b"#", digits.as_bytes(), &[next], &rest[..behind]].concat();
                prop_assert_eq!(decimal(&data, 1), Some((number, 1 + digits.len())));
            }
            prop_assert_eq!(decimal(digits.as_bytes(), 0), Some((number, digits.len())));
            prop_assert_eq!(decimal(format!("{}0{next}", u64::MAX).as_bytes(), 0), None);
            prop_assert_eq!(decimal(&[&[next], digits.as_bytes()].concat(), 0), None);
        }

        #[test]
        fn prop_other_bytes_are_refused(before in "[01]{0,70}", byte in 0u8..=255, after in "[01]{0,70}") {
            prop_assume!(digit(byte).is_none());
            let digits = [before.as_bytes(), &[byte], after.as_bytes()].concat();
            let words = digits.len().div_ceil(64);
            let packed = pack(&digits, digits.len() as u32, &mut vec![0; words], &mut vec![0; words]);
            prop_assert_eq!(packed, Err(byte));
        }
    }
}
