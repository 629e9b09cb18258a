//! Everything that can go wrong here, by cause.

use std::path::{Path, PathBuf};

/// Why a comparison could not be made. A *difference* is a result, never an error.
#[derive(Debug, thiserror::Error)]
pub enum WaveError {
    /// A file cannot be read or written.
    #[error("{}: cannot {doing}: {source}", .path.display())]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// The operation that failed.
        doing: &'static str,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A waveform file is damaged, or cannot be compared in bounded memory.
    #[error("{}: {place}: {problem}", .path.display())]
    Damaged {
        /// Path of the file.
        path: PathBuf,
        /// `line N`, or `byte N` at the end of a truncated file.
        place: String,
        /// What was found, what is allowed, what to do.
        problem: String,
    },
    /// An option does not fit the files with which it is used.
    #[error("{0}")]
    Option(String),
}

impl WaveError {
    /// Converts a system error while `doing` something with a file.
    pub fn file(path: &Path, doing: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { path, doing, source }
    }
}
