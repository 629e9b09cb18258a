//! The cache of built simulations, and the removal of old ones.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::Duration;

use posicast_system::interrupt::{self, Leftover, Listed};

use super::kept::SUM_ENDING;

const DAY: Duration = Duration::from_secs(24 * 60 * 60);
/// A simulation that was not used for this long is removed, and built again when it is needed.
const KEPT: Duration = DAY.saturating_mul(30);
/// A build folder that was not changed for this long was left by a process that was killed.
const ABANDONED: Duration = DAY;

/// Prefix of the folders in which simulations are built.
pub(super) const BUILD_PREFIX: &str = "build-";

/// Path of the cache: `$POSICAST_CACHE`, else the user's cache folder, else the temporary one.
pub(super) fn folder() -> PathBuf {
    let variable = |name| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    variable("POSICAST_CACHE")
        .or_else(|| variable("XDG_CACHE_HOME").map(|folder| folder.join("posicast")))
        .or_else(|| variable("HOME").map(|folder| folder.join(".cache").join("posicast")))
        .unwrap_or_else(|| std::env::temp_dir().join("posicast"))
}

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
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let modified = entry.metadata().and_then(|data| data.modified());
        let age = modified.ok().and_then(|time| time.elapsed().ok()).unwrap_or_default();
        let is_ours = name.starts_with("verilator-")
            && [".so", ".o", ".gch", ".lock", SUM_ENDING]
                .iter()
                .any(|end| name.ends_with(end));
        if is_ours && age > KEPT {
            let _ = fs::remove_file(entry.path());
        } else if name.starts_with(BUILD_PREFIX) && age > ABANDONED {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::kept;
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
