//! Chooses where an export is written. A user's own file is never replaced or appended to.
//!
//! Klipper's configuration ends with a block that `SAVE_CONFIG` writes. If anything follows this block, Klipper ignores it, and with it PID
//! values, the offset of the probe and meshes. So an export for Klipper is a separate file, which the configuration includes.

use super::ExportFormat;
use crate::failure::Failure;
use crate::observer::Observer;
use posicast_system::output::{Draft, OutputError, OutputFiles, seal};
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Klipper's mark at the beginning of each line of its own block.
const AUTOSAVE: &str = "#*#";
/// Suggested name for Klipper.
const SUGGESTED: &str = "posicast.cfg";

/// Place of the text.
pub(super) struct Place {
    format: ExportFormat,
    file: Option<PathBuf>,
}

impl Place {
    /// Requests the place before any work.
    pub(super) fn claim(format: ExportFormat, file: Option<&Path>, machine: &Path) -> Result<Self, Failure> {
        match file {
            None => refuse_to_append(format)?,
            Some(file) => {
                if is_klipper(format) && file.file_name() == Some(OsStr::new("printer.cfg")) {
                    return Err(owned(
                        &format!(
                            "--output {}: that is the name of the printer's own configuration",
                            file.display()
                        ),
                        format,
                    ));
                }
                let mut outputs = OutputFiles::new(false);
                outputs.input("the machine file", machine);
                outputs.claim("--output", file).map_err(|error| match error {
                    OutputError::Foreign { .. } | OutputError::MachineFile { .. } => owned(
                        &format!(
                            "--output {}: there is a file that posicast did not write, or that was changed since",
                            file.display()
                        ),
                        format,
                    ),
                    other => Failure::because(other),
                })?;
            }
        }
        Ok(Self {
            format,
            file: file.map(Path::to_owned),
        })
    }

    /// Writes the text, and reports what to do with the file. Without a file, returns the text.
    pub(super) fn write(&self, text: String, observer: &dyn Observer) -> Result<Option<String>, Failure> {
        let Some(file) = &self.file else {
            return Ok(Some(text));
        };
        let sealed = match self.format.comment() {
            Some(comment) => format!("{comment} {}\n{text}", seal::blank()),
            None => text,
        };
        let mut draft = Draft::new(file).map_err(Failure::because)?;
        draft
            .write_all(sealed.as_bytes())
            .and_then(|()| draft.put())
            .map_err(Failure::because)?;
        for line in self.next_step(file) {
            observer.say(&line);
        }
        Ok(None)
    }

    /// Instructions that make the firmware read the file.
    fn next_step(&self, file: &Path) -> Vec<String> {
        let name = file
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let written = format!("{}: written", file.display());
        let step = match self.format {
            ExportFormat::Klipper | ExportFormat::Kalico => vec![
                format!("put it beside printer.cfg, and add this line to printer.cfg, at its top, above the SAVE_CONFIG block:\n[include {name}]"),
                "then remove the same keys from [input_shaper] in printer.cfg, which would override them, and restart the firmware".into(),
            ],
            ExportFormat::Reprapfirmware => vec![format!(
                "put it into /sys, and add this line at the end of config.g:\nM98 P\"{name}\""
            )],
            ExportFormat::Marlin | ExportFormat::MarlinFt => {
                vec!["send its lines to the printer, then M500, which stores them".into()]
            }
            ExportFormat::C | ExportFormat::Csv | ExportFormat::Numpy | ExportFormat::Matlab => Vec::new(),
        };
        std::iter::once(written).chain(step).collect()
    }
}

fn is_klipper(format: ExportFormat) -> bool {
    matches!(format, ExportFormat::Klipper | ExportFormat::Kalico)
}

/// Refuses to change a file that is not an export.
fn owned(what: &str, format: ExportFormat) -> Failure {
    let remedy = if is_klipper(format) {
        format!(
            "name a file of its own, --include {SUGGESTED}, and add the line [include {SUGGESTED}] to printer.cfg, above the SAVE_CONFIG block"
        )
    } else {
        "name another file, or remove that one yourself".to_owned()
    };
    Failure::input(format!("{what}; an export never replaces such a file")).with_help(remedy)
}

/// Refuses to write behind Klipper's own block, if the shell appends the standard output to a configuration.
fn refuse_to_append(format: ExportFormat) -> Result<(), Failure> {
    let standard_output = Path::new("/dev/stdout");
    let appends = standard_output
        .metadata()
        .is_ok_and(|found| found.is_file() && found.len() > 0);
    // If it cannot be read, nothing is refused.
    let before = if appends && is_klipper(format) {
        std::fs::read(standard_output).unwrap_or_default()
    } else {
        return Ok(());
    };
    if String::from_utf8_lossy(&before)
        .lines()
        .any(|line| line.starts_with(AUTOSAVE))
    {
        Err(owned(
            "standard output is appended to a configuration with Klipper's SAVE_CONFIG block, which Klipper would drop",
            format,
        ))
    } else {
        Ok(())
    }
}
