//! One TOML table with its place in the file; each getter checks the value that it returns.
//!
//! A getter returns `None` where the key is absent and where its value is refused. A refusal is recorded in the
//! [`Reader`], which then ends in an error whatever the caller does with the `None`.

mod unknown;

use std::cell::RefCell;
use std::fmt::Display;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::ClockSection;
use super::error::ProblemCause;
use super::hint;
use super::names::{NAME_RULE, is_name, mended};
use super::range::{NumberRange, RATIO_ROUNDING};
use super::reader::Reader;
use crate::spelling::did_you_mean;
use posicast_shaper::unit::show_seconds;

/// One table of the file.
pub(super) struct Table<'r, 't> {
    reader: &'r Reader<'t>,
    entries: &'r DeTable<'t>,
    header: Range<usize>,
    path: String,
    place: String,
    /// Keys that are absent because the file has them misspelt, which has been reported already.
    misspelt: RefCell<Vec<&'static str>>,
}

impl<'r, 't> Table<'r, 't> {
    /// The file's outermost table.
    pub(super) fn root(reader: &'r Reader<'t>, entries: &'r DeTable<'t>) -> Self {
        Self {
            reader,
            entries,
            header: 0..0,
            path: String::new(),
            place: String::new(),
            misspelt: RefCell::default(),
        }
    }

    /// Sets the place that distinguishes this table from others of its kind in messages.
    pub(super) fn at(self, place: String) -> Self {
        Self { place, ..self }
    }

    /// Text that distinguishes this table from others of its kind in messages.
    pub(super) fn place(&self) -> &str {
        &self.place
    }

    fn dotted(&self, key: &str) -> String {
        match self.path.as_str() {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        }
    }

    fn value(&self, key: &str) -> Option<&'r Spanned<DeValue<'t>>> {
        self.entries.get(key)
    }

    /// The text of a file beside the machine file, or why it cannot be read.
    pub(super) fn beside(&self, name: &str) -> Result<String, String> {
        self.reader.beside(name)
    }

    /// Whether the key is there, right or wrong.
    pub(super) fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    /// Returns whether a table inside this one has this word under a key. It reports nothing.
    pub(super) fn has_word(&self, table: &str, key: &str, word: &str) -> bool {
        let inner = self.value(table).and_then(|value| value.get_ref().as_table());
        let found = inner
            .and_then(|entries| entries.get(key))
            .and_then(|value| value.get_ref().as_str());
        found == Some(word)
    }

    /// Whether a text is under a key. Reports nothing.
    pub(super) fn has_text(&self, key: &str) -> bool {
        self.value(key).is_some_and(|value| value.get_ref().as_str().is_some())
    }

    /// The number under a key, if it is one. Reports nothing.
    pub(super) fn number_if_any(&self, key: &str) -> Option<f64> {
        as_number(self.value(key)?.get_ref())
    }

    /// Line of a key's value, or of the header where the key is absent.
    pub(super) fn line_of(&self, key: &str) -> usize {
        self.reader.line(self.span_of(key).start)
    }

    fn span_of(&self, key: &str) -> Range<usize> {
        self.value(key).map_or(self.header.clone(), Spanned::span)
    }

    /// The value as it stands in the file.
    pub(super) fn quote(&self, key: &str) -> String {
        self.reader.quote(self.span_of(key))
    }

    /// Records a problem at a key's value, or at the header where the key is absent.
    pub(super) fn report(&self, key: &str, cause: ProblemCause, remedy: impl Into<String>) {
        let reader = self.reader;
        let problem = reader.problem(self.span_of(key), self.dotted(key), &self.place, cause, remedy.into());
        reader.report(problem);
    }

    /// Records a value that has the right type but is refused.
    pub(super) fn refuse(&self, key: &str, allowed: impl Display, remedy: impl Into<String>) {
        let found = self.quote(key);
        let allowed = allowed.to_string();
        self.report(key, ProblemCause::OutOfRange { found, allowed }, remedy);
    }

    /// Records keys that contradict each other.
    pub(super) fn contradiction(
        &self,
        key: &str,
        found: impl Into<String>,
        allowed: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let (found, allowed) = (found.into(), allowed.into());
        self.report(key, ProblemCause::Inconsistent { found, allowed }, remedy);
    }

    /// Records a value that an earlier table already has.
    pub(super) fn duplicate(&self, key: &str, first_line: usize, allowed: &str) {
        let (found, allowed) = (self.quote(key), allowed.to_owned());
        self.report(
            key,
            ProblemCause::Duplicate {
                found,
                first_line,
                allowed,
            },
            "choose another name",
        );
    }

    fn wrong_type(&self, key: &str, value: &Spanned<DeValue<'_>>, allowed: impl Display) {
        let allowed = allowed.to_string();
        let cause = ProblemCause::WrongType {
            found_type: value.get_ref().type_str(),
            found: self.reader.quote(value.span()),
            allowed: allowed.clone(),
        };
        let remedy = hint::of_type(key, value.get_ref(), &allowed, &self.dotted(key));
        self.report(key, cause, remedy);
    }

    /// A number in a range; integers count as numbers.
    pub(super) fn number(&self, key: &str, range: NumberRange) -> Option<f64> {
        let value = self.value(key)?;
        let Some(number) = as_number(value.get_ref()) else {
            self.wrong_type(key, value, format_args!("a number, {range}"));
            return None;
        };
        if !range.contains(number) {
            self.refuse(key, range, hint::of_number(key, number, range));
            return None;
        }
        Some(number)
    }

    /// A number that must be there.
    pub(super) fn required_number(&self, key: &str, range: NumberRange) -> Option<f64> {
        self.require(key, range);
        self.number(key, range)
    }

    /// A whole number from `low` to `high`.
    pub(super) fn integer(&self, key: &str, low: u32, high: u32) -> Option<u32> {
        let value = self.value(key)?;
        let allowed = format!("a whole number, {low} to {high}");
        let DeValue::Integer(integer) = value.get_ref() else {
            self.wrong_type(key, value, allowed);
            return None;
        };
        let parsed = u32::from_str_radix(integer.as_str(), integer.radix()).ok();
        let inside = parsed.filter(|n| (low..=high).contains(n));
        if inside.is_none() {
            self.refuse(key, allowed, format!("give `{key}` a value in this range"));
        }
        inside
    }

    /// A whole number out of a list.
    pub(super) fn one_of(&self, key: &str, list: &[u32]) -> Option<u32> {
        let value = self.value(key)?;
        let texts: Vec<String> = list.iter().map(u32::to_string).collect();
        let allowed = texts.join(", ");
        let DeValue::Integer(integer) = value.get_ref() else {
            self.wrong_type(key, value, format_args!("a whole number: {allowed}"));
            return None;
        };
        let parsed = u32::from_str_radix(integer.as_str(), integer.radix()).ok();
        let listed = parsed.filter(|n| list.contains(n));
        if listed.is_none() {
            self.refuse(key, allowed, "choose one of the list");
        }
        listed
    }

    /// True or false.
    pub(super) fn boolean(&self, key: &str) -> Option<bool> {
        let value = self.value(key)?;
        let boolean = value.get_ref().as_bool();
        if boolean.is_none() {
            self.wrong_type(key, value, "true or false");
        }
        boolean
    }

    /// Reads a text. `allowed` describes the allowed texts in messages.
    pub(super) fn text(&self, key: &str, allowed: impl Display) -> Option<&'r str> {
        let value = self.value(key)?;
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.wrong_type(key, value, format_args!("a text: {allowed}"));
        }
        text
    }

    /// A name that can be used in Verilog and in C; the key is required.
    pub(super) fn required_name(&self, key: &str) -> Option<String> {
        self.require(key, NAME_RULE);
        let name = self.text(key, NAME_RULE)?;
        if !is_name(name) {
            let remedy = mended(name).map_or("choose another name".to_owned(), |name| {
                format!("choose another name, such as `{key} = \"{name}\"`")
            });
            self.refuse(key, NAME_RULE, remedy);
            return None;
        }
        Some(name.to_owned())
    }

    /// One of a list of words.
    pub(super) fn choice<'w>(&self, key: &str, words: &[&'w str]) -> Option<&'w str> {
        self.choice_else(key, words, "choose one of the list")
    }

    /// One of a list of words; `otherwise` is the remedy for a word that is not nearly one of them.
    pub(super) fn choice_else<'w>(&self, key: &str, words: &[&'w str], otherwise: &str) -> Option<&'w str> {
        let list = words.join(", ");
        let text = self.text(key, &list)?;
        let word = words.iter().find(|word| **word == text).copied();
        if word.is_none() {
            let remedy = did_you_mean(text, words, '"').unwrap_or(otherwise.to_owned());
            let found = self.quote(key);
            self.report(key, ProblemCause::NotAChoice { found, allowed: list }, remedy);
        }
        word
    }

    /// The value that one of these words stands for.
    pub(super) fn word<T: Copy, const N: usize>(&self, key: &str, words: &[(T, &str); N]) -> Option<T> {
        let word = self.choice(key, &words.map(|(_, name)| name))?;
        let found = words.iter().find(|(_, name)| *name == word);
        found.map(|(value, _)| *value)
    }

    /// Refuses a time that is longer than this many clocks.
    pub(super) fn at_most_clocks(
        &self,
        (key, seconds): (&str, f64),
        clock: Option<ClockSection>,
        most: u32,
        remedy: &str,
    ) {
        let longest_s = clock.map(|clock| f64::from(most) / clock.frequency_hz);
        if let Some(longest_s) = longest_s.filter(|longest_s| seconds > longest_s * (1.0 + RATIO_ROUNDING)) {
            let found = format!("{key} = {}", self.quote(key));
            let allowed = format!("at most {}, {most} clocks", show_seconds(longest_s, 4));
            self.contradiction(key, found, allowed, remedy);
        }
    }

    /// One of a list of words; the key is required.
    pub(super) fn required_choice<'w>(&self, key: &str, words: &[&'w str]) -> Option<&'w str> {
        self.require(key, words.join(", "));
        self.choice(key, words)
    }

    /// The values for a list of words, which may be empty.
    pub(super) fn choices<T: Copy>(&self, key: &str, words: &[(&str, T)]) -> Option<Vec<T>> {
        let value = self.value(key)?;
        let names: Vec<&str> = words.iter().map(|(name, _)| *name).collect();
        let list = names.join(", ");
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, format_args!("a list of words, each one of {list}"));
            return None;
        };
        let mut chosen = Vec::new();
        for element in array {
            let text = element.get_ref().as_str();
            let word = words.iter().find(|(name, _)| Some(*name) == text);
            let Some((_, meaning)) = word else {
                let near = text.and_then(|text| did_you_mean(text, &names, '"'));
                let remedy = near.unwrap_or("choose of the list".to_owned());
                let found = self.reader.quote(element.span());
                self.report(key, ProblemCause::NotAChoice { found, allowed: list }, remedy);
                return None;
            };
            chosen.push(*meaning);
        }
        Some(chosen)
    }

    /// A list of `N` numbers in a range.
    pub(super) fn numbers<const N: usize>(&self, key: &str, range: NumberRange) -> Option<[f64; N]> {
        let value = self.value(key)?;
        let numbers = numbers_of(value.get_ref(), range);
        if numbers.is_none() {
            self.wrong_type(key, value, format_args!("a list of {N} numbers, each {range}"));
        }
        numbers
    }

    /// A list of 1 to `most` numbers in a range.
    pub(super) fn list(&self, key: &str, range: NumberRange, most: usize) -> Option<Vec<f64>> {
        let value = self.value(key)?;
        let array = value
            .get_ref()
            .as_array()
            .filter(|array| (1..=most).contains(&array.len()));
        let numbers = array.and_then(|array| array.iter().map(|number| as_number(number.get_ref())).collect());
        let numbers = numbers.filter(|numbers: &Vec<f64>| numbers.iter().all(|number| range.contains(*number)));
        if numbers.is_none() {
            self.wrong_type(key, value, format_args!("a list of 1 to {most} numbers, each {range}"));
        }
        numbers
    }

    /// A list of rows of `N` numbers, each in a range; `names` names the numbers of a row.
    pub(super) fn rows<const N: usize>(
        &self,
        key: &str,
        range: NumberRange,
        names: &str,
        most: usize,
    ) -> Option<Vec<[f64; N]>> {
        let value = self.value(key)?;
        let kind = if N == 2 { "pairs" } else { "rows" };
        let allowed = format!("a list of 1 to {most} {kind} [{names}], each number {range}");
        let Some(array) = value
            .get_ref()
            .as_array()
            .filter(|rows| (1..=most).contains(&rows.len()))
        else {
            self.wrong_type(key, value, allowed);
            return None;
        };
        let mut rows = Vec::with_capacity(array.len());
        for row in array {
            let Some(numbers) = numbers_of(row.get_ref(), range) else {
                self.wrong_type(key, row, allowed);
                return None;
            };
            rows.push(numbers);
        }
        Some(rows)
    }

    /// A table inside this one.
    pub(super) fn table(&self, key: &str) -> Option<Table<'r, 't>> {
        let value = self.value(key)?;
        let Some(entries) = value.get_ref().as_table() else {
            self.wrong_type(key, value, format_args!("a table, [{}]", self.dotted(key)));
            return None;
        };
        Some(self.inner(key, value.span(), entries))
    }

    /// The tables of an array of 1 to `most` tables; empty where the key is absent.
    pub(super) fn tables(&self, key: &str, most: usize) -> Vec<Table<'r, 't>> {
        let Some(value) = self.value(key) else {
            return Vec::new();
        };
        let header = self.dotted(key);
        let allowed = format!("1 to {most} tables [[{header}]]");
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, allowed);
            return Vec::new();
        };
        if !(1..=most).contains(&array.len()) {
            let found = format!("{} tables", array.len());
            self.contradiction(key, found, allowed, format!("give 1 to {most} tables [[{header}]]"));
            return Vec::new();
        }
        let mut tables = Vec::with_capacity(array.len());
        for element in array {
            match element.get_ref().as_table() {
                Some(entries) => tables.push(self.inner(key, element.span(), entries)),
                None => self.wrong_type(key, element, &allowed),
            }
        }
        tables
    }

    fn inner(&self, key: &str, header: Range<usize>, entries: &'r DeTable<'t>) -> Table<'r, 't> {
        Table {
            reader: self.reader,
            entries,
            header,
            path: self.dotted(key),
            place: self.place.clone(),
            misspelt: RefCell::default(),
        }
    }
}

/// The number that a value stands for. A number beyond `f64` becomes infinite, which no range contains.
fn as_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(i) if i.radix() == 10 => i.as_str().parse().ok(),
        DeValue::Integer(i) => Some(u64::from_str_radix(i.as_str(), i.radix()).map_or(f64::INFINITY, |n| n as f64)),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}

fn numbers_of<const N: usize>(value: &DeValue<'_>, range: NumberRange) -> Option<[f64; N]> {
    let array = value.as_array()?;
    let numbers: Option<Vec<f64>> = array.iter().take(N + 1).map(|v| as_number(v.get_ref())).collect();
    let numbers: [f64; N] = numbers?.try_into().ok()?;
    numbers.iter().all(|n| range.contains(*n)).then_some(numbers)
}
