//! Runs external programs. A missing and a failed program are different errors, and a failure keeps the end of the
//! output.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use posicast_system::process;
use posicast_system::tool::{self, Ended};

use crate::Error;

/// Number of last lines of a failed program's output that an error keeps, where the cause is found.
const LAST_LINES: usize = 20;

/// An external program: its name, its purpose, and how to install it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tool {
    pub(crate) name: &'static str,
    /// Environment variable that names another executable.
    pub(crate) variable: &'static str,
    pub(crate) purpose: &'static str,
    pub(crate) remedy: &'static str,
}

impl Tool {
    /// Path of the executable: that of the environment variable, else the plain name.
    pub(crate) fn program(&self) -> PathBuf {
        let found = tool::executables(self.variable, &[self.name]).into_iter().next();
        found.unwrap_or_else(|| self.name.into())
    }

    pub(crate) fn command(&self) -> Command {
        tool::command(self.program())
    }

    /// A command in `folder`: see [`tool::command_in`].
    pub(crate) fn command_in(&self, folder: &Path) -> Command {
        tool::command_in(self.program(), folder)
    }

    /// Runs the command to its end, and returns the output of a success.
    pub(crate) fn run(&self, command: &mut Command, doing: &'static str) -> Result<Output, Error> {
        let output = self.output(command, doing)?;
        if output.status.success() {
            return Ok(output);
        }
        Err(self.failed(doing, output.status.to_string(), &text(&output)))
    }

    /// Runs the command to its end, whatever its exit status is.
    pub(crate) fn output(&self, command: &mut Command, doing: &'static str) -> Result<Output, Error> {
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let output = process::start(command).and_then(process::Running::output);
        output.map_err(|cause| self.not_started(doing, &cause))
    }

    /// Output of a success; `None` if the command did not end within `limit` and was stopped.
    pub(crate) fn run_within(
        &self,
        command: &mut Command,
        doing: &'static str,
        limit: Duration,
    ) -> Result<Option<String>, Error> {
        match tool::run_within(command, limit).map_err(|cause| self.not_started(doing, &cause))? {
            Ended::Well(printed) => Ok(Some(printed)),
            Ended::Badly { status, printed } => Err(self.failed(doing, status.to_string(), &printed)),
            Ended::TimeOut => Ok(None),
        }
    }

    pub(crate) fn not_started(&self, doing: &'static str, cause: &std::io::Error) -> Error {
        if cause.kind() == ErrorKind::NotFound {
            return Error::ToolMissing {
                tool: self.program().display().to_string(),
                purpose: self.purpose,
                remedy: self.remedy,
            };
        }
        self.failed(doing, "not started".to_owned(), &cause.to_string())
    }

    pub(crate) fn failed(&self, doing: &'static str, status: String, output: &str) -> Error {
        Error::ToolFailed {
            tool: self.program().display().to_string(),
            doing,
            status,
            output: tool::last_lines(output, LAST_LINES),
        }
    }
}

/// Standard output and standard error in one text.
pub(crate) fn text(output: &Output) -> String {
    let mut text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.push_str(&String::from_utf8_lossy(&output.stderr));
    text
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
}
