//! Everything that can go wrong here, by cause.

use std::path::{Path, PathBuf};

/// Why a comparison could not be made. That something *differs* is a result, never an error.
#[derive(Debug, thiserror::Error)]
pub enum WaveError {
    /// A file cannot be read or written.
    #[error("{}: cannot {doing}: {source}", .path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// What the system says.
        source: std::io::Error,
    },
    /// A waveform file that is damaged, or beyond what can be compared in bounded memory.
    #[error("{}: {place}: {problem}", .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// `line N`, or `byte N` at the end of a truncated file.
        place: String,
        /// What was found, what is allowed, what to do.
        problem: String,
    },
    /// An option that does not fit the files it is used with.
    #[error("{0}")]
    Option(String),
}

impl WaveError {
    /// What the system said while `doing` something with a file.
    pub fn file(path: &Path, doing: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { path, doing, source }
    }
}
