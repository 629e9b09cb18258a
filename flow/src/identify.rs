//! `posicast identify`: finds modes in a measured log, and writes a machine file with them.

mod document;
mod excitation;
mod findings;
mod log_file;
mod machine_file;
mod pictures;

use crate::Outcome;
use crate::failure::Failure;
use crate::files::{ResultForm, one_document};
use crate::plot::{self, Panel};
use crate::template::MachineKind;
use crate::text::write_text as write_sealed;
use findings::Findings;
use log_file::read;
use machine_file::Written;
pub use posicast_identify::recommend::Judgement;
use posicast_system::output::OutputFiles;
use posicast_testbench::wave::write_text;
use std::path::{Path, PathBuf};

pub use document::{Background, Document, IdentifiedMode, RecommendedShaper, WrittenMachine};
pub use excitation::{LogExcitation, positive, sweep};
pub use log_file::LogOptions;

/// Options of the identification and its output.
#[derive(Debug, Clone)]
pub struct Options {
    /// Log in CSV.
    pub log: PathBuf,
    /// The machine file to write, with the modes found and the first shaper of the list.
    pub output: Option<PathBuf>,
    /// The machine file whose axis gets the modes; `None`: a template.
    pub machine: Option<PathBuf>,
    /// Name of the axis in the machine file; `None`: that of the sensor's direction, or the first.
    pub axis: Option<String>,
    /// Kind of machine of the template; `None`: chosen by the modes.
    pub kind: Option<MachineKind>,
    /// The SVG file into which fit, shapers and ringing are drawn.
    pub plot: Option<PathBuf>,
    /// Knowledge about the excitation.
    pub excitation: LogExcitation,
    /// Information that the log's file lacks.
    pub log_options: LogOptions,
    /// Jump of the acceleration by which shapers are judged, in m/s² or rad/s².
    pub acceleration: f64,
    /// Change of the frequencies in percent that a shaper must tolerate in addition to the uncertainty of the log.
    pub margin_percent: f64,
    /// Whether a file that posicast did not write is replaced; never one that is read.
    pub force: bool,
    /// What the front does with the document.
    pub form: ResultForm,
}

/// Finds the modes in a log.
///
/// # Errors
/// [`Failure`] for files that cannot be read, understood or written. A log without a mode is not an error but gives [`Outcome::failed`].
pub fn identify(options: &Options) -> Result<Outcome<Document>, Failure> {
    let mut outputs = OutputFiles::new(options.force);
    outputs.input("the log", &options.log);
    if let Some(machine) = &options.machine {
        outputs.input("--machine", machine);
    }
    if let Some(path) = &options.output {
        outputs.claim_machine_file("-o", path).map_err(Failure::because)?;
    }
    if let Some(path) = &options.plot {
        outputs.claim("--plot", path).map_err(Failure::because)?;
        plot::check_name("--plot", path)?;
    }
    one_document(&outputs, options.form)?;
    let reading = read(&options.log, &options.log_options)?;
    let judgement = Judgement {
        acceleration: options.acceleration,
        margin: options.margin_percent / 100.0,
        ..Judgement::default()
    };
    let mut findings =
        Findings::of(&reading, &options.excitation, &judgement).map_err(|error| error.in_file(&options.log))?;
    let machine = match &options.output {
        Some(path) if !findings.modes.is_empty() => Some((path.as_path(), machine_text(options, path, &findings)?)),
        _ => None,
    };
    findings.unit = match &machine {
        Some((_, machine)) => machine.unit,
        None => options.kind.unwrap_or(findings.kind()).unit(),
    };
    if let Some(path) = &options.plot {
        write_text(path, &plot::svg(&pictures::panels(&findings, &reading.log))?).map_err(Failure::because)?;
    }
    if let Some((path, machine)) = &machine {
        write_sealed(path, machine.text.as_str())?;
    }
    let written = machine.map(|(path, machine)| machine.at(path));
    let failed = findings
        .modes
        .is_empty()
        .then(|| none_found(&options.log, options.output.is_some()));
    Ok(Outcome {
        failed,
        ..Outcome::passed(Document::new(&options.log, &findings, written)).beside(&outputs)
    })
}

/// Finds the modes in a log, without writing a file; returns the curves of its picture, too.
///
/// # Errors
/// As [`identify`].
pub fn with_curves(
    log: &Path,
    log_options: &LogOptions,
    excitation: &LogExcitation,
    judgement: &Judgement,
) -> Result<(Outcome<Document>, Vec<Panel>), Failure> {
    let reading = read(log, log_options)?;
    let mut findings = Findings::of(&reading, excitation, judgement).map_err(|error| error.in_file(log))?;
    findings.unit = findings.kind().unit();
    let panels = pictures::panels(&findings, &reading.log);
    let outcome = Outcome {
        failed: findings.modes.is_empty().then(|| none_found(log, false)),
        ..Outcome::passed(Document::new(log, &findings, None))
    };
    Ok((outcome, panels))
}

/// Writes a machine file with the modes of a log, found with default settings.
///
/// # Errors
/// [`Failure`] for files that cannot be read, understood or written, and for a log without a mode.
pub fn new_machine(log: &Path, file: &Path, kind: Option<MachineKind>) -> Result<Document, Failure> {
    const OPTIONS: &str = "`posicast identify LOG -o FILE` has the options --columns, --rate and --direction";
    let reading = read(log, &LogOptions::default()).map_err(|failure| failure.or_help(OPTIONS))?;
    let mut findings =
        Findings::of(&reading, &LogExcitation::default(), &Judgement::default()).map_err(|error| error.in_file(log))?;
    if findings.modes.is_empty() {
        return Err(Failure::Check(none_found(log, true)));
    }
    let machine = machine_file::from_template(kind.unwrap_or(findings.kind()), file, None, &findings)?;
    findings.unit = machine.unit;
    write_sealed(file, machine.text.as_str())?;
    Ok(Document::new(log, &findings, Some(machine.at(file))))
}

fn none_found(log: &Path, wanted: bool) -> String {
    let but = if wanted { ", and no machine file written" } else { "" };
    format!("{}: no mode was found{but}", log.display())
}

fn machine_text(options: &Options, path: &Path, findings: &Findings) -> Result<Written, Failure> {
    let axis = options.axis.as_deref();
    match &options.machine {
        Some(machine) => machine_file::into_existing(machine, axis, findings),
        None => machine_file::from_template(options.kind.unwrap_or(findings.kind()), path, axis, findings),
    }
}
