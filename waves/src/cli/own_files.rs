//! The files that the program `wavecmp` writes: it replaces its own files, never an input, and other files only with
//! `--force`.

use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use super::CommandHost;
use crate::WaveError;
use crate::files::{OutputSink, WriteContent};

const MARK: &str = "written by wavecmp";
/// Number of bytes at the beginning of a file in which the mark is looked for.
const HEAD_BYTES: u64 = 4096;

/// The files of one run.
#[derive(Default)]
pub(crate) struct OwnFiles {
    force: bool,
    inputs: Vec<(&'static str, PathBuf)>,
    claimed: Vec<PathBuf>,
}

/// Why a file is not written.
#[derive(Debug, thiserror::Error)]
enum Refused {
    #[error("{option} {}: that is {input}, and an input is never replaced: name another file", .path.display())]
    Input {
        option: String,
        path: PathBuf,
        input: &'static str,
    },
    #[error("{option} {}: there is a file that wavecmp did not write: name another file, or replace it with --force", .path.display())]
    Foreign { option: String, path: PathBuf },
    #[error("{option} {}: something else is written there by the same command: name another file", .path.display())]
    Twice { option: String, path: PathBuf },
    #[error("{option} {}: that is a folder: name a file", .path.display())]
    Folder { option: String, path: PathBuf },
    #[error("{option} {}: there is no folder to hold it: make it, or name a file elsewhere", .path.display())]
    NoFolder { option: String, path: PathBuf },
}

impl OwnFiles {
    pub(crate) fn new(force: bool) -> Self {
        Self {
            force,
            ..Self::default()
        }
    }
}

fn is_standard_output(path: &Path) -> bool {
    path == Path::new("-") || path == Path::new("/dev/stdout")
}

/// Returns whether two paths are the same file.
fn same(a: &Path, b: &Path) -> bool {
    a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b)) || same_file(a, b)
}

#[cfg(unix)]
fn same_file(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |path: &Path| path.metadata().map(|data| (data.dev(), data.ino()));
    matches!((id(a), id(b)), (Ok(a), Ok(b)) if a == b)
}

#[cfg(not(unix))]
fn same_file(_: &Path, _: &Path) -> bool {
    false
}

fn is_ours(path: &Path) -> io::Result<bool> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD_BYTES).read_to_end(&mut head)?;
    Ok(String::from_utf8_lossy(&head).contains(MARK))
}

fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

impl OutputSink for OwnFiles {
    fn mark(&self) -> String {
        format!("{MARK} {}", env!("CARGO_PKG_VERSION"))
    }

    fn write(&self, path: &Path, content: &mut WriteContent<'_>) -> Result<(), WaveError> {
        let failed = |cause| WaveError::file(path, "write")(cause);
        if is_standard_output(path) {
            return content(&mut io::stdout().lock());
        }
        // Pipes and devices are written to; if the path is a link, the file that it points to is replaced.
        let path = &path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if path.metadata().is_ok_and(|data| !data.is_file()) {
            let file = File::options().write(true).open(path).map_err(failed)?;
            return content(&mut BufWriter::new(file));
        }
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // The default of temporary files, 0600, would stay on the finished file.
            builder.permissions(std::fs::Permissions::from_mode(0o644));
        }
        let mut file = builder
            .prefix(".wavecmp-")
            .tempfile_in(folder_of(path))
            .map_err(failed)?;
        content(&mut file)?;
        file.persist(path).map_err(|cause| failed(cause.error))?;
        Ok(())
    }
}

impl CommandHost for OwnFiles {
    fn reads(&mut self, what: &'static str, path: &Path) {
        self.inputs.push((what, path.to_owned()));
    }

    fn claim(&mut self, option: &str, path: &Path) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let (option, owned) = (option.to_owned(), path.to_owned());
        if self.claimed.iter().any(|other| same(other, path)) {
            return Err(Box::new(Refused::Twice { option, path: owned }));
        }
        if !is_standard_output(path) {
            match path.metadata() {
                Ok(data) if data.is_dir() => return Err(Box::new(Refused::Folder { option, path: owned })),
                Ok(data) => {
                    if let Some((input, _)) = self.inputs.iter().find(|(_, input)| same(input, path)) {
                        return Err(Box::new(Refused::Input {
                            option,
                            path: owned,
                            input,
                        }));
                    }
                    if data.is_file() && !self.force && !is_ours(path).unwrap_or(false) {
                        return Err(Box::new(Refused::Foreign { option, path: owned }));
                    }
                }
                Err(_) if !folder_of(path).is_dir() => {
                    return Err(Box::new(Refused::NoFolder { option, path: owned }));
                }
                Err(_) => {}
            }
        }
        self.claimed.push(owned);
        Ok(())
    }

    fn writes_standard_output(&self) -> bool {
        self.claimed.iter().any(|path| is_standard_output(path))
    }

    fn print(&self, text: &str) -> io::Result<()> {
        let mut out = io::stdout().lock();
        out.write_all(text.as_bytes()).and_then(|()| out.flush())
    }

    fn say(&self, line: &str) {
        // A message that cannot be shown must not stop the work.
        let _ = writeln!(io::stderr(), "{line}");
    }
}
