//! Runs Yosys on files.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use posicast_system::tool::{self, Ended};
use posicast_system::{interrupt, scratch};

use super::{Yosys, YosysError};

/// Number of last lines of the output that an error repeats.
const LAST_LINES: usize = 8;

impl Yosys {
    /// Runs Yosys as [`run_in`](Yosys::run_in) does, in a temporary folder.
    pub(super) fn run(&self, top: &str, files: &[PathBuf], arguments: &[&OsStr]) -> Result<String, YosysError> {
        self.run_in(scratch()?.path(), top, files, arguments)
    }

    /// Runs Yosys on `files` in `folder`, and returns its output.
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

/// Copies `files` into `folder` and returns their paths from there, because a Yosys in a sandbox sees no other folder.
fn beside(folder: &Path, files: &[PathBuf]) -> Result<Vec<PathBuf>, YosysError> {
    let copy = |(index, file): (usize, &PathBuf)| {
        // Each copy has a folder of its own, because two files may have the same name.
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

/// An empty folder that is removed when it is dropped.
pub(super) fn scratch() -> Result<scratch::Folder, YosysError> {
    let folder = scratch::Folder::new("posicast-yosys-");
    folder.map_err(at(&std::env::temp_dir()))
}

/// Adds the file or program to an error of the operating system.
pub(super) fn at(path: &Path) -> impl FnOnce(io::Error) -> YosysError {
    let path = path.to_owned();
    move |source| YosysError::Io { path, source }
}
