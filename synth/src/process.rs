//! Running a tool: in a folder, under a time limit, with its last words kept.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use posicast_system::process;

/// Lines of its output that an error repeats.
const LAST_LINES: usize = 8;

/// How a tool came to its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Ended {
    /// With exit status 0; what it printed.
    Well(String),
    /// With another; the end of what it printed.
    Badly(String),
    /// Not by itself: it had no more time.
    TimeOut,
}

/// Runs `program` in `folder`, and keeps what it prints, on either stream, in `log` there.
///
/// # Errors
/// Those of starting it, and of the log.
pub(crate) fn run(
    program: &Path,
    folder: &Path,
    log: &str,
    arguments: &[&OsStr],
    limit: Duration,
) -> io::Result<Ended> {
    // A file, not a pipe: nobody has to read while the tool runs.
    let log_path = folder.join(log);
    let log = File::create(&log_path)?;
    let log_too = log.try_clone()?;
    let mut command = Command::new(program);
    command
        .args(arguments)
        .current_dir(folder)
        // Its own temporary files go with the folder, even if it is killed.
        .env("TMPDIR", std::path::absolute(folder)?)
        .stdin(Stdio::null())
        .stdout(log)
        .stderr(log_too);
    let Some(status) = process::start(&mut command)?.wait_within(limit)? else {
        return Ok(Ended::TimeOut);
    };
    let printed = fs::read(&log_path)?;
    let printed = String::from_utf8_lossy(&printed).into_owned();
    if status.success() {
        return Ok(Ended::Well(printed));
    }
    let lines: Vec<&str> = printed.lines().filter(|line| !line.trim().is_empty()).collect();
    Ok(Ended::Badly(match lines.len() {
        0 => format!("it ended with {status} and said nothing"),
        count => lines[count.saturating_sub(LAST_LINES)..].join("\n"),
    }))
}
