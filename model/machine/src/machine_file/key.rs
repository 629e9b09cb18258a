//! The keys of a table of the machine file, as data: name, allowed values, default, meaning.
//!
//! A reader gives its list to [`Table::allow`](super::table::Table::allow), which refuses every other key; [`super::schema`] writes
//! the same list as JSON Schema, and [`super::page`] as the tables of `docs/machine-file.md`. The ranges are the constants that the reader checks with.

use super::range::NumberRange;

/// A key of a table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) values: Values,
    /// Whether a file without it is refused.
    pub(super) required: bool,
    pub(super) default: Option<Default>,
    /// Another key that may stand in place of this one: a table has one of the two.
    pub(super) instead_of: Option<&'static str>,
    /// Another key and the word of it that goes with this one.
    pub(super) chosen_by: Option<(&'static str, &'static str)>,
    /// Another key that is only valid beside this one.
    pub(super) needed_by: Option<&'static str>,
    /// Meaning in a sentence, and the unit where the name does not end in it.
    pub(super) about: &'static str,
    /// Further requirements of the reader beyond `values`, as text for the page; often empty.
    pub(super) rule: &'static str,
}

/// Values that a key may have.
#[derive(Debug, Clone, Copy)]
pub(super) enum Values {
    /// A number; integers count as numbers.
    Number(NumberRange),
    /// A length or angle of the axis, or its velocity, acceleration or jerk, in the axis's unit. The range is in m or
    /// rad.
    Quantity(NumberRange),
    /// Counts per unit of the axis. The range is per m or rad.
    Counts(NumberRange),
    /// A whole number, from the first to the second, both included.
    Integer(u32, u32),
    /// A whole number of this list.
    OneOf(&'static [u32]),
    /// True or false.
    Boolean,
    /// A name that can stand in Verilog and in C.
    Name,
    /// The name of a CSV file beside the machine file.
    CsvName,
    /// A word of this list.
    Word(fn() -> Vec<&'static str>),
    /// A list of such words, which may be empty.
    Words(fn() -> Vec<&'static str>),
    /// A word of this list, or `[low, high]`.
    WordOrPair(fn() -> Vec<&'static str>, NumberRange),
    /// `[low, high]`, plain numbers.
    PlainPair(NumberRange),
    /// `[low, high]` in the axis's unit. The range is in m or rad.
    Pair(NumberRange),
    /// A list of pairs of numbers, at least 1 and at most this many.
    Pairs(NumberRange, usize),
    /// A list of rows whose numbers lie in these ranges, at least 1 row and at most this many.
    Rows(&'static [NumberRange], usize),
    /// A list of numbers, at least 1 and at most this many.
    Numbers(NumberRange, usize),
    /// A table.
    Table(&'static [Key]),
    /// An array of tables, at least 1 and at most this many.
    Tables(&'static [Key], usize),
}

/// The value of a key that is absent.
#[derive(Debug, Clone, Copy)]
pub(super) enum Default {
    Number(f64),
    Integer(u32),
    Boolean(bool),
    Word(&'static str),
}

impl Key {
    /// Makes an optional key without a default.
    pub(super) const fn new(name: &'static str, values: Values, about: &'static str) -> Self {
        Self {
            name,
            values,
            required: false,
            default: None,
            instead_of: None,
            chosen_by: None,
            needed_by: None,
            about,
            rule: "",
        }
    }

    /// Marks the key as required.
    pub(super) const fn required(self) -> Self {
        Self { required: true, ..self }
    }

    /// Gives the key a default.
    pub(super) const fn default(self, value: Default) -> Self {
        Self {
            default: Some(value),
            ..self
        }
    }

    /// Marks the key as an alternative to `other`: a table has one of the two.
    pub(super) const fn instead_of(self, other: &'static str) -> Self {
        Self {
            instead_of: Some(other),
            ..self
        }
    }

    /// Sets the word of another key that selects this one, for keys that replace each other.
    pub(super) const fn chosen_by(self, other: &'static str, word: &'static str) -> Self {
        Self {
            chosen_by: Some((other, word)),
            ..self
        }
    }

    /// Makes `other` valid only beside this key.
    pub(super) const fn needed_by(self, other: &'static str) -> Self {
        Self {
            needed_by: Some(other),
            ..self
        }
    }

    /// Sets the text on the page about requirements beyond type and range.
    pub(super) const fn rule(self, rule: &'static str) -> Self {
        Self { rule, ..self }
    }

    /// Makes an optional boolean, false by default.
    pub(super) const fn switch(name: &'static str, about: &'static str) -> Self {
        Self::new(name, Values::Boolean, about).default(Default::Boolean(false))
    }

    /// Makes an optional number, 0 by default.
    pub(super) const fn or_zero(name: &'static str, range: NumberRange, about: &'static str) -> Self {
        Self::new(name, Values::Number(range), about).default(Default::Number(0.0))
    }
}
