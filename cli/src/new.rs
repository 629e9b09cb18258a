//! `posicast new`: writes a machine file to start from, with a comment on every key.
//!
//! The templates are whole machine files that pass `posicast run` unchanged. Answers replace single values in them,
//! so that their comments stay.

mod questions;

use crate::{output, render, schema};
use posicast_flow::Failure;
use posicast_flow::identify::new_machine;
use posicast_flow::template::{MachineDraft, MachineKind, to_measure};
use posicast_flow::text::{shell_word, write_text};
use posicast_system::output::{OutputError, OutputFiles};
use questions::Questions;
use std::io::{IsTerminal, stderr, stdin};
use std::path::Path;
use std::path::PathBuf;

/// Write a commented machine file for a kind of machine, to start from
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast new stage.toml                asks a few questions on a terminal
  posicast new --crane crane.toml        asks nothing
  posicast new --from-log x.csv head.toml
                                         with the modes of a measured log
  posicast schema -o posicast-machine.schema.json
                                         beside it: editors then complete and check the file

Without a terminal and without a kind it writes a gantry.")]
pub(crate) struct Args {
    /// Machine file to write; if possible, its name without the ending becomes the name of the machine
    file: PathBuf,
    #[command(flatten)]
    kind: KindFlags,
    /// Take modes and shaper from a measured log, as `posicast identify` finds them; only for the axis that was measured
    #[arg(long, value_name = "LOG")]
    from_log: Option<PathBuf>,
    /// Replace FILE if posicast wrote it and nobody has changed it since
    #[arg(long)]
    force: bool,
}

#[derive(clap::Args)]
#[group(multiple = false)]
pub(crate) struct KindFlags {
    /// 3D printer: two belt axes with stepper motors, shaped steps out
    #[arg(long)]
    printer: bool,
    /// CNC router: three screw axes with stepper motors, shaped steps out
    #[arg(long)]
    cnc: bool,
    /// Gantry or XY stage: two linear axes with encoder, drive and controller
    #[arg(long)]
    gantry: bool,
    /// Joint of a robot: one rotary axis with encoder, drive and controller
    #[arg(long)]
    joint: bool,
    /// Crane: a trolley with a load that swings
    #[arg(long)]
    crane: bool,
}

impl KindFlags {
    pub(crate) fn kind(&self) -> Option<MachineKind> {
        let flags = [
            (self.printer, MachineKind::Printer),
            (self.cnc, MachineKind::Cnc),
            (self.gantry, MachineKind::Gantry),
            (self.joint, MachineKind::Joint),
            (self.crane, MachineKind::Crane),
        ];
        flags.into_iter().find(|(given, _)| *given).map(|(_, kind)| kind)
    }
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let mut outputs = claim(&args.file, args.force)?;
    if let Some(log) = &args.from_log {
        outputs.input("--from-log", log);
        let said = render::identify(&new_machine(log, &args.file, args.kind.kind())?);
        return output::print_beside(&outputs, &format!("{said}{}\n", schema::hint(&args.file)));
    }
    let asks = stdin().is_terminal() && stderr().is_terminal();
    let draft = match args.kind.kind() {
        // Standard error is not locked, so that a signal that ends the questions can be reported there.
        None if asks => Questions::new(stdin().lock(), stderr()).draft(&args.file)?,
        kind => MachineDraft::new(kind.unwrap_or(MachineKind::Gantry), &args.file),
    };
    let (file, text) = (shell_word(&args.file), draft.text());
    write_text(&args.file, text)?;
    let said = format!(
        "{} written: machine {}, {}\n\
         next: {}`posicast design {file}`, then `posicast run {file}`\n\
         {}\n",
        args.file.display(),
        draft.name(),
        draft.kind().about(),
        to_measure(text),
        schema::hint(&args.file),
    );
    output::print_beside(&outputs, &said)
}

/// Claims the file name. A machine file is the user's work: an existing file is kept, unless posicast wrote it and
/// nobody has changed it.
fn claim(path: &Path, force: bool) -> Result<OutputFiles, Failure> {
    let there = |found: &str, help: &str| {
        Failure::input(format!("FILE {}: {found}; it is not replaced", path.display())).with_help(help)
    };
    if path.is_file() && !force {
        let help = "name another file; --force replaces it if posicast wrote it and nobody has changed it since";
        return Err(there("this file exists", help));
    }
    let mut outputs = OutputFiles::new(false);
    match outputs.claim_machine_file("FILE", path) {
        Ok(()) => Ok(outputs),
        Err(OutputError::Foreign { .. }) => Err(there(
            "posicast did not write this file, or it was changed since",
            "name another file, or move this one away",
        )),
        Err(error) => Err(Failure::because(error)),
    }
}
