//! The table of a log: finds its header, decides what its columns are, and reads its rows.

use super::names::{self, Meaning, Name};
use super::text::{DAY_S, Said, in_utf8, is_remark, number, separator, time_of_day};
use super::uses::{self, Target, Uses};
use super::{LogError, ReadOptions, Remark};
use csv::{ByteRecord, ReaderBuilder, Trim};

/// A column that is used.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub(super) name: String,
    pub(super) meaning: Meaning,
    /// Factor by which its values were multiplied, if its name has a unit.
    pub(super) factor: Option<f64>,
    pub(super) values: Vec<f64>,
}

/// A log as it is in its file, in SI units where its names give units.
pub(super) struct Table {
    pub(super) times_s: Vec<f64>,
    /// Line of each row in the file.
    pub(super) lines: Vec<u64>,
    pub(super) columns: Vec<Column>,
    /// What is to be said of columns that are not used.
    pub(super) remarks: Vec<Remark>,
    /// Name of the column of times, if it does not state its unit.
    pub(super) plain_time: Option<String>,
}

/// Lines before the header that are none of it, at most.
const PREAMBLE: usize = 64;

type Reader<'a> = csv::Reader<&'a [u8]>;

/// The next record; the reader accepts any number of fields and any bytes, so it cannot fail on a text in memory.
fn next(reader: &mut Reader<'_>, record: &mut ByteRecord) -> bool {
    reader.read_byte_record(record).unwrap_or(false)
}

/// Reads header and rows.
pub(super) fn read(text: &[u8], options: &ReadOptions) -> Result<Table, LogError> {
    let text = &*in_utf8(text)?;
    let (separator, text) = separator(text);
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .trim(Trim::All)
        .from_reader(&*text);
    let mut record = ByteRecord::new();
    let mut said = Said::default();
    let (header, mut has_row) = header(&mut reader, &mut record, &mut said, options)?;
    let Uses {
        fields,
        mut columns,
        mut remarks,
        is_numbered,
        question,
    } = uses::uses(&header, options)?;
    let (mut times, mut lines) = (Vec::new(), Vec::new());
    let mut clock = Clock::default();
    while std::mem::replace(&mut has_row, false) || next(&mut reader, &mut record) {
        let line = line(&record);
        let first = record.get(0).unwrap_or_default();
        if is_remark(first) && separator != first[0] {
            said.hear(&joined(&record));
            continue;
        }
        if is_numbered && number(first).is_none() && first.first().is_some_and(u8::is_ascii_alphabetic) {
            let text = joined(&record);
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
        lines.push(line);
    }
    if let Some(count) = said.overflows.filter(|count| *count > 0) {
        remarks.push(Remark::Overflows(count));
    }
    if lines.is_empty() {
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
        times = match is_numbered && times.len() == lines.len() {
            true => times.iter().map(|number| number / rate_hz).collect(),
            false => (0..lines.len()).map(|row| row as f64 / rate_hz).collect(),
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

/// Times of day, which begin anew at midnight.
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

/// The header, and whether `record` then has the first row. Lines of remarks before the header are passed by, and what instruments
/// write there of themselves.
fn header(
    reader: &mut Reader<'_>,
    record: &mut ByteRecord,
    said: &mut Said,
    options: &ReadOptions,
) -> Result<(Vec<Name>, bool), LogError> {
    let mut passed: Vec<(bool, Vec<Name>)> = Vec::new();
    let mut found = None;
    let mut first_line = 0;
    while found.is_none() {
        if !next(reader, record) {
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
            first_line = line(record);
        }
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
    let has_row = found.is_none() || next(reader, record);
    if let Some(given) = &options.columns {
        // What stands below the header may still be a line of units.
        let has_row = has_row && (numbers(record) > 0 || next(reader, record));
        let fields = if has_row { record.len() } else { given.len() };
        return Ok((given_names(given, fields)?, has_row));
    }
    let mut header = match found {
        Some(names) => names,
        None => above(passed, record).ok_or(LogError::NoHeader { line: first_line })?,
    };
    if has_row && numbers(record) == 0 && with_units(&mut header, record) {
        let has_row = next(reader, record);
        return Ok((header, has_row));
    }
    Ok((header, has_row))
}

/// Of the lines above the first row, the last with as many fields; one of units belongs to the line before it.
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

/// The names of `--columns`, with unused columns behind them.
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

fn line(record: &ByteRecord) -> u64 {
    record.position().map_or(0, csv::Position::line)
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
    // Some loggers write the header as a remark that says so.
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

/// Adds the units of a line below the header to its names, as `(ms)` or `second`; whether it is one.
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
