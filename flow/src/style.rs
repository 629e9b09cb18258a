//! Colours of texts for people: of verdicts, and of the first word of a message.
//!
//! They are escape sequences, which a front removes if nobody would see them.

use anstyle::{AnsiColor, Style};

const GREEN: Style = AnsiColor::Green.on_default();
const BOLD_GREEN: Style = GREEN.bold();
const RED: Style = AnsiColor::Red.on_default().bold();
const YELLOW: Style = AnsiColor::Yellow.on_default();

/// Style for a condition that holds.
pub fn good(text: &str) -> String {
    styled(GREEN, text)
}

/// Style for a passed verdict.
pub fn passed(text: &str) -> String {
    styled(BOLD_GREEN, text)
}

/// Style for a condition that does not hold.
pub fn bad(text: &str) -> String {
    styled(RED, text)
}

/// Style for a doubtful result.
pub fn doubtful(text: &str) -> String {
    styled(YELLOW, text)
}

/// First words of a line of a message or verdict, with their colours.
const BEGINNINGS: [(&str, Style); 7] = [
    ("warning:", YELLOW),
    ("error:", RED),
    ("match:", BOLD_GREEN),
    ("MISMATCH", RED),
    ("PASS:", BOLD_GREEN),
    ("FAIL:", RED),
    ("NO VERDICT", YELLOW),
];

/// Returns a line with its first word coloured, if that is one of [`BEGINNINGS`].
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
