//! Resolves a name: it leads to a file, to the standard output, or to a pipe or a device.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Largest number of links that are followed before they count as a circle.
const MOST_LINKS: u32 = 40;
/// Name of the standard output.
const DASH: &str = "-";

/// What a name leads to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Target {
    /// An existing file, after following all links.
    Existing(PathBuf),
    /// A file that does not exist yet.
    New(PathBuf),
    /// The standard output.
    Stdout,
    /// A pipe or device, which is written to and not replaced.
    Stream(PathBuf),
}

impl Target {
    /// Follows the name.
    ///
    /// # Errors
    /// An error for a folder ([`ErrorKind::IsADirectory`]), for links in a circle, or from the system.
    pub(super) fn of(path: &Path) -> io::Result<Self> {
        if path == Path::new(DASH) {
            return Ok(Self::Stdout);
        }
        let mut path = path.to_owned();
        for _ in 0..MOST_LINKS {
            match descriptor(&path) {
                Some(1) => return Ok(Self::Stdout),
                Some(_) => return Ok(Self::Stream(path)),
                None => {}
            }
            let kind = match path.symlink_metadata() {
                Ok(found) => found.file_type(),
                Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Self::New(path)),
                Err(error) => return Err(error),
            };
            if kind.is_dir() {
                return Err(io::Error::new(ErrorKind::IsADirectory, "it is a folder"));
            }
            if kind.is_file() {
                return Ok(Self::Existing(path));
            }
            if !kind.is_symlink() {
                return Ok(Self::Stream(path));
            }
            let next = path.read_link()?;
            path = path.parent().unwrap_or(Path::new("")).join(next);
        }
        Err(io::Error::other("its links lead in a circle"))
    }
}

/// Number of an open file of this process, where the system has a name for it: `/dev/fd/3`, `/proc/self/fd/3`.
fn descriptor(path: &Path) -> Option<u32> {
    let folder = path.parent()?;
    let is_list = folder == Path::new("/dev/fd") || (folder.starts_with("/proc") && folder.ends_with("fd"));
    is_list.then(|| path.file_name()?.to_str()?.parse().ok()).flatten()
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn a_name_leads_to_a_file_a_stream_or_the_standard_output() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("file"), "").unwrap();
        for (name, to) in [
            ("link", "file"),
            ("chain", "link"),
            ("nowhere", "missing"),
            ("circle", "circle"),
            ("null", "/dev/null"),
            ("out", "/dev/stdout"),
        ] {
            symlink(to, path(name)).unwrap();
        }
        let of = |path: &Path| Target::of(path).unwrap();
        assert_eq!(of(&path("chain")), Target::Existing(path("file")));
        assert_eq!(of(&path("new")), Target::New(path("new")));
        assert_eq!(of(&path("nowhere")), Target::New(path("missing")), "the link stays");
        assert_eq!(of(&path("null")), Target::Stream("/dev/null".into()));
        for stdout in [
            Path::new("-"),
            Path::new("/dev/stdout"),
            Path::new("/dev/fd/1"),
            &path("out"),
        ] {
            assert_eq!(of(stdout), Target::Stdout, "{}", stdout.display());
        }
        assert!(matches!(of(Path::new("/dev/stderr")), Target::Stream(_)));
        assert_eq!(Target::of(folder.path()).unwrap_err().kind(), ErrorKind::IsADirectory);
        assert!(Target::of(&path("circle")).is_err());
    }
}
