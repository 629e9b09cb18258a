//! Errors of writing or reading an output folder.

use std::io;
use std::path::{Path, PathBuf};

use super::layout::MANIFEST;

/// Why a folder cannot be written or read. Every variant but [`Io`](PackageError::Io) leaves it untouched.
#[derive(Debug, thiserror::Error)]
pub enum PackageError {
    /// The path is a file.
    #[error("{}: is a file; the output needs a folder: name another one", .0.display())]
    NotAFolder(PathBuf),
    /// The folder has contents, but no manifest.
    #[error(
        "{}: contains files but no {MANIFEST}, so posicast did not write it and does not change it: \
         name an empty or a new folder",
        .0.display()
    )]
    NotOurs(PathBuf),
    /// The folder to read was not written by posicast.
    #[error("{}: this is not an output folder of posicast, {MANIFEST} is missing: name a folder that `generate` or \
        `run` wrote", .0.display())]
    NotAPackage(PathBuf),
    /// The folder has a block alone, and not a machine.
    #[error(
        "{}: this is the kit of the block {block} alone: `make bench` there runs its bench; to compare a block with its model, name a machine \
         that has it: posicast verify MACHINE --block {block}",
        .folder.display()
    )]
    BlockAlone {
        /// Path of the folder.
        folder: PathBuf,
        /// Name of the block.
        block: String,
    },
    /// The manifest is invalid.
    #[error(
        "{}: {reason}, so the files that posicast wrote here are unknown: move the folder away or name another one",
        .folder.join(MANIFEST).display()
    )]
    Manifest {
        /// Path of the folder.
        folder: PathBuf,
        /// What is wrong with the manifest.
        reason: String,
    },
    /// Files were edited since posicast wrote them.
    #[error(
        "{}: edited since posicast wrote it: {}; it would be overwritten: move it away or delete it",
        .folder.display(), .files.join(", ")
    )]
    Edited {
        /// Path of the folder.
        folder: PathBuf,
        /// Paths of the files in the folder.
        files: Vec<String>,
    },
    /// Files that posicast did not write have paths that this run produces.
    #[error(
        "{}: posicast did not write {}, and now produces a file of that name: move it away or delete it",
        .folder.display(), .files.join(", ")
    )]
    InTheWay {
        /// Path of the folder.
        folder: PathBuf,
        /// Paths of the files in the folder.
        files: Vec<String>,
    },
    /// There is a link, folder or device in place of a plain file, or a file or link in place of a folder.
    #[error("{}: is {found} where posicast keeps {wanted}: move it away or delete it", .path.display())]
    WrongType {
        /// Path of the entry.
        path: PathBuf,
        /// What was found.
        found: &'static str,
        /// What is expected there.
        wanted: &'static str,
    },
    /// Posicast does not write to such a path.
    #[error("output path {path:?} {reason}")]
    Path {
        /// The path.
        path: String,
        /// The rule that the path breaks.
        reason: &'static str,
    },
    /// The same path was added twice.
    #[error("output path {0:?} was added twice")]
    Twice(String),
    /// The caller announced a file and did not write it.
    #[error("output file {0:?} was announced and never written")]
    NotWritten(String),
    /// Another run uses the folder.
    #[error("{}: another posicast is writing to this folder: wait until it ends, or name another folder", .0.display())]
    Busy(PathBuf),
    /// The last run on the folder was killed while it replaced files.
    #[error("{}: the run that wrote this folder was interrupted: run it again", .0.display())]
    Unfinished(PathBuf),
    /// A file of the package is missing.
    #[error("{}: is missing: write the folder again with `generate` or `run`", .0.display())]
    Missing(PathBuf),
    /// A text file is larger than anything that posicast writes.
    #[error("{}: is larger than {limit_bytes} bytes, the most that is read", .path.display())]
    TooLarge {
        /// Path of the file.
        path: PathBuf,
        /// Size limit in bytes.
        limit_bytes: u64,
    },
    /// The operating system reported an error.
    #[error("{}: cannot {action}: {source}", .path.display())]
    Io {
        /// Path of the file or folder.
        path: PathBuf,
        /// What was attempted.
        action: &'static str,
        /// The error.
        source: io::Error,
    },
}

/// Adds the attempted action and the path to an error of the operating system.
pub(super) fn at(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> PackageError {
    let path = path.to_owned();
    move |source| PackageError::Io { path, action, source }
}
