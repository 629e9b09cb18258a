//! Why a step did not end well.

use miette::Diagnostic;
use std::fmt;
use std::path::Path;

/// Why a step stopped. The kind of failure determines the exit status of a command.
#[derive(Debug)]
pub enum Failure {
    /// A check failed: exit status 1. This is the closing line; the result has the details.
    Check(String),
    /// Bad usage or input: exit status 2.
    Input(miette::Report),
    /// A required tool is missing: exit status 3.
    MissingTool(miette::Report),
}

impl Failure {
    /// Bad input, described by any error.
    pub fn input(error: impl Diagnostic + Send + Sync + 'static) -> Self {
        Self::Input(miette::Report::new(error))
    }

    /// Bad input, described by a library's error without diagnostics.
    pub fn because(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::Input(miette::Report::from_err(error))
    }

    /// An error of the system while `doing` something with a file or folder. The error itself does not name the file.
    pub fn of_file(path: &Path, doing: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.display().to_string();
        move |error| {
            let error = error.to_string();
            if error.contains(&path) {
                Self::from(miette::miette!("{error}"))
            } else {
                Self::from(miette::miette!("{path}: cannot {doing}: {error}"))
            }
        }
    }

    /// Puts the name of the file before the message of the failure.
    #[must_use]
    pub fn in_file(self, path: &Path) -> Self {
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
    #[must_use]
    pub fn or_help(self, help: &str) -> Self {
        match self {
            Self::Input(report) if report.help().is_none() => {
                Self::Input(miette::miette!(help = help, "{}", with_causes(&report)))
            }
            other => other,
        }
    }

    /// The failure with another line of help.
    #[must_use]
    pub fn with_help(self, line: &str) -> Self {
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
    pub fn missing_tool(message: impl fmt::Display) -> Self {
        Self::MissingTool(miette::miette!("{message}"))
    }
}

/// Returns a message with those of its causes.
#[must_use]
pub fn with_causes(report: &miette::Report) -> String {
    let mut message = report.to_string();
    for cause in report.chain().skip(1) {
        let cause = cause.to_string();
        // Some error texts already contain their causes, which must not be repeated.
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
