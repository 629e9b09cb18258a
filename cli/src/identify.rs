//! `posicast identify`: finds modes in a measured log, and writes a machine file with them.

mod document;
mod excitation;
mod findings;
mod log_flags;
mod machine_file;
mod pictures;
mod text;

use crate::failure::Failure;
use crate::new::{KindFlags, MachineKind};
use crate::output;
use crate::plot;
use crate::schema;
use excitation::ExcitationFlags;
use findings::Findings;
use log_flags::{LogFlags, read};
use machine_file::Written;
use posicast_identify::recommend::Judgement;
use posicast_system::output::OutputFiles;
use posicast_testbench::wave::write_text;
use std::path::{Path, PathBuf};

/// Modes from a measured log, with their uncertainty, shapers for them, and a machine file
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  posicast identify raw_data_x.csv                    an accelerometer's log of a printer's resonance test
  posicast identify raw_data_x.csv --plot x.svg -o printer.toml
  posicast identify raw_data_y.csv --machine printer.toml --axis y -o both.toml
  posicast identify step.csv --json                   columns time,command,response
  posicast identify stop.csv --columns time_ms,accel_x_g,-,-
                                                      what rings after a stop, in a file whose header does not say it

The columns of a log, and what each method needs: docs/identify.md")]
pub(crate) struct Args {
    /// Log in CSV: time,accel_x,accel_y,accel_z in s and mm/s², or time,command,response
    log: PathBuf,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
    /// Write a machine file with the modes found and the first shaper of the list
    #[arg(short, long, value_name = "MACHINE")]
    output: Option<PathBuf>,
    /// Take this machine file and put the modes into the axis that --axis names, instead of starting from a template
    #[arg(long, value_name = "MACHINE", requires = "output", conflicts_with_all = ["printer", "gantry", "joint", "crane"])]
    machine: Option<PathBuf>,
    /// Name of the axis in the machine file; else that of the sensor's direction, or the first
    #[arg(long, value_name = "NAME", requires = "output")]
    axis: Option<String>,
    #[command(flatten)]
    kind: KindFlags,
    /// Draw the fit, the shapers and the ringing into this SVG file
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    excitation: ExcitationFlags,
    #[command(flatten)]
    log_flags: LogFlags,
    /// Jump of the acceleration by which shapers are judged, in m/s² or rad/s²
    #[arg(long, value_name = "M/S2", default_value = "5", value_parser = excitation::positive)]
    acceleration: f64,
    /// Change of the frequencies in percent that a shaper must stand beside what the log leaves open
    #[arg(long, value_name = "PERCENT", default_value = "5", value_parser = crate::compare::band, allow_negative_numbers = true)]
    margin: f64,
    /// Replace a file that posicast did not write, or that was changed since; never one that this command reads
    #[arg(long)]
    force: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let mut outputs = OutputFiles::new(args.force);
    outputs.input("the log", &args.log);
    if let Some(machine) = &args.machine {
        outputs.input("--machine", machine);
    }
    for (option, path) in [("-o", &args.output), ("--plot", &args.plot)] {
        if let Some(path) = path {
            let claimed = match option {
                "-o" => outputs.claim_machine_file(option, path),
                _ => outputs.claim(option, path),
            };
            claimed.map_err(Failure::because)?;
        }
    }
    if let Some(path) = &args.plot {
        plot::check_name("--plot", path)?;
    }
    output::one_document(&outputs, args.json)?;
    let reading = read(&args.log, &args.log_flags)?;
    let judgement = Judgement {
        acceleration: args.acceleration,
        margin: args.margin / 100.0,
        ..Judgement::default()
    };
    let mut findings =
        Findings::of(&reading, &args.excitation, &judgement).map_err(|error| error.in_file(&args.log))?;
    let machine = match &args.output {
        Some(path) if !findings.modes.is_empty() => Some((path, machine_text(args, path, &findings)?)),
        _ => None,
    };
    findings.unit = match &machine {
        Some((_, machine)) => machine.unit,
        None => args.kind.kind().unwrap_or(findings.kind()).unit(),
    };
    if let Some(path) = &args.plot {
        write_text(path, &plot::svg(&pictures::panels(&findings, &reading.log))?).map_err(Failure::because)?;
    }
    if let Some((path, machine)) = &machine {
        output::write_text(path, machine.text.as_str())?;
    }
    if args.json {
        output::print_json(&document::Document::new(&findings))?;
    } else {
        let written = machine.as_ref().map(|(path, machine)| (path.as_path(), machine));
        output::print_beside(&outputs, &text::text(&args.log, &findings, written))?;
    }
    match findings.modes.is_empty() {
        false => Ok(()),
        true => Err(none_found(&args.log, args.output.is_some())),
    }
}

/// Writes a machine file with the modes of a log, found with default settings.
pub(crate) fn new_machine(
    log: &Path,
    file: &Path,
    kind: Option<MachineKind>,
    outputs: &OutputFiles,
) -> Result<(), Failure> {
    const OPTIONS: &str = "`posicast identify LOG -o FILE` has the options --columns, --rate and --direction";
    let flags = ExcitationFlags::default();
    let reading = read(log, &LogFlags::default()).map_err(|failure| failure.or_help(OPTIONS))?;
    let mut findings = Findings::of(&reading, &flags, &Judgement::default()).map_err(|error| error.in_file(log))?;
    if findings.modes.is_empty() {
        return Err(none_found(log, true));
    }
    let machine = machine_file::from_template(kind.unwrap_or(findings.kind()), file, None, &findings)?;
    findings.unit = machine.unit;
    output::write_text(file, machine.text.as_str())?;
    let said = text::text(log, &findings, Some((file, &machine)));
    output::print_beside(outputs, &format!("{said}{}\n", schema::hint(file)))
}

fn none_found(log: &Path, wanted: bool) -> Failure {
    let but = if wanted { ", and no machine file written" } else { "" };
    Failure::Check(format!("{}: no mode was found{but}", log.display()))
}

fn machine_text(args: &Args, path: &Path, findings: &Findings) -> Result<Written, Failure> {
    match &args.machine {
        Some(machine) => machine_file::into_existing(machine, args.axis.as_deref(), findings),
        None => {
            let kind = args.kind.kind().unwrap_or(findings.kind());
            machine_file::from_template(kind, path, args.axis.as_deref(), findings)
        }
    }
}
