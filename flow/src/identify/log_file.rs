//! Options for information that a log's file lacks, and the reading of the file.

use crate::failure::Failure;
use posicast_identify::log::{self, Log, ReadOptions, Reading};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Information that a log's file lacks.
#[derive(Debug, Clone, Default)]
pub struct LogOptions {
    /// Names of the columns in their order, such as `time_ms`, instead of those in the header; `-` for an unused column.
    pub columns: Option<Vec<String>>,
    /// Samples per second, for a log without times or with times that waver.
    pub rate_hz: Option<f64>,
    /// Direction of the accelerometer to be used, `x`, `y` or `z` or the name of its column; `None`: the strongest.
    pub direction: Option<String>,
}

/// Largest log in bytes: three hours at 3,200 samples per second.
const LARGEST_LOG_BYTES: u64 = 1 << 31;

/// Reads the log in a file.
pub(super) fn read(path: &Path, options: &LogOptions) -> Result<Reading, Failure> {
    let unreadable = |found: &dyn std::fmt::Display| {
        Failure::input(format!("cannot read the log `{}`: {found}", path.display()))
            .with_help("name a log in CSV, with a header such as time,accel_x,accel_y,accel_z or time,command,response")
    };
    let file = File::open(path).map_err(|error| unreadable(&error))?;
    let mut text = Vec::new();
    // A device or a pipe may never end.
    let limit = file.take(LARGEST_LOG_BYTES + 1).read_to_end(&mut text);
    if limit.map_err(|error| unreadable(&error))? as u64 > LARGEST_LOG_BYTES {
        return Err(unreadable(&format!("it goes on after {LARGEST_LOG_BYTES} bytes")));
    }
    let read_options = ReadOptions {
        columns: options.columns.clone(),
        rate_hz: options.rate_hz,
    };
    let mut reading = log::read_with(&text, &read_options).map_err(|error| Failure::because(error).in_file(path))?;
    if let Some(direction) = &options.direction {
        only(&mut reading, direction).map_err(|error| error.in_file(path))?;
    }
    Ok(reading)
}

/// Keeps only one direction of an accelerometer.
fn only(reading: &mut Reading, direction: &str) -> Result<(), Failure> {
    let Log::Acceleration(log) = &mut reading.log else {
        return Err(
            Failure::input("--direction is for the log of an accelerometer, and this log is not one")
                .with_help("leave --direction out, or name the columns with --columns"),
        );
    };
    let names: Vec<String> = log.directions.iter().map(|(name, _)| name.clone()).collect();
    let wanted = direction.to_lowercase();
    log.directions
        .retain(|(name, _)| *name == wanted || axis_of(name).as_deref() == Some(&wanted));
    match log.directions.len() {
        1 => Ok(()),
        _ => Err(
            Failure::input(format!("--direction {direction}: the log has no such direction"))
                .with_help(format!("the directions of the log are {}", names.join(", "))),
        ),
    }
}

/// Returns the axis of a direction: `accel_x_g` and `x` belong to axis `x`.
pub(super) fn axis_of(direction: &str) -> Option<String> {
    let name = direction.strip_prefix("accel_").unwrap_or(direction);
    let mut letters = name.chars();
    let letter = letters.next().filter(|letter| matches!(letter, 'x' | 'y' | 'z'))?;
    let rest = letters.as_str();
    let is_whole = rest.is_empty() || rest.starts_with('_') || rest.chars().all(|letter| letter.is_ascii_digit());
    is_whole.then(|| letter.to_string())
}
