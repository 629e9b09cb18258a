//! Takes the values of changes.

use super::written::{Written, digit_byte};
use super::{Blocks, Form, Stop, damaged, port_bits};
use crate::reader::digits::{digit, is_state, pack, state};
use crate::reader::gatherer::Gatherer;
use crate::reader::header::Kind;
use crate::reader::put::put_port;
use crate::reader::values::pack_text;

impl Blocks {
    /// Takes a change.
    pub(super) fn put(&self, value: Written<'_>, form: Form, slot: u32, gatherer: &mut Gatherer) -> Result<(), Stop> {
        let kind = gatherer.kind(slot);
        match (value, form) {
            (Written::Digit(of_bit), _) => {
                let byte = digit_byte(of_bit);
                if kind == Kind::Bits(1) {
                    let value = digit(byte).ok_or_else(|| damaged("a bit is not a digit"))?;
                    gatherer.put_digit(slot, value);
                    if is_state(byte) {
                        gatherer.note_state(state(&[byte]));
                    }
                } else if byte == b'1' && kind == Kind::Event {
                    gatherer.put_event(slot);
                }
            }
            // An event has no value.
            (Written::Known(_), _) if kind == Kind::Event => {}
            (Written::Known(bytes), Form::Bits(width)) => {
                let bit = |at: usize| b'0' + (bytes[at / 8] >> (7 - at % 8) & 1);
                let digits: Vec<u8> = (0..width as usize).map(bit).collect();
                put_digits(gatherer, slot, width, &digits)?;
            }
            (Written::Digits(digits), Form::Bits(width)) => put_digits(gatherer, slot, width, digits)?,
            (Written::Real(bytes), _) => self.put_real(gatherer, slot, bytes),
            (Written::Text(text), _) => {
                if kind == Kind::Text {
                    pack_text(text, gatherer.put_words(slot));
                }
            }
            (Written::Known(_) | Written::Digits(_), Form::Real | Form::Text) => {}
        }
        Ok(())
    }

    pub(super) fn real(&self, value: &[u8]) -> f64 {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(value);
        if self.little_endian {
            f64::from_le_bytes(bytes)
        } else {
            f64::from_be_bytes(bytes)
        }
    }

    pub(super) fn put_real(&self, gatherer: &mut Gatherer, slot: u32, value: &[u8]) {
        if gatherer.kind(slot) == Kind::Real {
            gatherer.put_word(slot, self.real(value).to_bits(), 0);
        }
    }
}

/// Takes digits, as many as the signal has bits.
pub(super) fn put_digits(gatherer: &mut Gatherer, slot: u32, width: u32, digits: &[u8]) -> Result<(), Stop> {
    match gatherer.kind(slot) {
        Kind::Bits(declared) if declared == width => {}
        Kind::Bits(bits) if port_bits(width) == Some(bits) => return put_port_of(gatherer, slot, bits, digits),
        _ => return Ok(()),
    }
    let words = gatherer.put_words(slot);
    let (bits, unknown) = words.split_at_mut(words.len() / 2);
    let packed = pack(digits, width, bits, unknown);
    let has_states = packed.map_err(|byte| Stop::Damaged(format!("byte {byte} is not a digit")))?;
    gatherer.watch_last(slot);
    if has_states {
        gatherer.note_state(state(digits));
    }
    Ok(())
}

/// Takes the value of a port: states and strengths, or digits.
fn put_port_of(gatherer: &mut Gatherer, slot: u32, bits: u32, value: &[u8]) -> Result<(), Stop> {
    let mut words = value.split(|byte| *byte <= b' ').filter(|word| !word.is_empty());
    let states = words.next().unwrap_or_default();
    if states.len() == bits as usize {
        let strengths = [words.next(), words.next()].map(Option::unwrap_or_default);
        return put_port(gatherer, slot, states, strengths).map_err(Stop::Unknown);
    }
    // `vcd2fst` extends digits to the length of states and strengths.
    let digits = &value[value.len() - bits as usize..];
    crate::reader::put::put_digits(gatherer, slot, digits).map_err(Stop::Damaged)
}
