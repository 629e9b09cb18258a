//! `posicast schema`: writes the JSON Schema of the machine file, for editors, or that of a run's report, for programs.

use crate::output;
use posicast_flow::Failure;
use posicast_flow::text::{json_text, shell_word, write_text};
use posicast_machine::machine_file;
use posicast_system::output::OutputFiles;
use std::path::{Path, PathBuf};

/// Print the JSON Schema of the machine file, for editors that complete and check TOML; with --report, that of report.json
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast schema -o posicast-machine.schema.json
  posicast schema --report -o posicast-report.schema.json

Machine files that `posicast new` writes name a file posicast-machine.schema.json beside them. Editors with Taplo (Even Better
TOML) then complete keys, show what they mean and mark what is out of range. The schema has few rules about several keys
together: `posicast design` checks everything.")]
pub(crate) struct Args {
    /// Write the schema of `report.json` and of `run --json` instead
    #[arg(long)]
    report: bool,
    /// File to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace a file that posicast did not write, or that was changed since
    #[arg(long, requires = "output")]
    force: bool,
}

/// Name of the schema's file in the first line of machine files that `posicast new` writes.
const FILE: &str = "posicast-machine.schema.json";

/// Instructions to write the schema that a new machine file names in its first line.
pub(crate) fn hint(machine: &Path) -> String {
    let schema = shell_word(&machine.with_file_name(FILE));
    format!("editors complete and check it beside its schema: `posicast schema -o {schema}`")
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let text = if args.report {
        json_text(&posicast_flow::run::schema())?
    } else {
        json_text(&machine_file::schema())?
    };
    let Some(path) = &args.output else {
        return output::print(&text);
    };
    OutputFiles::new(args.force)
        .claim("--output", path)
        .map_err(Failure::because)?;
    write_text(path, &text)
}
