//! `posicast schema`: writes the JSON Schema of the machine file, for editors, or that of a document that a command prints, for programs.

use crate::output;
use crate::{doctor, host, reproduce};
use clap::ValueEnum;
use posicast_flow::text::{json_schema, json_text, shell_word, write_text};
use posicast_flow::{Failure, bitstream, compare, design, generate, identify, run, simulate, synth, verify};
use posicast_machine::machine_file;
use posicast_system::output::OutputFiles;
use posicast_testbench::shard::Merged;
use std::path::{Path, PathBuf};

/// Print the JSON Schema of the machine file, for editors that complete and check TOML; with NAME, that of a JSON document
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast schema -o posicast-machine.schema.json
  posicast schema report -o posicast-report.schema.json
  posicast schema design

Machine files that `posicast new` writes name a file posicast-machine.schema.json beside them. Editors with Taplo (Even Better
TOML) then complete keys, show what they mean and mark what is out of range. The schema has few rules about several keys
together: `posicast design` checks everything.")]
pub(crate) struct Args {
    /// Whose schema
    #[arg(value_enum, default_value_t = Name::MachineFile)]
    name: Name,
    /// The same as the name `report`
    #[arg(long, conflicts_with = "name")]
    report: bool,
    /// File to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace a file that posicast did not write, or that was changed since
    #[arg(long, requires = "output")]
    force: bool,
}

/// What a schema describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Name {
    /// The machine file
    MachineFile,
    /// `report.json` after `run`, and `run --json`
    Report,
    /// `design --json`, and `report.json` after `generate`
    Design,
    /// `design --compare --json`
    Compare,
    /// `generate --json`
    Generate,
    /// `simulate --json`, with --contour too
    Simulate,
    /// `verify --json`
    Verify,
    /// `diff --json`
    Diff,
    /// `campaign merge --json`
    Campaign,
    /// `synth --json`
    Synth,
    /// `bitstream --json`
    Bitstream,
    /// `identify --json`
    Identify,
    /// `host status --json` of a stage
    HostStatus,
    /// `host status --json` of an inline shaper
    HostInlineStatus,
    /// `reproduce --json`
    Reproduce,
    /// `reproduce --beyond --json`
    Beyond,
    /// `doctor --json`
    Doctor,
}

impl Name {
    /// The schema as text.
    fn text(self) -> Result<String, Failure> {
        let mut schema = match self {
            Self::MachineFile => return json_text(&machine_file::schema()),
            Self::Diff => return Ok(wavecmp::diff::JSON_SCHEMA.to_owned()),
            Self::Report => json_schema::<run::Document>(),
            Self::Design => json_schema::<design::Document>(),
            Self::Compare => json_schema::<compare::Document>(),
            Self::Generate => json_schema::<generate::Document>(),
            Self::Simulate => json_schema::<simulate::Simulated>(),
            Self::Verify => json_schema::<verify::Document>(),
            Self::Campaign => json_schema::<Merged>(),
            Self::Synth => json_schema::<synth::Document>(),
            Self::Bitstream => json_schema::<bitstream::Document>(),
            Self::Identify => json_schema::<identify::Document>(),
            Self::HostStatus => json_schema::<host::StatusDocument>(),
            Self::HostInlineStatus => json_schema::<host::InlineStatusDocument>(),
            Self::Reproduce => json_schema::<reproduce::Document<'_>>(),
            Self::Beyond => json_schema::<reproduce::BeyondDocument<'_>>(),
            Self::Doctor => json_schema::<doctor::Document<'_>>(),
        };
        let name = self.to_possible_value();
        let title = name.map_or_else(String::new, |name| format!("posicast {}", name.get_name()));
        schema.insert("title".to_owned(), title.into());
        json_text(&schema)
    }
}

/// The JSON Schema with this name, as `posicast schema NAME` prints it; `None` for a name that is none of [`names`].
pub fn text(name: &str) -> Option<String> {
    let name = Name::from_str(name, false).ok()?;
    name.text().ok()
}

/// The names of the schemas.
pub fn names() -> Vec<String> {
    let names = Name::value_variants().iter().filter_map(ValueEnum::to_possible_value);
    names.map(|name| name.get_name().to_owned()).collect()
}

/// Name of the schema's file in the first line of machine files that `posicast new` writes.
const FILE: &str = "posicast-machine.schema.json";

/// Instructions to write the schema that a new machine file names in its first line.
pub(crate) fn hint(machine: &Path) -> String {
    let schema = shell_word(&machine.with_file_name(FILE));
    format!("editors complete and check it beside its schema: `posicast schema -o {schema}`")
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let name = if args.report { Name::Report } else { args.name };
    let text = name.text()?;
    let Some(path) = &args.output else {
        return output::print(&text);
    };
    OutputFiles::new(args.force)
        .claim("--output", path)
        .map_err(Failure::because)?;
    write_text(path, &text)
}
