//! Verilator's own C++, which is the same in every simulation: it is compiled once and taken from the cache, and so are its headers.
//!
//! Compiling `verilated.cpp` and its companions, or reading their headers, takes longer than compiling a small block.

use std::fs;
use std::io;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use posicast_system::kept::{self, SUM_ENDING};

use super::harness::COMPILED_HEADERS;

/// The objects and compiled headers of one version of Verilator, compiled with one set of flags.
pub(super) struct Runtime {
    folder: PathBuf,
    prefix: String,
}

impl Runtime {
    /// Names the runtime in a cache folder. `key` must represent everything on which the objects depend.
    pub(super) fn new(folder: &Path, key: &str) -> Self {
        Self {
            folder: folder.to_owned(),
            prefix: format!("verilator-{key}-"),
        }
    }

    /// Gives a build folder what exists: the objects as copies, which `make` finds newer than their sources, and the headers, which
    /// are large, as a link.
    pub(super) fn lend(&self, work: &Path) {
        for (name, path) in files(&self.folder) {
            let Some(name) = name.strip_prefix(&self.prefix) else {
                continue;
            };
            if name.ends_with(SUM_ENDING) || !kept::holds(&path) {
                continue;
            }
            // If one of them fails, `make` compiles it again.
            if name == COMPILED_HEADERS {
                let _ = path.canonicalize().and_then(|path| symlink(path, work.join(name)));
            } else {
                let _ = fs::copy(&path, work.join(name));
            }
        }
    }

    /// Keeps what a build has compiled.
    ///
    /// # Errors
    /// [`io::Error`] where the cache cannot be written.
    pub(super) fn keep(&self, work: &Path) -> io::Result<()> {
        for (name, path) in files(work) {
            let is_kept = name == COMPILED_HEADERS || (name.starts_with("verilated") && name.ends_with(".o"));
            let kept = self.folder.join(format!("{}{name}", self.prefix));
            // What was lent fits; a link to the headers is not theirs.
            if is_kept && !path.is_symlink() && !kept::holds(&kept) {
                kept::keep(&path, &kept)?;
            }
        }
        Ok(())
    }
}

/// Names and paths of the files in a folder.
fn files(folder: &Path) -> impl Iterator<Item = (String, PathBuf)> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| Some((entry.file_name().into_string().ok()?, entry.path())))
}
