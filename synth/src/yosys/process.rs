//! Running Yosys on files.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use posicast_system::tool::{self, Ended};
use posicast_system::{interrupt, scratch};

use super::{Yosys, YosysError};

/// Lines of what it printed that an error repeats.
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
        let sources = beside(folder, files)?;
        let mut all = vec![OsStr::new("-q")];
        all.extend(arguments);
        all.extend(sources.iter().map(|file| file.as_os_str()));
        let mut command = tool::command_in(&self.program, folder);
        let ended = tool::run_within(command.args(all), self.time_limit);
        let ended = ended.map_err(|source| match source.kind() {
            ErrorKind::NotFound => YosysError::Missing(self.program.clone()),
            _ => at(&self.program)(source),
        });
        match ended? {
            Ended::Well(printed) => Ok(printed),
            Ended::Badly { printed, .. } => Err(YosysError::Failed {
                top: top.to_owned(),
                last_lines: tool::last_lines(&printed, LAST_LINES),
            }),
            Ended::TimeOut => Err(YosysError::TimeOut {
                top: top.to_owned(),
                limit: self.time_limit,
            }),
        }
    }
}

/// Copies of `files` in `folder`, by their paths from there: a Yosys in a sandbox sees no other folder than its own.
fn beside(folder: &Path, files: &[PathBuf]) -> Result<Vec<PathBuf>, YosysError> {
    let copy = |(index, file): (usize, &PathBuf)| {
        // A folder each, since two files may have one name.
        let copy = Path::new("sources").join(index.to_string());
        let copy = copy.join(file.file_name().unwrap_or(file.as_os_str()));
        let path = folder.join(&copy);
        let made = interrupt::uninterrupted(|| fs::create_dir_all(path.parent().unwrap_or(folder)));
        made.map_err(at(&path))?;
        fs::copy(file, &path).map_err(at(file))?;
        Ok(copy)
    };
    files.iter().enumerate().map(copy).collect()
}

/// An empty folder that vanishes when dropped.
pub(super) fn scratch() -> Result<scratch::Folder, YosysError> {
    let folder = scratch::Folder::new("posicast-yosys-");
    folder.map_err(at(&std::env::temp_dir()))
}

/// Says which file or program an error of the operating system is about.
pub(super) fn at(path: &Path) -> impl FnOnce(io::Error) -> YosysError {
    let path = path.to_owned();
    move |source| YosysError::Io { path, source }
}
