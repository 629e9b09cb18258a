//! Verilator's own C++, which is the same in every simulation: it is compiled once and taken from the cache.
//!
//! Compiling `verilated.cpp` and its companions takes longer than compiling a small block.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The objects of one version of Verilator, compiled with one set of flags.
pub(super) struct Runtime {
    folder: PathBuf,
    prefix: String,
}

impl Runtime {
    /// The objects in a cache folder. The key represents everything on which they depend.
    pub(super) fn new(folder: &Path, key: &str) -> Self {
        Self {
            folder: folder.to_owned(),
            prefix: format!("verilator-{key}-"),
        }
    }

    /// Copies the existing objects into a build folder, where `make` finds them newer than their sources.
    pub(super) fn lend(&self, work: &Path) {
        for (name, path) in objects(&self.folder, &self.prefix) {
            // If the copy fails, `make` compiles the object again.
            let _ = fs::copy(&path, work.join(name));
            super::cache::holds(&path);
        }
    }

    /// Keeps the objects that a build has made.
    ///
    /// # Errors
    /// [`io::Error`] where the cache cannot be written.
    pub(super) fn keep(&self, work: &Path) -> io::Result<()> {
        for (name, path) in objects(work, "verilated") {
            let kept = self.folder.join(format!("{}verilated{name}", self.prefix));
            if !kept.exists() {
                fs::rename(path, kept)?;
            }
        }
        Ok(())
    }
}

/// Object files whose names have this prefix: the rest of the name, and the path.
fn objects(folder: &Path, prefix: &str) -> Vec<(String, PathBuf)> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .filter_map(|entry| {
            let name = entry.file_name().into_string().ok()?;
            let rest = name.strip_prefix(prefix)?;
            rest.ends_with(".o").then(|| (rest.to_owned(), entry.path()))
        })
        .collect()
}
