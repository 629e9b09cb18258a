//! Running Yosys: in a scratch folder, under a time limit, with its last words kept.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::{Yosys, YosysError};

/// Lines of its output that an error repeats.
const LAST_LINES: usize = 8;

impl Yosys {
    /// As [`run_in`](Yosys::run_in), in a scratch folder of its own.
    pub(super) fn run(&self, top: &str, files: &[PathBuf], arguments: &[&OsStr]) -> Result<String, YosysError> {
        self.run_in(scratch()?.path(), top, files, arguments)
    }

    /// Runs Yosys on `files` in `folder`; returns what it printed.
    pub(super) fn run_in(
        &self,
        folder: &Path,
        top: &str,
        files: &[PathBuf],
        arguments: &[&OsStr],
    ) -> Result<String, YosysError> {
        // A file, not a pipe: nobody has to read while Yosys runs.
        let log_path = folder.join("yosys.log");
        let log = File::create(&log_path).map_err(at(&log_path))?;
        let log_too = log.try_clone().map_err(at(&log_path))?;
        let absolute: Result<Vec<PathBuf>, _> = files
            .iter()
            .map(|file| fs::canonicalize(file).map_err(at(file)))
            .collect();
        let mut child = Command::new(&self.program)
            .arg("-q")
            .args(arguments)
            .args(absolute?)
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(log)
            .stderr(log_too)
            .spawn()
            .map_err(|source| match source.kind() {
                ErrorKind::NotFound => YosysError::Missing(self.program.clone()),
                _ => at(&self.program)(source),
            })?;

        let deadline = Instant::now().checked_add(self.time_limit);
        let status = loop {
            if let Some(status) = child.try_wait().map_err(at(&self.program))? {
                break status;
            }
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                // It may have ended by itself in the meantime; both calls then do nothing.
                let _ = child.kill();
                let _ = child.wait();
                return Err(YosysError::TimeOut {
                    top: top.to_owned(),
                    limit: self.time_limit,
                });
            }
            sleep(Duration::from_millis(5));
        };
        let printed = fs::read(&log_path).map_err(at(&log_path))?;
        let printed = String::from_utf8_lossy(&printed).into_owned();
        if status.success() {
            return Ok(printed);
        }
        let lines: Vec<&str> = printed.lines().filter(|line| !line.trim().is_empty()).collect();
        let last_lines = match lines.len() {
            0 => format!("it ended with {status} and said nothing"),
            count => lines[count.saturating_sub(LAST_LINES)..].join("\n"),
        };
        Err(YosysError::Failed {
            top: top.to_owned(),
            last_lines,
        })
    }
}

/// An empty folder that vanishes when dropped.
pub(super) fn scratch() -> Result<TempDir, YosysError> {
    let folder = tempfile::Builder::new().prefix("posicast-yosys-").tempdir();
    folder.map_err(at(&std::env::temp_dir()))
}

/// Says which file or program an error of the operating system is about.
pub(super) fn at(path: &Path) -> impl FnOnce(io::Error) -> YosysError {
    let path = path.to_owned();
    move |source| YosysError::Io { path, source }
}
