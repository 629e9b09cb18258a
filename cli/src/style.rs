//! When colours are used: on a terminal, or as `--color` requests.
//!
//! Text carries its colours as escape sequences; [`print_styled`](crate::output::print_styled) and [`say`](crate::output::say) remove them
//! if nobody would see them: in a pipe or a file, with `NO_COLOR`, on a terminal without colours, or by `--color`.

use anstream::ColorChoice;
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
