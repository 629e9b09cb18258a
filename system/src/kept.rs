//! Files that are kept for later runs in the [`folder`] for them, each with its checksum beside it.
//!
//! ```text
//!  verilator-5f70….so           the file
//!  verilator-5f70….so.sha256    64 hexadecimal digits
//! ```
//!
//! A file that is truncated or was changed (by a damaged disk, an incomplete copy or a person) must never be used: half a
//! shared object ends the process with SIGBUS as soon as it is loaded. So the checksum is compared before each use, and a file
//! that does not match counts as absent. It is not removed; its replacement is renamed over it.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use sha2::{Digest, Sha256};

/// A file that was not used for this long is removed, and made again when it is needed.
const KEPT: Duration = Duration::from_secs(30 * 24 * 60 * 60);
/// Ending of the name of a checksum.
pub const SUM_ENDING: &str = ".sha256";

/// The folder of kept files: `$POSICAST_CACHE`, else that of the user's cache, else the temporary one.
#[must_use]
pub fn folder() -> PathBuf {
    let variable = |name| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    variable("POSICAST_CACHE")
        .or_else(|| variable("XDG_CACHE_HOME").map(|folder| folder.join("posicast")))
        .or_else(|| variable("HOME").map(|folder| folder.join(".cache").join("posicast")))
        .unwrap_or_else(|| std::env::temp_dir().join("posicast"))
}

/// Removes files in `folder` whose names begin with `prefix`, and which were not used for a month. Failures do not matter: another process
/// may be doing the same.
pub fn remove_old(folder: &Path, prefix: &str) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_ours = entry.file_name().to_string_lossy().starts_with(prefix);
        let modified = entry.metadata().and_then(|data| data.modified());
        let age = modified.ok().and_then(|time| time.elapsed().ok()).unwrap_or_default();
        if is_ours && age > KEPT {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether the file is there and fits its checksum; if so, it counts as used now.
#[must_use]
pub fn holds(path: &Path) -> bool {
    let fits = || Some(fs::read_to_string(sum_of(path)).ok()?.trim() == checksum(path).ok()?);
    if fits() != Some(true) {
        return false;
    }
    for path in [path, &sum_of(path)] {
        // If this fails, the file only counts as older than it is.
        let _ = File::options()
            .append(true)
            .open(path)
            .and_then(|file| file.set_modified(SystemTime::now()));
    }
    true
}

/// Puts the file `made` in the place `kept`, on the same file system, and its checksum beside it. What stood there is replaced.
///
/// # Errors
/// [`io::Error`] where it cannot be read, or the folder cannot be written.
pub fn keep(made: &Path, kept: &Path) -> io::Result<()> {
    let sum = made.with_extension("sum");
    fs::write(&sum, checksum(made)? + "\n")?;
    // A system that fails just after a rename must not leave a name without contents.
    File::open(made)?.sync_all()?;
    // The checksum goes first: where the file appears, it fits.
    fs::rename(sum, sum_of(kept))?;
    fs::rename(made, kept)
}

/// Path of a file's checksum.
fn sum_of(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(SUM_ENDING);
    name.into()
}

fn checksum(path: &Path) -> io::Result<String> {
    let (mut file, mut hash, mut buffer) = (File::open(path)?, Sha256::new(), vec![0; 1 << 16]);
    loop {
        match file.read(&mut buffer)? {
            0 => break,
            count => hash.update(&buffer[..count]),
        }
    }
    Ok(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_file_that_fits_its_checksum_is_held() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let keep_text = |text: &str| {
            fs::write(path("made"), text).unwrap();
            keep(&path("made"), &path("kept.so")).unwrap();
        };
        assert!(!holds(&path("kept.so")));
        keep_text("contents");
        assert!(holds(&path("kept.so")));
        // SHA-256 of `contents` by coreutils.
        let sum = fs::read_to_string(path("kept.so.sha256")).unwrap();
        assert_eq!(
            sum,
            "d1b2a59fbea7e20077af9f91b27e95e865061b270be03ff539ab3b73587882e8\n"
        );
        for damaged in ["content", "Contents", "", "contents\0"] {
            fs::write(path("kept.so"), damaged).unwrap();
            assert!(!holds(&path("kept.so")), "{damaged:?}");
        }
        keep_text("contents");
        assert!(holds(&path("kept.so")));
        for sum in ["", "0", &sum[1..]] {
            fs::write(path("kept.so.sha256"), sum).unwrap();
            assert!(!holds(&path("kept.so")), "{sum:?}");
        }
        fs::remove_file(path("kept.so.sha256")).unwrap();
        assert!(!holds(&path("kept.so")));
    }
}
