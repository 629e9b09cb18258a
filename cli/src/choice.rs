//! Options that take one of a few words.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use posicast_flow::choice::WordChoice;

/// Parses one of the words; the help lists them with their descriptions.
pub(crate) fn parser<T: WordChoice>() -> impl TypedValueParser<Value = T> {
    let words = T::ALL
        .iter()
        .map(|value| PossibleValue::new(value.word()).help(value.about()));
    PossibleValuesParser::new(words).try_map(|word| T::of_word(&word).ok_or("unknown word"))
}
