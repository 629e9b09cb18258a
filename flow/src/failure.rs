//! Why a step did not end well.

use posicast_machine::machine_file::SpecError;
use std::fmt;
use std::ops::Range;
use std::path::Path;

/// Why a step stopped. The kind of failure determines the exit status of a command.
#[derive(Debug, Clone, thiserror::Error)]
pub enum Failure {
    /// A check failed: exit status 1. This is the closing line; the result has the details.
    #[error("{0}")]
    Check(String),
    /// Bad usage or input: exit status 2.
    #[error("{0}")]
    Input(Reason),
    /// A required tool is missing: exit status 3.
    #[error("{0}")]
    MissingTool(Reason),
}

/// What is wrong, and what to do about it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Reason {
    /// What was found, and what is allowed.
    pub message: String,
    /// Its causes, the deepest last. Some repeat a part of the message.
    pub causes: Vec<String>,
    /// The remedy, in one line or several.
    pub help: Option<String>,
    /// The places of a text that the message is about.
    pub excerpt: Option<Box<Excerpt>>,
}

/// Places of a text, to be shown in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Excerpt {
    /// Name of the file with the text.
    pub file: String,
    /// The whole text.
    pub text: String,
    /// Bytes of the text, and what is wrong there in two or three words.
    pub places: Vec<(Range<usize>, &'static str)>,
}

/// The message with its causes, in one line.
impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = self.message.clone();
        for cause in &self.causes {
            // Some error texts already contain their causes, which must not be repeated.
            if !line.contains(cause) {
                line.push_str(": ");
                line.push_str(cause);
            }
        }
        f.write_str(&line)
    }
}

impl Reason {
    /// A reason that its message describes.
    fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            ..Self::default()
        }
    }

    /// The same reason with another line of help; message and causes become one message.
    fn with_help(self, line: &str) -> Self {
        let help = self.help.as_ref().map_or_else(String::new, |help| format!("{help}\n"));
        Self {
            help: Some(help + line),
            ..Self::new(self.to_string())
        }
    }
}

impl Failure {
    /// Bad input, described by this message.
    pub fn input(message: impl Into<String>) -> Self {
        Self::Input(Reason::new(message))
    }

    /// Bad input, described by any error and its causes.
    pub fn because(error: impl std::error::Error) -> Self {
        let causes = std::iter::successors(error.source(), |cause| cause.source());
        Self::Input(Reason {
            causes: causes.map(ToString::to_string).collect(),
            ..Reason::new(error.to_string())
        })
    }

    /// An error of the system while `doing` something with a file or folder. The error itself does not name the file.
    pub fn of_file(path: &Path, doing: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.display().to_string();
        move |error| {
            let error = error.to_string();
            if error.contains(&path) {
                Self::input(error)
            } else {
                Self::input(format!("{path}: cannot {doing}: {error}"))
            }
        }
    }

    /// A missing tool.
    pub fn missing_tool(message: impl fmt::Display) -> Self {
        Self::MissingTool(Reason::new(message.to_string()))
    }

    /// Puts the name of the file before the message of bad input.
    #[must_use]
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            Self::Input(reason) => {
                let message = format!("{}: {reason}", path.display());
                Self::Input(Reason {
                    help: reason.help,
                    ..Reason::new(message)
                })
            }
            other => other,
        }
    }

    /// The failure with a help text, if it is bad input without one.
    #[must_use]
    pub fn or_help(self, help: &str) -> Self {
        match self {
            Self::Input(reason) if reason.help.is_none() => Self::Input(reason.with_help(help)),
            other => other,
        }
    }

    /// The failure with another line of help. A failed check has none.
    #[must_use]
    pub fn with_help(self, line: impl AsRef<str>) -> Self {
        match self {
            Self::Input(reason) => Self::Input(reason.with_help(line.as_ref())),
            Self::MissingTool(reason) => Self::MissingTool(reason.with_help(line.as_ref())),
            check @ Self::Check(_) => check,
        }
    }

    /// As [`with_help`](Self::with_help), if there is a line.
    #[must_use]
    pub fn with_any_help(self, line: Option<impl AsRef<str>>) -> Self {
        match line {
            Some(line) => self.with_help(line),
            None => self,
        }
    }
}

/// A machine file that was refused, with the places of its problems.
impl From<SpecError> for Failure {
    fn from(error: SpecError) -> Self {
        let places = error.problems().iter();
        Self::Input(Reason {
            help: Some(error.help()),
            excerpt: Some(Box::new(Excerpt {
                file: error.file_name().to_owned(),
                text: error.text().to_owned(),
                places: places
                    .map(|problem| (problem.span.clone(), problem.cause.label()))
                    .collect(),
            })),
            ..Reason::new(error.to_string())
        })
    }
}
