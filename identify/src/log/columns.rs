//! The table of a log: finds its header, decides what its columns are, and reads its rows.

use super::names::{self, Meaning, Name};
use super::records::Records;
use super::rows::{self, Layout, PlainRows};
use super::text::{DAY_S, Said, in_utf8, is_remark, number, separator, time_of_day};
use super::uses::{self, Target, Use, Uses};
use super::{LogError, ReadOptions, Remark};
use csv::ByteRecord;

/// A column that is used.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub(super) name: String,
    pub(super) meaning: Meaning,
    /// Factor by which its values were multiplied, if its name has a unit.
    pub(super) factor: Option<f64>,
    pub(super) values: Vec<f64>,
}

/// The columns of a log as its file has them; in SI units if their names give units.
pub(super) struct Table {
    pub(super) times_s: Vec<f64>,
    /// Line of each row in the file.
    pub(super) lines: Lines,
    pub(super) columns: Vec<Column>,
    /// Remarks on columns that are not used.
    pub(super) remarks: Vec<Remark>,
    /// Name of the column of times, if it does not state its unit.
    pub(super) plain_time: Option<String>,
}

/// Lines of rows in a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Lines {
    /// Line of the first of the plain rows, which follow each other line by line, and their number.
    first: u64,
    plain: usize,
    later: Vec<u64>,
}

impl Lines {
    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.plain + self.later.len()
    }

    /// Line of a row.
    pub(super) fn of(&self, row: usize) -> u64 {
        match row.checked_sub(self.plain) {
            None => self.first + row as u64,
            Some(later) => self.later.get(later).copied().unwrap_or_default(),
        }
    }
}

/// Largest number of lines before the header.
const PREAMBLE: usize = 64;

/// Reads header and rows.
pub(super) fn read(text: &[u8], options: &ReadOptions) -> Result<Table, LogError> {
    let text = &*in_utf8(text)?;
    let (separator, text) = separator(text);
    let mut records = Records::new(&text, separator);
    let mut said = Said::default();
    let (header, mut has_row) = header(&mut records, &mut said, options)?;
    let Uses {
        fields,
        mut columns,
        mut remarks,
        is_numbered,
        question,
    } = uses::uses(&header, options)?;
    let mut times = Vec::new();
    let mut lines = Lines::default();
    if has_row {
        let layout = Layout {
            separator,
            width: header.len(),
            used: &fields,
        };
        let (text, line) = records.rest();
        let plain = rows::plain(text, layout);
        if plain.rows > 0 {
            (lines.first, lines.plain) = (line, plain.rows);
            records.skip_lines(plain.bytes, plain.rows);
            has_row = false;
        }
        take(plain, &fields, &mut times, &mut columns, &mut said);
    }
    let mut clock = Clock::default();
    while std::mem::replace(&mut has_row, false) || records.next() {
        let line = records.line();
        let record = records.record();
        let first = record.get(0).unwrap_or_default();
        if is_remark(first) && separator != first[0] {
            said.hear(&joined(record));
            continue;
        }
        if is_numbered && number(first).is_none() && first.first().is_some_and(u8::is_ascii_alphabetic) {
            let text = joined(record);
            if !text.to_lowercase().starts_with("rate") {
                return Err(LogError::Recorder { line, text });
            }
            said.hear(&text);
            continue;
        }
        // Some writers end every line with a separator, and spreadsheets end a table with empty rows.
        let has_more = record.iter().skip(header.len()).any(|field| !field.is_empty());
        if record.iter().all(<[u8]>::is_empty) {
            continue;
        }
        if record.len() < header.len() || has_more {
            return Err(LogError::Fields {
                line,
                expected: header.len(),
                found: record.len(),
            });
        }
        for used in &fields {
            let text = &record[used.field];
            let value = match used.target {
                Target::Time => number(text)
                    .map(|value| value * used.factor)
                    .or_else(|| clock.read(text)),
                _ => number(text).map(|value| value * used.factor),
            };
            let value = value.ok_or_else(|| LogError::Number {
                line,
                column: header[used.field].text.clone(),
                text: String::from_utf8_lossy(text).into_owned(),
            })?;
            match used.target {
                Target::Time | Target::Index => times.push(value),
                Target::Rate if value > 0.0 => said.rate_hz = Some(value),
                Target::Rate => {}
                Target::Overflows => said.overflows = Some(value as u64),
                Target::Column(column) => columns[column].values.push(value),
            }
        }
        lines.later.push(line);
    }
    if let Some(count) = said.overflows.filter(|count| *count > 0) {
        remarks.push(Remark::Overflows(count));
    }
    if lines.len() == 0 {
        return Err(LogError::Rows {
            rows: 0,
            least: super::LEAST_ROWS,
        });
    }
    let has_times = fields.iter().any(|used| used.target == Target::Time);
    if !has_times || options.rate_hz.is_some() {
        let Some(rate_hz) = options.rate_hz.or(said.rate_hz) else {
            return Err(LogError::NoRate);
        };
        times = if is_numbered && times.len() == lines.len() {
            times.iter().map(|number| number / rate_hz).collect()
        } else {
            (0..lines.len()).map(|row| row as f64 / rate_hz).collect()
        };
    }
    uses::decide(&mut columns, &mut remarks, question)?;
    let plain_time = fields
        .iter()
        .find(|used| used.target == Target::Time && header[used.field].factor.is_none() && !clock.was_read)
        .map(|used| header[used.field].text.clone());
    Ok(Table {
        times_s: times,
        lines,
        columns,
        remarks,
        plain_time,
    })
}

/// Adds the values of plain rows.
fn take(plain: PlainRows, fields: &[Use], times: &mut Vec<f64>, columns: &mut [Column], said: &mut Said) {
    for (used, values) in fields.iter().zip(plain.values) {
        match used.target {
            Target::Time | Target::Index => *times = values,
            Target::Rate => said.rate_hz = values.iter().rev().copied().find(|value| *value > 0.0).or(said.rate_hz),
            Target::Overflows => said.overflows = values.last().map(|value| *value as u64).or(said.overflows),
            Target::Column(column) => columns[column].values = values,
        }
    }
}

/// Reads times of day, which restart at midnight.
#[derive(Default)]
struct Clock {
    was_read: bool,
    days: f64,
    before_s: f64,
}

impl Clock {
    fn read(&mut self, text: &[u8]) -> Option<f64> {
        let time_s = time_of_day(text)?;
        if time_s < self.before_s - 0.5 * DAY_S {
            self.days += 1.0;
        }
        self.before_s = time_s;
        self.was_read = true;
        Some(self.days * DAY_S + time_s)
    }
}

/// Returns the header, and whether the current record is the first row. Skips the lines before the header, and keeps the settings that
/// instruments write there.
fn header(records: &mut Records<'_>, said: &mut Said, options: &ReadOptions) -> Result<(Vec<Name>, bool), LogError> {
    let mut passed: Vec<(bool, Vec<Name>)> = Vec::new();
    let mut found = None;
    let mut first_line = 0;
    while found.is_none() {
        if !records.next() {
            return match (&options.columns, passed.into_iter().find(|(is_remark, _)| !is_remark)) {
                (None, Some((_, names))) => Ok((names, false)),
                (Some(_), Some(_)) => Err(LogError::Rows {
                    rows: 0,
                    least: super::LEAST_ROWS,
                }),
                _ => Err(LogError::Empty),
            };
        }
        if first_line == 0 {
            first_line = records.line();
        }
        let record = records.record();
        let first = record.get(0).unwrap_or_default();
        if number(first).is_some() || time_of_day(first).is_some() {
            break;
        }
        said.hear(&joined(record));
        let commented = is_remark(first);
        let names = names_of(record);
        let known = names.iter().filter(|name| name.meaning.is_some()).count();
        let is_spectrum = names
            .first()
            .is_some_and(|name| name.meaning == Some(Meaning::Frequency))
            && known < names.len();
        if known > 1 || is_spectrum || (known == 1 && !commented && names.len() < 3) || passed.len() > PREAMBLE {
            found = Some(names);
        } else {
            passed.push((commented, names));
        }
    }
    let has_row = found.is_none() || records.next();
    if let Some(given) = &options.columns {
        // What stands below the header may still be a line of units.
        let has_row = has_row && (numbers(records.record()) > 0 || records.next());
        let fields = if has_row { records.record().len() } else { given.len() };
        return Ok((given_names(given, fields)?, has_row));
    }
    let mut header = match found {
        Some(names) => names,
        None => above(passed, records.record()).ok_or(LogError::NoHeader { line: first_line })?,
    };
    if has_row && numbers(records.record()) == 0 && with_units(&mut header, records.record()) {
        let has_row = records.next();
        return Ok((header, has_row));
    }
    Ok((header, has_row))
}

/// Of the lines above the first row, returns the last that has as many fields. If that is a line of units, its units go to the line before
/// it.
fn above(mut passed: Vec<(bool, Vec<Name>)>, row: &ByteRecord) -> Option<Vec<Name>> {
    let fits = |names: &Vec<Name>| names.len() == row.len() || names.len() == row.len() + 1;
    let mut last = passed.iter().rposition(|(is_remark, names)| !is_remark && fits(names));
    let is_units = |names: &Vec<Name>| {
        names
            .iter()
            .all(|name| name.text.is_empty() || names::is_unit(&name.text))
    };
    if let Some(at) = last
        && at > 0
        && is_units(&passed[at].1)
        && passed[at - 1].1.len() == passed[at].1.len()
    {
        let (names, units) = (&passed[at - 1].1, &passed[at].1);
        return Some(
            names
                .iter()
                .zip(units)
                .map(|(name, unit)| with_unit(name, &unit.text))
                .collect(),
        );
    }
    if last.is_none() {
        last = passed.iter().position(|(is_remark, _)| !is_remark);
    }
    last.map(|at| passed.swap_remove(at).1)
}

/// Returns the names of `--columns`, followed by unused columns.
fn given_names(given: &[String], fields: usize) -> Result<Vec<Name>, LogError> {
    let unused = || Name {
        text: "-".into(),
        meaning: None,
        factor: None,
    };
    let named = given.iter().map(|text| match text.trim() {
        "-" | "_" | "" => Ok(unused()),
        text => {
            let name = Name::of(text);
            match name.meaning {
                Some(_) => Ok(name),
                None => Err(LogError::GivenName(text.to_owned())),
            }
        }
    });
    let mut names: Vec<Name> = named.collect::<Result<_, _>>()?;
    if names.len() > fields {
        return Err(LogError::GivenCount {
            given: names.len(),
            fields,
        });
    }
    names.resize_with(fields, unused);
    Ok(names)
}

fn numbers(record: &ByteRecord) -> usize {
    record
        .iter()
        .filter(|field| number(field).is_some() || time_of_day(field).is_some())
        .count()
}

fn joined(record: &ByteRecord) -> String {
    let fields: Vec<_> = record.iter().map(String::from_utf8_lossy).collect();
    fields.join(", ")
}

fn names_of(record: &ByteRecord) -> Vec<Name> {
    let mut names: Vec<Name> = record
        .iter()
        .map(|field| Name::of(&String::from_utf8_lossy(field)))
        .collect();
    // Some loggers write the header as a remark.
    if names
        .first()
        .is_some_and(|name| matches!(name.text.as_str(), "headers" | "header" | "columns" | "fields"))
    {
        names.remove(0);
    }
    names
}

fn with_unit(name: &Name, unit: &str) -> Name {
    match unit {
        "" => name.clone(),
        unit => Name::of(&format!("{} ({unit})", name.text)),
    }
}

/// Adds the units of a line below the header, such as `(ms)` or `second`, to the header's names; returns whether it is such a line.
fn with_units(header: &mut [Name], units: &ByteRecord) -> bool {
    let units = names_of(units);
    let more: Vec<Name> = header
        .iter()
        .zip(&units)
        .map(|(name, unit)| with_unit(name, &unit.text))
        .collect();
    let is_units = header
        .iter()
        .zip(&more)
        .any(|(name, more)| name != more && more.factor.is_some());
    if is_units {
        for (name, more) in header.iter_mut().zip(more) {
            if more.meaning.is_some() {
                *name = more;
            }
        }
    }
    is_units
}
