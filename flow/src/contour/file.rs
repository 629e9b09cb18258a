//! The file of a path.

use crate::failure::Failure;
use std::cell::Cell;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::rc::Rc;

/// Largest size in bytes of points or G-code that come through a pipe, which is read once and kept.
const PIPED_BYTES: u64 = 64 << 20;
/// Bytes that are read from a file at a time.
const BUFFER_BYTES: usize = 1 << 18;

/// A file that can be read from its beginning any number of times.
pub(super) struct PathFile<'a> {
    pub(super) path: &'a Path,
    pub(super) bytes: u64,
    /// The content of a pipe.
    kept: Option<Vec<u8>>,
}

impl<'a> PathFile<'a> {
    pub(super) fn open(path: &'a Path) -> Result<Self, Failure> {
        let file = File::open(path).map_err(|error| unreadable(path, &error.to_string()))?;
        let kind = file.metadata().map_err(|error| unreadable(path, &error.to_string()))?;
        if kind.is_dir() {
            return Err(unreadable(path, "it is a folder"));
        }
        if kind.is_file() {
            return Ok(Self {
                path,
                bytes: kind.len(),
                kept: None,
            });
        }
        let mut kept = Vec::new();
        let read = file.take(PIPED_BYTES + 1).read_to_end(&mut kept);
        let bytes = read.map_err(|error| unreadable(path, &error.to_string()))? as u64;
        if bytes > PIPED_BYTES {
            Err(unreadable(
                path,
                &format!("through a pipe it has more than {PIPED_BYTES} bytes; write it into a file"),
            ))
        } else {
            Ok(Self {
                path,
                bytes,
                kept: Some(kept),
            })
        }
    }

    /// The file from its beginning; `bytes` counts what was read of it.
    pub(super) fn reader(&self, bytes: &Rc<Cell<u64>>) -> Result<Box<dyn BufRead + '_>, Failure> {
        match &self.kept {
            Some(kept) => Ok(Box::new(kept.as_slice())),
            None => {
                let file = File::open(self.path).map_err(|error| unreadable(self.path, &error.to_string()))?;
                let counted = Counted {
                    file,
                    bytes: Rc::clone(bytes),
                };
                Ok(Box::new(BufReader::with_capacity(BUFFER_BYTES, counted)))
            }
        }
    }
}

/// A file that counts the bytes read from it.
struct Counted {
    file: File,
    bytes: Rc<Cell<u64>>,
}

impl Read for Counted {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let read = self.file.read(into)?;
        self.bytes.set(self.bytes.get() + read as u64);
        Ok(read)
    }
}

pub(super) fn unreadable(path: &Path, found: &str) -> Failure {
    Failure::input(format!("--contour: cannot read `{}`: {found}", path.display()))
        .with_help("name `circle`, `square`, a CSV file with rows x,y, or a G-code file (.gcode, .nc, .ngc)")
}
