//! Reads a log: determines its columns, checks whether its time is uniform, and finds samples that are not credible.
//!
//! | columns | kind of log |
//! |---|---|
//! | `time`, `accel_x`, `accel_y`, `accel_z` (any of them) | an accelerometer log as 3D-printer firmware writes it: s and mm/s² |
//! | `time`, `command`, `response` | a position log: command and response of an axis, in one unit |
//! | `time`, `response` | a free decay |
//! | `time`, `drive_command`, `position` | command of a drive, and position of its own motor |
//! | `time`, `captured_position`, `deviation` | a trace of the stage: position of the motor, and motor minus scale; the motor drives the scale |
//! | `Sample`, `X`, `Y`, `Z` (any of them), the rate in the last line | accelerations in g as RepRapFirmware writes them |
//! | `time`, `x`, `y`, `z` | accelerations, if the three directions measure gravity; otherwise the user is asked |
//!
//! Names may include a unit: `time_ms`, `command_mm`, `response_um`, `Accel X (g)`. A `#` before the first name is
//! ignored. [`ReadOptions`] say what a file leaves open.

mod columns;
mod error;
mod names;
mod records;
mod rows;
mod saturated;
mod text;
mod time;
mod uses;

pub use error::{LogError, Remark};

use crate::signal::{AccelerationLog, Between, DriveLog, PositionLog};
use columns::Column;
use names::Meaning;
use saturated::{dead, saturated};

/// A log that was read.
#[derive(Debug, Clone, PartialEq)]
pub enum Log {
    /// Log of an accelerometer.
    Acceleration(AccelerationLog),
    /// Command and response of an axis.
    Position(PositionLog),
    /// A drive and its own motor.
    Drive(DriveLog),
}

/// A log, with remarks about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The log.
    pub log: Log,
    /// Number of rows from which it was made.
    pub rows: usize,
    /// Defects of the log that were mended or left.
    pub remarks: Vec<Remark>,
}

/// What a log's file does not say, or says otherwise.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Names of the columns in their order, in the place of the header's; `-` for a column that is not used.
    pub columns: Option<Vec<String>>,
    /// Samples per second, in the place of the times.
    pub rate_hz: Option<f64>,
}

/// Smallest number of rows of a log.
const LEAST_ROWS: usize = 32;

/// Time between the samples of an accelerometer in seconds above which the unit of the time is asked.
const SLOWEST_ACCELEROMETER_S: f64 = 0.1;

/// Reads a log from the text of its file.
///
/// # Errors
/// [`LogError`] with the line and the column.
pub fn read(text: &[u8]) -> Result<Reading, LogError> {
    read_with(text, &ReadOptions::default())
}

/// Reads a log from the text of its file, which these options explain.
///
/// # Errors
/// [`LogError`] with the line and the column.
pub fn read_with(text: &[u8], options: &ReadOptions) -> Result<Reading, LogError> {
    let table = columns::read(text, options)?;
    if table.times_s.len() < LEAST_ROWS {
        return Err(LogError::Rows {
            rows: table.times_s.len(),
            least: LEAST_ROWS,
        });
    }
    let mut remarks = table.remarks.clone();
    let grid = time::grid(&table, &mut remarks)?;
    if grid.range().len() < LEAST_ROWS {
        return Err(LogError::Rows {
            rows: grid.range().len(),
            least: LEAST_ROWS,
        });
    }
    let mut columns = table.columns;
    let has_command = columns
        .iter()
        .any(|column| matches!(column.meaning, Meaning::Command | Meaning::Drive));
    if let (true, Some((deviation, line))) = (has_command, grid.wavers()) {
        return Err(LogError::Irregular { deviation, line });
    }
    for column in &columns {
        remarks.extend(saturated(column, &table.lines, grid.range()));
    }
    for column in &mut columns {
        let course = match column.meaning {
            Meaning::Command | Meaning::Drive => time::Course::Held,
            _ => time::Course::Straight,
        };
        column.values = grid.of(std::mem::take(&mut column.values), course);
    }
    let rows = grid.range().len();
    let accelerometer = columns.iter().any(|column| column.meaning == Meaning::Acceleration);
    let log = if accelerometer {
        if let (Some(column), true) = (table.plain_time, grid.sample_s > SLOWEST_ACCELEROMETER_S) {
            return Err(LogError::TimeUnit {
                column,
                step: grid.sample_s,
            });
        }
        Log::Acceleration(acceleration(columns, &grid, &mut remarks)?)
    } else {
        position(columns, &grid)?
    };
    Ok(Reading { log, rows, remarks })
}

fn acceleration(
    columns: Vec<Column>,
    grid: &time::Grid,
    remarks: &mut Vec<Remark>,
) -> Result<AccelerationLog, LogError> {
    let mut directions = Vec::new();
    let mut last_dead = None;
    for column in columns {
        match dead(&column.values) {
            Some(value) => {
                remarks.push(Remark::DeadDirection {
                    column: column.name.clone(),
                    value,
                });
                last_dead = Some(LogError::Dead {
                    column: column.name,
                    value,
                });
            }
            None => directions.push((column.name, column.values)),
        }
    }
    match last_dead {
        Some(error) if directions.is_empty() => Err(error),
        _ => Ok(AccelerationLog {
            sample_s: grid.sample_s,
            directions,
            missing: grid.missing.clone(),
        }),
    }
}

fn position(columns: Vec<Column>, grid: &time::Grid) -> Result<Log, LogError> {
    let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
    let mut log = PositionLog {
        sample_s: grid.sample_s,
        command: Vec::new(),
        between: Between::Held,
        response: Vec::new(),
        missing: grid.missing.clone(),
    };
    let (mut deviation, mut drive) = (None, None);
    for column in columns {
        if column.meaning == Meaning::Command {
            log.command = column.values;
        } else if column.meaning == Meaning::Deviation {
            deviation = Some(column.values);
        } else if column.meaning == Meaning::Drive {
            drive = Some(column.values);
        } else if let Some(value) = dead(&column.values) {
            return Err(LogError::Dead {
                column: column.name,
                value,
            });
        } else {
            log.response = column.values;
        }
    }
    if let Some(deviation) = deviation {
        // The motor's position was measured, not commanded: it continues to move between samples.
        log.between = Between::Straight;
        log.command = std::mem::take(&mut log.response);
        log.response = log
            .command
            .iter()
            .zip(&deviation)
            .map(|(motor, deviation)| motor - deviation)
            .collect();
    }
    if log.response.is_empty() {
        return Err(LogError::Missing {
            missing: "response",
            found: names,
        });
    }
    Ok(match drive {
        Some(drive) => Log::Drive(DriveLog {
            sample_s: grid.sample_s,
            drive,
            position: log.response,
            missing: log.missing,
        }),
        None => Log::Position(log),
    })
}
