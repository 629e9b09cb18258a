//! Values as a report shows them, and what unknown ones are equal to.

use serde::{Serialize, Serializer};

/// A value in a report.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Shown {
    /// Binary digits, most significant first, including `x` and `z`.
    Bits(String),
    /// A real number; in JSON, which has no notation for an invalid one, `"NaN"`.
    Real(
        #[serde(serialize_with = "number_or_text")]
        #[cfg_attr(feature = "schema", schemars(with = "f64"))]
        f64,
    ),
    /// The first 64 bytes of a text.
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

/// What an unknown bit (`x`, `z`) is equal to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum UnknownPolicy {
    /// `x` is equal only to `x`, `z` only to `z`.
    #[default]
    Strict,
    /// An unknown bit of either file is equal to anything.
    Wildcard,
    /// An unknown bit is 0, as in two-valued simulators.
    Zero,
}
