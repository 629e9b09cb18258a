//! The text of a machine file and the problems found in it. Byte offsets become lines, and the problems become one
//! error.
//!
//! Reading continues after a problem, so that one run reports all that is wrong.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use super::error::{MAX_PROBLEMS, Problem, ProblemCause, SpecError};

/// Longest piece of the file that a message repeats, in characters.
const MAX_QUOTE: usize = 48;

/// The problems of one file, as they are found.
pub(super) struct Reader<'t> {
    file_name: &'t str,
    text: &'t str,
    beside: &'t dyn Fn(&str) -> Result<String, String>,
    line_ends: Vec<usize>,
    problems: Problems,
}

/// A list that keeps its first [`MAX_PROBLEMS`] entries and counts the others.
#[derive(Default)]
struct Problems {
    kept: RefCell<Vec<Problem>>,
    unlisted: Cell<usize>,
}

impl Problems {
    fn push(&self, problem: Problem) {
        let mut kept = self.kept.borrow_mut();
        if kept.len() < MAX_PROBLEMS {
            kept.push(problem);
        } else {
            self.unlisted.set(self.unlisted.get() + 1);
        }
    }
}

impl<'t> Reader<'t> {
    /// A reader that has found nothing wrong yet.
    pub(super) fn new(file_name: &'t str, text: &'t str, beside: &'t dyn Fn(&str) -> Result<String, String>) -> Self {
        Self {
            file_name,
            text,
            beside,
            line_ends: text.match_indices('\n').map(|(offset, _)| offset).collect(),
            problems: Problems::default(),
        }
    }

    /// The text of a file beside the machine file.
    pub(super) fn beside(&self, name: &str) -> Result<String, String> {
        (self.beside)(name)
    }

    /// Line of a byte of the file, from 1.
    pub(super) fn line(&self, offset: usize) -> usize {
        1 + self.line_ends.partition_point(|end| *end < offset)
    }

    /// The bytes of the line that a byte of the file is in, without its end.
    pub(super) fn line_span(&self, offset: usize) -> Range<usize> {
        let index = self.line(offset) - 1;
        let start = if index == 0 { 0 } else { self.line_ends[index - 1] + 1 };
        start..self.line_ends.get(index).copied().unwrap_or(self.text.len())
    }

    /// A problem at a place of the file.
    pub(super) fn problem(
        &self,
        span: Range<usize>,
        key: String,
        place: &str,
        cause: ProblemCause,
        remedy: String,
    ) -> Problem {
        Problem {
            line: self.line(span.start),
            span,
            key,
            place: place.to_owned(),
            cause,
            remedy,
        }
    }

    /// Records a problem.
    pub(super) fn report(&self, problem: Problem) {
        self.problems.push(problem);
    }

    /// Quotes the text at a place of the file on one line, without control characters.
    pub(super) fn quote(&self, span: Range<usize>) -> String {
        let text = self.text.get(span).unwrap_or_default();
        let mut quote: String = text.chars().take(MAX_QUOTE).flat_map(printable).collect();
        if text.chars().nth(MAX_QUOTE).is_some() {
            quote.push('…');
        }
        quote
    }

    /// Returns the value if no problem was recorded.
    pub(super) fn finish<T>(self, value: Option<T>) -> Result<T, SpecError> {
        let problems = self.problems.kept.into_inner();
        match value {
            Some(value) if problems.is_empty() => Ok(value),
            _ => Err(SpecError::new(
                self.file_name,
                self.text,
                problems,
                self.problems.unlisted.get(),
            )),
        }
    }
}

/// Escapes a character for a message: the content of a machine file must not control the terminal.
fn printable(c: char) -> impl Iterator<Item = char> {
    let escaped = if c.is_control() { Some(c.escape_debug()) } else { None };
    let plain = if c.is_control() { None } else { Some(c) };
    escaped.into_iter().flatten().chain(plain)
}
