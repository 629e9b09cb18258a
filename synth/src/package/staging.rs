//! The staging folder of a run. It is inside the output folder, on the same file system, so that a rename puts a file
//! in place.

use std::fs::{self, File, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use posicast_system::interrupt::{self, Leftover, Listed};

use super::error::{PackageError, at};
use super::layout::STAGING;

/// The claim on an output folder. When dropped, it removes the staging folder, and every folder that it had to
/// create, unless [`keep_folder`](Staging::keep_folder) was called.
#[derive(Debug)]
pub(super) struct Staging {
    path: PathBuf,
    created: Vec<PathBuf>,
    /// Handle of the locked output folder; the system unlocks it even if the process is killed.
    _lock: File,
    _listed: Listed,
}

impl Staging {
    /// Creates `root` if needed, locks it, and makes an empty staging folder in it.
    pub(super) fn claim(root: &Path) -> Result<Self, PackageError> {
        let (staging, listed) = interrupt::listed(|| {
            let missing = root
                .ancestors()
                .take_while(|p| !p.as_os_str().is_empty() && !p.exists());
            let created: Vec<PathBuf> = missing.map(Path::to_owned).collect();
            let path = root.join(STAGING);
            match Self::make(root, &path) {
                Ok(lock) => {
                    let folders = created.iter().rev().cloned().map(Leftover::EmptyFolder);
                    let leftovers = folders.chain([Leftover::Tree(path.clone())]).collect();
                    Ok(((path, created, lock), leftovers))
                }
                Err(error) => {
                    remove_empty(&created);
                    Err(error)
                }
            }
        })?;
        let (path, created, lock) = staging;
        Ok(Self {
            path,
            created,
            _lock: lock,
            _listed: listed,
        })
    }

    /// Creates the folders, and locks.
    fn make(root: &Path, staging: &Path) -> Result<File, PackageError> {
        fs::create_dir_all(root).map_err(at("create", root))?;
        let lock = lock(root)?;
        // The lock is ours, so an existing staging folder was left behind by a run that was killed.
        match fs::remove_dir_all(staging) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(at("remove", staging)(error)),
            _ => fs::create_dir(staging).map(|()| lock).map_err(at("create", staging)),
        }
    }

    /// Path of the staging folder.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Keeps the output folder, because it now contains a package.
    pub(super) fn keep_folder(&mut self) {
        self.created.clear();
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // A failure cannot be reported here; the next run removes what remains.
        let _ = fs::remove_dir_all(&self.path);
        remove_empty(&self.created);
    }
}

fn lock(root: &Path) -> Result<File, PackageError> {
    let folder = File::open(root).map_err(at("open", root))?;
    match folder.try_lock() {
        Ok(()) => Ok(folder),
        Err(TryLockError::WouldBlock) => Err(PackageError::Busy(root.to_owned())),
        // Some network file systems have no locks; there the user must keep two runs apart.
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => Ok(folder),
        Err(TryLockError::Error(error)) => Err(at("lock", root)(error)),
    }
}

/// Removes empty folders, the innermost first.
fn remove_empty(folders: &[PathBuf]) {
    for folder in folders {
        let _ = fs::remove_dir(folder);
    }
}
