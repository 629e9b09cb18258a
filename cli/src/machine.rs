//! Reads the machine file, and names the key of it that is to blame for an error.

use crate::failure::Failure;
use posicast_model::design::{DesignBlame, DesignError, blame};
use posicast_model::hardware::HardwareError;
use posicast_model::machine_file::{self, Machine};
use posicast_synth::yosys::Family;
use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest size in bytes. A machine file is a page of text; anything far beyond is another file named by mistake.
const LARGEST_FILE_BYTES: u64 = 1 << 20;

/// A machine file, read and validated.
pub(crate) struct MachineFile {
    /// The text of the file.
    pub(crate) text: String,
    /// The machine that it describes.
    pub(crate) machine: Machine,
}

/// Reads and validates the machine file at `path`.
pub(crate) fn read(path: &Path) -> Result<MachineFile, Failure> {
    let name = path.display().to_string();
    let unreadable = |found: &dyn std::fmt::Display| {
        Failure::from(miette::miette!(
            help = "name a machine file, such as examples/xy-stage.toml; `posicast new FILE` writes one",
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
    // The length above is 0 for a device or a pipe, which may never end.
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

/// The device family of the machine file's target.
pub(crate) fn family(machine: &Machine) -> Result<Family, Failure> {
    match &machine.target {
        Some(target) => target.family.parse().map_err(Failure::because),
        None => Ok(Family::default()),
    }
}

/// Bad input at a key of the machine file at `path`, or of the machine file in the folder `path`; `axis` counts from
/// 0.
pub(crate) fn at_key(path: &Path, axis: usize, key: &str, reason: impl fmt::Display) -> Failure {
    let file = file_of(path);
    let line = line_of(&file, axis, key);
    Failure::from(miette::miette!("{}{line}: {key}: {reason}", file.display()))
}

/// `:LINE` of a key, to follow the file's name.
fn line_of(file: &Path, axis: usize, key: &str) -> String {
    // The file was read before; if it is gone, the key alone must do.
    let text = std::fs::read_to_string(file).unwrap_or_default();
    machine_file::line_of(&text, axis, key).map_or_else(String::new, |line| format!(":{line}"))
}

/// The machine file; `path` may also be the folder that contains it.
fn file_of(path: &Path) -> PathBuf {
    match path.is_dir() {
        true => path.join("machine.toml"),
        false => path.to_owned(),
    }
}

/// The failure of a design of the machine file at `path`, or of that in the folder `path`.
pub(crate) fn of_design(machine: &Machine, error: &DesignError, path: &Path) -> Failure {
    let file = file_of(path);
    let Some(DesignBlame {
        axis,
        mode,
        key,
        remedy,
    }) = blame(machine, error)
    else {
        return Failure::from(miette::miette!("{}: {error}", file.display()));
    };
    let indexed = mode.map_or_else(
        || key.clone(),
        |mode| key.replacen("axis.mode", &format!("axis.mode[{mode}]"), 1),
    );
    let mode = mode.map_or_else(String::new, |mode| format!(", mode {}", mode + 1));
    let name = &machine.axes[axis].name;
    let reason = error.to_string();
    // The place already names the axis.
    let reason = reason.strip_prefix(&format!("axis {name}: ")).unwrap_or(&reason);
    let line = line_of(&file, axis, &indexed);
    let message = format!("{}{line}: {key} of axis {name}{mode}: {reason}", file.display());
    Failure::from(match remedy {
        Some(remedy) => miette::miette!(help = remedy, "{message}"),
        None => miette::miette!("{message}"),
    })
}

/// The failure of hardware of the machine file at `path`, or of that in the folder `path`.
pub(crate) fn of_hardware(error: &HardwareError, path: &Path) -> Failure {
    at_key(path, error.axis, &error.key, error)
}
