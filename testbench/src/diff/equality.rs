//! When two values are equal, and how they are shown.

use super::Shown;
use crate::reader::Value;

/// Equal exactly, or as numbers within `tolerance`; rules in the module doc of [`super`].
pub(super) fn equal(a: Value<'_>, b: Value<'_>, tolerance: Option<f64>) -> bool {
    match (a, b) {
        (
            Value::Bits {
                bits: a_bits,
                unknown: a_unknown,
                ..
            },
            Value::Bits {
                bits: b_bits,
                unknown: b_unknown,
                ..
            },
        ) => {
            if let (Some(lsb), Some(a), Some(b)) = (tolerance, a.signed(), b.signed()) {
                return a.abs_diff(b) as f64 <= lsb;
            }
            same_words(a_bits, b_bits) && same_words(a_unknown, b_unknown)
        }
        (Value::Real(None), Value::Real(None)) => true,
        (Value::Real(Some(a)), Value::Real(Some(b))) => near(a, b, tolerance),
        (Value::Real(Some(real)), bits) | (bits, Value::Real(Some(real))) => {
            bits.signed().is_some_and(|number| near(number as f64, real, tolerance))
        }
        // Neither has had a value yet.
        (Value::Real(None), Value::Bits { unknown, .. }) | (Value::Bits { unknown, .. }, Value::Real(None)) => {
            unknown.iter().any(|word| *word != 0)
        }
        (Value::Real(None), Value::Other) | (Value::Other, _) | (Value::Bits { .. }, Value::Other) => false,
    }
}

fn near(a: f64, b: f64, tolerance: Option<f64>) -> bool {
    a == b || (a.is_nan() && b.is_nan()) || (a - b).abs() <= tolerance.unwrap_or(0.0)
}

/// Equal words, the shorter extended with zeros.
fn same_words(a: &[u64], b: &[u64]) -> bool {
    let common = a.len().min(b.len());
    let rest = a[common..].iter().chain(&b[common..]);
    a[..common] == b[..common] && rest.copied().all(|word| word == 0)
}

/// Both values as the report shows them, vectors in the width of the wider.
pub(super) fn shown(a: Option<Value<'_>>, b: Option<Value<'_>>, signed: bool) -> (Shown, Shown) {
    let width = |value: &Option<Value<'_>>| match value {
        Some(Value::Bits { width, .. }) => *width,
        _ => 0,
    };
    let wider = width(&a).max(width(&b));
    let show = |value: Option<Value<'_>>| match value {
        Some(bits @ Value::Bits { .. }) => Shown::Bits(bits.digits(wider, signed)),
        Some(Value::Real(Some(real))) => Shown::Real(real),
        Some(Value::Real(None) | Value::Other) | None => Shown::Missing,
    };
    (show(a), show(b))
}
