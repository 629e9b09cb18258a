//! The cache of built simulations, and the removal of old ones.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::Duration;

use posicast_system::interrupt::{self, Leftover, Listed};
use posicast_system::kept;

const DAY: Duration = Duration::from_secs(24 * 60 * 60);
/// A build folder that was not changed for this long was left by a process that was killed.
const ABANDONED: Duration = DAY;

/// Prefix of the files that are kept.
const OBJECT_PREFIX: &str = "verilator-";
/// Prefix of the folders in which simulations are built.
pub(super) const BUILD_PREFIX: &str = "build-";

/// A file that keeps other processes from building the same object. It is removed when this value is dropped, and when a signal ends the
/// process. A process that comes just then may make it anew: both then build, which only takes longer.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    file: File,
    _listed: Listed,
}

impl Lock {
    /// Waits until no other process builds this object. `None` where the file system has no locks.
    pub(super) fn wait_for(object: &Path) -> Option<Self> {
        let path = object.with_extension("lock");
        let (file, listed) = interrupt::listed(|| {
            let file = File::options().create(true).append(true).open(&path)?;
            Ok::<_, std::io::Error>((file, vec![Leftover::File(path.clone())]))
        })
        .ok()?;
        let lock = Self {
            path,
            file,
            _listed: listed,
        };
        lock.file.lock().ok()?;
        Some(lock)
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Another process may have removed it already.
        let _ = fs::remove_file(&self.path);
    }
}

/// Removes old entries. Failures do not matter: another process may be doing the same.
pub(super) fn tidy(folder: &Path) {
    kept::remove_old(folder, OBJECT_PREFIX);
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let modified = entry.metadata().and_then(|data| data.modified());
        let age = modified.ok().and_then(|time| time.elapsed().ok()).unwrap_or_default();
        if entry.file_name().to_string_lossy().starts_with(BUILD_PREFIX) && age > ABANDONED {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::SystemTime;

    #[test]
    fn only_old_files_of_the_cache_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let make = |name: &str, days: u64| {
            let path = folder.path().join(name);
            let file = File::create(&path).unwrap();
            file.set_modified(SystemTime::now() - DAY * days as u32).unwrap();
            path
        };
        let old = make("verilator-1.so", 31);
        let old_object = make("verilator-1-verilated.o", 31);
        let old_headers = make("verilator-1-harness_headers.h.gch", 31);
        let old_sum = make("verilator-1.so.sha256", 31);
        let made = make("made", 31);
        let [used, used_sum] = ["verilator-2.so", "verilator-2.so.sha256"].map(|name| folder.path().join(name));
        kept::keep(&made, &used).unwrap();
        let month = SystemTime::now() - DAY * 31;
        for path in [&used, &used_sum] {
            File::options()
                .append(true)
                .open(path)
                .unwrap()
                .set_modified(month)
                .unwrap();
        }
        let recent = make("verilator-3.so", 29);
        let foreign = make("thesis.tex", 1000);
        assert!(kept::holds(&used));
        tidy(folder.path());
        assert_eq!(
            [old, old_object, old_headers, old_sum, used, used_sum, recent, foreign].map(|path| path.exists()),
            [false, false, false, false, true, true, true, true]
        );
    }
}
