//! Copies the files that options of `run` name into the output folder, where the run can then be repeated.

use crate::failure::Failure;
use std::path::{Path, PathBuf};

/// Folder of the copies in the output folder.
const FOLDER: &str = "input";

/// Name of the copy in the output folder; `None` for a word that is not a file, and for a pipe, which can be read only once.
fn name(path: &Path) -> Option<String> {
    let name = path.file_name().filter(|_| path.is_file())?;
    let plain = |letter: char| !letter.is_control() && letter != '\\' && letter != char::REPLACEMENT_CHARACTER;
    let letters = name.to_string_lossy();
    let letters = letters.chars().map(|letter| if plain(letter) { letter } else { '_' });
    Some(format!("{FOLDER}/{}", letters.collect::<String>()))
}

/// The path of an option's file inside the output folder.
pub(crate) fn in_folder(path: &Path) -> PathBuf {
    name(path).map_or_else(|| path.to_owned(), PathBuf::from)
}

/// Name and contents of the copy of a file; `None` if there is none.
pub(crate) fn copy(path: &Path) -> Option<Result<(String, Vec<u8>), Failure>> {
    let name = name(path)?;
    let unreadable = |error: std::io::Error| Failure::input(format!("cannot read `{}`: {error}", path.display()));
    Some(std::fs::read(path).map(|bytes| (name, bytes)).map_err(unreadable))
}
