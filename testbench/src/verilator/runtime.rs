//! Verilator's own C++, which is the same in every simulation: compiled once, then lent by the cache.
//!
//! `verilated.cpp` and its kin take longer to compile than a small block does.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The objects of one version of Verilator, compiled with one set of flags.
pub(super) struct Runtime {
    folder: PathBuf,
    prefix: String,
}

impl Runtime {
    /// Those in a cache folder. The key stands for all that they depend on.
    pub(super) fn new(folder: &Path, key: &str) -> Self {
        Self {
            folder: folder.to_owned(),
            prefix: format!("verilator-{key}-"),
        }
    }

    /// Puts the objects that are there into a folder to build in, where `make` finds them newer than their sources.
    pub(super) fn lend(&self, work: &Path) {
        for (name, path) in objects(&self.folder, &self.prefix) {
            // Without it, `make` compiles the object again.
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

/// Object files whose names begin so: the rest of the name, and the path.
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
