//! Runs external programs: missing and failed are different errors, and a failure keeps the end of the output.

use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use posicast_system::{process, scratch};

use crate::Error;

/// Lines of a failed program's output that an error keeps: the cause is at the end, after the noise.
const TAIL_LINES: usize = 20;

/// An external program: how it is called, what for, and how to get it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tool {
    pub(crate) name: &'static str,
    /// Environment variable that names another executable.
    pub(crate) variable: &'static str,
    pub(crate) purpose: &'static str,
    pub(crate) remedy: &'static str,
}

impl Tool {
    /// The executable: that of the environment variable, else the plain name.
    pub(crate) fn program(&self) -> String {
        match std::env::var(self.variable) {
            Ok(program) if !program.is_empty() => program,
            _ => self.name.to_owned(),
        }
    }

    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(self.program());
        command.stdin(Stdio::null());
        command
    }

    /// The same, in `folder`, where it also keeps its own temporary files: they go with the folder even if it is killed.
    pub(crate) fn command_in(&self, folder: &Path) -> Command {
        let mut command = self.command();
        let temporary = std::path::absolute(folder);
        command.current_dir(folder);
        command.env("TMPDIR", temporary.as_deref().unwrap_or(folder));
        command
    }

    /// Runs to the end and returns the output of a success.
    pub(crate) fn run(&self, command: &mut Command, doing: &'static str) -> Result<Output, Error> {
        let output = self.output(command, doing)?;
        if output.status.success() {
            return Ok(output);
        }
        Err(self.failed(doing, output.status.to_string(), &text(&output)))
    }

    /// Runs to the end, whatever the exit status.
    pub(crate) fn output(&self, command: &mut Command, doing: &'static str) -> Result<Output, Error> {
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let output = process::start(command).and_then(process::Running::output);
        output.map_err(|cause| self.not_started(doing, &cause))
    }

    /// What a success printed on standard output; none if it did not end within `limit`, and was stopped.
    pub(crate) fn run_within(
        &self,
        command: &mut Command,
        doing: &'static str,
        limit: Duration,
    ) -> Result<Option<String>, Error> {
        let failed = |cause: std::io::Error| self.not_started(doing, &cause);
        // A file, not a pipe: nobody has to read while it runs.
        let mut log = scratch::unnamed().map_err(failed)?;
        command.stdout(log.try_clone().map_err(failed)?).stderr(Stdio::null());
        let ended = process::start(command).and_then(|running| running.wait_within(limit));
        let Some(status) = ended.map_err(failed)? else {
            return Ok(None);
        };
        let mut printed = String::new();
        log.seek(SeekFrom::Start(0))
            .and_then(|_| log.read_to_string(&mut printed))
            .map_err(failed)?;
        if status.success() {
            return Ok(Some(printed));
        }
        Err(self.failed(doing, status.to_string(), &printed))
    }

    pub(crate) fn not_started(&self, doing: &'static str, cause: &std::io::Error) -> Error {
        if cause.kind() == ErrorKind::NotFound {
            return Error::ToolMissing {
                tool: self.program(),
                purpose: self.purpose,
                remedy: self.remedy,
            };
        }
        self.failed(doing, "not started".to_owned(), &cause.to_string())
    }

    pub(crate) fn failed(&self, doing: &'static str, status: String, output: &str) -> Error {
        Error::ToolFailed {
            tool: self.program(),
            doing,
            status,
            output: tail(output),
        }
    }
}

/// Standard output and standard error as one text.
pub(crate) fn text(output: &Output) -> String {
    let mut text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.push_str(&String::from_utf8_lossy(&output.stderr));
    text
}

fn tail(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let from = lines.len().saturating_sub(TAIL_LINES);
    let mut tail = lines[from..].join("\n");
    if from > 0 {
        tail.insert_str(0, &format!("… {from} lines before\n"));
    }
    tail
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOTHING: Tool = Tool {
        name: "posicast-no-such-program",
        variable: "POSICAST_NO_SUCH_VARIABLE",
        purpose: "a test",
        remedy: "Nothing helps",
    };

    #[test]
    fn unit_a_missing_program_is_told_from_a_failing_one() {
        let missing = NOTHING.run(&mut NOTHING.command(), "testing").unwrap_err();
        assert!(missing.is_missing_tool(), "{missing}");
        assert!(missing.to_string().contains("Nothing helps"));
        let failing = NOTHING
            .run(Command::new("sh").args(["-c", "echo why; exit 3"]), "testing")
            .unwrap_err();
        assert!(!failing.is_missing_tool());
        assert!(failing.to_string().contains("why"), "{failing}");
    }

    #[test]
    fn unit_a_program_without_end_is_stopped() {
        let run =
            |words: &[&str], limit| NOTHING.run_within(Command::new("sh").arg("-c").args(words), "testing", limit);
        let soon = Duration::from_millis(50);
        assert_eq!(run(&["sleep 60"], soon).unwrap(), None);
        let long = Duration::from_secs(60);
        assert_eq!(run(&["echo said"], long).unwrap().as_deref(), Some("said\n"));
        assert!(
            run(&["echo why; exit 3"], long)
                .unwrap_err()
                .to_string()
                .contains("why")
        );
    }

    #[test]
    fn unit_only_the_end_of_a_long_output_is_kept() {
        let long: String = (0..100).map(|n| format!("line {n}\n")).collect();
        let kept = tail(&long);
        assert!(
            kept.starts_with("… 80 lines before\nline 80\n") && kept.ends_with("line 99"),
            "{kept}"
        );
    }
}
