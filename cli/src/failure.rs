//! Why a command did not end with exit status 0, and how that is said.

use crate::style;
use miette::Diagnostic;
use std::fmt;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

/// What stopped a command; its kind is its exit status.
pub(crate) enum Failure {
    /// A check failed: exit status 1. The command has printed which; this is the closing line.
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

    /// Bad input, described by a library's error that carries no diagnostics of its own.
    pub(crate) fn because(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::Input(miette::Report::from_err(error))
    }

    /// The same failure, its message led by the file that it is about.
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

    /// A missing tool.
    pub(crate) fn missing_tool(message: impl fmt::Display) -> Self {
        Self::MissingTool(miette::miette!("{message}"))
    }

    /// Says on standard error what stopped the command: with a picture of the place on a terminal, in plain lines in a
    /// pipe, so that a log can be searched for them.
    pub(crate) fn report(self) -> ExitCode {
        let mut err = std::io::stderr().lock();
        // Nothing sensible is left to do where standard error cannot be written.
        let _ = match &self {
            Self::Check(line) => writeln!(anstream::stderr(), "posicast: {}", style::bad(line)),
            Self::Input(report) | Self::MissingTool(report) if err.is_terminal() => writeln!(err, "{report:?}"),
            Self::Input(report) | Self::MissingTool(report) => write_plain(&mut err, report),
        };
        ExitCode::from(match self {
            Self::Check(_) => 1,
            Self::Input(_) => 2,
            Self::MissingTool(_) => 3,
        })
    }
}

fn write_plain(err: &mut impl Write, report: &miette::Report) -> std::io::Result<()> {
    writeln!(err, "error: {}", with_causes(report))?;
    write_help(err, report.help())?;
    for related in report.related().into_iter().flatten() {
        writeln!(err, "error: {related}")?;
        write_help(err, related.help())?;
    }
    Ok(())
}

/// Each line of a help as one of its own that a log can be searched for.
fn write_help(err: &mut impl Write, help: Option<Box<dyn fmt::Display + '_>>) -> std::io::Result<()> {
    let help = help.map_or_else(String::new, |help| help.to_string());
    help.lines().try_for_each(|line| writeln!(err, "help: {line}"))
}

/// A message with those of its causes.
fn with_causes(report: &miette::Report) -> String {
    let mut message = report.to_string();
    for cause in report.chain().skip(1) {
        let cause = cause.to_string();
        // An error that already tells its cause in its own text must not tell it twice.
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
