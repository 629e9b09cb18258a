//! The errors of a machine file: each problem with its place, what was found, what is allowed and the remedy.
//!
//! The plain text of a [`SpecError`] is complete without colours or graphics, one line per problem:
//!
//! ```text
//! stage.toml:23: axis.mode.damping of axis x, mode 1: found 1.2; allowed: at least 0, below 1
//! ```
//!
//! A front may add the source ([`SpecError::text`]) with a mark at the span of each problem, and the remedies
//! ([`SpecError::help`]). It should not wrap lines: the plain text is meant to be searched.

use std::fmt;
use std::ops::Range;

/// Largest number of problems that one error lists; a longer list would not help to mend the file.
pub const MAX_PROBLEMS: usize = 20;

/// Why a machine file was refused: at least one [`Problem`], in the order of the file.
#[derive(Debug, thiserror::Error)]
#[error("{}", Listing(self))]
pub struct SpecError {
    file_name: String,
    text: String,
    problems: Vec<Problem>,
    unlisted: usize,
}

/// One thing that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Line in the file, from 1. For a missing key it is the line of its table's header.
    pub line: usize,
    /// Bytes of the file that the problem is about.
    pub span: Range<usize>,
    /// Dotted key, such as `axis.mode.damping`; empty where the problem is the file as a whole.
    pub key: String,
    /// The table among several of its kind, such as `axis x, mode 2`; empty where there is only one.
    pub place: String,
    /// The problem: the value that was found, and the allowed ones.
    pub cause: ProblemCause,
    /// Remedy.
    pub remedy: String,
}

/// Kinds of problems, with the value that was found and the allowed ones.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ProblemCause {
    /// The text is not valid TOML.
    #[error("found a TOML syntax error: {0}; allowed: TOML as of https://toml.io")]
    Syntax(String),
    /// The file holds no key at all.
    #[error("found an empty file; allowed: a machine with {allowed}")]
    Empty {
        /// The keys that every machine file has.
        allowed: String,
    },
    /// A key that no table of this kind has.
    #[error("found the unknown key {found}; allowed: {allowed}")]
    UnknownKey {
        /// The key as it stands in the file.
        found: String,
        /// The keys of this table.
        allowed: String,
    },
    /// A key that must be there.
    #[error("found no such key; allowed: {allowed}")]
    MissingKey {
        /// The values it may take.
        allowed: String,
    },
    /// A value of another type.
    #[error("found the {found_type} {found}; allowed: {allowed}")]
    WrongType {
        /// Type of the value in the file.
        found_type: &'static str,
        /// The value as it stands in the file.
        found: String,
        /// The type or range expected.
        allowed: String,
    },
    /// A number outside its range.
    #[error("found {found}; allowed: {allowed}")]
    OutOfRange {
        /// The value as it stands in the file.
        found: String,
        /// The range.
        allowed: String,
    },
    /// A word that is not in the list.
    #[error("found {found}; allowed: {allowed}")]
    NotAChoice {
        /// The value as it stands in the file.
        found: String,
        /// The list.
        allowed: String,
    },
    /// A name that must be unique but is used twice.
    #[error("found {found}, which line {first_line} already has; allowed: {allowed}")]
    Duplicate {
        /// The value as it stands in the file.
        found: String,
        /// Line of the first use.
        first_line: usize,
        /// The rule.
        allowed: String,
    },
    /// Keys that are valid alone but contradict each other.
    #[error("found {found}; allowed: {allowed}")]
    Inconsistent {
        /// The combination.
        found: String,
        /// The combinations that are right.
        allowed: String,
    },
}

impl ProblemCause {
    /// The cause in two or three words, for the mark in a listing of the source.
    #[must_use]
    pub fn label(&self) -> &'static str {
        match self {
            ProblemCause::Syntax(_) => "no TOML",
            ProblemCause::Empty { .. } => "empty",
            ProblemCause::UnknownKey { .. } => "unknown key",
            ProblemCause::MissingKey { .. } => "key missing here",
            ProblemCause::WrongType { .. } => "wrong type",
            ProblemCause::OutOfRange { .. } => "out of range",
            ProblemCause::NotAChoice { .. } => "not in the list",
            ProblemCause::Duplicate { .. } => "not unique",
            ProblemCause::Inconsistent { .. } => "contradiction",
        }
    }
}

impl SpecError {
    /// Makes the error of problems in any order. `unlisted` further problems were found and not kept.
    pub(super) fn new(file_name: &str, text: &str, mut problems: Vec<Problem>, unlisted: usize) -> Self {
        problems.sort_by_key(|p| p.span.start);
        Self {
            file_name: file_name.to_owned(),
            text: text.to_owned(),
            problems,
            unlisted,
        }
    }

    /// The problems, in the order of the file.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// Name of the file.
    #[must_use]
    pub fn file_name(&self) -> &str {
        &self.file_name
    }

    /// Text of the file.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The remedies, one a line; where there are several, each begins with its line numbers.
    #[must_use]
    pub fn help(&self) -> String {
        let mut remedies: Vec<(&str, Vec<String>)> = Vec::new();
        for problem in &self.problems {
            let line = problem.line.to_string();
            match remedies.iter_mut().find(|(remedy, _)| *remedy == problem.remedy) {
                Some((_, lines)) if lines.contains(&line) => {}
                Some((_, lines)) => lines.push(line),
                None => remedies.push((&problem.remedy, vec![line])),
            }
        }
        let with_lines = |(remedy, lines): &(&str, Vec<String>)| match lines.as_slice() {
            [line] => format!("line {line}: {remedy}"),
            lines => format!("lines {}: {remedy}", lines.join(", ")),
        };
        match remedies.as_slice() {
            [(remedy, _)] => (*remedy).to_owned(),
            several => several.iter().map(with_lines).collect::<Vec<_>>().join("\n"),
        }
    }
}

/// Writes the lines of an error's plain text.
struct Listing<'e>(&'e SpecError);

impl fmt::Display for Listing<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = &self.0.file_name;
        for (index, problem) in self.0.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            write!(f, "{file}:{}: {problem}", problem.line)?;
        }
        match self.0.unlisted {
            0 => Ok(()),
            n => write!(f, "\n{file}: and {n} more"),
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.key)?;
        if !self.place.is_empty() {
            write!(f, " of {}", self.place)?;
        }
        if !self.key.is_empty() {
            f.write_str(": ")?;
        }
        write!(f, "{}", self.cause)
    }
}
