//! Runs external programs. A missing and a failed program are different errors, and a failure keeps the end of the
//! output.

use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Duration;

use posicast_system::tool::{self, Ended};
use posicast_system::{process, scratch};

use crate::Error;
use crate::error::MissingTool;

/// Environment variable with the time limit of a program, in seconds.
pub(crate) const LIMIT_VARIABLE: &str = "POSICAST_TOOL_LIMIT_S";
/// Time limit of a program that translates or compiles.
const WORK_LIMIT: Duration = Duration::from_secs(3600);
/// Time limit of a short answer: a version, or a clock of a simulation.
const ANSWER_LIMIT: Duration = Duration::from_secs(120);

/// Returns the time limit that the user set, otherwise `limit`.
fn limit_or(limit: Duration) -> Duration {
    let set = std::env::var(LIMIT_VARIABLE).ok().and_then(|text| text.parse().ok());
    set.filter(|seconds: &f64| *seconds > 0.0)
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .unwrap_or(limit)
}

/// Time limit of an answer of a simulator.
pub(crate) fn answer_limit() -> Duration {
    limit_or(ANSWER_LIMIT)
}

/// A program with a limit of processor time may take this many times as long on the clock, where others run beside it.
pub const WAITED: u32 = 8;
/// Signal of Linux to a process that has used its processor time.
const SIGXCPU: i32 = 24;

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

    /// This tool, if it is not installed.
    pub(crate) fn missing(&self) -> Option<MissingTool> {
        tool::located(&self.program()).is_none().then(|| self.as_missing())
    }

    fn as_missing(&self) -> MissingTool {
        MissingTool {
            tool: self.program().display().to_string(),
            purpose: self.purpose,
            remedy: self.remedy,
        }
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
        self.success(output, doing)
    }

    /// Runs the command to its end, or stops it at its time limit. Any exit status is a success.
    pub(crate) fn output(&self, command: &mut Command, doing: &'static str) -> Result<Output, Error> {
        self.output_within(command, doing, limit_or(WORK_LIMIT))
    }

    /// Runs a command that takes seconds, such as one for a version, and returns its output. A failure is an error.
    pub(crate) fn answer(&self, command: &mut Command, doing: &'static str) -> Result<Output, Error> {
        let output = self.output_within(command, doing, answer_limit())?;
        self.success(output, doing)
    }

    fn success(&self, output: Output, doing: &'static str) -> Result<Output, Error> {
        if output.status.success() {
            Ok(output)
        } else {
            Err(self.failed(doing, output.status.to_string(), &text(&output)))
        }
    }

    fn output_within(&self, command: &mut Command, doing: &'static str, limit: Duration) -> Result<Output, Error> {
        match outcome(command, limit).map_err(|cause| self.not_started(doing, &cause))? {
            Some(output) => Ok(output),
            None => Err(Error::TimeOut {
                tool: self.program().display().to_string(),
                doing,
                limit,
            }),
        }
    }

    /// Runs the program in `folder` and returns its output. `None` if it used up `limit`, or waited too long for a
    /// processor ([`WAITED`]); a failure is an error.
    ///
    /// The limit is one of processor time, so that a verdict does not depend on what else the machine does.
    pub(crate) fn run_within(
        &self,
        folder: &Path,
        arguments: &[&str],
        doing: &'static str,
        limit: Duration,
    ) -> Result<Option<String>, Error> {
        if let Some(missing) = self.missing() {
            return Err(Error::ToolMissing(vec![missing]));
        }
        let mut command = tool::command_in("sh", folder);
        command.args(["-c", r#"ulimit -S -t "$0" && exec "$@""#]);
        command
            .arg(limit.as_secs().max(1).to_string())
            .arg(self.program())
            .args(arguments);
        let ended = tool::run_within(&mut command, limit.saturating_mul(WAITED));
        match ended.map_err(|cause| self.not_started(doing, &cause))? {
            Ended::Well(printed) => Ok(Some(printed)),
            Ended::TimeOut => Ok(None),
            Ended::Badly { status, .. } if status.signal() == Some(SIGXCPU) => Ok(None),
            Ended::Badly { status, printed } => Err(self.failed(doing, status.to_string(), &printed)),
        }
    }

    pub(crate) fn not_started(&self, doing: &'static str, cause: &std::io::Error) -> Error {
        if cause.kind() == ErrorKind::NotFound {
            return Error::ToolMissing(vec![self.as_missing()]);
        }
        self.failed(doing, "not started".to_owned(), &cause.to_string())
    }

    /// Returns the error of a program that failed. If its output reports a missing program, that is the error.
    pub(crate) fn failed(&self, doing: &'static str, status: String, output: &str) -> Error {
        if let Some(tool) = absent_program(output) {
            return Error::ToolMissing(vec![MissingTool {
                tool: tool.to_owned(),
                purpose: self.purpose,
                remedy: "Another tool calls it: install it, or correct PATH",
            }]);
        }
        Error::ToolFailed {
            tool: self.program().display().to_string(),
            doing,
            status,
            output: tool::last_lines(output, LAST_LINES),
        }
    }
}

/// Runs the command and returns its exit status and output; `None` if it was stopped at its time limit.
fn outcome(command: &mut Command, limit: Duration) -> std::io::Result<Option<Output>> {
    // The output goes to files, not pipes, so that nobody has to read while the program runs.
    let mut streams = [scratch::unnamed()?, scratch::unnamed()?];
    command.stdout(streams[0].try_clone()?).stderr(streams[1].try_clone()?);
    let Some(status) = process::start(command)?.wait_within(limit)? else {
        return Ok(None);
    };
    let mut read = |stream: usize| {
        let mut bytes = Vec::new();
        streams[stream].seek(SeekFrom::Start(0))?;
        streams[stream].read_to_end(&mut bytes)?;
        std::io::Result::Ok(bytes)
    };
    Ok(Some(Output {
        status,
        stdout: read(0)?,
        stderr: read(1)?,
    }))
}

/// Returns the name of the program that make, a shell or `env` reports as missing in this output.
fn absent_program(output: &str) -> Option<&str> {
    output.lines().find_map(absent_in_line)
}

fn absent_in_line(line: &str) -> Option<&str> {
    let line = line.trim();
    let who = ["make: ", "/bin/sh: ", "sh: ", "/usr/bin/env: "];
    let rest = who.iter().find_map(|who| line.strip_prefix(who))?;
    let says = [": No such file or directory", ": command not found", ": not found"];
    let name = says.iter().find_map(|end| rest.strip_suffix(end))?;
    // Shells name their line first: `sh: 1: g++: not found`.
    let name = name.rsplit(": ").next()?.trim_matches(['‘', '’', '\'', '`']);
    let is_program = !name.is_empty() && !name.contains(char::is_whitespace) && !name.ends_with(".mk");
    is_program.then_some(name)
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
    fn a_missing_program_is_distinguished_from_a_failing_one() {
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
    fn a_program_that_another_one_lacks_is_missing() {
        for said in [
            "make: g++: No such file or directory\nmake: *** [Vdevice.mk:60: a.o] Error 127",
            "/bin/sh: 1: g++: not found",
            "sh: line 1: g++: command not found",
            "/usr/bin/env: ‘g++’: No such file or directory",
        ] {
            assert_eq!(absent_program(said), Some("g++"), "{said}");
            assert!(NOTHING.failed("testing", String::new(), said).is_missing_tool());
        }
        for said in [
            "harness.cpp:1: fatal error: verilated.h: No such file or directory",
            "make: *** No rule to make target 'a'. Stop.",
            "simulation.mk:1: Vdevice.mk: No such file or directory",
            "make: Vdevice.mk: No such file or directory",
        ] {
            assert_eq!(absent_program(said), None, "{said}");
        }
    }

    #[test]
    fn only_the_time_that_a_program_computes_counts() {
        const SHELL: Tool = Tool { name: "sh", ..NOTHING };
        let run = |script| SHELL.run_within(Path::new("."), &["-c", script], "testing", Duration::from_secs(1));
        assert_eq!(run("while :; do :; done").unwrap(), None);
        assert_eq!(run("sleep 1.5; echo said").unwrap().as_deref(), Some("said\n"));
        assert!(run("echo why; exit 3").unwrap_err().to_string().contains("why"));
        let missing = NOTHING.run_within(Path::new("."), &[], "testing", Duration::from_secs(1));
        assert!(missing.unwrap_err().is_missing_tool());
    }
}
