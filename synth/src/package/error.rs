//! Why a folder cannot be written or read.

use std::io;
use std::path::{Path, PathBuf};

use super::layout::MANIFEST;

/// Why a folder cannot be written or read. Every variant but [`Io`](PackageError::Io) leaves it untouched.
#[derive(Debug, thiserror::Error)]
pub enum PackageError {
    /// The path is a file.
    #[error("{}: is a file; the output needs a folder: name another one", .0.display())]
    NotAFolder(PathBuf),
    /// A folder with contents, and no manifest.
    #[error(
        "{}: holds files and no {MANIFEST}, so posicast did not write it and does not touch it: \
         name an empty or a new folder",
        .0.display()
    )]
    NotOurs(PathBuf),
    /// To be read, but posicast did not write it.
    #[error("{}: no output folder of posicast, {MANIFEST} is missing: name a folder that `generate` or `run` wrote", .0.display())]
    NotAPackage(PathBuf),
    /// A manifest that cannot be believed.
    #[error(
        "{}: {reason}, so what posicast wrote here is unknown: move the folder away or name another one",
        .folder.join(MANIFEST).display()
    )]
    Manifest {
        /// The folder.
        folder: PathBuf,
        /// What is wrong with the manifest.
        reason: String,
    },
    /// Files that were edited since posicast wrote them.
    #[error(
        "{}: edited since posicast wrote it: {}; it would be overwritten: move it away or delete it",
        .folder.display(), .files.join(", ")
    )]
    Edited {
        /// The folder.
        folder: PathBuf,
        /// Paths of the files in it.
        files: Vec<String>,
    },
    /// Files at paths that this run produces, but that posicast did not write.
    #[error(
        "{}: posicast did not write {}, and now produces a file of that name: move it away or delete it",
        .folder.display(), .files.join(", ")
    )]
    InTheWay {
        /// The folder.
        folder: PathBuf,
        /// Paths of the files in it.
        files: Vec<String>,
    },
    /// A link, folder or device where a plain file, or a file or link where a folder, belongs.
    #[error("{}: is {found} where posicast keeps {wanted}: move it away or delete it", .path.display())]
    WrongType {
        /// The path.
        path: PathBuf,
        /// What is there.
        found: &'static str,
        /// What belongs there.
        wanted: &'static str,
    },
    /// A path that posicast does not write to.
    #[error("output path {path:?} {reason}")]
    Path {
        /// The path.
        path: String,
        /// Which rule it breaks.
        reason: &'static str,
    },
    /// The same path added twice.
    #[error("output path {0:?} was added twice")]
    Twice(String),
    /// A staged path at which the caller wrote nothing.
    #[error("output file {0:?} was announced and never written")]
    NotWritten(String),
    /// Another run holds the folder.
    #[error("{}: another posicast is writing to this folder: wait until it ends, or name another folder", .0.display())]
    Busy(PathBuf),
    /// The last run on the folder was killed while it replaced files.
    #[error("{}: the run that wrote this folder was interrupted: run it again", .0.display())]
    Unfinished(PathBuf),
    /// A file of the package that is not there.
    #[error("{}: is missing: write the folder again with `generate` or `run`", .0.display())]
    Missing(PathBuf),
    /// A text file larger than anything posicast writes.
    #[error("{}: is larger than {limit_bytes} bytes, the most that is read", .path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Size limit in bytes.
        limit_bytes: u64,
    },
    /// The operating system refused.
    #[error("{}: cannot {action}: {source}", .path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// Its reason.
        source: io::Error,
    },
}

/// Says what was tried, and where, of an error of the operating system.
pub(super) fn at(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> PackageError {
    let path = path.to_owned();
    move |source| PackageError::Io { path, action, source }
}
