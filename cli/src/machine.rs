//! Reading the machine file, and saying which of its keys is to blame.

use crate::failure::Failure;
use posicast_model::hardware::HardwareError;
use posicast_model::machine_file::{self, Machine};
use posicast_synth::yosys::Family;
use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A machine file is a page of text; anything far beyond is some other file named by mistake.
const LARGEST_FILE_BYTES: u64 = 1 << 20;

/// A machine file, read and validated.
pub(crate) struct MachineFile {
    /// The text as it stands in the file.
    pub(crate) text: String,
    /// What it says.
    pub(crate) machine: Machine,
}

/// Reads and validates the machine file at `path`.
pub(crate) fn read(path: &Path) -> Result<MachineFile, Failure> {
    let name = path.display().to_string();
    let unreadable = |found: &dyn std::fmt::Display| {
        Failure::from(miette::miette!(
            help = "name a machine file, such as examples/xy-stage.toml",
            "cannot read the machine file `{name}`: {found}"
        ))
    };
    let metadata = std::fs::metadata(path).map_err(|e| unreadable(&e))?;
    if metadata.is_dir() {
        return Err(unreadable(&"it is a folder"));
    }
    if metadata.len() > LARGEST_FILE_BYTES {
        return Err(unreadable(&format!(
            "{} bytes found, at most {LARGEST_FILE_BYTES} allowed",
            metadata.len()
        )));
    }
    // The length above is 0 for a device or a pipe: these may go on for ever.
    let file = File::open(path).map_err(|e| unreadable(&e))?;
    let mut bytes = Vec::new();
    let limit = file.take(LARGEST_FILE_BYTES + 1).read_to_end(&mut bytes);
    if limit.map_err(|e| unreadable(&e))? as u64 > LARGEST_FILE_BYTES {
        return Err(unreadable(&format!("it goes on after {LARGEST_FILE_BYTES} bytes")));
    }
    let text = String::from_utf8(bytes).map_err(|e| unreadable(&format!("it is not UTF-8 text: {e}")))?;
    let machine = parse(path, &text)?;
    Ok(MachineFile { text, machine })
}

/// Validates the text of the machine file at `path`.
pub(crate) fn parse(path: &Path, text: &str) -> Result<Machine, Failure> {
    machine_file::parse(&path.display().to_string(), text).map_err(Failure::input)
}

/// The family of the machine file's target.
pub(crate) fn family(machine: &Machine) -> Result<Family, Failure> {
    match &machine.target {
        Some(target) => target.family.parse().map_err(Failure::because),
        None => Ok(Family::default()),
    }
}

/// Bad input at a key of the machine file at `path`, or of that in the folder; `axis` counts the axes from 0.
pub(crate) fn at_key(path: &Path, axis: usize, key: &str, reason: impl fmt::Display) -> Failure {
    let file = match path.is_dir() {
        true => path.join("machine.toml"),
        false => path.to_owned(),
    };
    // The file was read before; where it is gone, the key must do.
    let text = std::fs::read_to_string(&file).unwrap_or_default();
    let line = machine_file::line_of(&text, axis, key).map_or_else(String::new, |line| format!(":{line}"));
    Failure::from(miette::miette!("{}{line}: {key}: {reason}", file.display()))
}

/// The failure of hardware that the machine file at `path`, or that in the folder, asks for.
pub(crate) fn of_hardware(error: &HardwareError, path: &Path) -> Failure {
    at_key(path, error.axis, &error.key, error)
}
