//! Text files of bounded size.

use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::Path;

use super::error::{PackageError, at};

/// Largest text file that is read, in bytes: far above any machine file.
const TEXT_LIMIT_BYTES: u64 = 16 << 20;

/// Reads the text of a file of bounded size.
pub(super) fn read_text(path: &Path) -> Result<String, PackageError> {
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => {}
        Ok(metadata) => {
            return Err(PackageError::WrongType {
                path: path.to_owned(),
                found: if metadata.is_dir() { "a folder" } else { "a device" },
                wanted: "a file",
            });
        }
        Err(error) if error.kind() == ErrorKind::NotFound => return Err(PackageError::Missing(path.to_owned())),
        Err(error) => return Err(at("read", path)(error)),
    }
    let file = File::open(path).map_err(at("read", path))?;
    let mut text = String::new();
    let length = file
        .take(TEXT_LIMIT_BYTES + 1)
        .read_to_string(&mut text)
        .map_err(at("read", path))?;
    if length as u64 > TEXT_LIMIT_BYTES {
        return Err(PackageError::TooLarge {
            path: path.to_owned(),
            limit_bytes: TEXT_LIMIT_BYTES,
        });
    }
    Ok(text)
}
