//! Adds values of a VCD to a batch: all except the simple ones, which [`super::section`] handles itself.
//!
//! A value of another kind than its signal is declared with (text on a real number, as MyHDL writes it, or a word wider
//! than its signal) makes the signal *odd*: the comparison then reads the file again, with a kind that holds any value
//! ([`Kind::Any`]). Only text that is not a value at all is an error.

use std::borrow::Cow;

use super::digits::{digit, pack, state};
use super::gatherer::Gatherer;
use super::header::{Declared, Kind};
use super::values::{hash, pack_any_bits, pack_any_real, pack_text};

/// Adds digits of any length and kind for a slot.
pub(super) fn put_digits(gatherer: &mut Gatherer, slot: u32, digits: &[u8]) -> Result<(), String> {
    // PyMTL3 writes `b0b0101`.
    let digits = digits.strip_prefix(b"0b").unwrap_or(digits);
    let bad = |byte| format!("invalid VCD logic value `{}`: the file is damaged", shown(&[byte]));
    let (width, declared) = match gatherer.kind(slot) {
        Kind::Bits(width) => (width, None),
        Kind::Any(declared) => (0, Some(declared)),
        Kind::Event => {
            if digits == b"1" {
                gatherer.put_event(slot);
            }
            return Ok(());
        }
        Kind::Real | Kind::Text => {
            if let Some(byte) = digits.iter().find(|byte| digit(**byte).is_none()) {
                return Err(bad(*byte));
            }
            gatherer.put_odd(slot);
            return Ok(());
        }
    };
    if let Some(declared) = declared {
        return put_any_digits(gatherer, slot, digits, declared).map_err(bad);
    }
    if digits.is_empty() && width > 0 {
        return Err("a value without digits".to_owned());
    }
    if digits.len() > width as usize {
        // Leading digits without meaning are usual: some writers dump every vector in 32 or 64 digits.
        let (extra, rest) = digits.split_at(digits.len() - width as usize);
        let unknown = rest
            .first()
            .filter(|byte| digit(**byte).is_some_and(|digit| digit >= 2));
        let filler = *unknown.unwrap_or(&b'0');
        if extra.iter().any(|byte| *byte != filler) {
            if let Some(byte) = digits.iter().find(|byte| digit(**byte).is_none()) {
                return Err(bad(*byte));
            }
            gatherer.put_odd(slot);
            return Ok(());
        }
        return if width == 0 {
            Ok(())
        } else {
            put_digits(gatherer, slot, rest)
        };
    }
    if width == 0 {
        return Ok(());
    }
    let has_states;
    if width <= 64 {
        let (mut bits, mut unknown) = ([0], [0]);
        has_states = pack(digits, width, &mut bits, &mut unknown).map_err(bad)?;
        gatherer.put_word(slot, bits[0], unknown[0]);
    } else {
        let words = gatherer.put_words(slot);
        let (bits, unknown) = words.split_at_mut(words.len() / 2);
        has_states = pack(digits, width, bits, unknown).map_err(bad)?;
    }
    if has_states {
        gatherer.note_state(state(digits));
    }
    Ok(())
}

/// Adds digits for a slot that holds values of any kind. Those of more than 256 bits are kept as text.
fn put_any_digits(gatherer: &mut Gatherer, slot: u32, digits: &[u8], declared: Declared) -> Result<(), u8> {
    let least = match declared {
        Declared::Bits(width) => width as usize,
        Declared::Real | Declared::Text => 64,
    };
    let width = digits.len().max(least);
    let mut planes = [[0; 4]; 2];
    let [bits, unknown] = &mut planes;
    if width <= 256 {
        let has_states = pack(digits, width as u32, bits, unknown)?;
        pack_any_bits(width as u32, bits, unknown, gatherer.put_words(slot));
        if has_states {
            gatherer.note_state(state(digits));
        }
    } else {
        if let Some(byte) = digits.iter().find(|byte| digit(**byte).is_none()) {
            return Err(*byte);
        }
        let text = [b"b", digits].concat().to_ascii_lowercase();
        pack_text(&text, gatherer.put_words(slot));
    }
    Ok(())
}

/// Adds a real number for a slot.
pub(super) fn put_real(gatherer: &mut Gatherer, slot: u32, word: &[u8]) -> Result<(), String> {
    let real = real(word);
    match (gatherer.kind(slot), real) {
        (Kind::Real, Some(real)) => gatherer.put_word(slot, real.to_bits(), 0),
        (Kind::Any(_), Some(real)) => pack_any_real(real, gatherer.put_words(slot)),
        (Kind::Any(_), None) => pack_text(word, gatherer.put_words(slot)),
        (Kind::Event, _) => gatherer.put_event(slot),
        (Kind::Real | Kind::Bits(_) | Kind::Text, _) => gatherer.put_odd(slot),
    }
    Ok(())
}

/// Adds a text for a slot.
pub(super) fn put_text(gatherer: &mut Gatherer, slot: u32, word: &[u8]) -> Result<(), String> {
    // MyHDL declares all but bits as real numbers, and writes numbers as text, too.
    let is_number = word.first().is_some_and(|byte| b"+-.0123456789".contains(byte));
    let number = || real(word).filter(|_| is_number);
    match gatherer.kind(slot) {
        Kind::Text => pack_text(&unescaped(word), gatherer.put_words(slot)),
        Kind::Real => match number() {
            Some(real) => gatherer.put_word(slot, real.to_bits(), 0),
            None => gatherer.put_odd(slot),
        },
        Kind::Any(declared) => match number().filter(|_| declared == Declared::Real) {
            Some(real) => pack_any_real(real, gatherer.put_words(slot)),
            None => pack_text(&unescaped(word), gatherer.put_words(slot)),
        },
        Kind::Bits(_) => gatherer.put_odd(slot),
        Kind::Event => gatherer.put_event(slot),
    }
    Ok(())
}

/// Adds the states of a port of an extended VCD, as 0, 1, `x` and `z`. Who drives it, and how strongly, is kept as a
/// state besides ([`Gatherer::note_state`]).
pub(super) fn put_port(gatherer: &mut Gatherer, slot: u32, states: &[u8], strengths: [&[u8]; 2]) -> Result<(), String> {
    let digits: Result<Vec<u8>, u8> = states
        .iter()
        .map(|state| match state {
            b'D' | b'd' | b'L' | b'l' | b'0' => Ok(b'0'),
            b'U' | b'u' | b'H' | b'h' | b'1' => Ok(b'1'),
            b'N' | b'X' | b'?' | b'A' | b'a' | b'B' | b'b' | b'C' | b'c' => Ok(b'x'),
            b'Z' | b'T' | b'F' | b'f' => Ok(b'z'),
            other => Err(*other),
        })
        .collect();
    let digits = digits.map_err(|byte| format!("`{}` is not a state of a port in an extended VCD", shown(&[byte])))?;
    put_digits(gatherer, slot, &digits)?;
    if matches!(gatherer.kind(slot), Kind::Bits(1..) | Kind::Any(_)) {
        gatherer.note_state(hash(&[states, b" ", strengths[0], b" ", strengths[1]].concat()) | 1);
    }
    Ok(())
}

/// Reads a number in the forms that producers write; `None` if it is not a number.
pub(super) fn real(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(real) = text.parse() {
        return Some(real);
    }
    let text = text.to_ascii_lowercase();
    let (sign, plain) = match text.strip_prefix('-') {
        Some(plain) => (-1.0, plain),
        None => (1.0, text.as_str()),
    };
    // C's and Microsoft's libraries write these.
    if plain.starts_with("nan") || plain.starts_with("1.#qnan") || plain.starts_with("1.#ind") {
        return Some(f64::NAN);
    }
    if plain.starts_with("1.#inf") {
        return Some(sign * f64::INFINITY);
    }
    // Some writers use the decimal comma of their locale.
    text.replacen(',', ".", 1).parse().ok()
}

/// Replaces the escapes of C, which stand for spaces and what cannot be printed: `50\040NS`.
pub(super) fn unescaped(text: &[u8]) -> Cow<'_, [u8]> {
    if !text.contains(&b'\\') {
        return Cow::Borrowed(text);
    }
    let mut plain = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some((first, behind)) = rest.split_first() {
        rest = behind;
        let (b'\\', Some((escape, behind))) = (*first, behind.split_first()) else {
            plain.push(*first);
            continue;
        };
        rest = behind;
        let digits = |radix: u32, most: usize, text: &[u8]| {
            let digits = text
                .iter()
                .take(most)
                .map_while(|byte| char::from(*byte).to_digit(radix));
            digits.fold((0u32, 0), |(number, count), digit| (number * radix + digit, count + 1))
        };
        plain.push(match escape {
            b'a' => 7,
            b'b' => 8,
            b'f' => 12,
            b'n' => b'\n',
            b'r' => b'\r',
            b't' => b'\t',
            b'v' => 11,
            b'0'..=b'7' => {
                let (number, count) = digits(8, 2, rest);
                rest = &rest[count..];
                ((u32::from(escape - b'0') << (3 * count)) + number) as u8
            }
            b'x' => match digits(16, 2, rest) {
                (_, 0) => b'x',
                (number, count) => {
                    rest = &rest[count..];
                    number as u8
                }
            },
            other => *other,
        });
    }
    Cow::Owned(plain)
}

/// Formats bytes for a message.
pub(super) fn shown(bytes: &[u8]) -> String {
    String::from_utf8_lossy(&bytes[..bytes.len().min(60)])
        .escape_debug()
        .to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_of_c_are_replaced() {
        for (written, meant) in [
            (r"50\040NS", &b"50 NS"[..]),
            (r"a\\b\tc\x41\0", b"a\\b\tcA\0"),
            (r"\7\18\x", b"\x07\x018x"),
            (r"end\", b"end\\"),
            ("plain", b"plain"),
        ] {
            assert_eq!(unescaped(written.as_bytes()).as_ref(), meant, "{written}");
        }
    }

    #[test]
    fn numbers_are_read_as_every_library_prints_them() {
        for (text, number) in [
            ("1.5", 1.5),
            ("+.5e1", 5.0),
            ("1,5", 1.5),
            ("-1.#INF", f64::NEG_INFINITY),
            ("inf", f64::INFINITY),
        ] {
            assert_eq!(real(text.as_bytes()), Some(number), "{text}");
        }
        for text in ["nan", "-nan", "nan(0x8000)", "1.#QNAN"] {
            assert!(real(text.as_bytes()).is_some_and(f64::is_nan), "{text}");
        }
        assert_eq!(real(b"idle"), None);
    }
}
