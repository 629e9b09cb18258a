//! Values as a report shows them, and what unknown ones equal.

use serde::{Serialize, Serializer};

/// A value in a report.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Shown {
    /// Binary digits, most significant first, `x` and `z` included.
    Bits(String),
    /// A real number; as JSON, which has no other word for it, `"NaN"` where it is none.
    Real(#[serde(serialize_with = "number_or_text")] f64),
    /// Text, its first 64 bytes.
    Text(String),
    /// There is no value: the signal or the clock edge is missing, or nothing was written yet.
    Missing,
}

fn number_or_text<S: Serializer>(real: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if real.is_finite() {
        serializer.serialize_f64(*real)
    } else {
        serializer.serialize_str(&real.to_string())
    }
}

/// What an unknown bit (`x`, `z`) equals.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum UnknownPolicy {
    /// `x` equals `x`, `z` equals `z`, nothing else.
    #[default]
    Strict,
    /// An unknown bit of either file equals anything.
    Wildcard,
    /// It is 0, as in two-valued simulators.
    Zero,
}
