//! Standard output, and the files that commands write.

use crate::failure::Failure;
use crate::style;
use anstream::adapter::strip_str;
use anstream::{AutoStream, ColorChoice};
use posicast_machine::unit::AxisUnit;
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

/// Writes a text with a seal into a file with a name that the user gave, completely or not at all.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    let name = match path == Path::new("-") {
        true => Path::new("standard output"),
        false => path,
    };
    posicast_system::output::write_text(path, text).map_err(Failure::of_file(name, "write it"))
}

/// Prints text with coloured verdicts; the colours are left out where nobody sees them.
pub(crate) fn print_styled(text: &str) -> Result<(), Failure> {
    let colours = AutoStream::choice(&std::io::stdout()) != ColorChoice::Never;
    match colours {
        true => print(text),
        false => print(&strip_str(text).to_string()),
    }
}

/// Prints the result of a command that writes files: on standard error where one of the files is the standard output.
pub(crate) fn print_beside(outputs: &OutputFiles, text: &str) -> Result<(), Failure> {
    if outputs.take_standard_output() {
        say(text.trim_end());
        return Ok(());
    }
    print(text)
}

/// Refuses `--json` where a file that the command writes is the standard output.
pub(crate) fn one_document(outputs: &OutputFiles, json: bool) -> Result<(), Failure> {
    match json && outputs.take_standard_output() {
        false => Ok(()),
        true => Err(Failure::from(miette::miette!(
            help = "name a file for it, or leave out --json",
            "--json: standard output takes one document, and a file is written there already"
        ))),
    }
}

/// A path as a word of a command line that the user copies into a shell.
pub(crate) fn shell_word(path: &Path) -> String {
    let path = path.display().to_string();
    // Only a NUL character cannot be quoted, and no path has one.
    shlex::try_quote(&path).map_or_else(|_| path.clone(), |quoted| quoted.into_owned())
}

/// Prints one JSON document on standard output.
pub(crate) fn print_json(document: &impl Serialize) -> Result<(), Failure> {
    print(&json_text(document)?)
}

/// A JSON document as text with a final newline.
pub(crate) fn json_text(document: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(document)
        .map(|text| text + "\n")
        .map_err(Failure::because)
}

/// Number of names of a list that a text shows; JSON has all.
const SHOWN: usize = 8;

/// The first names of a list, and how many more there are.
pub(crate) fn few(names: &[String]) -> String {
    let mut text = names.iter().take(SHOWN).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN {
        text += &format!(" and {} more", names.len() - SHOWN);
    }
    text
}

/// Prints a message on standard error.
pub(crate) fn say(line: &str) {
    // A message that cannot be written must not stop the work.
    let _ = writeln!(anstream::stderr(), "{}", style::message(line));
}

/// The unit of an axis in a JSON document, whose figures are in `si_unit` whatever unit the machine file uses.
#[derive(Clone, Copy, Serialize)]
pub(crate) struct UnitDocument {
    unit: &'static str,
    si_unit: &'static str,
    #[serde(skip)]
    of_axis: AxisUnit,
}

impl UnitDocument {
    pub(crate) fn new(of_axis: AxisUnit) -> Self {
        Self {
            unit: of_axis.name(),
            si_unit: of_axis.si_name(),
            of_axis,
        }
    }

    /// The unit, for figures that people read.
    pub(crate) fn of_axis(&self) -> AxisUnit {
        self.of_axis
    }
}

/// A fraction as percent, with enough digits to tell it from zero.
pub(crate) fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    if percent == 0.0 || percent.abs() >= 0.01 {
        format!("{percent:.3}")
    } else {
        format!("{percent:.1e}")
    }
}

/// Characters of a cell that are seen: escape sequences of colours are not.
fn seen(cell: &str) -> usize {
    strip_str(cell).to_string().chars().count()
}

/// A table for people: columns as wide as their widest cell, numbers right-aligned by the caller's choice.
pub(crate) struct Table {
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headings; a heading that starts with `>` makes its column right-aligned.
    pub(crate) fn new(headings: &[&str]) -> Self {
        let right = headings.iter().map(|h| h.starts_with('>')).collect();
        let first = headings.iter().map(|h| h.trim_start_matches('>').to_owned()).collect();
        Self {
            right,
            rows: vec![first],
        }
    }

    /// Adds a row.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// The text, each line indented.
    pub(crate) fn text(&self, indent: &str) -> String {
        let width = |column: usize| self.rows.iter().filter_map(|r| r.get(column)).map(|c| seen(c)).max();
        let widths: Vec<usize> = (0..self.right.len()).map(|c| width(c).unwrap_or(0)).collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = indent.to_owned();
            for ((cell, width), right) in row.iter().zip(&widths).zip(&self.right) {
                let padding = " ".repeat(width.saturating_sub(seen(cell)));
                line += &if *right {
                    format!("{padding}{cell}  ")
                } else {
                    format!("{cell}{padding}  ")
                };
            }
            text += line.trim_end();
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_aligns_its_columns_by_characters() {
        let mut table = Table::new(&["axis", ">ζ"]);
        table.row(["x".into(), "0.1578".into()]);
        assert_eq!(table.text("  "), "  axis       ζ\n  x     0.1578\n");
    }
}
