//! The names to which a command may write. They are claimed before the work begins, so that nothing is computed in
//! vain.

use std::fs::Metadata;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::seal::is_ours;
use super::target::Target;

/// Ending of a machine file, which is somebody's work even where posicast wrote it.
const MACHINE_FILE: &str = "toml";

/// Why a command does not write to a name. With every variant, existing files stay untouched.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The name is that of a file that the command reads.
    #[error("{option} {}: that is {input}, and an input is never replaced: name another file", .path.display())]
    Input {
        /// The option that gave the name.
        option: String,
        /// The name.
        path: PathBuf,
        /// Description of the input.
        input: &'static str,
    },
    /// There is a file that posicast did not write, or that was changed since.
    #[error(
        "{option} {}: there is a file that posicast did not write, or that was changed since: name another file, or replace it \
         with --force", .path.display()
    )]
    Foreign {
        /// The option that gave the name.
        option: String,
        /// The name.
        path: PathBuf,
    },
    /// There is a machine file, and something else would be written.
    #[error("{option} {}: there is a machine file: name another file, or replace it with --force", .path.display())]
    MachineFile {
        /// The option that gave the name.
        option: String,
        /// The name.
        path: PathBuf,
    },
    /// The same command writes something else to this name.
    #[error("{option} {}: {other} of the same command is written there: name another file", .path.display())]
    Twice {
        /// The option that gave the name.
        option: String,
        /// The name.
        path: PathBuf,
        /// The option that claimed the name first.
        other: String,
    },
    /// There is a folder with this name.
    #[error("{option} {}: that is a folder: name a file", .path.display())]
    Folder {
        /// The option that gave the name.
        option: String,
        /// The name.
        path: PathBuf,
    },
    /// The folder of the file does not exist.
    #[error("{option} {}: the folder {} does not exist: create it, or name a file elsewhere", .path.display(), .folder.display())]
    NoFolder {
        /// The option that gave the name.
        option: String,
        /// The name.
        path: PathBuf,
        /// The missing folder.
        folder: PathBuf,
    },
    /// The operating system reported an error.
    #[error("{option} {}: cannot write there: {source}: name another file", .path.display())]
    Io {
        /// The option that gave the name.
        option: String,
        /// The name.
        path: PathBuf,
        /// The error.
        source: io::Error,
    },
}

/// What is written to a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Content {
    MachineFile,
    Other,
}

/// The files that a command reads and writes.
#[derive(Debug, Clone, Default)]
pub struct OutputFiles {
    force: bool,
    inputs: Vec<(&'static str, PathBuf)>,
    claimed: Vec<(String, Target)>,
}

impl OutputFiles {
    /// Starts without files. With `force`, files that posicast did not write are replaced, but never inputs.
    pub fn new(force: bool) -> Self {
        Self {
            force,
            ..Self::default()
        }
    }

    /// Adds a file that the command reads; `what` describes it for messages.
    pub fn input(&mut self, what: &'static str, path: &Path) {
        self.inputs.push((what, path.to_owned()));
    }

    /// Claims a name to write to, for something else than a machine file. `option` is the option that gave it, for messages.
    ///
    /// # Errors
    /// [`OutputError`] says why the name cannot be used.
    pub fn claim(&mut self, option: &str, path: &Path) -> Result<(), OutputError> {
        self.claim_for(Content::Other, option, path)
    }

    /// Claims a name for a machine file.
    ///
    /// # Errors
    /// [`OutputError`] says why the name cannot be used.
    pub fn claim_machine_file(&mut self, option: &str, path: &Path) -> Result<(), OutputError> {
        self.claim_for(Content::MachineFile, option, path)
    }

    fn claim_for(&mut self, content: Content, option: &str, path: &Path) -> Result<(), OutputError> {
        let (option, owned) = (option.to_owned(), path.to_owned());
        let target = match Target::of(path) {
            Ok(target) => target,
            Err(error) if error.kind() == ErrorKind::IsADirectory => {
                return Err(OutputError::Folder { option, path: owned });
            }
            Err(source) => {
                return Err(OutputError::Io {
                    option,
                    path: owned,
                    source,
                });
            }
        };
        let other = |(_, claimed): &&(String, Target)| *claimed == target || same_target(claimed, &target);
        if let Some((other, _)) = self.claimed.iter().find(other) {
            return Err(OutputError::Twice {
                option,
                path: owned,
                other: other.clone(),
            });
        }
        match &target {
            Target::Existing(file) => {
                if let Some((input, _)) = self.inputs.iter().find(|(_, input)| same(input, file)) {
                    return Err(OutputError::Input {
                        option,
                        path: owned,
                        input,
                    });
                }
                let ours = self.force || is_ours(file).unwrap_or(false);
                if !ours {
                    return Err(OutputError::Foreign { option, path: owned });
                }
                let is_machine_file = file.extension().is_some_and(|ending| ending == MACHINE_FILE);
                if is_machine_file && content == Content::Other && !self.force {
                    return Err(OutputError::MachineFile { option, path: owned });
                }
            }
            Target::New(file) => {
                let folder = folder_of(file);
                if !folder.is_dir() {
                    return Err(OutputError::NoFolder {
                        option,
                        path: owned,
                        folder: folder.to_owned(),
                    });
                }
            }
            Target::Stdout | Target::Stream(_) => {}
        }
        self.claimed.push((option, target));
        Ok(())
    }

    /// Whether one of the names is the standard output.
    pub fn take_standard_output(&self) -> bool {
        self.claimed.iter().any(|(_, target)| *target == Target::Stdout)
    }
}

fn folder_of(file: &Path) -> &Path {
    file.parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// Whether two names, which need not exist, lead to the same file.
fn same_target(a: &Target, b: &Target) -> bool {
    match (a, b) {
        (Target::Existing(a), Target::Existing(b)) => same(a, b),
        (Target::New(a), Target::New(b)) => a.file_name() == b.file_name() && same(folder_of(a), folder_of(b)),
        _ => false,
    }
}

/// Whether two names lead to the same file or folder, also through links and hard links. Nothing is opened, because
/// one may be a pipe.
fn same(a: &Path, b: &Path) -> bool {
    match (a.metadata(), b.metadata()) {
        (Ok(of_a), Ok(of_b)) => {
            same_file(&of_a, &of_b) || a.canonicalize().ok().is_some_and(|a| b.canonicalize().ok() == Some(a))
        }
        _ => false,
    }
}

#[cfg(unix)]
fn same_file(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

#[cfg(not(unix))]
fn same_file(_: &Metadata, _: &Metadata) -> bool {
    false
}
