//! The columns of a log: meanings and numbers.

use super::{LogError, Remark};
use csv::{ByteRecord, ReaderBuilder, Trim};
use std::borrow::Cow;

/// Meaning of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meaning {
    Time,
    Command,
    Response,
    /// Difference between motor and scale.
    Deviation,
    /// Command of a drive.
    Drive,
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
    /// What is to be said of columns that are not used.
    pub(super) remarks: Vec<Remark>,
}

/// Lines before the header that are none of it, at most.
const PREAMBLE: usize = 40;

/// Columns of one meaning: how they are called, and the units that their names may end in.
struct Known {
    meaning: Meaning,
    names: &'static [&'static str],
    units: &'static [(&'static str, f64)],
    /// Factor for a name without unit.
    plain: f64,
}

const LENGTH_UNITS: [(&str, f64); 11] = [
    ("m", 1.0),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("nm", 1e-9),
    ("rad", 1.0),
    ("mrad", 1e-3),
    ("deg", std::f64::consts::PI / 180.0),
    ("counts", 1.0),
    ("v", 1.0),
    ("volt", 1.0),
];

const TIME_UNITS: [(&str, f64); 8] = [
    ("s", 1.0),
    ("sec", 1.0),
    ("second", 1.0),
    ("seconds", 1.0),
    ("ms", 1e-3),
    ("msec", 1e-3),
    ("us", 1e-6),
    ("ns", 1e-9),
];

/// Whatever a drive is told; only how it moves counts.
const DRIVE_UNITS: [(&str, f64); 9] = [
    ("n", 1.0),
    ("nm", 1.0),
    ("a", 1.0),
    ("ma", 1e-3),
    ("v", 1.0),
    ("percent", 1.0),
    ("m_s", 1.0),
    ("rad_s", 1.0),
    ("rpm", 1.0),
];

const KNOWN: [Known; 6] = [
    Known {
        meaning: Meaning::Time,
        names: &["timestamp", "time", "t", "x_axis"],
        units: &TIME_UNITS,
        plain: 1.0,
    },
    Known {
        meaning: Meaning::Command,
        names: &[
            "command",
            "commanded_position",
            "commanded",
            "reference",
            "ref",
            "setpoint",
            "target",
            "demand",
            "input",
            "u",
        ],
        units: &LENGTH_UNITS,
        plain: 1.0,
    },
    Known {
        meaning: Meaning::Response,
        names: &[
            "response",
            "captured_position",
            "actual_position",
            "actual",
            "position",
            "measured",
            "feedback",
            "encoder",
            "output",
            "y",
        ],
        units: &LENGTH_UNITS,
        plain: 1.0,
    },
    Known {
        meaning: Meaning::Drive,
        names: &["drive_command", "drive", "torque", "force", "current", "duty"],
        units: &DRIVE_UNITS,
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
        names: &DIRECTIONS,
        units: &[("mm_s2", 1e-3), ("m_s2", 1.0), ("g", 9.806_65), ("mg", 9.806_65e-3)],
        // Printer firmware writes mm/s² without saying so.
        plain: 1e-3,
    },
];

/// The directions of an accelerometer, by the names that the firmware gives them.
const DIRECTIONS: [&str; 3] = ["accel_x", "accel_y", "accel_z"];

/// Other names for them, but for the letter of the direction.
const OTHER_DIRECTIONS: [(&str, &str); 8] = [
    ("acceleration_", ""),
    ("accelerometer_", ""),
    ("accel", ""),
    ("acc_", ""),
    ("acc", ""),
    ("a", ""),
    ("", "_acceleration"),
    ("", "_accel"),
];

/// A name, that of a direction as the firmware has it: `acc_x_g` is `accel_x_g`.
fn canonical(name: &str) -> String {
    for (letter, direction) in ["x", "y", "z"].into_iter().zip(DIRECTIONS) {
        for (before, behind) in OTHER_DIRECTIONS {
            if let Some(rest) = name.strip_prefix(&format!("{before}{letter}{behind}"))
                && (rest.is_empty() || rest.starts_with('_'))
            {
                return format!("{direction}{rest}");
            }
        }
    }
    name.to_owned()
}

/// What a name means, and what its numbers are multiplied by.
fn meaning(name: &str) -> Option<(Meaning, f64)> {
    KNOWN.iter().find_map(|known| {
        let factor = known.names.iter().find_map(|stem| {
            let rest = name.strip_prefix(stem)?;
            if rest.is_empty() {
                return Some(known.plain);
            }
            let unit = rest.strip_prefix('_')?;
            known
                .units
                .iter()
                .find(|(name, _)| *name == unit)
                .map(|(_, factor)| *factor)
        })?;
        Some((known.meaning, factor))
    })
}

/// Reads header and rows.
pub(super) fn read(text: &[u8]) -> Result<Table, LogError> {
    let text = &*in_utf8(text);
    if text.contains(&0) {
        return Err(LogError::Binary);
    }
    let (separator, text) = separator(text);
    let text = &*text;
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
    let (mut passed, mut lines) = (None, 0);
    let mut header = loop {
        if !next(&mut reader, &mut record) {
            match passed {
                Some(names) => break names,
                None => return Err(LogError::Empty),
            }
        }
        let line = line(&record);
        let names = names(&record);
        if record.get(0).is_some_and(|field| number(field).is_some()) {
            match passed {
                Some(names) => break names,
                None => return Err(LogError::NoHeader { line }),
            }
        }
        // Lines of remarks before the header are passed by, and what instruments write there of themselves.
        let commented = record.get(0).is_some_and(|first| first.starts_with(b"#"));
        let known = names.iter().filter(|name| meaning(name).is_some()).count();
        let is_last = known > 1 || (known == 1 && !commented && names.len() < 3);
        if is_last {
            break names;
        }
        if !commented && passed.is_none() {
            passed = Some(names);
        }
        lines += 1;
        if lines > PREAMBLE {
            break passed.unwrap_or_default();
        }
    };
    let mut table = Table {
        times_s: Vec::new(),
        lines: Vec::new(),
        columns: Vec::new(),
        remarks: Vec::new(),
    };
    let mut has_row = next(&mut reader, &mut record);
    if has_row && record.iter().all(|field| number(field).is_none()) && with_units(&mut header, &record) {
        has_row = next(&mut reader, &mut record);
    }
    let uses = uses(&header, &mut table)?;
    while std::mem::replace(&mut has_row, false) || next(&mut reader, &mut record) {
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

/// A name without what writers put around it: `Command [mm]` is `command_mm`, `Accel X (m/s²)` is `accel_x_m_s2`.
fn plain(name: &str) -> String {
    let name = name.trim_start_matches('#').trim().to_lowercase();
    let name = name
        .replace("^2", "2")
        .replace('²', "2")
        .replace(['µ', 'μ'], "u")
        .replace('°', "deg");
    let words = name
        .split([' ', '[', ']', '(', ')', '_', '/', '-', '.', ':', '*', '·'])
        .filter(|word| !word.is_empty());
    canonical(&words.collect::<Vec<_>>().join("_"))
}

/// A finite number, with a decimal point, or with a decimal comma where commas do not separate fields.
fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    let value: f64 = text.parse().or_else(|_| text.replace(',', ".").parse()).ok()?;
    value.is_finite().then_some(value)
}

/// Adds the units of a line below the header to its names, as `(ms)` or `second`; whether it is one.
fn with_units(header: &mut [String], units: &ByteRecord) -> bool {
    let with_unit: Vec<String> = header
        .iter()
        .zip(names(units))
        .map(|(name, unit)| match unit.is_empty() {
            true => name.clone(),
            false => format!("{name}_{unit}"),
        })
        .collect();
    let is_known = |name: &String| meaning(name).is_some();
    let is_units = header
        .iter()
        .zip(&with_unit)
        .any(|(name, more)| name != more && is_known(more));
    if is_units {
        for (name, more) in header.iter_mut().zip(with_unit) {
            if is_known(&more) {
                *name = more;
            }
        }
    }
    is_units
}

/// Text in UTF-8 without a mark of the order of bytes; spreadsheets write UTF-16 too.
fn in_utf8(text: &[u8]) -> Cow<'_, [u8]> {
    let wide = |rest: &[u8], of: fn([u8; 2]) -> u16| {
        let (pairs, _) = rest.as_chunks::<2>();
        let words: Vec<u16> = pairs.iter().map(|pair| of(*pair)).collect();
        Cow::Owned(String::from_utf16_lossy(&words).into_bytes())
    };
    match text {
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
        _ => Cow::Borrowed(text),
    }
}

/// Semicolon or tabulator, if the first lines have one; else comma, which may stand in numbers beside the others; else spaces, which become
/// tabulators. A first line `sep=;` says it, and is none of the log.
fn separator(text: &[u8]) -> (u8, Cow<'_, [u8]>) {
    const LOOKED_AT: usize = 64;
    if let Some(rest) = text.strip_prefix(b"sep=")
        && let [separator, rest @ ..] = rest
    {
        // The line stays as an empty one, so that lines are counted as an editor does.
        return (*separator, Cow::Borrowed(rest));
    }
    let has = |separator: u8| {
        let mut lines = text.split(|byte| *byte == b'\n').take(LOOKED_AT);
        lines.any(|line| !line.starts_with(b"#") && line.contains(&separator))
    };
    let found = [b';', b'\t', b','].into_iter().find(|separator| has(*separator));
    match found {
        Some(separator) => (separator, Cow::Borrowed(text)),
        None if has(b' ') => (b'\t', Cow::Owned(tabbed(text))),
        None => (b',', Cow::Borrowed(text)),
    }
}

/// Each run of spaces within a line as one tabulator.
fn tabbed(text: &[u8]) -> Vec<u8> {
    let words = |line: &[u8]| {
        let words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join(&b'\t')
    };
    let lines: Vec<Vec<u8>> = text.split(|byte| *byte == b'\n').map(words).collect();
    lines.join(&b'\n')
}

/// A field that is used, its column (`None`: the time), and its factor.
type Use = (usize, Option<usize>, f64);

fn uses(header: &[String], table: &mut Table) -> Result<Vec<Use>, LogError> {
    let mut uses: Vec<Use> = Vec::new();
    let mut seen: Vec<(Meaning, String)> = Vec::new();
    for (field, name) in header.iter().enumerate() {
        let Some((meaning, factor)) = meaning(name) else {
            table.remarks.push(Remark::Unknown(name.clone()));
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
    // One log is one of these: what it has beside it is not looked at.
    let (kept, taken): (&[Meaning], _) = if has(Meaning::Acceleration) {
        (&[Meaning::Acceleration], "that of an accelerometer")
    } else if has(Meaning::Deviation) {
        (&[Meaning::Response, Meaning::Deviation], "a trace of motor and scale")
    } else if has(Meaning::Command) {
        (
            &[Meaning::Command, Meaning::Response],
            "that of a position command and its response",
        )
    } else {
        (&[Meaning::Response, Meaning::Drive], "that of a drive and its motor")
    };
    let is_dropped = |n: &usize| !kept.contains(&table.columns[*n].meaning);
    let dropped: Vec<usize> = (0..table.columns.len()).filter(is_dropped).collect();
    for &n in dropped.iter().rev() {
        let column = table.columns.remove(n);
        table.remarks.push(Remark::Beside {
            column: column.name,
            taken,
        });
        uses.retain(|(_, target, _)| *target != Some(n));
        for (_, target, _) in &mut uses {
            *target = target.map(|target| if target > n { target - 1 } else { target });
        }
    }
    Ok(uses)
}
