//! Why a log cannot be read, and the defects of one that can.

use thiserror::Error;

/// Why a log cannot be read. Lines count from 1, the header included.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LogError {
    /// The log is empty.
    #[error("the log is empty: it needs a header with the names of its columns, and rows of numbers")]
    Empty,
    /// It has bytes that no text has.
    #[error("this is not text: a log is a file of comma-separated values, with a header and rows of numbers")]
    Binary,
    /// It is packed.
    #[error("the file is {0}")]
    Packed(&'static str),
    /// The first line has numbers.
    #[error(
        "line {line} is the first and has no column names: put `time,command,response` or `time,accel_x,accel_y,accel_z` before it, or give them with `--columns time,accel_x_g,-`"
    )]
    NoHeader {
        /// Number of the line.
        line: u64,
    },
    /// A column that is needed is not there.
    #[error(
        "there is no column `{missing}`: the columns are {}; name them in the header as posicast knows them, or with `--columns \
         NAME,NAME,…` (`-` for an unused column): `time` with `command` and `response`, `drive_command` and `position`, or `accel_x_g`",
        .found.join(", ")
    )]
    Missing {
        /// Name of the missing column.
        missing: &'static str,
        /// Names of the columns that were found.
        found: Vec<String>,
    },
    /// Two columns have the same meaning.
    #[error(
        "the columns `{0}` and `{1}` mean the same: name the columns to use with `--columns NAME,NAME,…`, and write `-` for the others"
    )]
    Twice(String, String),
    /// The names do not say what the columns are.
    #[error(
        "{} may be accelerations or positions: give `--columns {accelerations}` if they are accelerations in g (or `_mg`, `_m_s2`, \
         `_mm_s2`), `--columns {position}` for one position",
        listed(.columns)
    )]
    Ambiguous {
        /// The columns.
        columns: Vec<String>,
        /// Names for `--columns` if they are accelerations.
        accelerations: String,
        /// Names for `--columns` if one is a position.
        position: String,
    },
    /// A name of `--columns` is not known.
    #[error(
        "`--columns`: posicast does not know the name `{0}`; allowed: `time`, `sample`, `accel_x`, `accel_y`, `accel_z`, `command`, \
         `response`, `drive_command`, each with a unit behind it (`time_ms`, `accel_x_g`, `response_um`), or `-` for a column that is \
         not used"
    )]
    GivenName(String),
    /// `--columns` has more names than the file has columns.
    #[error("`--columns` has {given} names, but a row of the log has {fields} fields")]
    GivenCount {
        /// Number of names.
        given: usize,
        /// Number of fields.
        fields: usize,
    },
    /// The log numbers its samples, and does not say how many there are in a second.
    #[error(
        "the log has no times, and no line such as `Rate 1344, overflows 0` says how many samples there are in a second: give `--rate HZ`"
    )]
    NoRate,
    /// The times of an accelerometer are too far apart to be seconds.
    #[error(
        "column `{column}` rises by {step} from row to row: if these are seconds, this is too slow for an accelerometer. Give its unit \
         with `--columns {column}_ms,…` (or `_us`, `_ns`), or `--rate HZ`"
    )]
    TimeUnit {
        /// Name of the column.
        column: String,
        /// Usual step.
        step: f64,
    },
    /// The file has a spectrum.
    #[error(
        "this is a spectrum ({}), not a log of the motion over time, and the modes' phases and dampings are not in it: record a log. Klipper: `TEST_RESONANCES AXIS=X OUTPUT=raw_data` writes raw_data_x_….csv; RepRapFirmware: M956; others: export the time signal",
        .0.join(", ")
    )]
    Spectrum(Vec<String>),
    /// The recorder reports a failure.
    #[error(
        "line {line}: the firmware wrote `{text}` in place of samples: the recording is incomplete; record it again"
    )]
    Recorder {
        /// Number of the line.
        line: u64,
        /// What it says.
        text: String,
    },
    /// A row has a different number of fields than the header.
    #[error("line {line} has {found} fields, but the header has {expected}")]
    Fields {
        /// Number of the line.
        line: u64,
        /// Number of fields of the header.
        expected: usize,
        /// Number of fields of the line.
        found: usize,
    },
    /// A field is not a finite number.
    #[error(
        "line {line}, column `{column}`: `{text}` is not a finite number; remove the rows that the sensor did not deliver"
    )]
    Number {
        /// Number of the line.
        line: u64,
        /// Name of the column.
        column: String,
        /// Text of the field.
        text: String,
    },
    /// The time does not increase.
    #[error(
        "line {line}: the time {time_s} s is not after {before_s} s of the line before; sort the rows by time, cut the log where its \
         time restarts, or, if the rows are equally spaced, give `--rate HZ`"
    )]
    Unsorted {
        /// Number of the line.
        line: u64,
        /// Its time in seconds.
        time_s: f64,
        /// The time before it in seconds.
        before_s: f64,
    },
    /// The times are so irregular that the course of the command between the rows is not known.
    #[error(
        "the steps from row to row differ by {:.0} % of a step (root mean square), most at line {line}: the command between two rows is \
         unknown, and the log would show modes that the machine does not have; log at a constant rate, in every tick of the controller, \
         or, if the rows are equally spaced and only their time stamps jitter, give `--rate HZ`",
        100.0 * .deviation
    )]
    Irregular {
        /// Root mean square of the steps' deviations from their mean, in steps.
        deviation: f64,
        /// Line with the largest deviation.
        line: u64,
    },
    /// There are too few rows.
    #[error("the log has {rows} rows: at least {least} are needed")]
    Rows {
        /// Number of rows.
        rows: usize,
        /// Smallest number of rows.
        least: usize,
    },
    /// A column is constant.
    #[error("column `{column}` has the value {value} in every row: the sensor is dead, or not connected")]
    Dead {
        /// Name of the column.
        column: String,
        /// Its only value.
        value: f64,
    },
}

/// A defect of a log that can still be read.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Remark {
    /// Rows are missing; the others were used where they are.
    #[error(
        "{missing} of {samples} samples are missing ({:.2} %), in {places} {}, the first after line {line}, most ({longest_s:.4} s) \
         after line {longest_line}: the others were used at their own times, and the result is less certain",
        100.0 * *.missing as f64 / *.samples as f64, if *.places == 1 { "place" } else { "places" }
    )]
    Gaps {
        /// Number of samples that are missing.
        missing: usize,
        /// Number of samples with those that are missing.
        samples: usize,
        /// Number of gaps.
        places: usize,
        /// Line before the first gap.
        line: u64,
        /// Duration in seconds that the longest gap lacks.
        longest_s: f64,
        /// Line before it.
        longest_line: u64,
    },
    /// Most rows are missing; the longest part without a gap was used.
    #[error(
        "most rows are missing, the first after line {line}: {gap_s:.4} s without a sample; the {kept} rows from line {from} to {to} were used, the longest part without a gap"
    )]
    Part {
        /// Line before the first gap.
        line: u64,
        /// Length of the gap in seconds.
        gap_s: f64,
        /// First line that was used.
        from: u64,
        /// Last line that was used.
        to: u64,
        /// Number of rows that were used.
        kept: usize,
    },
    /// The samples are not equally spaced; they were interpolated.
    #[error("the times of the samples are off a uniform grid by up to {:.0} % of a sample (line {line}): they were interpolated linearly, which weakens frequencies near half the rate of {rate_hz:.0} samples per second", 100.0 * .worst)]
    Irregular {
        /// Line with the largest deviation.
        line: u64,
        /// Largest deviation in samples.
        worst: f64,
        /// Rate of the grid in Hz.
        rate_hz: f64,
    },
    /// A column stays at its largest or smallest value again and again.
    #[error(
        "column `{column}` stands at {value} in {samples} samples, first in line {line}: the sensor is saturated there, and damping and participation come out wrong; use a larger range or less acceleration"
    )]
    Saturated {
        /// Name of the column.
        column: String,
        /// The value.
        value: f64,
        /// Number of samples with this value.
        samples: usize,
        /// First line with it.
        line: u64,
    },
    /// A direction of an accelerometer is constant.
    #[error(
        "column `{column}` has the value {value} in every row and was left out: this direction of the sensor is dead, or not connected"
    )]
    DeadDirection {
        /// Name of the column.
        column: String,
        /// Its only value.
        value: f64,
    },
    /// The meaning of a column is not known.
    #[error("column `{0}` was not used: posicast does not know its name")]
    Unknown(String),
    /// There is a second column of times.
    #[error("column `{0}` was not used: the times were taken from `{1}`, whose unit is stated")]
    OtherTime(String, String),
    /// Gravity decided the unit of the accelerations.
    #[error(
        "the accelerations were taken to be in {unit}: the magnitude of their means is {measured:.4}, the acceleration of gravity in \
         that unit; if that is wrong, give their unit with `--columns`"
    )]
    Gravity {
        /// The unit.
        unit: &'static str,
        /// What the three directions measure together, in the log's numbers.
        measured: f64,
    },
    /// The sensor's memory has overflowed.
    #[error(
        "the sensor's memory has overflowed {0} times: samples are lost at places that the log does not show, and frequencies and \
         dampings may be wrong; record again at a lower rate or with fewer axes"
    )]
    Overflows(u64),
    /// A column of another kind of log.
    #[error(
        "column `{column}` was not used: the log was taken as {taken}; to use other columns, name them with `--columns`"
    )]
    Beside {
        /// The column.
        column: String,
        /// What the log was taken as.
        taken: &'static str,
    },
}

/// Names in a sentence.
fn listed(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.len() {
        1 => format!("column {}", quoted[0]),
        _ => format!("columns {}", quoted.join(", ")),
    }
}
