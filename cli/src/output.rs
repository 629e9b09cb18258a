//! Standard output, and messages on standard error.

use crate::style;
use anstream::adapter::strip_str;
use anstream::{AutoStream, ColorChoice};
use posicast_flow::text::json_text;
use posicast_flow::{Failure, Outcome, ResultForm};
use posicast_system::output::OutputFiles;
use serde::Serialize;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Prints text on standard output. It is not an error if the reader has ended (`| head`).
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::of_file(Path::new("standard output"), "write it")(error))
        }
        _ => Ok(()),
    }
}

/// Writes what standard output still buffers. At the end of a process only Rust's own `main` does that, which Python's is not.
pub(crate) fn flush() {
    // A reader that has ended is no error, and others were reported by the writes.
    let _ = std::io::stdout().flush();
}

/// Prints text with coloured verdicts; leaves the colours out if nobody would see them.
pub(crate) fn print_styled(text: &str) -> Result<(), Failure> {
    let colours = AutoStream::choice(&std::io::stdout()) != ColorChoice::Never;
    if colours {
        print(text)
    } else {
        print(&strip_str(text).to_string())
    }
}

/// Prints the result of a command that writes files: on standard error if one of the files is the standard output.
pub(crate) fn print_beside(outputs: &OutputFiles, text: &str) -> Result<(), Failure> {
    if outputs.take_standard_output() {
        say(text.trim_end());
        return Ok(());
    }
    print(text)
}

/// Prints the result of a step, as its document or as the text that `render` makes of it; a failed check is the command's failure.
pub(crate) fn show<D: Serialize>(
    outcome: Outcome<D>,
    json: bool,
    render: impl FnOnce(&D) -> String,
) -> Result<(), Failure> {
    match (json, outcome.is_beside_a_file) {
        (true, _) => print_json(&outcome.document)?,
        (false, true) => say(render(&outcome.document).trim_end()),
        (false, false) => print_styled(&render(&outcome.document))?,
    }
    match outcome.failed {
        None => Ok(()),
        Some(reason) => Err(Failure::Check(reason)),
    }
}

/// How the document of a step is shown.
pub(crate) fn form(json: bool) -> ResultForm {
    if json { ResultForm::Document } else { ResultForm::Text }
}

/// Prints one JSON document on standard output.
pub(crate) fn print_json(document: &impl Serialize) -> Result<(), Failure> {
    print(&json_text(document)?)
}

/// Prints a message on standard error.
pub(crate) fn say(line: &str) {
    // A message that cannot be written must not stop the work.
    let _ = writeln!(anstream::stderr(), "{}", style::message(line));
}
