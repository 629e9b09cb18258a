//! Colours of texts for people: of verdicts, and of the word with which a message begins.
//!
//! They are escape sequences; a front leaves them out where nobody sees them.

use anstyle::{AnsiColor, Style};

const GREEN: Style = AnsiColor::Green.on_default();
const BOLD_GREEN: Style = GREEN.bold();
const RED: Style = AnsiColor::Red.on_default().bold();
const YELLOW: Style = AnsiColor::Yellow.on_default();

/// Style for what holds.
pub fn good(text: &str) -> String {
    styled(GREEN, text)
}

/// Style for a passed verdict.
pub fn passed(text: &str) -> String {
    styled(BOLD_GREEN, text)
}

/// Style for what does not hold.
pub fn bad(text: &str) -> String {
    styled(RED, text)
}

/// Style for what is doubtful.
pub fn doubtful(text: &str) -> String {
    styled(YELLOW, text)
}

/// Words with which a line of a message or verdict may begin, with their colours.
const BEGINNINGS: [(&str, Style); 7] = [
    ("warning:", YELLOW),
    ("error:", RED),
    ("match:", BOLD_GREEN),
    ("MISMATCH", RED),
    ("PASS:", BOLD_GREEN),
    ("FAIL:", RED),
    ("NO VERDICT", YELLOW),
];

/// A line with its first word coloured, if that is one of [`BEGINNINGS`].
pub fn message(line: &str) -> String {
    let known = BEGINNINGS.iter().find(|(beginning, _)| line.starts_with(beginning));
    known.map_or_else(
        || line.to_owned(),
        |(beginning, style)| styled(*style, beginning) + &line[beginning.len()..],
    )
}

fn styled(style: Style, text: &str) -> String {
    format!("{style}{text}{style:#}")
}
