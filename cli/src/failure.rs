//! Why a command did not end with exit status 0, and how the reason is printed.

use crate::style;
use miette::Diagnostic;
use std::fmt;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

/// Why a command stopped; the kind determines its exit status.
pub(crate) enum Failure {
    /// A check failed: exit status 1. The command has printed which one; this is the closing line.
    Check(String),
    /// Bad usage or input: exit status 2.
    Input(miette::Report),
    /// A tool that was asked for is missing: exit status 3.
    MissingTool(miette::Report),
}

impl Failure {
    /// Bad input, described by any error.
    pub(crate) fn input(error: impl Diagnostic + Send + Sync + 'static) -> Self {
        Self::Input(miette::Report::new(error))
    }

    /// Bad input, described by a library's error without diagnostics.
    pub(crate) fn because(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::Input(miette::Report::from_err(error))
    }

    /// An error of the system while `doing` something with a file or folder, which the error itself does not name.
    pub(crate) fn of_file(path: &Path, doing: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.display().to_string();
        move |error| {
            let error = error.to_string();
            match error.contains(&path) {
                true => Self::from(miette::miette!("{error}")),
                false => Self::from(miette::miette!("{path}: cannot {doing}: {error}")),
            }
        }
    }

    /// The failure with its message prefixed by the file that it is about.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        match self {
            Self::Input(report) => {
                let help = report.help().map(|help| help.to_string());
                let message = format!("{}: {}", path.display(), with_causes(&report));
                Self::Input(match help {
                    Some(help) => miette::miette!(help = help, "{message}"),
                    None => miette::miette!("{message}"),
                })
            }
            other => other,
        }
    }

    /// The failure with a help text, if it has none.
    pub(crate) fn or_help(self, help: &str) -> Self {
        match self {
            Self::Input(report) if report.help().is_none() => {
                Self::Input(miette::miette!(help = help, "{}", with_causes(&report)))
            }
            other => other,
        }
    }

    /// The failure with another line of help.
    pub(crate) fn with_help(self, line: &str) -> Self {
        let add = |report: miette::Report| {
            let help = report.help().map_or_else(String::new, |help| format!("{help}\n"));
            miette::miette!(help = help + line, "{}", with_causes(&report))
        };
        match self {
            Self::Input(report) => Self::Input(add(report)),
            Self::MissingTool(report) => Self::MissingTool(add(report)),
            check @ Self::Check(_) => check,
        }
    }

    /// A missing tool.
    pub(crate) fn missing_tool(message: impl fmt::Display) -> Self {
        Self::MissingTool(miette::miette!("{message}"))
    }

    /// Prints on standard error why the command stopped: with an excerpt of the place on a terminal, in plain lines
    /// in a pipe, so that a log can be searched for them.
    pub(crate) fn report(self) -> ExitCode {
        let mut err = std::io::stderr().lock();
        // If standard error cannot be written, nothing sensible is left to do.
        let _ = match &self {
            Self::Check(line) => writeln!(anstream::stderr(), "posicast: {}", style::bad(line)),
            Self::Input(report) | Self::MissingTool(report) if err.is_terminal() => writeln!(err, "{report:?}"),
            Self::Input(report) | Self::MissingTool(report) => write_plain(&mut anstream::stderr(), report),
        };
        ExitCode::from(match self {
            Self::Check(_) => 1,
            Self::Input(_) => 2,
            Self::MissingTool(_) => 3,
        })
    }
}

/// Begins a line that says what is wrong.
const ERROR: &str = "error:";

fn write_plain(err: &mut impl Write, report: &miette::Report) -> std::io::Result<()> {
    writeln!(err, "{} {}", style::message(ERROR), with_causes(report))?;
    write_help(err, report.help())?;
    for related in report.related().into_iter().flatten() {
        writeln!(err, "{} {related}", style::message(ERROR))?;
        write_help(err, related.help())?;
    }
    Ok(())
}

/// Writes each line of a help text as a line of its own that a log can be searched for.
fn write_help(err: &mut impl Write, help: Option<Box<dyn fmt::Display + '_>>) -> std::io::Result<()> {
    let help = help.map_or_else(String::new, |help| help.to_string());
    help.lines().try_for_each(|line| writeln!(err, "help: {line}"))
}

/// A message with those of its causes.
fn with_causes(report: &miette::Report) -> String {
    let mut message = report.to_string();
    for cause in report.chain().skip(1) {
        let cause = cause.to_string();
        // An error whose text contains its cause already must not repeat it.
        if !message.contains(&cause) {
            message.push_str(": ");
            message.push_str(&cause);
        }
    }
    message
}

impl From<miette::Report> for Failure {
    fn from(report: miette::Report) -> Self {
        Self::Input(report)
    }
}
