//! Failures of the steps as Python exceptions.

use posicast_flow::{Failure, Reason};
use pyo3::prelude::*;

/// Name of the machine file that describes a design without one: its places mean nothing to a user.
pub(crate) const NO_FILE: &str = "posicast.design";

/// A failure with its parts as data.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Parts {
    /// Class in `posicast._errors`.
    pub(crate) class: &'static str,
    /// What was found, and what is allowed.
    pub(crate) message: String,
    /// File that it is about.
    pub(crate) file: Option<String>,
    /// Line in that file, from 1.
    pub(crate) line: Option<usize>,
    /// Dotted key of the machine file.
    pub(crate) key: Option<String>,
    /// What to do.
    pub(crate) remedy: Option<String>,
}

impl Parts {
    /// The parts of a failure of a step that read this file.
    pub(crate) fn of(failure: &Failure, file: Option<&str>) -> Self {
        let (class, reason) = match failure {
            Failure::Check(line) => {
                return Self {
                    class: "CheckFailed",
                    message: line.clone(),
                    file: file.map(str::to_owned),
                    line: None,
                    key: None,
                    remedy: None,
                };
            }
            Failure::Input(reason) => ("InputError", reason),
            Failure::MissingTool(reason) => ("MissingTool", reason),
        };
        Self::placed(class, reason, file)
    }

    /// Takes file, line and key from the beginning of a message, such as `m.toml:13: clock.sample_hz: found -3`.
    fn placed(class: &'static str, reason: &Reason, file: Option<&str>) -> Self {
        let message = reason.to_string();
        let name = reason.excerpt.as_ref().map(|excerpt| excerpt.file.as_str()).or(file);
        let rest = name.and_then(|name| message.strip_prefix(name)?.strip_prefix(':'));
        let (line, rest) = match rest.and_then(|rest| rest.split_once(':')) {
            Some((line, after)) if line.parse::<usize>().is_ok() => (line.parse().ok(), Some(after)),
            _ => (None, rest),
        };
        let key = rest.and_then(|rest| {
            let word = rest.trim_start().split([':', ' ']).next()?;
            let is_key = |letter: char| letter.is_ascii_alphanumeric() || "._[]".contains(letter);
            (word.contains('.') && word.chars().all(is_key)).then(|| word.to_owned())
        });
        let (message, name) = match (name, rest) {
            (Some(NO_FILE), Some(_)) => (without_places(&message), None),
            (Some(NO_FILE), None) => (message, None),
            _ => (message, name),
        };
        Self {
            class,
            message,
            line: line.filter(|_| name.is_some()),
            file: name.map(str::to_owned),
            key,
            remedy: reason.help.clone(),
        }
    }
}

/// The lines of a message without the name and lines of the file that does not exist.
fn without_places(message: &str) -> String {
    let lines = message.lines().map(|line| {
        let rest = line.strip_prefix(NO_FILE).and_then(|rest| rest.strip_prefix(':'));
        let rest = rest.map_or(line, |rest| {
            let after_number = rest.trim_start_matches(|letter: char| letter.is_ascii_digit());
            after_number.strip_prefix(':').unwrap_or(after_number)
        });
        rest.trim_start().to_owned()
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// The exception of a failure of a step that read this file.
pub(crate) fn raised(py: Python<'_>, failure: &Failure, file: Option<&str>) -> PyErr {
    exception(py, Parts::of(failure, file))
}

/// The exception with these parts.
pub(crate) fn exception(py: Python<'_>, parts: Parts) -> PyErr {
    let made = || {
        let class = py.import("posicast._errors")?.getattr(parts.class)?;
        class.call1((parts.message, parts.file, parts.line, parts.key, parts.remedy))
    };
    match made() {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}

/// The exception for a value that a function cannot take, and the remedy.
pub(crate) fn refused(py: Python<'_>, message: impl ToString, remedy: &str) -> PyErr {
    let parts = Parts {
        class: "InputError",
        message: message.to_string(),
        file: None,
        line: None,
        key: None,
        remedy: Some(remedy.to_owned()),
    };
    exception(py, parts)
}
