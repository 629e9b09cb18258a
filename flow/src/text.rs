//! Parts of texts: figures, names, and a path as a word of a command line.

use crate::failure::Failure;
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
