//! Reports on standard error why a command stopped, and determines its exit status.

use anstream::stderr;
use posicast_flow::{Failure, style, with_causes};
use std::fmt;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;

/// Prints why the command stopped: with an excerpt of the place on a terminal, but in plain lines in a pipe, where a log can be searched
/// for them.
pub(crate) fn report(failure: &Failure) -> ExitCode {
    let mut err = std::io::stderr().lock();
    // If standard error cannot be written, nothing sensible is left to do.
    let _ = match failure {
        Failure::Check(line) => writeln!(stderr(), "posicast: {}", style::bad(line)),
        Failure::Input(report) | Failure::MissingTool(report) if err.is_terminal() => writeln!(err, "{report:?}"),
        Failure::Input(report) | Failure::MissingTool(report) => write_plain(&mut stderr(), report),
    };
    ExitCode::from(match failure {
        Failure::Check(_) => 1,
        Failure::Input(_) => 2,
        Failure::MissingTool(_) => 3,
    })
}

/// Beginning of a line that describes an error.
const ERROR: &str = "error:";

fn write_plain(err: &mut impl Write, report: &miette::Report) -> std::io::Result<()> {
    writeln!(err, "{} {}", style::message(ERROR), with_causes(report))?;
    write_help(err, report.help())?;
    for related in report.related().into_iter().flatten() {
        writeln!(err, "{} {related}", style::message(ERROR))?;
        write_help(err, related.help())?;
    }
    Ok(())
}

/// Writes each line of a help text as a separate line, for which a log can be searched.
fn write_help(err: &mut impl Write, help: Option<Box<dyn fmt::Display + '_>>) -> std::io::Result<()> {
    let help = help.map_or_else(String::new, |help| help.to_string());
    help.lines().try_for_each(|line| writeln!(err, "help: {line}"))
}
