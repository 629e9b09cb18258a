//! Values of all signals, before and after the step at hand, in one array.

use super::header::Kind;

/// A value: bits with a mask of the unknown ones, or a real number.
///
/// In `unknown` bits, a zero of `bits` is `x` and a one is `z`.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Value<'a> {
    /// Least significant word first.
    Bits {
        width: u32,
        bits: &'a [u64],
        unknown: &'a [u64],
    },
    /// `None` before the first change.
    Real(Option<f64>),
    /// Not comparable.
    Other,
}

impl Value<'_> {
    /// Whether it is a single, known bit of this value.
    pub(crate) fn is_bit(&self, bit: u64) -> bool {
        matches!(self, Value::Bits { width: 1, bits, unknown } if bits[0] == bit && unknown[0] == 0)
    }

    /// As a signed number; `None` with unknown bits, or more than 128 bits.
    pub(crate) fn signed(&self) -> Option<i128> {
        let Value::Bits { width, bits, unknown } = *self else {
            return None;
        };
        if width > 128 || unknown.iter().any(|word| *word != 0) {
            return None;
        }
        let words = bits.iter().rev();
        let raw = words.fold(0u128, |all, word| all << 32 << 32 | u128::from(*word));
        let shift = 128 - width;
        Some(((raw << shift) as i128) >> shift)
    }

    /// As digits, most significant first, extended to `width` with zeros, or with the sign.
    pub(crate) fn digits(&self, to_width: u32, signed: bool) -> String {
        let Value::Bits { width, bits, unknown } = *self else {
            return String::new();
        };
        let digit = |at: u32| {
            let bit = |words: &[u64]| words[at as usize / 64] >> (at % 64) & 1;
            match (bit(unknown), bit(bits)) {
                (0, 0) => '0',
                (0, _) => '1',
                (_, 0) => 'x',
                _ => 'z',
            }
        };
        let extension = if signed { digit(width - 1) } else { '0' };
        let extended = std::iter::repeat_n(extension, to_width.saturating_sub(width) as usize);
        extended.chain((0..width).rev().map(digit)).collect()
    }
}

struct Slot {
    kind: Kind,
    /// Four runs of words: bits and unknown now, bits and unknown next.
    offset: usize,
    words: usize,
    dirty: bool,
}

/// All values.
#[derive(Default)]
pub(super) struct Values {
    slots: Vec<Slot>,
    words: Vec<u64>,
    dirty: Vec<u32>,
}

impl Values {
    pub(super) fn len(&self) -> usize {
        self.slots.len()
    }

    pub(super) fn kind(&self, slot: u32) -> Kind {
        self.slots[slot as usize].kind
    }

    /// A new slot, all `x`.
    pub(super) fn add(&mut self, kind: Kind) -> u32 {
        let words = match kind {
            Kind::Bits(width) => width.div_ceil(64) as usize,
            Kind::Real => 1,
            Kind::Other => 0,
        };
        let offset = self.words.len();
        for run in 0..4 {
            let value = if run % 2 == 1 { u64::MAX } else { 0 };
            self.words.extend(std::iter::repeat_n(value, words));
            if let (Kind::Bits(width), 1) = (kind, run % 2) {
                self.trim(width);
            }
        }
        self.slots.push(Slot {
            kind,
            offset,
            words,
            dirty: false,
        });
        self.slots.len() as u32 - 1
    }

    /// Clears the bits above the width in the last word.
    fn trim(&mut self, width: u32) {
        if let (Some(last), 1..) = (self.words.last_mut(), width % 64) {
            *last &= u64::MAX >> (64 - width % 64);
        }
    }

    pub(super) fn now(&self, slot: u32) -> Value<'_> {
        self.value(slot, 0)
    }

    pub(super) fn next(&self, slot: u32) -> Value<'_> {
        self.value(slot, 2)
    }

    fn value(&self, slot: u32, run: usize) -> Value<'_> {
        let Slot {
            kind, offset, words, ..
        } = self.slots[slot as usize];
        let from = offset + run * words;
        let bits = &self.words[from..from + words];
        let unknown = &self.words[from + words..from + 2 * words];
        match kind {
            Kind::Bits(width) => Value::Bits { width, bits, unknown },
            Kind::Real => Value::Real((unknown[0] == 0).then_some(f64::from_bits(bits[0]))),
            Kind::Other => Value::Other,
        }
    }

    pub(super) fn set_real(&mut self, slot: u32, value: f64) {
        let from = self.slots[slot as usize].offset + 2;
        self.words[from] = value.to_bits();
        self.words[from + 1] = 0;
        self.touch(slot);
    }

    /// Sets `length` bits, most significant first; the rest as VCD has it: zeros, or the first bit if it is `x` or `z`.
    pub(super) fn set_bits(&mut self, slot: u32, length: usize, bits: impl Iterator<Item = vcd::Value>) {
        let Slot {
            kind, offset, words, ..
        } = self.slots[slot as usize];
        let Kind::Bits(width) = kind else { return };
        let from = offset + 2 * words;
        let run = &mut self.words[from..from + 2 * words];
        run.fill(0);
        let (low, high) = run.split_at_mut(words);
        let mut set = |at: usize, value: vcd::Value| {
            let mask = 1 << (at % 64);
            if matches!(value, vcd::Value::V1 | vcd::Value::Z) {
                low[at / 64] |= mask;
            }
            if matches!(value, vcd::Value::X | vcd::Value::Z) {
                high[at / 64] |= mask;
            }
        };
        let mut first = vcd::Value::X;
        for (at, value) in bits.enumerate() {
            if at == 0 {
                first = value;
            }
            set(length - 1 - at, value);
        }
        if matches!(first, vcd::Value::X | vcd::Value::Z) {
            (length..width as usize).for_each(|at| set(at, first));
        }
        self.touch(slot);
    }

    fn touch(&mut self, slot: u32) {
        let state = &mut self.slots[slot as usize];
        if !state.dirty {
            state.dirty = true;
            self.dirty.push(slot);
        }
    }

    pub(super) fn has_changes(&self) -> bool {
        !self.dirty.is_empty()
    }

    pub(super) fn commit(&mut self, mut changed: impl FnMut(u32)) {
        for slot in self.dirty.drain(..) {
            let state = &mut self.slots[slot as usize];
            state.dirty = false;
            let (now, length) = (state.offset, 2 * state.words);
            let (before, after) = self.words[now..now + 2 * length].split_at_mut(length);
            if before != after {
                before.copy_from_slice(after);
                changed(slot);
            }
        }
    }
}
