//! Colours of verdicts and of the first word of a message, and when they are used: on a terminal, or as `--color` requests.
//!
//! Text carries its colours as escape sequences; [`print_styled`](crate::output::print_styled) and [`say`](crate::output::say) remove them
//! if nobody would see them: in a pipe or a file, with `NO_COLOR`, on a terminal without colours, or by `--color`.

use anstream::ColorChoice;
use anstyle::{AnsiColor, Style};
use clap::ValueEnum;
use std::ffi::OsString;

/// Value of `--color`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum When {
    /// On a terminal, unless NO_COLOR is set
    Auto,
    /// In a pipe too
    Always,
    /// Never
    Never,
}

/// Sets when colours are used.
pub(crate) fn set(when: When) {
    let choice = match when {
        When::Auto => ColorChoice::Auto,
        When::Always => ColorChoice::Always,
        When::Never => ColorChoice::Never,
    };
    choice.write_global();
    if when == When::Never {
        // This fails if a hook is set already, which then stays.
        let plain = || miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor());
        let _ = miette::set_hook(Box::new(move |_| Box::new(plain())));
    }
}

/// Returns the value of `--color` among these arguments; `auto` if there is none, or a wrong one, which the parser reports.
pub(crate) fn of_arguments(arguments: impl Iterator<Item = OsString>) -> clap::ColorChoice {
    const OPTION: &str = "--color";
    let words: Vec<OsString> = arguments.collect();
    let words: Vec<&str> = words.iter().filter_map(|word| word.to_str()).collect();
    let beside = words.iter().skip_while(|word| **word != OPTION).nth(1).copied();
    let joined = words
        .iter()
        .find_map(|word| word.strip_prefix(OPTION)?.strip_prefix('='));
    let value = beside
        .or(joined)
        .and_then(|value| clap::ColorChoice::from_str(value, false).ok());
    value.unwrap_or_default()
}

const GREEN: Style = AnsiColor::Green.on_default();
const BOLD_GREEN: Style = GREEN.bold();
const RED: Style = AnsiColor::Red.on_default().bold();
const YELLOW: Style = AnsiColor::Yellow.on_default();

/// Style for a condition that holds.
pub(crate) fn good(text: &str) -> String {
    styled(GREEN, text)
}

/// Style for a passed verdict.
pub(crate) fn passed(text: &str) -> String {
    styled(BOLD_GREEN, text)
}

/// Style for a condition that does not hold.
pub(crate) fn bad(text: &str) -> String {
    styled(RED, text)
}

/// Style for a doubtful result.
pub(crate) fn doubtful(text: &str) -> String {
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
pub(crate) fn message(line: &str) -> String {
    let known = BEGINNINGS.iter().find(|(beginning, _)| line.starts_with(beginning));
    known.map_or_else(
        || line.to_owned(),
        |(beginning, style)| styled(*style, beginning) + &line[beginning.len()..],
    )
}

fn styled(style: Style, text: &str) -> String {
    format!("{style}{text}{style:#}")
}
