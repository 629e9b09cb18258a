//! Adds values of a VCD to a batch: all except the simple ones, which [`super::section`] handles itself.
//!
//! Each function returns an error for a value that does not fit the declaration of its signal.

use super::digits::{digit, pack};
use super::gatherer::Gatherer;
use super::header::Kind;
use super::values::pack_text;

/// Adds digits of any length and kind for a slot.
pub(super) fn put_digits(gatherer: &mut Gatherer, slot: u32, digits: &[u8]) -> Result<(), String> {
    let width = match gatherer.kind(slot) {
        Kind::Bits(width) => width,
        Kind::Real => return Err("bits for a signal that is declared as real".to_owned()),
        Kind::Text | Kind::Event => return Ok(()),
    };
    if digits.is_empty() {
        return Err("a value without digits".to_owned());
    }
    let bad = |byte| format!("invalid VCD logic value `{}`: the file is damaged", shown(&[byte]));
    if digits.len() > width as usize {
        // Leading digits without meaning are not an error: some writers dump every vector in 32 or 64 digits.
        let (extra, rest) = digits.split_at(digits.len() - width as usize);
        if extra.iter().any(|byte| *byte != b'0') {
            return Err(match digits.iter().find(|byte| digit(**byte).is_none()) {
                Some(byte) => bad(*byte),
                None => format!(
                    "a value of {} bits for a signal that is declared with {width}: the file is damaged",
                    digits.len()
                ),
            });
        }
        return put_digits(gatherer, slot, rest);
    }
    if width <= 64 {
        let (mut bits, mut unknown) = ([0], [0]);
        pack(digits, width, &mut bits, &mut unknown).map_err(bad)?;
        gatherer.put_word(slot, bits[0], unknown[0]);
        return Ok(());
    }
    let words = gatherer.put_words(slot);
    let (bits, unknown) = words.split_at_mut(words.len() / 2);
    pack(digits, width, bits, unknown).map_err(bad)
}

/// Adds a real number for a slot.
pub(super) fn put_real(gatherer: &mut Gatherer, slot: u32, word: &[u8]) -> Result<(), String> {
    if gatherer.kind(slot) != Kind::Real {
        return Err("a real value for a signal that is declared as bits".to_owned());
    }
    let text = std::str::from_utf8(word).ok();
    let real: f64 = text
        .and_then(|text| text.parse().ok())
        .ok_or_else(|| format!("`{}` is not a number", shown(word)))?;
    gatherer.put_word(slot, real.to_bits(), 0);
    Ok(())
}

/// Adds a text for a slot.
pub(super) fn put_text(gatherer: &mut Gatherer, slot: u32, word: &[u8]) -> Result<(), String> {
    if gatherer.kind(slot) == Kind::Text {
        pack_text(word, gatherer.put_words(slot));
    }
    Ok(())
}

/// Formats bytes for a message.
pub(super) fn shown(bytes: &[u8]) -> String {
    String::from_utf8_lossy(&bytes[..bytes.len().min(60)])
        .escape_debug()
        .to_string()
}
