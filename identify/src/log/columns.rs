//! The columns of a log: meanings and numbers.

use super::LogError;
use csv::{ByteRecord, ReaderBuilder, Trim};

/// Meaning of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meaning {
    Time,
    Command,
    Response,
    /// Difference between motor and scale.
    Deviation,
    Acceleration,
}

/// A column that is used.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub(super) name: String,
    pub(super) meaning: Meaning,
    pub(super) values: Vec<f64>,
}

/// A log as it is in its file, in SI units where its names give units.
pub(super) struct Table {
    pub(super) times_s: Vec<f64>,
    /// Line of each row in the file.
    pub(super) lines: Vec<u64>,
    pub(super) columns: Vec<Column>,
    pub(super) unknown: Vec<String>,
}

/// Names of columns with one meaning, and the units in which their names may end.
struct Known {
    meaning: Meaning,
    names: &'static [&'static str],
    units: &'static [(&'static str, f64)],
    /// Factor for a name without unit.
    plain: f64,
}

const LENGTH_UNITS: [(&str, f64); 6] = [
    ("m", 1.0),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("rad", 1.0),
    ("deg", std::f64::consts::PI / 180.0),
    ("counts", 1.0),
];

const KNOWN: [Known; 5] = [
    Known {
        meaning: Meaning::Time,
        names: &["time", "t"],
        units: &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6)],
        plain: 1.0,
    },
    Known {
        meaning: Meaning::Command,
        names: &["command", "reference", "setpoint", "input", "u"],
        units: &LENGTH_UNITS,
        plain: 1.0,
    },
    Known {
        meaning: Meaning::Response,
        names: &["response", "captured_position", "position", "measured", "output", "y"],
        units: &LENGTH_UNITS,
        plain: 1.0,
    },
    Known {
        meaning: Meaning::Deviation,
        names: &["deviation"],
        units: &LENGTH_UNITS,
        plain: 1.0,
    },
    Known {
        meaning: Meaning::Acceleration,
        names: &["accel_x", "accel_y", "accel_z"],
        units: &[("mm_s2", 1e-3), ("m_s2", 1.0), ("g", 9.806_65)],
        // Printer firmware writes mm/s² without naming the unit.
        plain: 1e-3,
    },
];

/// Meaning of a name, and the factor for its numbers.
fn meaning(name: &str) -> Option<(Meaning, f64)> {
    KNOWN.iter().find_map(|known| {
        let rest = known.names.iter().find_map(|stem| name.strip_prefix(stem))?;
        if rest.is_empty() {
            return Some((known.meaning, known.plain));
        }
        let unit = rest.strip_prefix('_')?;
        let (_, factor) = known.units.iter().find(|(name, _)| *name == unit)?;
        Some((known.meaning, *factor))
    })
}

/// Reads header and rows.
pub(super) fn read(text: &[u8]) -> Result<Table, LogError> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let separator = separator(text);
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .trim(Trim::All)
        .from_reader(text);
    let mut record = ByteRecord::new();
    let next = |reader: &mut csv::Reader<&[u8]>, record: &mut ByteRecord| {
        // The reader accepts any number of fields and any bytes, so it cannot fail on a text in memory.
        reader.read_byte_record(record).unwrap_or(false)
    };
    let header = loop {
        if !next(&mut reader, &mut record) {
            return Err(LogError::Empty);
        }
        let line = line(&record);
        let names = names(&record);
        if names.first().is_some_and(|name| name.parse::<f64>().is_ok()) {
            return Err(LogError::NoHeader { line });
        }
        // Comment lines before the header are skipped.
        let commented = record.get(0).is_some_and(|first| first.starts_with(b"#"));
        if !commented || names.iter().any(|name| meaning(name).is_some()) {
            break names;
        }
    };
    let mut table = Table {
        times_s: Vec::new(),
        lines: Vec::new(),
        columns: Vec::new(),
        unknown: Vec::new(),
    };
    let uses = uses(&header, &mut table)?;
    while next(&mut reader, &mut record) {
        let line = line(&record);
        if record.get(0).is_some_and(|first| first.starts_with(b"#")) {
            continue;
        }
        // Some writers end every line with a separator.
        let has_more = record.iter().skip(header.len()).any(|field| !field.is_empty());
        if record.len() < header.len() || has_more {
            return Err(LogError::Fields {
                line,
                expected: header.len(),
                found: record.len(),
            });
        }
        for &(field, target, factor) in &uses {
            let value = number(&record[field]).ok_or_else(|| LogError::Number {
                line,
                column: header[field].clone(),
                text: String::from_utf8_lossy(&record[field]).into_owned(),
            })?;
            match target {
                None => table.times_s.push(value * factor),
                Some(column) => table.columns[column].values.push(value * factor),
            }
        }
        table.lines.push(line);
    }
    Ok(table)
}

fn line(record: &ByteRecord) -> u64 {
    record.position().map_or(0, csv::Position::line)
}

fn names(record: &ByteRecord) -> Vec<String> {
    record
        .iter()
        .map(|name| plain(&String::from_utf8_lossy(name)))
        .collect()
}

/// A name in plain form: `Command [mm]` becomes `command_mm`.
fn plain(name: &str) -> String {
    let name = name.trim_start_matches('#').trim().to_lowercase();
    let words = name
        .split([' ', '[', ']', '(', ')', '_'])
        .filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_")
}

/// A finite number, with a decimal point, or with a decimal comma where commas do not separate fields.
fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    let value: f64 = text.parse().or_else(|_| text.replace(',', ".").parse()).ok()?;
    value.is_finite().then_some(value)
}

/// Semicolon or tabulator, if the first lines have one; else comma, which may stand in numbers otherwise.
fn separator(text: &[u8]) -> u8 {
    const LOOKED_AT: usize = 16;
    let has = |separator: &u8| {
        let mut lines = text.split(|byte| *byte == b'\n').take(LOOKED_AT);
        lines.any(|line| !line.starts_with(b"#") && line.contains(separator))
    };
    [b';', b'\t'].into_iter().find(has).unwrap_or(b',')
}

/// A field that is used, its column (`None`: the time), and its factor.
type Use = (usize, Option<usize>, f64);

fn uses(header: &[String], table: &mut Table) -> Result<Vec<Use>, LogError> {
    let mut uses: Vec<Use> = Vec::new();
    let mut seen: Vec<(Meaning, String)> = Vec::new();
    for (field, name) in header.iter().enumerate() {
        let Some((meaning, factor)) = meaning(name) else {
            table.unknown.push(name.clone());
            continue;
        };
        let twice = seen.iter().find(|(other, named)| {
            *other == meaning && (meaning != Meaning::Acceleration || named.get(..7) == name.get(..7))
        });
        if let Some((_, other)) = twice {
            return Err(LogError::Twice(other.clone(), name.clone()));
        }
        seen.push((meaning, name.clone()));
        if meaning == Meaning::Time {
            uses.push((field, None, factor));
        } else {
            uses.push((field, Some(table.columns.len()), factor));
            table.columns.push(Column {
                name: name.clone(),
                meaning,
                values: Vec::new(),
            });
        }
    }
    let missing = |missing| {
        Err(LogError::Missing {
            missing,
            found: header.to_vec(),
        })
    };
    let has = |meaning| seen.iter().any(|(seen, _)| *seen == meaning);
    if !has(Meaning::Time) {
        return missing("time");
    }
    if !has(Meaning::Acceleration) && !has(Meaning::Response) {
        return missing("response");
    }
    if has(Meaning::Acceleration) {
        // A log has one kind of data: with accelerations, positions are ignored.
        let kept = |column: &Column| column.meaning == Meaning::Acceleration;
        let dropped: Vec<usize> = (0..table.columns.len()).filter(|&n| !kept(&table.columns[n])).collect();
        for &n in dropped.iter().rev() {
            let column = table.columns.remove(n);
            table.unknown.push(column.name);
            uses.retain(|(_, target, _)| *target != Some(n));
            for (_, target, _) in &mut uses {
                *target = target.map(|target| if target > n { target - 1 } else { target });
            }
        }
    }
    Ok(uses)
}
