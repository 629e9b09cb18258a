//! Temporary folders and files. They are removed when their value is dropped, and when a signal ends the process.

use crate::interrupt::{self, Leftover, Listed};
use std::fs::File;
use std::io;
use std::path::Path;
use tempfile::{Builder, NamedTempFile, TempDir};

/// Default prefix of a temporary folder's name.
pub const PREFIX: &str = "posicast-";

/// A temporary folder.
#[derive(Debug)]
pub struct Folder {
    // This is dropped before its entry of the list.
    folder: TempDir,
    _listed: Listed,
}

impl Folder {
    /// Makes a new, empty folder whose name begins with `prefix`, in the system's folder for temporary files.
    ///
    /// # Errors
    /// An error if the folder cannot be created.
    pub fn new(prefix: &str) -> io::Result<Self> {
        Self::new_in(prefix, &std::env::temp_dir())
    }

    /// Makes such a folder in `parent`.
    ///
    /// # Errors
    /// An error if the folder cannot be created.
    pub fn new_in(prefix: &str, parent: &Path) -> io::Result<Self> {
        let (folder, listed) = interrupt::listed(|| {
            let folder = Builder::new().prefix(prefix).tempdir_in(parent)?;
            let leftover = Leftover::Tree(folder.path().to_owned());
            Ok::<_, io::Error>((folder, vec![leftover]))
        })?;
        Ok(Self {
            folder,
            _listed: listed,
        })
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Makes a temporary file without a name.
///
/// # Errors
/// An error if the file cannot be created.
pub fn unnamed() -> io::Result<File> {
    interrupt::uninterrupted(tempfile::tempfile)
}

/// A temporary file that gets its name when it is complete.
#[derive(Debug)]
pub(crate) struct Beside {
    file: NamedTempFile,
    listed: Listed,
}

impl Beside {
    /// Makes a file in `folder`.
    pub(crate) fn new(folder: &Path) -> io::Result<Self> {
        let (file, listed) = interrupt::listed(|| {
            let mut builder = Builder::new();
            #[cfg(unix)]
            {
                use std::os::unix::fs::PermissionsExt;
                // Temporary files have mode 0600 by default, which would stay on the finished file.
                builder.permissions(std::fs::Permissions::from_mode(0o644));
            }
            let file = builder.prefix(".posicast-").tempfile_in(folder)?;
            let leftover = Leftover::File(file.path().to_owned());
            Ok::<_, io::Error>((file, vec![leftover]))
        })?;
        Ok(Self { file, listed })
    }

    /// The file itself.
    pub(crate) fn file(&mut self) -> &mut File {
        self.file.as_file_mut()
    }

    /// Gives the file its name, and replaces a file that has that name now.
    pub(crate) fn put(mut self, path: &Path) -> io::Result<()> {
        let file = self.file;
        let renamed = interrupt::settled(&mut self.listed, || file.persist(path));
        renamed.map(drop).map_err(|cause| cause.error)
    }
}
