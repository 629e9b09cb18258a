//! A file that appears with its name only when it is complete.

use std::fs::{File, OpenOptions};
use std::io::{self, BufReader, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::seal;
use super::target::Target;
use crate::scratch::{self, Beside};

/// A file that is being written. If it is dropped before [`put`](Draft::put), it leaves nothing behind.
#[derive(Debug)]
pub struct Draft {
    place: Option<Place>,
    hash: Sha256,
}

#[derive(Debug)]
enum Place {
    /// A file in the folder of the final file, with that file's path.
    File(Beside, PathBuf),
    /// A file that is copied into the stream at the end, because a seal is filled in at a place that was written
    /// before. `None` is the standard output.
    Stream(File, Option<PathBuf>),
}

impl Draft {
    /// Starts a file that will replace `path`; `-` is the standard output.
    ///
    /// # Errors
    /// An error if `path` is a folder, or its folder cannot be written.
    pub fn new(path: &Path) -> io::Result<Self> {
        let place = match Target::of(path)? {
            Target::Existing(path) | Target::New(path) => {
                let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
                let beside = Beside::new(folder.unwrap_or(Path::new("."))).map_err(|error| {
                    // The system's error names the temporary file, of which the user knows nothing.
                    io::Error::new(
                        error.kind(),
                        format!("{}: cannot write there: {}", path.display(), error.kind()),
                    )
                })?;
                Place::File(beside, path)
            }
            Target::Stdout => Place::Stream(scratch::unnamed()?, None),
            Target::Stream(path) => Place::Stream(scratch::unnamed()?, Some(path)),
        };
        Ok(Self {
            place: Some(place),
            hash: Sha256::new(),
        })
    }

    /// Fills in its seal, if it has a blank one, and gives the file its name.
    ///
    /// # Errors
    /// An error if the file cannot be written or renamed, or was already put in its place.
    pub fn put(&mut self) -> io::Result<()> {
        let place = self.place.take().ok_or_else(gone)?;
        let hash = std::mem::take(&mut self.hash);
        match place {
            Place::File(mut beside, path) => {
                seal::fill_in(beside.file(), hash)?;
                beside.put(&path)
            }
            Place::Stream(mut file, stream) => {
                seal::fill_in(&mut file, hash)?;
                file.seek(SeekFrom::Start(0))?;
                let mut from = BufReader::new(file);
                let copied = match stream {
                    None => {
                        let mut to = io::stdout().lock();
                        io::copy(&mut from, &mut to).and_then(|_| to.flush())
                    }
                    // If the stream turns out to be a file, this appends to it.
                    Some(path) => {
                        let to = OpenOptions::new().append(true).open(path);
                        to.and_then(|mut to| io::copy(&mut from, &mut to).map(drop))
                    }
                };
                match copied {
                    // A reader that has ended wants no more.
                    Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
                    other => other,
                }
            }
        }
    }

    fn file(&mut self) -> io::Result<&mut File> {
        match &mut self.place {
            Some(Place::File(beside, _)) => Ok(beside.file()),
            Some(Place::Stream(file, _)) => Ok(file),
            None => Err(gone()),
        }
    }
}

fn gone() -> io::Error {
    io::Error::other("the file was put in its place already")
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.file()?.write(bytes)?;
        self.hash.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file()?.flush()
    }
}

/// Writes a text with a seal, completely or not at all. The seal is a comment of XML where the text begins with `<`,
/// of GTKWave's session files where it begins with `[`, of JSON (the key `$comment`) where it begins with `{`, of man
/// pages where it begins with `.`, else a second line that begins with `#`.
///
/// # Errors
/// Those of [`Draft::new`] and [`Draft::put`].
pub fn write_text(path: &Path, text: &str) -> io::Result<()> {
    let mut draft = Draft::new(path)?;
    draft.write_all(seal::with_blank(text).as_bytes())?;
    draft.put()
}
