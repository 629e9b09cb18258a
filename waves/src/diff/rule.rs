//! Decides when two values are equal, and how they are shown.

use std::fmt;

use super::value::{Shown, UnknownPolicy};
use crate::reader::Value;

/// How bits are read as a number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum View {
    /// Bit by bit, not as a number.
    #[default]
    Bits,
    /// Two's complement, with this many bits after the binary point.
    Signed {
        /// Number of bits after the point, 0..=128.
        fraction: u8,
    },
    /// Without a sign, with this many bits after the binary point.
    Unsigned {
        /// Number of bits after the point, 0..=128.
        fraction: u8,
    },
}

impl View {
    pub(super) fn parse(text: &str) -> Option<Self> {
        match text {
            "bits" => return Some(Self::Bits),
            "signed" => return Some(Self::Signed { fraction: 0 }),
            "unsigned" => return Some(Self::Unsigned { fraction: 0 }),
            _ => {}
        }
        let (signed, format) = match text.strip_prefix("uq") {
            Some(format) => (false, format),
            None => (true, text.strip_prefix('q')?),
        };
        let number = |digits: &str| digits.parse::<u8>().ok().filter(|bits| *bits <= 128);
        let fraction = match format.split_once('.') {
            // The bits before the point follow from the width; writing them helps those who read the command.
            Some((whole, fraction)) => number(whole).and(number(fraction))?,
            None => number(format)?,
        };
        Some(if signed {
            Self::Signed { fraction }
        } else {
            Self::Unsigned { fraction }
        })
    }

    fn signed(self) -> bool {
        !matches!(self, Self::Unsigned { .. })
    }

    fn fraction(self) -> u8 {
        match self {
            Self::Bits => 0,
            Self::Signed { fraction } | Self::Unsigned { fraction } => fraction,
        }
    }

    /// Returns the largest width with which it can calculate.
    pub(super) fn widest(self) -> u32 {
        if self.signed() { 128 } else { 127 }
    }
}

impl fmt::Display for View {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bits => f.write_str("bits"),
            Self::Signed { fraction: 0 } => f.write_str("signed"),
            Self::Unsigned { fraction: 0 } => f.write_str("unsigned"),
            Self::Signed { fraction } => write!(f, "q{fraction}"),
            Self::Unsigned { fraction } => write!(f, "uq{fraction}"),
        }
    }
}

/// Largest difference of two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Difference in units of the last bit; for reals, in their own unit.
    Lsb(f64),
    /// Difference in the number's unit, after the binary point is applied.
    Absolute(f64),
    /// Difference as a fraction of the larger of the two.
    Relative(f64),
}

impl Tolerance {
    pub(super) fn parse(text: &str) -> Option<Self> {
        let (number, make): (&str, fn(f64) -> Self) = if let Some(number) = text.strip_suffix('%') {
            (number, |percent| Self::Relative(percent / 100.0))
        } else if let Some(number) = text.strip_suffix("abs") {
            (number, Self::Absolute)
        } else {
            (text.strip_suffix("lsb").unwrap_or(text), Self::Lsb)
        };
        let number: f64 = number.trim_end().parse().ok()?;
        (number.is_finite() && number >= 0.0).then(|| make(number))
    }

    fn limit(self, a: f64, b: f64, lsb: f64) -> f64 {
        match self {
            Self::Lsb(count) => count * lsb,
            Self::Absolute(limit) => limit,
            Self::Relative(part) => part * a.abs().max(b.abs()),
        }
    }
}

impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lsb(count) => write!(f, "{count} LSB"),
            Self::Absolute(limit) => write!(f, "{limit} absolute"),
            Self::Relative(part) => write!(f, "{} %", 100.0 * part),
        }
    }
}

/// How the two values of a pair are compared.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Rule {
    pub(super) view: View,
    pub(super) tolerance: Option<Tolerance>,
    pub(super) unknown: UnknownPolicy,
    /// Whether real numbers are compared to the 16 digits that a VCD has: the other file is an FST.
    pub(super) to_16_digits: bool,
}

/// Returns whether two numbers are the same as a VCD has them, `%.16g`.
fn same_16_digits(a: f64, b: f64) -> bool {
    a.is_finite() && b.is_finite() && format!("{a:.15e}") == format!("{b:.15e}")
}

impl Rule {
    /// Returns whether words are simply compared for equality.
    pub(super) fn is_plain(&self) -> bool {
        self.tolerance.is_none() && self.unknown == UnknownPolicy::Strict
    }

    /// Returns how the bits are read: as signed numbers if there is a tolerance and no view.
    pub(super) fn reading(&self) -> View {
        match (self.view, self.tolerance) {
            (View::Bits, Some(_)) => View::Signed { fraction: 0 },
            (view, _) => view,
        }
    }

    fn lsb(&self) -> f64 {
        (-f64::from(self.view.fraction())).exp2()
    }

    pub(super) fn equal(&self, a: Value<'_>, b: Value<'_>) -> bool {
        match (a, b) {
            (Value::Bits { .. }, Value::Bits { .. }) => {
                if let (Some(tolerance), Some(a), Some(b)) = (self.tolerance, self.whole(a), self.whole(b)) {
                    let (a, b, lsb) = (a as f64 * self.lsb(), b as f64 * self.lsb(), (a.abs_diff(b)));
                    return lsb == 0 || lsb as f64 * self.lsb() <= tolerance.limit(a, b, self.lsb());
                }
                self.same_bits(a, b)
            }
            (Value::Real(None), Value::Real(None)) => true,
            (Value::Real(Some(a)), Value::Real(Some(b))) => self.near(a, b),
            (Value::Real(Some(real)), bits) | (bits, Value::Real(Some(real))) => match self.whole(bits) {
                Some(whole) => self.near(whole as f64 * self.lsb(), real),
                None => self.unknown == UnknownPolicy::Wildcard,
            },
            // Neither has had a value yet.
            (Value::Real(None), Value::Bits { unknown, .. }) | (Value::Bits { unknown, .. }, Value::Real(None)) => {
                unknown.iter().any(|word| *word != 0)
            }
            (Value::Text(a), Value::Text(b)) => a == b,
            (Value::Event(a), Value::Event(b)) => a == b,
            // Neither has had a value yet, and the kind of one is unknown.
            (Value::Text([0, ..]), Value::Real(None)) | (Value::Real(None), Value::Text([0, ..])) => true,
            (Value::Text([0, ..]), Value::Bits { unknown, .. })
            | (Value::Bits { unknown, .. }, Value::Text([0, ..])) => unknown.iter().any(|word| *word != 0),
            _ => false,
        }
    }

    fn near(&self, a: f64, b: f64) -> bool {
        // A share of infinity is infinite, so no number may count as within a tolerance of it.
        let within = || {
            self.tolerance
                .is_some_and(|t| (a - b).is_finite() && (a - b).abs() <= t.limit(a, b, self.lsb()))
        };
        a == b || (a.is_nan() && b.is_nan()) || within() || (self.to_16_digits && same_16_digits(a, b))
    }

    /// Returns whether two values that count as equal agree only in the digits that a VCD has.
    pub(super) fn rounds(&self, a: Value<'_>, b: Value<'_>) -> bool {
        let exactly = Self {
            to_16_digits: false,
            ..*self
        };
        self.to_16_digits && matches!((a, b), (Value::Real(_), Value::Real(_))) && !exactly.equal(a, b)
    }

    /// Returns the distance of two numbers, at least one of which is real.
    pub(super) fn distance(&self, a: Value<'_>, b: Value<'_>) -> Option<f64> {
        let number = |value: Value<'_>| match value {
            Value::Real(real) => real,
            Value::Bits { .. } => self.whole(value).map(|whole| whole as f64 * self.lsb()),
            _ => None,
        };
        let is_real = [a, b].iter().any(|value| matches!(value, Value::Real(_)));
        let distance = (number(a)? - number(b)?).abs();
        (is_real && distance.is_finite()).then_some(distance)
    }

    /// Returns the bits as a whole number of LSB; `None` with unknown bits that are not zero by the policy.
    fn whole(&self, value: Value<'_>) -> Option<i128> {
        // A single bit is 0 or 1, if no view says otherwise.
        let signed = match (self.view, value) {
            (View::Bits, Value::Bits { width: 1, .. }) => false,
            (view, _) => view.signed(),
        };
        let known = value.integer(signed);
        if known.is_some() || self.unknown != UnknownPolicy::Zero {
            return known;
        }
        let Value::Bits { width, bits, unknown } = value else {
            return None;
        };
        let words: Vec<u64> = bits
            .iter()
            .zip(unknown)
            .map(|(bits, unknown)| bits & !unknown)
            .collect();
        let zeros = vec![0; words.len()];
        let cleared = Value::Bits {
            width,
            bits: &words,
            unknown: &zeros,
        };
        cleared.integer(signed)
    }

    /// Compares bit by bit; the narrower value is extended with zeros, or in a signed view with its sign.
    fn same_bits(&self, a: Value<'_>, b: Value<'_>) -> bool {
        let extend = matches!(self.view, View::Signed { .. });
        let words = words(a).max(words(b));
        (0..words).all(|at| {
            let ([a, a_unknown], [b, b_unknown]) = (word(a, at, extend), word(b, at, extend));
            match self.unknown {
                UnknownPolicy::Strict => a == b && a_unknown == b_unknown,
                UnknownPolicy::Wildcard => (a ^ b) & !(a_unknown | b_unknown) == 0,
                UnknownPolicy::Zero => a & !a_unknown == b & !b_unknown,
            }
        })
    }

    /// Returns both values as the report shows them, vectors in the width of the wider.
    pub(super) fn shown(&self, a: Option<Value<'_>>, b: Option<Value<'_>>) -> (Shown, Shown) {
        let width = |value: &Option<Value<'_>>| match value {
            Some(Value::Bits { width, .. }) => *width,
            _ => 0,
        };
        let wider = width(&a).max(width(&b));
        let signed = matches!(self.reading(), View::Signed { .. });
        let show = |value: Option<Value<'_>>| match value {
            Some(bits @ Value::Bits { .. }) => Shown::Bits(bits.digits(wider, signed)),
            Some(Value::Real(Some(real))) => Shown::Real(real),
            Some(text @ Value::Text(_)) => text.text().map_or(Shown::Missing, Shown::Text),
            Some(Value::Event(count)) => Shown::Real(count as f64),
            Some(Value::Real(None)) | None => Shown::Missing,
        };
        (show(a), show(b))
    }

    /// Returns the value as a number, if it is read as one.
    pub(super) fn number(&self, value: Option<Value<'_>>) -> Option<f64> {
        match value? {
            Value::Real(real) => real,
            _ if self.view == View::Bits && self.tolerance.is_none() => None,
            bits => self.whole(bits).map(|whole| whole as f64 * self.lsb()),
        }
    }
}

fn words(value: Value<'_>) -> usize {
    match value {
        Value::Bits { bits, .. } => bits.len(),
        _ => 0,
    }
}

/// Returns word `at` of the bits and of the unknown ones; missing words are zero or the sign.
fn word(value: Value<'_>, at: usize, extend: bool) -> [u64; 2] {
    let Value::Bits { width, bits, unknown } = value else {
        return [0; 2];
    };
    [bits, unknown].map(|words| {
        let sign = words.last().map_or(0, |last| last >> ((width - 1) % 64) & 1);
        let fill = if extend && sign == 1 { u64::MAX } else { 0 };
        match words.get(at) {
            Some(word) if at + 1 == words.len() && width % 64 != 0 => word | fill << (width % 64),
            Some(word) => *word,
            None => fill,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(width: u32, words: &[u64]) -> Value<'_> {
        let (bits, unknown) = words.split_at(words.len() / 2);
        Value::Bits { width, bits, unknown }
    }

    #[test]
    fn views_and_tolerances_are_read() {
        assert_eq!(View::parse("q3.16"), Some(View::Signed { fraction: 16 }));
        assert_eq!(View::parse("uq8"), Some(View::Unsigned { fraction: 8 }));
        assert_eq!(Tolerance::parse("2"), Some(Tolerance::Lsb(2.0)));
        assert_eq!(Tolerance::parse("2lsb"), Some(Tolerance::Lsb(2.0)));
        assert_eq!(Tolerance::parse("0.25abs"), Some(Tolerance::Absolute(0.25)));
        assert_eq!(Tolerance::parse("50 %"), Some(Tolerance::Relative(0.5)));
    }

    #[test]
    fn fractions_scale_and_signs_extend() {
        let rule = |view, tolerance| Rule {
            view,
            tolerance,
            ..Rule::default()
        };
        let minus_half = bits(4, &[0b1110, 0]);
        let q2 = View::Signed { fraction: 2 };
        assert!(rule(q2, None).equal(minus_half, Value::Real(Some(-0.5))));
        assert!(rule(q2, None).equal(minus_half, bits(70, &[u64::MAX - 1, 63, 0, 0])));
        assert!(!rule(View::Bits, None).equal(minus_half, bits(70, &[u64::MAX - 1, 63, 0, 0])));
        let unsigned = View::Unsigned { fraction: 0 };
        assert!(rule(unsigned, Some(Tolerance::Lsb(1.0))).equal(minus_half, bits(4, &[0b1111, 0])));
        assert!(!rule(unsigned, Some(Tolerance::Lsb(1.0))).equal(minus_half, bits(4, &[0b0000, 0])));
        assert!(rule(q2, Some(Tolerance::Absolute(0.5))).equal(minus_half, bits(4, &[0, 0])));
        assert!(!rule(q2, Some(Tolerance::Absolute(0.49))).equal(minus_half, bits(4, &[0, 0])));
        assert!(rule(q2, Some(Tolerance::Relative(0.5))).equal(minus_half, bits(4, &[0b1111, 0])));
        assert!(!rule(q2, Some(Tolerance::Relative(0.49))).equal(minus_half, bits(4, &[0b1111, 0])));
    }

    #[test]
    fn infinity_equals_only_itself() {
        let near = |a: f64, b: f64| {
            let rule = Rule {
                tolerance: Some(Tolerance::Relative(0.5)),
                ..Rule::default()
            };
            rule.equal(Value::Real(Some(a)), Value::Real(Some(b)))
        };
        assert!(near(1.0, 1.5) && near(f64::INFINITY, f64::INFINITY) && near(f64::NAN, f64::NAN));
        assert!(!near(f64::INFINITY, 1e308) && !near(1.0, f64::INFINITY));
        assert!(!near(f64::INFINITY, f64::NEG_INFINITY) && !near(1.0, f64::NAN));
    }

    #[test]
    fn unknown_bits_by_policy() {
        let [zero, one, x, z] = [[0, 0], [1, 0], [0, 1], [1, 1]];
        for (policy, equal) in [
            (UnknownPolicy::Strict, [true, false, false, false]),
            (UnknownPolicy::Wildcard, [true, false, true, true]),
            (UnknownPolicy::Zero, [true, false, true, true]),
        ] {
            for (other, expected) in [zero, one, x, z].iter().zip(equal) {
                for tolerance in [None, Some(Tolerance::Lsb(0.0))] {
                    let rule = Rule {
                        unknown: policy,
                        tolerance,
                        ..Rule::default()
                    };
                    assert_eq!(
                        rule.equal(bits(1, &zero), bits(1, other)),
                        expected,
                        "{policy:?} {other:?}"
                    );
                    assert_eq!(
                        rule.equal(bits(1, other), bits(1, &zero)),
                        expected,
                        "{policy:?} {other:?}"
                    );
                }
            }
        }
    }
}
