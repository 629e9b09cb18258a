//! Reads the machine file, and finds the key that causes an error.

use crate::failure::Failure;
use posicast_machine::hardware::HardwareError;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::{DesignBlame, blame};
use posicast_shaper::design::DesignError;
use posicast_synth::yosys::Family;
use std::cell::RefCell;
use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest size in bytes. A machine file is a page of text, so anything far larger is a wrong file.
const LARGEST_FILE_BYTES: u64 = 1 << 20;

/// A machine file, read and validated.
pub struct MachineFile {
    /// The text of the file.
    pub text: String,
    /// The machine that it describes.
    pub machine: Machine,
    /// Names and texts of the other files that it names.
    pub beside: Vec<(String, String)>,
}

/// Reads and validates the machine file at `path`.
pub fn read(path: &Path) -> Result<MachineFile, Failure> {
    let name = path.display().to_string();
    let unreadable = |found: &dyn std::fmt::Display| {
        Failure::input(format!("cannot read the machine file `{name}`: {found}"))
            .with_help("name a machine file, such as examples/xy-stage.toml; `posicast new FILE` writes one")
    };
    let text = match text_of(path) {
        Ok(text) => text,
        Err(Unreadable::Encoding { line, found }) => {
            return Err(
                Failure::input(format!("{name}:{line}: found {found}; allowed: text in UTF-8"))
                    .with_help("save the file as UTF-8: in the editor's menu, or `iconv -f LATIN1 -t UTF-8 OLD > NEW`"),
            );
        }
        Err(found) => return Err(unreadable(&found)),
    };
    let beside = RefCell::default();
    let machine = parse_beside(path, &text, &beside)?;
    Ok(MachineFile {
        text,
        machine,
        beside: beside.into_inner(),
    })
}

/// Why a file cannot be read as text.
#[derive(Debug, thiserror::Error)]
enum Unreadable {
    #[error("{0}")]
    File(String),
    /// It is in another encoding.
    #[error("line {line}: found {found}; allowed: text in UTF-8")]
    Encoding {
        /// Line of the first byte that is not UTF-8, from 1.
        line: usize,
        /// That byte in its line.
        found: String,
    },
}

impl Unreadable {
    /// Describes the first byte that is not UTF-8, which follows `valid` valid bytes, by the words before it.
    fn encoding(bytes: &[u8], valid: usize) -> Self {
        const SHOWN: usize = 20;
        let before = String::from_utf8_lossy(&bytes[..valid]);
        let line = before.lines().count().max(1) + usize::from(before.ends_with('\n'));
        let words = before.rsplit('\n').next().unwrap_or_default();
        let skipped = words.chars().count().saturating_sub(SHOWN);
        let words: String = words.chars().skip(skipped).collect();
        let byte = bytes.get(valid).copied().unwrap_or_default();
        Self::Encoding {
            line,
            found: match words.trim() {
                "" => format!("the byte 0x{byte:02X}"),
                words => format!("the byte 0x{byte:02X} after \"{words}\""),
            },
        }
    }
}

/// The names of the axes of the plane in which paths and circles lie, such as `x and y`.
pub(crate) fn plane_name(machine: &Machine) -> String {
    let names: Vec<&str> = machine.axes.iter().take(2).map(|axis| axis.name.as_str()).collect();
    names.join(" and ")
}

/// The text of a file, or why it cannot be read.
fn text_of(path: &Path) -> Result<String, Unreadable> {
    let said = |error: std::io::Error| Unreadable::File(error.to_string());
    let metadata = std::fs::metadata(path).map_err(said)?;
    if metadata.is_dir() {
        return Err(Unreadable::File("it is a folder".to_owned()));
    }
    if metadata.len() > LARGEST_FILE_BYTES {
        let found = metadata.len();
        return Err(Unreadable::File(format!(
            "{found} bytes found, at most {LARGEST_FILE_BYTES} allowed"
        )));
    }
    // The length above is 0 for a device or a pipe, which may have no end.
    let file = File::open(path).map_err(said)?;
    let mut bytes = Vec::new();
    if file
        .take(LARGEST_FILE_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(said)? as u64
        > LARGEST_FILE_BYTES
    {
        return Err(Unreadable::File(format!("it goes on after {LARGEST_FILE_BYTES} bytes")));
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        Unreadable::encoding(error.as_bytes(), valid)
    })
}

/// Validates the text of the machine file at `path`; files that it names are read beside it.
pub fn parse(path: &Path, text: &str) -> Result<Machine, Failure> {
    parse_beside(path, text, &RefCell::default())
}

/// The same; adds the names and texts of other files that it reads to `read`, each once.
fn parse_beside(path: &Path, text: &str, read: &RefCell<Vec<(String, String)>>) -> Result<Machine, Failure> {
    let beside = |name: &str| {
        let text = text_of(&path.with_file_name(name)).map_err(|found| format!("cannot be read: {found}"))?;
        let mut read = read.borrow_mut();
        if read.iter().all(|(other, _)| other != name) {
            read.push((name.to_owned(), text.clone()));
        }
        Ok(text)
    };
    machine_file::parse_beside(&path.display().to_string(), text, &beside).map_err(Failure::from)
}

/// The device family of the machine file's target.
pub fn family(machine: &Machine) -> Result<Family, Failure> {
    match machine.target.as_ref().and_then(|target| target.family.as_ref()) {
        Some(family) => family.parse().map_err(Failure::because),
        None => Ok(Family::default()),
    }
}

/// Bad input at a key of the machine file at `path`, or of the machine file in the folder `path`; `axis` counts from
/// 0.
pub fn at_key(path: &Path, axis: usize, key: &str, reason: impl fmt::Display) -> Failure {
    Failure::input(place(path, axis, key, reason))
}

/// `:LINE` of a key, to follow the file's name.
fn line_of(file: &Path, axis: usize, key: &str) -> String {
    // If the file has disappeared since it was read, the key alone is given.
    let text = std::fs::read_to_string(file).unwrap_or_default();
    machine_file::line_of(&text, axis, key).map_or_else(String::new, |line| format!(":{line}"))
}

/// The machine file; `path` may also be the folder that contains it.
fn file_of(path: &Path) -> PathBuf {
    if path.is_dir() {
        path.join("machine.toml")
    } else {
        path.to_owned()
    }
}

/// The failure of a design of the machine file at `path`, or of that in the folder `path`.
pub fn of_design(machine: &Machine, error: &DesignError, path: &Path) -> Failure {
    let file = file_of(path);
    let Some(DesignBlame {
        axis,
        mode,
        key,
        remedy,
    }) = blame(machine, error)
    else {
        return Failure::input(format!("{}: {error}", file.display()));
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
    Failure::input(message).with_any_help(remedy)
}

/// The failure of hardware of the machine file at `path`, or of that in the folder `path`.
pub fn of_hardware(error: &HardwareError, path: &Path) -> Failure {
    let message = place(path, error.axis, &error.key, error);
    Failure::input(message).with_any_help(error.help.as_ref())
}

/// A message with the file, the line and the key of the machine file that it is about.
pub fn place(path: &Path, axis: usize, key: &str, message: impl fmt::Display) -> String {
    let file = file_of(path);
    format!("{}{}: {key}: {message}", file.display(), line_of(&file, axis, key))
}
