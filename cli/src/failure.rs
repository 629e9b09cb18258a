//! Reports on standard error why a command stopped, and determines its exit status.

use crate::style;
use anstream::stderr;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use posicast_flow::{Failure, Reason};
use std::error::Error;
use std::fmt;
use std::io::{IsTerminal, Write};

/// Prints why the command stopped: with an excerpt of the place on a terminal, but in plain lines in a pipe, where a log can be searched
/// for them.
pub(crate) fn report(failure: &Failure) -> u8 {
    let mut err = std::io::stderr().lock();
    // If standard error cannot be written, nothing sensible is left to do.
    let _ = match failure {
        Failure::Check(line) => writeln!(stderr(), "posicast: {}", style::bad(line)),
        Failure::Input(reason) | Failure::MissingTool(reason) if err.is_terminal() => {
            writeln!(err, "{:?}", drawn(reason))
        }
        Failure::Input(reason) | Failure::MissingTool(reason) => write_plain(&mut stderr(), reason),
    };
    match failure {
        Failure::Check(_) => 1,
        Failure::Input(_) => 2,
        Failure::MissingTool(_) => 3,
    }
}

/// Beginning of a line that describes an error.
const ERROR: &str = "error:";

/// Writes the error in one line, and each line of its help as a separate line, for which a log can be searched.
fn write_plain(err: &mut impl Write, reason: &Reason) -> std::io::Result<()> {
    writeln!(err, "{} {reason}", style::message(ERROR))?;
    let help = reason.help.as_deref().unwrap_or_default();
    help.lines().try_for_each(|line| writeln!(err, "help: {line}"))
}

/// The reason as miette draws it for a terminal.
fn drawn(reason: &Reason) -> miette::Report {
    let causes = reason.causes.iter().rev();
    let cause = causes.fold(None, |below, message| {
        Some(Box::new(Cause {
            message: message.clone(),
            below,
        }))
    });
    miette::Report::new(Drawn {
        text: reason
            .excerpt
            .as_ref()
            .map(|excerpt| NamedSource::new(&excerpt.file, excerpt.text.clone())),
        reason: reason.clone(),
        cause,
    })
}

/// A reason with what miette asks for.
#[derive(Debug)]
struct Drawn {
    reason: Reason,
    cause: Option<Box<Cause>>,
    text: Option<NamedSource<String>>,
}

/// A cause, and the one below it.
#[derive(Debug)]
struct Cause {
    message: String,
    below: Option<Box<Cause>>,
}

impl fmt::Display for Drawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason.message)
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl Error for Drawn {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.cause.as_deref().map(|cause| cause as _)
    }
}

impl Error for Cause {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.below.as_deref().map(|cause| cause as _)
    }
}

impl Diagnostic for Drawn {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.reason.help.as_ref().map(|help| Box::new(help) as _)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.text.as_ref().map(|text| text as _)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let places = self.reason.excerpt.as_ref()?.places.iter();
        let labels = places.map(|(span, what)| LabeledSpan::new_with_span(Some((*what).to_owned()), span.clone()));
        Some(Box::new(labels))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_flow::Excerpt;

    /// What a terminal without colours and a pipe show of a reason.
    fn shown(reason: &Reason) -> (String, String) {
        let mut terminal = String::new();
        let handler = miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor());
        handler.render_report(&mut terminal, drawn(reason).as_ref()).unwrap();
        let mut pipe = Vec::new();
        write_plain(&mut pipe, reason).unwrap();
        (terminal, String::from_utf8(pipe).unwrap())
    }

    #[test]
    fn a_terminal_shows_the_place_and_a_pipe_plain_lines() {
        let reason = Reason {
            message: "m.toml:2: damping: found 7".to_owned(),
            help: Some("percent?\nelse below 1".to_owned()),
            excerpt: Some(Box::new(Excerpt {
                file: "m.toml".to_owned(),
                text: "frequency_hz = 5\ndamping = 7\n".to_owned(),
                places: vec![(27..28, "out of range")],
            })),
            ..Reason::default()
        };
        let (terminal, pipe) = shown(&reason);
        for part in ["[m.toml:2:11]", "2 │ damping = 7", "out of range", "help: percent?"] {
            assert!(terminal.contains(part), "{part} in {terminal}");
        }
        let end = ": damping: found 7\nhelp: percent?\nhelp: else below 1\n";
        assert!(pipe.contains("error:") && pipe.ends_with(end), "{pipe}");
    }

    #[test]
    fn causes_are_listed_on_a_terminal_and_joined_in_a_pipe() {
        let reason = Reason {
            message: "the log cannot be read: line 3".to_owned(),
            causes: vec!["line 3".to_owned(), "no number".to_owned()],
            ..Reason::default()
        };
        let (terminal, pipe) = shown(&reason);
        assert!(
            terminal.contains("├─▶ line 3") && terminal.contains("╰─▶ no number"),
            "{terminal}"
        );
        assert!(pipe.ends_with(" the log cannot be read: line 3: no number\n"), "{pipe}");
    }
}
