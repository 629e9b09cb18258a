//! Texts for people: tables, figures, names, and a path as a word of a command line.

use crate::failure::Failure;
use anstream::adapter::strip_str;
use posicast_machine::unit::AxisUnit;
use posicast_system::output::write_text as write_whole;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::Serialize;
use std::path::Path;

/// Writes a text with a seal into a file with a name that the user gave, completely or not at all.
///
/// # Errors
/// [`Failure`] that names the file, if it cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    let name = if path == Path::new("-") {
        Path::new("standard output")
    } else {
        path
    };
    write_whole(path, text).map_err(Failure::of_file(name, "write it"))
}

/// A path as a word of a command line that the user copies into a shell.
pub fn shell_word(path: &Path) -> String {
    let path = path.display().to_string();
    // Only a NUL character cannot be quoted, and no path has one.
    shlex::try_quote(&path).map_or_else(|_| path.clone(), |quoted| quoted.into_owned())
}

/// A JSON document as text with a final newline.
pub fn json_text(document: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(document)
        .map(|text| text + "\n")
        .map_err(Failure::because)
}

/// The JSON Schema of a document as it is printed.
#[must_use]
pub fn json_schema<D: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.into_generator().into_root_schema_for::<D>()
}

/// Number of names of a list that a text shows; JSON has all.
const SHOWN: usize = 8;

/// The first names of a list, and how many more there are.
pub fn few(names: &[String]) -> String {
    let mut text = names.iter().take(SHOWN).cloned().collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN {
        text += &format!(" and {} more", names.len() - SHOWN);
    }
    text
}

/// The unit of an axis in a JSON document, whose figures are in `si_unit` whatever unit the machine file uses.
#[derive(Clone, Copy, Serialize, JsonSchema)]
pub struct UnitDocument {
    /// Unit of the axis in the machine file.
    unit: &'static str,
    /// Unit of the figures here: `m` or `rad`.
    #[schemars(extend("enum" = ["m", "rad"]))]
    si_unit: &'static str,
    #[serde(skip)]
    of_axis: AxisUnit,
}

impl UnitDocument {
    /// The document of a unit.
    #[must_use]
    pub fn new(of_axis: AxisUnit) -> Self {
        Self {
            unit: of_axis.name(),
            si_unit: of_axis.si_name(),
            of_axis,
        }
    }

    /// The unit, for figures that people read.
    pub fn of_axis(&self) -> AxisUnit {
        self.of_axis
    }
}

/// Formats a fraction as percent, with enough digits to distinguish it from zero.
pub fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    if percent == 0.0 || percent.abs() >= 0.01 {
        format!("{percent:.3}")
    } else {
        format!("{percent:.1e}")
    }
}

/// Number of visible characters of a cell, without escape sequences of colours.
fn seen(cell: &str) -> usize {
    strip_str(cell).to_string().chars().count()
}

/// A table for people: columns are as wide as their widest cell, and the caller chooses which are right-aligned.
pub struct Table {
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headings; a heading that starts with `>` makes its column right-aligned.
    pub fn new(headings: &[&str]) -> Self {
        let right = headings.iter().map(|h| h.starts_with('>')).collect();
        let first = headings.iter().map(|h| h.trim_start_matches('>').to_owned()).collect();
        Self {
            right,
            rows: vec![first],
        }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// The text, each line indented.
    pub fn text(&self, indent: &str) -> String {
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
