//! `posicast export`: the designed impulses in the formats that other controllers and programs read.

use crate::terminal::Terminal;
use crate::{choice, output};
use posicast_flow::Failure;
use posicast_flow::export::{ExportFormat, Options, export};
use std::path::PathBuf;

/// Write the designed impulses for a printer's firmware, C, CSV, NumPy or MATLAB
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast export printer.toml --to klipper --include posicast.cfg
  posicast export printer.toml --to reprapfirmware --firmware-version 3.5
  posicast export printer.toml --to klipper --closest
  posicast export examples/gantry.toml --to c -o gantry.h

The export is a file of its own; the command prints the line that includes it. Never append it to a printer.cfg: Klipper drops
the SAVE_CONFIG block if something follows it.

Exit status 2: the format cannot express the design; the message gives the reason, and the firmware's own shaper that leaves
least.")]
pub(crate) struct Args {
    /// Machine file
    machine: PathBuf,
    /// Form of the output
    #[arg(long, value_name = "FORMAT", value_parser = choice::parser::<ExportFormat>())]
    to: ExportFormat,
    /// Version of the firmware, such as 3.5, v0.13.0-633 or 2026-03-31 [default: the newest; the output names it]
    #[arg(long, value_name = "VERSION")]
    firmware_version: Option<String>,
    /// Only this axis; may be given several times
    #[arg(long, value_name = "NAME")]
    axis: Vec<String>,
    /// If the firmware cannot take the design, write the firmware's own shaper that leaves least
    #[arg(long)]
    closest: bool,
    /// File to write; a file that posicast did not write is never replaced [default: standard output]
    #[arg(short, long, visible_alias = "include", value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let options = Options {
        machine: args.machine.clone(),
        to: args.to,
        firmware_version: args.firmware_version.clone(),
        axes: args.axis.clone(),
        closest: args.closest,
        output: args.output.clone(),
    };
    match export(&options, &Terminal)? {
        Some(text) => output::print(&text),
        None => Ok(()),
    }
}
