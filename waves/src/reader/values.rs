//! Values of all signals in one array.

use super::header::Kind;

/// A value: bits with a mask of the unknown ones, a real number, or text.
///
/// In `unknown` bits, a zero of `bits` is `x` and a one is `z`.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Value<'a> {
    /// Words of the bits, least significant first.
    Bits {
        width: u32,
        bits: &'a [u64],
        unknown: &'a [u64],
    },
    /// `None` before the first change.
    Real(Option<f64>),
    /// Length, a hash of the whole text, and its beginning; see [`pack_text`].
    Text(&'a [u64]),
    /// Number of times that an event has happened.
    Event(u64),
}

/// Number of words of a text: length + 1 (0 before the first change), hash, the first 64 bytes.
const TEXT_WORDS: usize = 10;

/// Returns the number of words that a value of this kind takes.
#[inline]
pub(super) fn words_of(kind: Kind) -> usize {
    match kind {
        Kind::Bits(width) => 2 * width.div_ceil(64) as usize,
        Kind::Real => 2,
        Kind::Text | Kind::Any(_) => TEXT_WORDS,
        Kind::Event => 2,
    }
}

/// Returns a hash of bytes.
pub(super) fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3)
    })
}

/// Packs a text into words: equal texts give equal words; different ones give different words except with a
/// probability of 1 in 2^64.
pub(super) fn pack_text(text: &[u8], words: &mut [u64]) {
    words[0] = text.len() as u64 + 1;
    words[1] = hash(text);
    for (at, byte) in text.iter().take(8 * (TEXT_WORDS - 2)).enumerate() {
        words[2 + at / 8] |= u64::from(*byte) << (8 * (at % 8));
    }
}

/// Place of the type of a value of [`Kind::Any`]: text if it is 0.
const ANY_SHIFT: u32 = 56;
const ANY_REAL: u64 = 1;
const ANY_BITS: u64 = 2;

/// Packs a real number into the words of a value of any kind.
pub(super) fn pack_any_real(real: f64, words: &mut [u64]) {
    words[0] = ANY_REAL << ANY_SHIFT;
    words[1] = real.to_bits();
}

/// Packs at most 256 bits into the words of a value of any kind.
pub(super) fn pack_any_bits(width: u32, bits: &[u64], unknown: &[u64], words: &mut [u64]) {
    words[0] = ANY_BITS << ANY_SHIFT | u64::from(width);
    words[2..2 + bits.len()].copy_from_slice(bits);
    words[6..6 + unknown.len()].copy_from_slice(unknown);
}

fn any(words: &[u64]) -> Value<'_> {
    match words[0] >> ANY_SHIFT {
        ANY_REAL => Value::Real(Some(f64::from_bits(words[1]))),
        ANY_BITS => {
            let width = words[0] as u32;
            let count = width.div_ceil(64) as usize;
            Value::Bits {
                width,
                bits: &words[2..2 + count],
                unknown: &words[6..6 + count],
            }
        }
        _ => Value::Text(words),
    }
}

impl Value<'_> {
    /// Returns the value as a number, with signed bits or not; `None` with unknown bits, or beyond 128 bits.
    pub(crate) fn integer(&self, signed: bool) -> Option<i128> {
        let Value::Bits { width, bits, unknown } = *self else {
            return None;
        };
        if width == 0 || width > 128 || unknown.iter().any(|word| *word != 0) {
            return None;
        }
        let words = bits.iter().rev();
        let raw = words.fold(0u128, |all, word| all << 32 << 32 | u128::from(*word));
        if !signed {
            return i128::try_from(raw).ok();
        }
        let shift = 128 - width;
        Some(((raw << shift) as i128) >> shift)
    }

    /// Returns the value as digits, most significant first, extended to `width` with zeros, or with the sign.
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
        let extension = if signed && width > 0 { digit(width - 1) } else { '0' };
        let extended = std::iter::repeat_n(extension, to_width.saturating_sub(width) as usize);
        extended.chain((0..width).rev().map(digit)).collect()
    }

    /// Returns the text, as much of it as is kept; `None` before the first change.
    pub(crate) fn text(&self) -> Option<String> {
        let Value::Text(words) = self else { return None };
        let length = usize::try_from(words[0].checked_sub(1)?).unwrap_or(usize::MAX);
        let bytes: Vec<u8> = words[2..].iter().flat_map(|word| word.to_le_bytes()).collect();
        let mut text = String::from_utf8_lossy(&bytes[..length.min(bytes.len())]).into_owned();
        if length > bytes.len() {
            // Texts that differ only behind what is kept are distinguished.
            text.push_str(&format!("… ({length} bytes, {:016x})", words[1]));
        }
        Some(text)
    }
}

/// All values of one file.
#[derive(Debug, Default)]
pub(crate) struct Values {
    kinds: Vec<Kind>,
    offsets: Vec<usize>,
    words: Vec<u64>,
}

impl Values {
    /// Creates a slot of each kind, all without a value: `x`.
    pub(crate) fn new(kinds: &[Kind]) -> Self {
        let mut values = Self::default();
        for kind in kinds {
            values.add(*kind);
        }
        values
    }

    /// Adds a slot.
    pub(crate) fn add(&mut self, kind: Kind) -> u32 {
        let from = self.words.len();
        self.offsets.push(from);
        self.kinds.push(kind);
        self.words.resize(from + words_of(kind), 0);
        match kind {
            Kind::Bits(width) => {
                let words = words_of(kind) / 2;
                self.words[from + words..].fill(u64::MAX);
                if let (Some(last), 1..) = (self.words[from..].last_mut(), width % 64) {
                    *last &= u64::MAX >> (64 - width % 64);
                }
            }
            Kind::Real => self.words[from + 1] = u64::MAX,
            Kind::Text | Kind::Event | Kind::Any(_) => {}
        }
        self.kinds.len() as u32 - 1
    }

    /// Returns the number of slots.
    pub(crate) fn count(&self) -> usize {
        self.kinds.len()
    }

    pub(crate) fn kind(&self, slot: u32) -> Kind {
        self.kinds[slot as usize]
    }

    /// Returns the words of a slot: the bits, then the mask of the unknown ones.
    #[inline]
    pub(crate) fn words(&self, slot: u32) -> &[u64] {
        let from = self.offsets[slot as usize];
        &self.words[from..from + words_of(self.kinds[slot as usize])]
    }

    /// Sets a slot's words; returns whether that changed them.
    #[inline]
    pub(crate) fn set(&mut self, slot: u32, words: &[u64]) -> bool {
        let from = self.offsets[slot as usize];
        let own = &mut self.words[from..from + words.len()];
        if let ([own_bits, own_unknown], [bits, unknown]) = (&mut *own, words) {
            if own_bits == bits && own_unknown == unknown {
                return false;
            }
            (*own_bits, *own_unknown) = (*bits, *unknown);
            return true;
        }
        if own == words {
            return false;
        }
        own.copy_from_slice(words);
        true
    }

    /// Sets one bit of a slot: 0 or 1, known or not.
    pub(crate) fn set_bit(&mut self, slot: u32, bit: u32, [value, unknown]: [u64; 2]) {
        let from = self.offsets[slot as usize];
        let half = words_of(self.kinds[slot as usize]) / 2;
        let (at, shift) = (from + bit as usize / 64, bit % 64);
        for (word, value) in [(at, value), (at + half, unknown)] {
            self.words[word] = self.words[word] & !(1 << shift) | (value & 1) << shift;
        }
    }

    pub(crate) fn get(&self, slot: u32) -> Value<'_> {
        value(self.kinds[slot as usize], self.words(slot))
    }
}

/// Converts the words of a kind to a value.
pub(crate) fn value(kind: Kind, words: &[u64]) -> Value<'_> {
    let (bits, unknown) = words.split_at(words.len() / 2);
    match kind {
        Kind::Bits(width) => Value::Bits { width, bits, unknown },
        Kind::Real => Value::Real((unknown[0] == 0).then_some(f64::from_bits(bits[0]))),
        Kind::Text => Value::Text(words),
        Kind::Event => Value::Event(bits[0]),
        Kind::Any(_) => any(words),
    }
}
